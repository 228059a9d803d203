//! Light gathered at a vertex by path tracing until its error is small enough.

use core::f64::consts::PI;

use glam::{DVec3, Vec3};
use ivg_grid::harmonics::{COEFFICIENTS, basis};

use super::gather::Mean;
use super::held::{AXES, Held};
use crate::sampling::rng::{Purpose, Stream};
use crate::stage::Stage;

/// Numbers of the irradiance vectors of a point, `[hemisphere][rgb][xyz]`.
pub(crate) const VECTOR_NUMBERS: usize = 54;

/// Numbers of the radiance harmonics of a point, `[rgb][coefficient]`.
pub(crate) const RADIANCE_NUMBERS: usize = 3 * COEFFICIENTS;

/// Numbers gathered at a vertex: vectors, then harmonics.
pub(crate) const NUMBERS: usize = VECTOR_NUMBERS + RADIANCE_NUMBERS;

/// Paths of a batch: their first directions are spread evenly over the sphere.
const PATHS: u32 = 64;

/// Batches that tell how many are needed, and the fewest of those: the spread of eight means tells their variance to a
/// half, and 18 numbers are looked at together.
const BATCHES: u32 = 8;

/// The fewest paths of a vertex.
pub(crate) const FEWEST_PATHS: u32 = BATCHES * PATHS;

/// Sets the random numbers of gathering apart from those of photons with the same seed.
const SEED: u64 = 0x9d2c_5680_6a09_e667;

/// How well a vertex is to be gathered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Enough {
    /// So many paths, rounded up to whole batches and [`FEWEST_PATHS`].
    Paths(u32),
    /// About so many paths, of which the variance of one vertex is told roughly and that of many well: rounded up to whole
    /// batches, at least two.
    Roughly(u32),
    /// Until the sum of the variances of the 18 irradiances along the axes is about `variance` \[(W/m²)²\], with `most`
    /// paths at most.
    Variance {
        /// The sum of variances.
        variance: f64,
        /// The most paths.
        most: u32,
    },
}

/// Light gathered at a vertex.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct VertexGather {
    /// Vectors \[W/m²\], then harmonics \[W/(m² sr)\].
    pub(crate) numbers: [f64; NUMBERS],
    /// The irradiance along the axes, as [`Held::axes`] of the quantity gathered for \[W/m²\].
    pub(crate) axes: [f64; AXES],
    /// Sum of the variances of the axes' irradiance \[(W/m²)²\].
    pub(crate) variance: f64,
    pub(crate) paths: u32,
}

impl Stage<'_> {
    /// Gathers light at `eye` (bake space) for the vertex of an index. The result depends on seed, vertex and `enough` alone.
    ///
    /// How many paths a variance takes is told from the first batches, and the variance from the others alone. Were paths added
    /// until those traced seem to be enough, vertices would stop where chance makes their variance look small (C. Stein, "A
    /// two-sample test for a linear hypothesis whose power is independent of the variance", 1945).
    pub(crate) fn gather<V: Held>(
        &self,
        eye: Vec3,
        vertex: usize,
        seed: u64,
        enough: Enough,
    ) -> VertexGather {
        let mut sums = [0.0; NUMBERS];
        let mut trace = |batches: core::ops::Range<u32>| {
            let mut mean = Mean::<AXES>::default();
            for batch in batches {
                let batch = self.gather_batch(eye, vertex, seed, batch);
                sums.iter_mut().zip(&batch).for_each(|(sum, x)| *sum += x);
                mean.add(&V::gathered(&batch).axes().map(f64::from));
            }
            mean
        };
        let variance = |mean: &Mean<AXES>| mean.standard_error().iter().map(|e| e * e).sum::<f64>();
        let mut fixed = |batches: u32| (batches, variance(&trace(0..batches)));
        let (batches, variance) = match enough {
            Enough::Paths(paths) => fixed(paths.max(FEWEST_PATHS).div_ceil(PATHS)),
            Enough::Roughly(paths) => fixed(paths.div_ceil(PATHS).max(2)),
            Enough::Variance { variance: wanted, most } => {
                let of_first = variance(&trace(0..BATCHES));
                let most = f64::from(most / PATHS);
                // Nothing but darkness divided by nothing wanted is not a number, and is enough.
                let needed = (f64::from(BATCHES) * of_first / wanted).ceil().min(most).max(0.0) as u32;
                let batches = needed.max(2 * BATCHES);
                let others = batches - BATCHES;
                let of_others = variance(&trace(BATCHES..batches));
                (batches, of_others * f64::from(others) / f64::from(batches))
            }
        };
        let numbers = sums.map(|sum| sum / f64::from(batches));
        let axes = V::gathered(&numbers).axes().map(f64::from);
        VertexGather { numbers, axes, variance, paths: batches * PATHS }
    }

    /// The mean of a batch of paths.
    fn gather_batch(&self, eye: Vec3, vertex: usize, seed: u64, batch: u32) -> [f64; NUMBERS] {
        let stream = |path: u32| {
            let item = (vertex as u64) << 32 | u64::from(batch * PATHS + path);
            Stream::new(seed ^ SEED, item)
        };
        let [_, _, u, v] = stream(0).uniforms(0, Purpose::Gather);
        let mut sums = [0.0; NUMBERS];
        for path in 0..PATHS {
            let (w, radiance) = self.sample_even(eye, (path, PATHS), [u, v], &stream(path));
            add_light(&mut sums, w, radiance * (4.0 * PI / f64::from(PATHS)));
        }
        sums
    }
}

/// Adds light from direction `w` \[W/m²\] to the numbers of a point: vectors, then harmonics.
pub(crate) fn add_light(sums: &mut [f64], w: DVec3, light: DVec3) {
    let (vectors, harmonics) = sums.split_at_mut(VECTOR_NUMBERS);
    for axis in 0..3 {
        if w[axis] != 0.0 {
            let hemisphere = 2 * axis + usize::from(w[axis] < 0.0);
            for (n, sum) in vectors[9 * hemisphere..][..9].iter_mut().enumerate() {
                *sum += light[n / 3] * w[n % 3];
            }
        }
    }
    let basis = basis(w);
    for (n, sum) in harmonics.iter_mut().enumerate() {
        *sum += light[n / COEFFICIENTS] * basis[n % COEFFICIENTS];
    }
}
