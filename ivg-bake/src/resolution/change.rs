//! How light changes along each axis, and how noisy it is: two bakes of a coarse grid.

use crate::BakeError;
use crate::BakeOptions;
use crate::Silent;
use crate::accumulate::Total;
use crate::estimate::Estimate;
use crate::estimate::held::{AXES, Axes, Linear};
use crate::estimate::track_length::VectorTracks;
use crate::ready::Ready;
use crate::tally::run;
use crate::validity::Surroundings;
use crate::workers::Workers;

/// What two bakes of a coarse grid tell.
pub(super) struct Trial {
    /// Change of light a metre along x, y and z, relative to its root mean square \[1/m\].
    pub(super) per_metre: [f64; 3],
    /// Squared relative noise of one of the bakes.
    noise: f64,
    photons: u64,
    vertices: u64,
}

impl Trial {
    /// Bakes the grid of `ready` twice, with different photons.
    pub(super) fn new(ready: &Ready<'_>, options: &BakeOptions, bounces: u32) -> Result<Self, BakeError> {
        let photons = options.photons;
        let workers = Workers { threads: options.thread_count(), monitor: &Silent, total_photons: photons };
        let surroundings = ready.surroundings(options.estimator, &workers)?;
        let estimate = VectorTracks::new(ready.cells, &surroundings.regions);
        let light = |seed: u64| -> Result<Vec<Axes>, BakeError> {
            let traced = run(&ready.tracer(seed, bounces), &estimate, photons, &workers)?;
            let total = Total::of(&traced.sums);
            let mut axes: Vec<Axes> =
                (0..ready.cells.len()).map(|vertex| estimate.value(&total, vertex, 1.0).axes()).collect();
            surroundings.centring.apply(&mut axes, &workers)?;
            Ok(axes)
        };
        let pair = [light(options.seed)?, light(options.seed.wrapping_add(1))?];
        Ok(Self::of(&pair, ready, &surroundings, photons))
    }

    fn of(pair: &[Vec<Axes>; 2], ready: &Ready<'_>, surroundings: &Surroundings, photons: u64) -> Self {
        let cells = &ready.cells;
        let valid = |vertex: &usize| surroundings.validity[*vertex] > 0;
        let (mut signal, mut noise, mut count) = (0.0, 0.0, 0u64);
        let (mut changes, mut edges) = ([0.0; 3], [0u64; 3]);
        for vertex in (0..cells.len()).filter(valid) {
            let [a, b] = [0, 1].map(|n| pair[n][vertex].map(f64::from));
            count += 1;
            signal += product(&a, &b);
            noise += 0.5 * a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            let at = cells.coords(vertex);
            for next in surroundings.open_neighbours(cells, vertex).filter(|next| *next > vertex) {
                let there = cells.coords(next);
                let Some(axis) = (0..3).find(|&axis| there[axis] != at[axis]) else { continue };
                let [c, d] = [0, 1].map(|n| pair[n][next].map(f64::from));
                let [x, y] = [(a, c), (b, d)].map(|(from, to)| core::array::from_fn(|n| to[n] - from[n]));
                changes[axis] += product(&x, &y);
                edges[axis] += 1;
            }
        }
        // Noise of the two is independent, so that products have only light as their mean.
        let square = signal / count.max(1) as f64;
        let per_metre = core::array::from_fn(|axis| {
            let change = changes[axis] / edges[axis].max(1) as f64;
            let step = ready.lattice.step[axis];
            if square > 0.0 && step > 0.0 { (change.max(0.0) / square).sqrt() / step } else { 0.0 }
        });
        let noise = if signal > 0.0 { noise / signal } else { 0.0 };
        Self { per_metre, noise, photons, vertices: cells.len() as u64 }
    }

    /// The relative noise that `photons` photons leave on a grid of `vertices` within the same bounds: a cell is met by a share of the
    /// flights in proportion to its cross-section.
    pub(super) fn noise(&self, vertices: u64, photons: u64) -> f64 {
        let finer = (vertices as f64 / self.vertices as f64).powf(2.0 / 3.0);
        (self.noise * finer * self.photons as f64 / photons.max(1) as f64).sqrt()
    }
}

fn product(a: &[f64; AXES], b: &[f64; AXES]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
