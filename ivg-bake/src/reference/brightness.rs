//! Whether surfaces that a client lights from a grid are as bright as they should be.

use glam::{DVec3, Vec3};
use ivg_format::Lattice;
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

/// A place on one side of a surface, lit from a grid and by path tracing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LitPlace {
    /// Where it is, a little off the surface \[m\].
    pub point: DVec3,
    /// Unit normal of that side.
    pub normal: Vec3,
    /// Indirect irradiance that the grid gives it, all channels together \[W/m²\].
    pub baked: f64,
    /// The path-traced one \[W/m²\].
    pub traced: f64,
    /// Standard error of `traced` \[W/m²\].
    pub error: f64,
    /// Whether a vertex of the grid that light reaches sees it: one that is valid, in front of the surface, one of the
    /// 4 × 4 × 4 around the place, and with nothing in between.
    pub seen: bool,
}

/// What [`Oracle::brightness`] makes of places, of those that are [seen](LitPlace::seen): all together, then those in each of `boxes`³ equal boxes of the lattice's
/// bounds that has any.
#[must_use]
pub fn brightness_of(places: &[LitPlace], lattice: &Lattice, boxes: u16) -> Vec<Brightness> {
    let [nx, ny, nz] = lattice.dims.map(|n| n - 1);
    let (low, high) = (DVec3::from(lattice.origin), DVec3::from(lattice.position(nx, ny, nz)));
    let step = (high - low) / f64::from(boxes.max(1));
    let count = usize::from(boxes.max(1));
    let mut sums = vec![Sums::default(); count * count * count];
    for place in places.iter().filter(|place| place.seen) {
        let at = ((place.point - low) / step).to_array().map(|x| (x.max(0.0) as usize).min(count - 1));
        sums[at[0] + count * (at[1] + count * at[2])].add(&Sums {
            places: 1,
            baked: place.baked,
            traced: place.traced,
            variance: place.error * place.error,
        });
    }
    let mut all = Sums::default();
    sums.iter().for_each(|sum| all.add(sum));
    let parts = sums.iter().enumerate().filter(|(_, sum)| sum.places > 0).map(|(n, sum)| {
        let corner = DVec3::new((n % count) as f64, (n / count % count) as f64, (n / count / count) as f64);
        sum.brightness(low + step * corner, low + step * (corner + 1.0))
    });
    core::iter::once(all.brightness(low, high)).chain(parts).collect()
}

impl Oracle<'_> {
    /// Compares the indirect irradiance that `grid` gives surfaces, looked up as a client does (filled, moved off the surface by
    /// [`SURFACE_BIAS`], with `reconstruction`), with what paths find there: first for all surfaces together, then for those in
    /// each of `boxes`³ equal boxes of the grid's bounds that has any light.
    ///
    /// About `places` places are spread evenly over the area of all surfaces, each with both its sides; a side counts if a path
    /// finds light there and it is [seen](LitPlace::seen) from the open, where a camera may be. The inside of a scanned model
    /// and the floor under it do not count, although a little light gets there through holes and gaps.
    /// [`lit_places`](Self::lit_places) tells what is left out. Of `sampling` the paths are those of each side.
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
        let found = self.lit_places(grid, reconstruction, places, sampling, monitor)?;
        Ok(brightness_of(&found, grid.lattice(), boxes))
    }

    /// The places that [`brightness`](Self::brightness) looks at and a path finds light at, each with what was found there and
    /// whether it counts.
    ///
    /// # Errors
    ///
    /// [`BakeError::Cancelled`]; the monitor's progress counts sides.
    ///
    /// # Panics
    ///
    /// If the reconstruction does not [fit](Reconstruction::fits) what the grid holds.
    pub fn lit_places(
        &self,
        grid: &IrradianceGrid,
        reconstruction: Reconstruction,
        places: usize,
        sampling: Sampling,
        monitor: &dyn Monitor,
    ) -> Result<Vec<LitPlace>, BakeError> {
        let sides = self.sides(places);
        let traced = self.irradiance(&sides, sampling, monitor)?;
        let filled = fill(grid, &FillOptions::default());
        let lit = sides.into_iter().zip(traced).filter_map(|((point, normal), traced)| {
            let truth = traced.irradiance.element_sum();
            let filter = SpatialFilter::Trilinear;
            let baked = || filled.surface_irradiance(point, normal, SURFACE_BIAS, reconstruction, filter);
            (truth > 0.0).then(|| LitPlace {
                point,
                normal,
                baked: f64::from(baked().element_sum()),
                traced: truth,
                // Channels of one path go together: the worst case.
                error: traced.standard_error.element_sum(),
                seen: self.is_seen(grid, point, normal),
            })
        });
        Ok(lit.collect())
    }

    /// Whether a place a little off a surface is seen from one of the 4 × 4 × 4 vertices around it that light reaches.
    fn is_seen(&self, grid: &IrradianceGrid, point: DVec3, normal: Vec3) -> bool {
        let (lattice, sight) = (grid.lattice(), self.stage.sight());
        let from = self.stage.space.to_bake(point);
        let around: [core::ops::Range<u16>; 3] = core::array::from_fn(|a| {
            let (last, step) = (f64::from(lattice.dims[a]) - 1.0, lattice.step[a]);
            let place = if step > 0.0 { (point[a] - lattice.origin[a]) / step } else { 0.0 };
            let below = place.clamp(0.0, last).floor();
            ((below - 1.0).max(0.0) as u16)..((below + 2.0).min(last) as u16 + 1)
        });
        let [x, y, z] = around;
        z.into_iter().any(|k| {
            y.clone().any(|j| {
                x.clone().any(|i| {
                    let way = self.stage.space.to_bake(lattice.position(i, j, k).into()) - from;
                    grid.is_valid(lattice.index(i, j, k) as usize)
                        && way.dot(normal) > 0.0
                        && !sight.occluded(from, way, 1.0)
                })
            })
        })
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
