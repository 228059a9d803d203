//! The track-length estimator: what a photon adds to a vertex is in proportion to how far it flies through its dual cell.
//!
//! The radiance from direction w, averaged over a volume V, is the power times length of all flights along −w in it,
//! divided by V. A flight of power φ and length l in the region of a vertex adds φ l w / V to the three hemispheres
//! that contain w. No cosine is divided by, so that grazing flights do no harm, and every flight counts in every
//! region that it passes.
//!
//! Which three hemispheres contain w follows from the signs of its components alone, so deposits go to one of eight
//! octants a vertex, and each hemisphere is the sum of four octants at the end.

use ivg_grid::HemisphereVectors;

use super::{Estimate, Flight};
use crate::accumulate::{MAX_QUANTA, NUMBERS, Sums};
use crate::dual::Boxes;
use crate::region::{Region, Regions};

const OCTANTS: usize = 8;

/// Stretches of a flight that are collected before they are added. Waiting for memory is most of the cost of a bake; many
/// short additions in a row let the processor wait for several at once. For the same reason the buckets of an octant lie
/// together: a flight stays in one octant.
const STRETCHES: usize = 64;

/// Roundings in cutting a flight can make a stretch this much longer than the diagonal.
const DIAGONAL_MARGIN: f32 = 1.001;

/// The estimator over the dual cells of a lattice.
#[derive(Debug)]
pub(crate) struct TrackLength<'a> {
    cells: Boxes,
    regions: &'a Regions,
    /// Bake units a quantum: a power of two.
    quantum: f64,
}

impl<'a> TrackLength<'a> {
    pub(crate) fn new(cells: Boxes, regions: &'a Regions) -> Self {
        let exponent = libm::ilogbf(cells.diagonal() * DIAGONAL_MARGIN) + 1;
        Self { cells, regions, quantum: libm::scalbn(1.0, exponent) / f64::from(MAX_QUANTA) }
    }
}

impl Estimate for TrackLength<'_> {
    fn buckets(&self) -> usize {
        self.cells.len() * OCTANTS
    }

    #[inline]
    fn deposit(&self, flight: &Flight, sums: &mut impl Sums) {
        let per_length = flight.numbers((1.0 / self.quantum) as f32);
        let towards = -flight.direction;
        let octant = usize::from(towards.x < 0.0)
            | usize::from(towards.y < 0.0) << 1
            | usize::from(towards.z < 0.0) << 2;
        let first = octant * self.cells.len();
        let mut stretches = [(0usize, 0f32); STRETCHES];
        let mut waiting = 0;
        let mut add = |stretches: &[(usize, f32)]| {
            for &(bucket, length) in stretches {
                sums.add(bucket, &per_length.map(|number| number * length));
            }
        };
        self.cells.walk(flight.origin, flight.direction, 0.0, flight.length, |cell, from, to| {
            let index = self.cells.index(cell);
            let length = match self.regions.get(index) {
                Region::Whole => to - from,
                region => region.length(&self.cells, cell, flight.origin, flight.direction, from, to),
            };
            if length > 0.0 {
                stretches[waiting] = (first + index, length);
                waiting += 1;
                if waiting == STRETCHES {
                    add(&stretches);
                    waiting = 0;
                }
            }
        });
        add(&stretches[..waiting]);
    }

    fn vectors(&self, sums: &[i64], vertex: usize, power: f64) -> HemisphereVectors {
        let share = self.regions.get(vertex).share();
        if share == 0.0 {
            return HemisphereVectors::default();
        }
        let scale = power * self.quantum / (self.cells.volume() * share);
        let number = |octant: usize, n: usize| sums[(octant * self.cells.len() + vertex) * NUMBERS + n];
        core::array::from_fn(|hemisphere| {
            let (axis, negative) = (hemisphere / 2, hemisphere % 2);
            core::array::from_fn(|channel| {
                core::array::from_fn(|component| {
                    let sum: i64 = (0..OCTANTS)
                        .filter(|octant| octant >> axis & 1 == negative)
                        .map(|octant| number(octant, 3 * channel + component))
                        .sum();
                    (sum as f64 * scale) as f32
                })
            })
        })
    }
}

#[cfg(test)]
mod tests;
