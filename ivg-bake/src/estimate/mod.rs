//! From flights of photons to what the vertices hold: irradiance vectors, or spherical harmonics of the radiance.

pub(crate) mod face_crossing;
pub(crate) mod gather;
pub(crate) mod held;
pub(crate) mod queue;
pub(crate) mod track_length;
pub(crate) mod vertex_gather;

use glam::Vec3;

use crate::accumulate::{Sums, Total};

/// Numbers of a flight's deposit of irradiance vectors: three channels times three axes.
pub(crate) const NUMBERS: usize = 9;

/// A straight flight of a photon between two surfaces, or beyond the last.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flight {
    pub(crate) origin: Vec3,
    /// Unit length.
    pub(crate) direction: Vec3,
    /// Length \[bake units\], perhaps infinite.
    pub(crate) length: f32,
    /// Power as a share of a whole photon's, each channel in [0, 1].
    pub(crate) power: Vec3,
}

impl Flight {
    /// Power times the direction the light comes from: `[rgb][xyz]`, scaled.
    #[inline]
    fn numbers(&self, scale: f32) -> [f32; NUMBERS] {
        let w = -self.direction * scale;
        let [r, g, b] = self.power.to_array().map(|channel| w * channel);
        [r.x, r.y, r.z, g.x, g.y, g.z, b.x, b.y, b.z]
    }
}

/// How the flights of photons become what the vertices hold.
pub(crate) trait Estimate: Sync {
    /// What a vertex holds.
    type Value;

    /// Number of sums.
    fn sums(&self) -> usize;

    /// Deposits a flight.
    fn deposit(&self, flight: &Flight, sums: &mut impl Sums);

    /// The values of all `vertices` from the sums of a finished bake; `power` as below.
    fn values(&self, sums: Vec<i64>, vertices: usize, power: f64) -> Vec<Self::Value> {
        let total = Total::of(&sums);
        (0..vertices).map(|vertex| self.value(&total, vertex, power)).collect()
    }

    /// The value of a vertex from all sums; `power` is what a photon of share 1 carries \[W\], lengths are in bake units.
    fn value(&self, sums: &Total<'_>, vertex: usize, power: f64) -> Self::Value;
}
