//! Light at any point of the grid: interpolate the values, then reconstruct.

use glam::{DVec3, Vec3};
use ivg_format::{HemisphereVectors, Quantity, RadianceHarmonics, Values, VertexValues};

use crate::spatial::Taps;
use crate::{IrradianceGrid, Reconstruction, SpatialFilter, harmonics, reconstruct};

/// How far [`IrradianceGrid::surface_irradiance`] moves its point off the surface, as a share of the smallest step.
///
/// Enough to leave vertices that lie on the surface or just behind it, a tenth of what the interpolation spreads
/// light by anyway.
pub const SURFACE_BIAS: f64 = 0.1;

impl IrradianceGrid {
    /// The irradiance \[W/m²\] at point `p` \[m\] of a surface with unit normal `n`, one value a channel, never negative.
    ///
    /// Interpolates the values (linear quantities, so that directions and colours are never averaged apart) and
    /// reconstructs the irradiance from them. Which vertices count near geometry, and what a point outside the grid
    /// gets, is the rule of [`spatial`](crate::spatial): vertices behind walls count nothing while another one is
    /// reachable, and outside the box the nearest point of it answers.
    ///
    /// # Panics
    ///
    /// If the reconstruction does not [fit](Reconstruction::fits) what the grid holds.
    #[must_use]
    pub fn irradiance(
        &self,
        p: DVec3,
        n: Vec3,
        reconstruction: Reconstruction,
        filter: SpatialFilter,
    ) -> Vec3 {
        assert!(
            reconstruction.fits(self.quantity()),
            "{} cannot be reconstructed by {}",
            self.quantity().name(),
            reconstruction.name()
        );
        let taps = Taps::new(self, p, Some(n), filter);
        match self.values() {
            Values::Vectors(all) => {
                let vectors = mix_vectors(all, &taps, |hemisphere| reconstruction.reads(hemisphere, n));
                reconstruct(reconstruction, &vectors, n)
            }
            Values::Radiance(all) => harmonics::irradiance(&mix_radiance(all, &taps), n),
        }
    }

    /// Like [`irradiance`](Self::irradiance), for shading: at a point moved along the normal by `bias` times the
    /// smallest step. [`SURFACE_BIAS`] is a good share.
    ///
    /// # Panics
    ///
    /// As [`irradiance`](Self::irradiance).
    #[must_use]
    pub fn surface_irradiance(
        &self,
        p: DVec3,
        n: Vec3,
        bias: f64,
        reconstruction: Reconstruction,
        filter: SpatialFilter,
    ) -> Vec3 {
        let smallest = self.lattice().step.into_iter().filter(|&step| step > 0.0).reduce(f64::min);
        let moved = p + n.as_dvec3() * (bias * smallest.unwrap_or(0.0));
        self.irradiance(moved, n, reconstruction, filter)
    }

    /// The interpolated irradiance vectors \[W/m²\] at point `p` \[m\].
    ///
    /// A normal `n` tells the side of a surface that the point lies on, where geometry divides a cell; without one the
    /// nearer side counts.
    ///
    /// # Panics
    ///
    /// If the grid holds radiance harmonics.
    #[must_use]
    pub fn vectors_at(&self, p: DVec3, n: Option<Vec3>, filter: SpatialFilter) -> HemisphereVectors {
        mix_vectors(self.vectors(), &Taps::new(self, p, n, filter), |_| true)
    }

    /// The interpolated values at point `p` \[m\], of what the grid holds; see [`vectors_at`](Self::vectors_at).
    #[must_use]
    pub fn values_at(&self, p: DVec3, n: Option<Vec3>, filter: SpatialFilter) -> VertexValues {
        match self.quantity() {
            Quantity::Vectors => VertexValues::Vectors(self.vectors_at(p, n, filter)),
            Quantity::Radiance => {
                VertexValues::Radiance(mix_radiance(self.radiance(), &Taps::new(self, p, n, filter)))
            }
        }
    }
}

/// The weighted sum of the vectors of those hemispheres that are read; zero for the others.
fn mix_vectors(all: &[HemisphereVectors], taps: &Taps, reads: impl Fn(usize) -> bool) -> HemisphereVectors {
    let mut sums = [[[0.0; 3]; 3]; 6];
    for (vertex, weight) in taps.iter() {
        for hemisphere in (0..6).filter(|&hemisphere| reads(hemisphere)) {
            let sum = sums[hemisphere].as_flattened_mut();
            for (sum, component) in sum.iter_mut().zip(all[vertex][hemisphere].as_flattened()) {
                *sum += weight * component;
            }
        }
    }
    sums
}

fn mix_radiance(all: &[RadianceHarmonics], taps: &Taps) -> RadianceHarmonics {
    let mut sums = [[0.0; 9]; 3];
    for (vertex, weight) in taps.iter() {
        for (sum, coefficient) in sums.as_flattened_mut().iter_mut().zip(all[vertex].as_flattened()) {
            *sum += weight * coefficient;
        }
    }
    sums
}

#[cfg(test)]
mod tests;
