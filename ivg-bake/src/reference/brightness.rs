//! Whether surfaces that a client lights from a grid are as bright as they should be.

use glam::{DVec3, Vec3};
use ivg_format::Lattice;
use ivg_grid::{
    FillOptions, IrradianceGrid, Reconstruction, SURFACE_BIAS, SpatialFilter, VertexValues, fill,
};

use super::{Oracle, Sampling};
use crate::sampling::hemisphere;
use crate::sampling::rng::{Purpose, Stream};
use crate::validity::ASIDE;
use crate::{BakeError, Monitor};

/// Seed of the pixels: the same scene and grid are always looked at in the same places.
const VIEW_SEED: u64 = 0;

/// Points that are tried until one is in the open.
const LOOKS: u32 = 64;

/// The least difference of radiance that an 8-bit sRGB picture shows, near black, relative to white: a code, on the straight part of the curve (IEC 61966-2-1).
const SRGB_CODE: f64 = 1.0 / (255.0 * 12.92);

/// What the mean of a picture is exposed to, relative to white: the middle grey of photography.
const MIDDLE_GREY: f64 = 0.18;

/// Share of the mean light below which a part's light is not what its error is relative to: an error of a tenth of so little is
/// one code of an 8-bit sRGB picture whose mean is middle grey, and smaller ones do not show. 1.7 %.
pub const DARKEST: f64 = 10.0 * SRGB_CODE / MIDDLE_GREY;

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
    /// Standard error of `ratio`, as a ratio of means over places (W. Cochran, "Sampling Techniques", 1977, section 6.4): what
    /// other paths and other places would change. What other photons would is not in it. Infinite for one place.
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
}

impl Brightness {
    /// How far the part is off: the difference of baked and traced light, relative to the traced light or, if that is more, to
    /// [`DARKEST`] of the `mean` traced irradiance of all parts \[W/m²\].
    #[must_use]
    pub fn off(&self, mean: f64) -> f64 {
        let whole = self.traced.max(DARKEST * mean);
        if whole > 0.0 { self.traced * (self.ratio - 1.0).abs() / whole } else { 0.0 }
    }

    /// Standard error of what [`off`](Self::off) tells, relative to the same.
    #[must_use]
    pub fn off_error(&self, mean: f64) -> f64 {
        let whole = self.traced.max(DARKEST * mean);
        if whole > 0.0 { self.traced * self.error / whole } else { 0.0 }
    }
}

/// What [`Oracle::brightness`] makes of places: all together, then those in each of `boxes`³ equal boxes of the lattice's bounds
/// that has any.
#[must_use]
pub fn brightness_of(places: &[LitPlace], lattice: &Lattice, boxes: u16) -> Vec<Brightness> {
    let [nx, ny, nz] = lattice.dims.map(|n| n - 1);
    let (low, high) = (DVec3::from(lattice.origin), DVec3::from(lattice.position(nx, ny, nz)));
    let step = (high - low) / f64::from(boxes.max(1));
    let count = usize::from(boxes.max(1));
    let mut sums = vec![Sums::default(); count * count * count];
    for place in places {
        let at = ((place.point - low) / step).to_array().map(|x| (x.max(0.0) as usize).min(count - 1));
        sums[at[0] + count * (at[1] + count * at[2])].add(&Sums {
            places: 1,
            baked: place.baked,
            traced: place.traced,
            squares: [place.baked * place.baked, place.baked * place.traced, place.traced * place.traced],
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
    /// each of `boxes`³ equal boxes of the grid's bounds that has any.
    ///
    /// The places are about `places` pixels of pictures that are taken everywhere: in all directions from points that are even over the
    /// open space within the grid's bounds, as far as there is light: next to a vertex with at least [`DARKEST`] of the mean, for in less
    /// a picture exposed for the scene shows nothing. So a place counts as much as it is seen; the inside of a scanned model and the gap
    /// under it, where no camera comes, do not count, although a little light gets there. Of `sampling` the paths are
    /// those of each place.
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

    /// The places that [`brightness`](Self::brightness) looks at, each with what was found there.
    ///
    /// # Errors
    ///
    /// [`BakeError::Cancelled`]; the monitor's progress counts places.
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
        let lit = self.lit_vertices(grid);
        let seen: Vec<_> = (0..places).filter_map(|n| self.pixel(grid.lattice(), &lit, n as u64)).collect();
        let traced = self.irradiance(&seen, sampling, monitor)?;
        let filled = fill(grid, &FillOptions::default());
        let found = seen.into_iter().zip(traced).map(|((point, normal), traced)| {
            let filter = SpatialFilter::Trilinear;
            let baked = filled.surface_irradiance(point, normal, SURFACE_BIAS, reconstruction, filter);
            LitPlace {
                point,
                normal,
                baked: f64::from(baked.element_sum()),
                traced: traced.irradiance.element_sum(),
                // Channels of one path go together: the worst case.
                error: traced.standard_error.element_sum(),
            }
        });
        Ok(found.collect())
    }

    /// The place, a little off a surface that reflects evenly, and the normal of its side that pixel `number` shows of pictures that
    /// are taken next to `lit` vertices; `None` where it shows no surface.
    fn pixel(&self, lattice: &Lattice, lit: &[bool], number: u64) -> Option<(DVec3, Vec3)> {
        let stage = &self.stage;
        let stream = Stream::new(VIEW_SEED, number);
        let [nx, ny, nz] = lattice.dims.map(|n| n - 1);
        let (low, high) = (DVec3::from(lattice.origin), DVec3::from(lattice.position(nx, ny, nz)));
        let eye = (0..LOOKS).find_map(|look| {
            let [x, y, z, _] = stream.uniforms(look, Purpose::View).map(f64::from);
            let eye = low + (high - low) * DVec3::new(x, y, z);
            self.is_open(lattice, lit, eye).then_some(eye)
        })?;
        let [u, v, ..] = stream.uniforms(LOOKS, Purpose::View);
        let (eye, direction) = (stage.space.to_bake(eye), hemisphere::sphere([u, v]));
        let hit = stage.sight().closest_hit(eye, direction, f32::MAX)?;
        let point = stage.surfaces.point(hit.triangle, hit.weights);
        let side = point.facing(-direction);
        let reflects = stage.surfaces.albedo(&hit).max_element() > 0.0;
        reflects.then(|| (stage.space.to_world(point.origin(side)), side))
    }

    /// Which vertices are valid, lie in no surface (one in a wall would be seen from both sides) and have at least [`DARKEST`] of the
    /// mean light of those that are valid.
    fn lit_vertices(&self, grid: &IrradianceGrid) -> Vec<bool> {
        let light = |vertex: usize| -> f64 {
            if !grid.is_valid(vertex) {
                return 0.0;
            }
            match grid.get(vertex) {
                Some(VertexValues::Vectors(vectors)) => {
                    let along = |hemisphere: usize| {
                        vectors[hemisphere].iter().map(|c| f64::from(c[hemisphere / 2].abs())).sum::<f64>()
                    };
                    (0..6).map(along).sum()
                }
                Some(VertexValues::Radiance(radiance)) => radiance.iter().map(|c| f64::from(c[0])).sum(),
                None => 0.0,
            }
        };
        let all: Vec<f64> = (0..grid.vertex_count()).map(light).collect();
        let valid = (0..all.len()).filter(|&vertex| grid.is_valid(vertex)).count().max(1);
        let least = DARKEST * all.iter().sum::<f64>() / valid as f64;
        let free = |vertex: usize| {
            let (lattice, space) = (grid.lattice(), self.stage.space);
            let [i, j, k] = lattice.coords(vertex as u64);
            let middle = space.to_bake(lattice.position(i, j, k).into());
            let aside = DVec3::from(lattice.step) * (space.scale() * f64::from(ASIDE));
            // The diagonals of a small box: a wall, an edge or a corner that the vertex lies in cuts one of them.
            [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].iter().all(|[y, z]| {
                let half = (aside * DVec3::new(1.0, *y, *z)).as_vec3();
                !self.stage.sight().occluded(middle - half, half * 2.0, 1.0)
            })
        };
        let shows = |(vertex, light): (usize, f64)| light > 0.0 && light >= least && free(vertex);
        all.into_iter().enumerate().map(shows).collect()
    }

    /// Whether a point is in the open: a `lit` corner of its cell sees it.
    fn is_open(&self, lattice: &Lattice, lit: &[bool], eye: DVec3) -> bool {
        let stage = &self.stage;
        let from = stage.space.to_bake(eye);
        let first: [u16; 3] = core::array::from_fn(|a| {
            let (last, step) = (lattice.dims[a].saturating_sub(2), lattice.step[a]);
            if step > 0.0 {
                ((eye[a] - lattice.origin[a]) / step).clamp(0.0, f64::from(last)) as u16
            } else {
                0
            }
        });
        (0..8u16).any(|corner| {
            let [i, j, k] = core::array::from_fn(|a| (first[a] + (corner >> a & 1)).min(lattice.dims[a] - 1));
            let way = stage.space.to_bake(lattice.position(i, j, k).into()) - from;
            lit[lattice.index(i, j, k) as usize] && !stage.sight().occluded(from, way, 1.0)
        })
    }
}

/// Sums over places.
#[derive(Clone, Copy, Default)]
struct Sums {
    places: usize,
    baked: f64,
    traced: f64,
    /// Of baked light, of baked and traced, of traced.
    squares: [f64; 3],
}

impl Sums {
    fn add(&mut self, other: &Self) {
        self.places += other.places;
        self.baked += other.baked;
        self.traced += other.traced;
        self.squares.iter_mut().zip(other.squares).for_each(|(sum, square)| *sum += square);
    }

    fn brightness(&self, low: DVec3, high: DVec3) -> Brightness {
        let ratio = if self.traced > 0.0 { self.baked / self.traced } else { 0.0 };
        let places = self.places as f64;
        // Sum over places of the square of baked light less `ratio` times the traced: their mean is 0.
        let [baked, both, traced] = self.squares;
        let rest = (baked - 2.0 * ratio * both + ratio * ratio * traced).max(0.0);
        let error = match self.places {
            _ if self.traced <= 0.0 => 0.0,
            1 => f64::INFINITY,
            _ => (rest * places / (places - 1.0)).sqrt() / self.traced,
        };
        let traced = self.traced / places.max(1.0);
        Brightness { low, high, places: self.places, traced, error, ratio }
    }
}

#[cfg(test)]
mod tests;
