//! Noise, from batches of photons that are independent of each other.
//!
//! Two batches of B photons each differ at a number by D, whose square has twice the variance of a batch as its mean. So
//! ΣD² / 2B, summed over all numbers of all vertices, is one unbiased sample of the variance a photon, whatever B is; a grid of
//! N photons has that divided by N. Each pair of batches gives one sample. They are independent, so that Student's t bounds
//! what one more of them will be, and the squared error that a finished grid really has is like one more: its numbers are
//! correlated in the same way.

use super::student;
use crate::BakeError;
use crate::estimate::held::{AXES, Axes};
use crate::workers::{Workers, map_chunks};

/// Noise of the sums of photons, in units of what the grid would hold if each photon carried unit power and their number
/// was one.
#[derive(Debug)]
pub(crate) struct Noise {
    vertices: Vec<Vertex>,
    /// Samples of the variance a photon of all numbers together.
    samples: Vec<f64>,
}

#[derive(Clone, Debug)]
struct Vertex {
    /// What it held before the pair of batches under way.
    before: Axes,
    /// What it held between the two.
    between: Axes,
    /// Sum of its samples of the variance a photon.
    samples: f32,
}

impl Noise {
    /// No batch yet.
    pub(crate) fn new(vertices: usize) -> Self {
        let dark = [0.0; AXES];
        let vertex = Vertex { before: dark, between: dark, samples: 0.0 };
        Self { vertices: vec![vertex; vertices], samples: Vec::new() }
    }

    /// Notes what vertices hold after the first batch of a pair.
    pub(crate) fn note_first(&mut self, axes: &[Axes], workers: &Workers<'_>) -> Result<(), BakeError> {
        map_chunks(workers, &mut self.vertices, |first, chunk| {
            chunk.iter_mut().zip(&axes[first..]).for_each(|(vertex, axes)| vertex.between = *axes);
        })?;
        Ok(())
    }

    /// Notes what they hold after the second batch of a pair, of `batch` photons each.
    pub(crate) fn note_second(
        &mut self,
        axes: &[Axes],
        batch: u64,
        workers: &Workers<'_>,
    ) -> Result<(), BakeError> {
        let sums = map_chunks(workers, &mut self.vertices, |first, chunk| {
            let mut sum = 0.0;
            for (vertex, &after) in chunk.iter_mut().zip(&axes[first..]) {
                let mut squares = 0.0;
                for n in 0..AXES {
                    let [before, between, after] =
                        [vertex.before[n], vertex.between[n], after[n]].map(f64::from);
                    squares += ((between - before) - (after - between)).powi(2);
                }
                let sample = squares / (2.0 * batch as f64);
                vertex.samples += sample as f32;
                vertex.before = after;
                sum += sample;
            }
            sum
        })?;
        self.samples.push(sums.into_iter().sum());
        Ok(())
    }

    /// Pairs of batches so far.
    pub(crate) fn pairs(&self) -> usize {
        self.samples.len()
    }

    /// The variance a photon of all numbers together.
    pub(crate) fn variance(&self) -> f64 {
        self.samples.iter().sum::<f64>() / self.samples.len() as f64
    }

    /// What one more sample of the variance a photon exceeds with probability `beyond` at most.
    pub(crate) fn bound(&self, beyond: f64) -> f64 {
        let count = self.samples.len() as f64;
        let mean = self.variance();
        let spread = self.samples.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / (count - 1.0);
        mean + student::quantile(beyond, count - 1.0) * (spread * (1.0 + 1.0 / count)).sqrt()
    }

    /// The variance a photon of one vertex, its numbers together.
    pub(crate) fn of_vertex(&self, vertex: usize) -> f64 {
        f64::from(self.vertices[vertex].samples) / self.samples.len() as f64
    }
}
