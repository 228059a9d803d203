//! Light at any point of the grid: interpolate the irradiance vectors, then reconstruct.

use glam::{DVec3, Vec3};

use crate::spatial::Taps;
use crate::{HemisphereVectors, IrradianceGrid, Reconstruction, SpatialFilter, reconstruct};

/// How far [`IrradianceGrid::surface_irradiance`] moves its point off the surface, as a share of the smallest step.
///
/// Enough to leave vertices that lie on the surface or just behind it, a tenth of what the interpolation spreads
/// light by anyway.
pub const SURFACE_BIAS: f64 = 0.1;

impl IrradianceGrid {
    /// The irradiance \[W/m²\] at point `p` \[m\] of a surface with unit normal `n`, one value a channel, never negative.
    ///
    /// Interpolates the vectors (linear quantities, so that directions and colours are never averaged apart) and
    /// reconstructs the irradiance from them. Which vertices count near geometry, and what a point outside the grid
    /// gets, is the rule of [`spatial`](crate::spatial): vertices behind walls count nothing while another one is
    /// reachable, and outside the box the nearest point of it answers.
    #[must_use]
    pub fn irradiance(
        &self,
        p: DVec3,
        n: Vec3,
        reconstruction: Reconstruction,
        filter: SpatialFilter,
    ) -> Vec3 {
        let vectors = self.interpolate(p, Some(n), filter, |hemisphere| reconstruction.reads(hemisphere, n));
        reconstruct(reconstruction, &vectors, n)
    }

    /// Like [`irradiance`](Self::irradiance), for shading: at a point moved along the normal by `bias` times the
    /// smallest step. [`SURFACE_BIAS`] is a good share.
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
    #[must_use]
    pub fn vectors_at(&self, p: DVec3, n: Option<Vec3>, filter: SpatialFilter) -> HemisphereVectors {
        self.interpolate(p, n, filter, |_| true)
    }

    fn interpolate(
        &self,
        p: DVec3,
        n: Option<Vec3>,
        filter: SpatialFilter,
        reads: impl Fn(usize) -> bool,
    ) -> HemisphereVectors {
        let mut sums = [[[0.0; 3]; 3]; 6];
        for (vertex, weight) in Taps::new(self, p, n, filter).iter() {
            let vectors = &self.vectors()[vertex];
            for hemisphere in (0..6).filter(|&hemisphere| reads(hemisphere)) {
                let sum = sums[hemisphere].as_flattened_mut();
                for (sum, component) in sum.iter_mut().zip(vectors[hemisphere].as_flattened()) {
                    *sum += weight * component;
                }
            }
        }
        sums
    }
}

#[cfg(test)]
mod tests;
