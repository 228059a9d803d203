use glam::DVec3;
use ivg_format::{Lattice, LatticeError, Quantity};
use ivg_scene::FlatScene;

use crate::BakeError;
use crate::stage::bounds;

/// How the flights of photons are turned into what the vertices hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Estimator {
    /// Length of the flights through each vertex's dual cell: unbiased for the mean over the cell, the least variance. Next
    /// to surfaces the mean is carried from the centre of what the vertex sees to the vertex, with the gradient around it.
    #[default]
    TrackLength,
    /// Crossings of the lattice's faces divided by the cosine (RR-6983 section 3.3, corrected): unbiased for the
    /// mean over the face; the tangential components are noisy.
    FaceCrossing,
    /// Crossings as RR-6983 prints the sum: a third too dark in even light. For comparison only.
    FaceCrossingRr6983,
    /// No photons: every vertex is path traced. Unbiased and slow; the yardstick of the others.
    Gather,
}

impl Estimator {
    /// All estimators, the default one first.
    pub const ALL: [Self; 4] =
        [Self::TrackLength, Self::FaceCrossing, Self::FaceCrossingRr6983, Self::Gather];

    /// Whether it gives spherical harmonics of the radiance, and not irradiance vectors alone.
    #[must_use]
    pub fn gives_radiance(self) -> bool {
        matches!(self, Self::TrackLength | Self::Gather)
    }

    /// The name on the command line and in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::TrackLength => "track-length",
            Self::FaceCrossing => "face-crossing",
            Self::FaceCrossingRr6983 => "face-crossing-rr6983",
            Self::Gather => "gather",
        }
    }

    /// The estimator of a name; `None` for a name that none has.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|estimator| estimator.name() == name)
    }
}

/// What to bake, and with how much effort.
#[derive(Debug, Clone, PartialEq)]
pub struct BakeOptions {
    /// Vertices along x, y and z, each at least 1. Time and memory grow with their product (for track lengths 576 bytes a
    /// vertex and thread, for radiance 216, while small; shared between threads beyond 512 MiB).
    pub dims: [u16; 3],
    /// First and last vertex in world space \[m\], taken as they are; `None`: see [`automatic_bounds`].
    pub bounds: Option<(DVec3, DVec3)>,
    /// Photons, at least 1; with an `accuracy`, the most. Noise falls with the square root. [`Estimator::Gather`] traces
    /// none.
    pub photons: u64,
    /// The relative error to stop at, in (0, 1), as [`AccuracyReport`](crate::AccuracyReport) measures it; `None`: all
    /// photons (or paths) are traced, and nothing is said about the error.
    pub accuracy: Option<f64>,
    /// Paths that [`Estimator::Gather`] traces for each vertex, rounded up to a multiple of 64 and at least 512; with an
    /// `accuracy`, the most, and at least 1024.
    pub paths: u32,
    /// How flights become what the vertices hold.
    pub estimator: Estimator,
    /// What the vertices hold: irradiance vectors, or spherical harmonics of the radiance, which only
    /// [`Estimator::TrackLength`] and [`Estimator::Gather`] give.
    pub quantity: Quantity,
    /// Seed of the random numbers. The same seed gives the same grid, bit for bit.
    pub seed: u64,
    /// Worker threads, at least 1; `None`: one for each core. The grid does not depend on it.
    pub threads: Option<usize>,
}

impl Default for BakeOptions {
    /// 16 × 16 × 16 vertices around the scene, a million photons, track lengths to irradiance vectors.
    fn default() -> Self {
        Self {
            dims: [16; 3],
            bounds: None,
            photons: 1_000_000,
            accuracy: None,
            paths: 4096,
            estimator: Estimator::TrackLength,
            quantity: Quantity::Vectors,
            seed: 1,
            threads: None,
        }
    }
}

/// Extents below this share of the longest one count as none: a floor, a wall.
const FLAT_SHARE: f64 = 1e-3;

/// What bounds grow by on an axis of two or three vertices, as a share of the extent.
const SMALL_MARGIN: f64 = 0.05;

/// Bounds of a lattice of `dims` vertices around a scene, in world space \[m\]: the first and the last vertex.
///
/// They lie one step outside the scene's own bounds, so that every surface has vertices on both its sides (those that
/// no light reaches become invalid). An axis of two or three vertices grows by 5 % of the extent instead. An axis along
/// which the scene is flat is given the longest extent, centred on the scene.
///
/// # Errors
///
/// [`LatticeError::NotFinite`] for a scene without triangles or with positions that are not numbers.
pub fn automatic_bounds(flat: &FlatScene, dims: [u16; 3]) -> Result<(DVec3, DVec3), LatticeError> {
    let (min, max) = bounds(flat).ok_or(LatticeError::NotFinite { axis: 0 })?;
    let longest = (max - min).max_element();
    // A scene that is a single point still has a size.
    let longest = if longest > 0.0 { longest } else { 1.0 };
    let (mut low, mut high) = (min, max);
    for axis in 0..3 {
        let middle = low[axis].midpoint(high[axis]);
        if high[axis] - low[axis] < FLAT_SHARE * longest {
            (low[axis], high[axis]) = (middle - 0.5 * longest, middle + 0.5 * longest);
            continue;
        }
        let extent = high[axis] - low[axis];
        let margin = match dims[axis] {
            0..=3 => SMALL_MARGIN * extent,
            n => extent / f64::from(n - 3),
        };
        low[axis] -= margin;
        high[axis] += margin;
    }
    Ok((low, high))
}

/// Vertices along x, y and z for cells that are about cubes, `longest` along the longest axis of the box from `min` to
/// `max`, and at least two along each.
#[must_use]
pub fn dims_for(min: DVec3, max: DVec3, longest: u16) -> [u16; 3] {
    let extent = max - min;
    let step = extent.max_element() / f64::from(longest.max(2) - 1);
    extent
        .to_array()
        .map(|e| if step > 0.0 { (e / step).round() as u16 + 1 } else { 1 }.clamp(2, longest.max(2)))
}

/// How far from the middle of the scene bounds may reach, in its diagonals: beyond, the scene itself is smaller than the
/// rounding of f32 coordinates allows the tracer to resolve well.
const FARTHEST: f64 = 1e4;

impl BakeOptions {
    /// Where the vertices will be.
    ///
    /// # Errors
    ///
    /// [`BakeError::Lattice`] or [`BakeError::FarBounds`].
    pub fn lattice(&self, flat: &FlatScene) -> Result<Lattice, BakeError> {
        let (min, max) = self.first_and_last(flat)?;
        Ok(Lattice::new(self.dims, min.to_array(), max.to_array())?)
    }

    /// The bounds given, or the automatic ones.
    pub(crate) fn first_and_last(&self, flat: &FlatScene) -> Result<(DVec3, DVec3), BakeError> {
        match self.bounds {
            Some((min, max)) => {
                let Some((low, high)) = bounds(flat) else { return Ok((min, max)) };
                let (middle, reach) = (low.midpoint(high), FARTHEST * (high - low).length());
                let near = |p: DVec3| (p - middle).abs().max_element() <= reach;
                // A scene that is a single point has no size to compare with; NaN is the lattice's to refuse.
                if reach > 0.0 && min.is_finite() && max.is_finite() && !(near(min) && near(max)) {
                    return Err(BakeError::FarBounds);
                }
                Ok((min, max))
            }
            None => Ok(automatic_bounds(flat, self.dims)?),
        }
    }

    /// Size of the dual cells along axes of one vertex \[m\]: what the bounds span there, else the mean of the other
    /// steps, else a metre.
    pub(crate) fn thickness(&self, lattice: &Lattice, min: DVec3, max: DVec3) -> [f64; 3] {
        let steps: Vec<f64> = lattice.step.into_iter().filter(|&s| s > 0.0).collect();
        let mean = if steps.is_empty() { 1.0 } else { steps.iter().sum::<f64>() / steps.len() as f64 };
        (max - min).to_array().map(|extent| if extent > 0.0 { extent } else { mean })
    }

    /// Worker threads.
    pub(crate) fn thread_count(&self) -> usize {
        let cores = || std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        self.threads.unwrap_or_else(cores).max(1)
    }
}

#[cfg(test)]
mod tests;
