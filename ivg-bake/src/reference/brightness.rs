//! Whether surfaces that a client lights from a grid are as bright as they should be.

use glam::{DVec3, Vec3};
use ivg_grid::{FillOptions, IrradianceGrid, Reconstruction, SURFACE_BIAS, SpatialFilter, fill};

use super::{Oracle, Sampling};
use crate::{BakeError, Monitor};

/// Light of a part of the scene's surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Brightness {
    /// Lowest corner of the part's box \[m\].
    pub low: DVec3,
    /// Highest corner \[m\].
    pub high: DVec3,
    /// Places compared.
    pub places: usize,
    /// Mean path-traced indirect irradiance, all channels together \[W/m²\].
    pub traced: f64,
    /// Standard error of `ratio`, as the paths of each place leave it.
    pub error: f64,
    /// Mean irradiance that the grid gives over the traced one; 1 is right.
    pub ratio: f64,
}

impl Oracle<'_> {
    /// Compares the indirect irradiance that `grid` gives surfaces, looked up as a client does (filled, moved off the surface by
    /// [`SURFACE_BIAS`], with `reconstruction`), with what paths find there: first for all surfaces together, then for those in
    /// each of `boxes`³ equal boxes of the grid's bounds that has any light.
    ///
    /// About `places` places are spread evenly over the area of all surfaces, each with both its sides; a side counts if a path
    /// finds light there, so that the insides of solids, which nobody sees, do not. Of `sampling` the paths are those of each side.
    ///
    /// # Errors
    ///
    /// [`BakeError::Cancelled`]; the monitor's progress counts sides.
    ///
    /// # Panics
    ///
    /// If the reconstruction does not [fit](Reconstruction::fits) what the grid holds.
    pub fn brightness(
        &self,
        grid: &IrradianceGrid,
        reconstruction: Reconstruction,
        (places, boxes): (usize, u16),
        sampling: Sampling,
        monitor: &dyn Monitor,
    ) -> Result<Vec<Brightness>, BakeError> {
        let sides = self.sides(places);
        let traced = self.irradiance(&sides, sampling, monitor)?;
        let filled = fill(grid, &FillOptions::default());
        let lattice = grid.lattice();
        let [nx, ny, nz] = lattice.dims.map(|n| n - 1);
        let (low, high) = (DVec3::from(lattice.origin), DVec3::from(lattice.position(nx, ny, nz)));
        let step = (high - low) / f64::from(boxes.max(1));
        let count = usize::from(boxes.max(1));
        let mut sums = vec![Sums::default(); count * count * count];
        for ((place, normal), traced) in sides.iter().zip(traced) {
            let truth = traced.irradiance.element_sum();
            if truth <= 0.0 {
                continue;
            }
            let filter = SpatialFilter::Trilinear;
            let baked = filled.surface_irradiance(*place, *normal, SURFACE_BIAS, reconstruction, filter);
            let at = ((*place - low) / step).to_array().map(|x| (x.max(0.0) as usize).min(count - 1));
            sums[at[0] + count * (at[1] + count * at[2])].add(&Sums {
                places: 1,
                baked: f64::from(baked.element_sum()),
                traced: truth,
                // Channels of one path go together: the worst case.
                variance: traced.standard_error.element_sum().powi(2),
            });
        }
        let mut all = Sums::default();
        sums.iter().for_each(|sum| all.add(sum));
        let parts = sums.iter().enumerate().filter(|(_, sum)| sum.places > 0).map(|(n, sum)| {
            let corner =
                DVec3::new((n % count) as f64, (n / count % count) as f64, (n / count / count) as f64);
            sum.brightness(low + step * corner, low + step * (corner + 1.0))
        });
        Ok(core::iter::once(all.brightness(low, high)).chain(parts).collect())
    }

    /// Places in world space \[m\], a little off both sides of about as many points as asked for, spread over all
    /// surfaces in proportion to their area.
    fn sides(&self, places: usize) -> Vec<(DVec3, Vec3)> {
        let stage = &self.stage;
        let triangles = stage.surfaces.triangles();
        let area = |t: &[Vec3; 3]| f64::from((t[1] - t[0]).cross(t[2] - t[0]).length());
        let each = triangles.iter().map(area).sum::<f64>() / places.max(1) as f64;
        let mut sides = Vec::new();
        // Equal steps along the list of areas, the first half a step in.
        let mut left = 0.5 * each;
        for (number, triangle) in triangles.iter().enumerate() {
            left -= area(triangle);
            while left < 0.0 && each > 0.0 {
                let n = sides.len() as f64 / 2.0;
                // Multiples of irrational fractions are even over the square (Roberts 2018, "R2"), folded to a triangle.
                let [u, v] =
                    [0.754_877_666_246_693, 0.569_840_290_998_053].map(|a: f64| (0.5 + a * n).fract());
                let [u, v] = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] }.map(|x| x as f32);
                let point = stage.surfaces.point(number as u32, [1.0 - u - v, u, v]);
                for normal in [point.normal, -point.normal] {
                    sides.push((stage.space.to_world(point.origin(normal)), normal));
                }
                left += each;
            }
        }
        sides
    }
}

/// Sums over places.
#[derive(Clone, Copy, Default)]
struct Sums {
    places: usize,
    baked: f64,
    traced: f64,
    variance: f64,
}

impl Sums {
    fn add(&mut self, other: &Self) {
        self.places += other.places;
        self.baked += other.baked;
        self.traced += other.traced;
        self.variance += other.variance;
    }

    fn brightness(&self, low: DVec3, high: DVec3) -> Brightness {
        let ratio = if self.traced > 0.0 { self.baked / self.traced } else { 0.0 };
        let error = if self.traced > 0.0 { self.variance.sqrt() / self.traced * ratio } else { 0.0 };
        let traced = self.traced / self.places.max(1) as f64;
        Brightness { low, high, places: self.places, traced, error, ratio }
    }
}

#[cfg(test)]
mod tests;
