//! The face-crossing estimators of RR-6983, section 3.3: what a photon adds to a vertex is counted where it crosses the
//! faces of the lattice that the vertex lies in.
//!
//! A crossing of the plane through the vertices i of axis a, in the rectangle around a vertex, adds to the hemisphere on
//! the side of the plane that the light comes from. Of the light of direction w the share |w·a| crosses a face, so
//! φ w / (A |w·a|) is unbiased ([`FaceCrossing::UNBIASED`]), at a price: the tangential components have a variance
//! that grows without bound towards grazing flights. RR-6983 prints φ w / A ([`FaceCrossing::AS_PRINTED`]), which
//! estimates the integral of L |w·a| w: a third too little in even light. It is kept for the comparison, with the
//! half and quarter areas that RR-6983 gives the border and with no eye for geometry.

use glam::Vec3;
use ivg_grid::HemisphereVectors;

use super::{Estimate, Flight, NUMBERS};
use crate::accumulate::{MAX_QUANTA, Sums, Total};
use crate::dual::Boxes;
use crate::region::{Region, Regions, SUB};

const HEMISPHERES: usize = 6;

/// The smallest |w·a| that a deposit is divided by. Flights closer to the plane count as if at this angle, which
/// takes a share of less than 2⁻¹⁰ from the tangential components in even light, and bounds the deposit.
const SMALLEST_COSINE: f32 = 1.0 / 1024.0;

/// Powers of a whole photon a quantum, so that the largest deposit is [`MAX_QUANTA`].
const QUANTUM: f64 = 1.0 / (MAX_QUANTA as f64 * SMALLEST_COSINE as f64);

/// How far the outermost planes are moved inwards, in steps: bounds are often put exactly on walls, and whether a photon
/// that ends in the plane crosses it would be a matter of rounding.
const INWARDS: f32 = 1.0 / 64.0;

/// The estimators over the faces of a lattice.
#[derive(Debug)]
pub(crate) struct FaceCrossing<'a> {
    cells: Boxes,
    /// What counts around each vertex; none for the estimator as printed.
    regions: Option<&'a Regions>,
}

impl<'a> FaceCrossing<'a> {
    /// The unbiased estimator, in the regions given.
    pub(crate) fn unbiased(cells: Boxes, regions: &'a Regions) -> Self {
        Self { cells, regions: Some(regions) }
    }

    /// The estimator as RR-6983 prints it.
    pub(crate) fn as_printed(cells: Boxes) -> Self {
        Self { cells, regions: None }
    }

    /// Position of the plane through the vertices `at` of an axis, in steps above the lowest dual cell.
    fn plane(&self, axis: usize, at: usize) -> f32 {
        let middle = at as f32 + 0.5;
        match (at == 0, at + 1 == self.cells.count[axis]) {
            (true, false) => middle + INWARDS,
            (false, true) => middle - INWARDS,
            _ => middle,
        }
    }

    /// The layer of sub-cells that the plane through a vertex passes.
    fn layer(&self, axis: usize, at: usize) -> usize {
        (((self.plane(axis, at) - at as f32) * SUB as f32) as usize).min(SUB - 1)
    }

    /// Share of the rectangle around a vertex, across an axis, that counts.
    fn area_share(&self, vertex: usize, axis: usize) -> f64 {
        let at = self.cells.coords(vertex);
        match self.regions.map(|regions| regions.get(vertex)) {
            Some(Region::Whole) => 1.0,
            Some(Region::Nothing) => 0.0,
            Some(Region::Part(part)) => {
                f64::from(part.mask.layer_count(axis, self.layer(axis, at[axis]))) / (SUB * SUB) as f64
            }
            // RR-6983: "except for grid boundary vertices, where the area is divided by two, and for grid corner
            // vertices, where it is divided by four".
            None => [(axis + 1) % 3, (axis + 2) % 3]
                .into_iter()
                .filter(|&a| self.cells.count[a] > 1 && (at[a] == 0 || at[a] + 1 == self.cells.count[a]))
                .fold(1.0, |share, _| share * 0.5),
        }
    }

    /// The vertex whose rectangle a crossing of the plane `at` of an axis lies in, if it counts.
    fn vertex(&self, place: Vec3, axis: usize, at: usize) -> Option<usize> {
        let mut cell = [at; 3];
        let mut sub = [self.layer(axis, at); 3];
        for a in [(axis + 1) % 3, (axis + 2) % 3] {
            let steps = (place[a] - self.cells.low[a]) / self.cells.step[a];
            let last = self.cells.count[a] as f32;
            // As printed, only faces of the lattice itself count: half a step less on either side.
            let edge = if self.regions.is_none() && self.cells.count[a] > 1 { 0.5 } else { 0.0 };
            if !(edge..last - edge).contains(&steps) {
                return None;
            }
            cell[a] = (steps as usize).min(self.cells.count[a] - 1);
            sub[a] = (((steps - cell[a] as f32) * SUB as f32) as usize).min(SUB - 1);
        }
        let vertex = self.cells.index(cell);
        let counts = match self.regions.map(|regions| regions.get(vertex)) {
            None | Some(Region::Whole) => true,
            Some(Region::Nothing) => false,
            Some(Region::Part(part)) => part.mask.contains(sub),
        };
        counts.then_some(vertex)
    }
}

impl Estimate for FaceCrossing<'_> {
    type Value = HemisphereVectors;

    fn sums(&self) -> usize {
        self.cells.len() * HEMISPHERES * NUMBERS
    }

    #[inline]
    fn deposit(&self, flight: &Flight, sums: &mut impl Sums) {
        for axis in 0..3 {
            let towards = -flight.direction[axis];
            if towards == 0.0 {
                continue;
            }
            let divisor = if self.regions.is_some() { towards.abs().max(SMALLEST_COSINE) } else { 1.0 };
            let quanta = flight.numbers((1.0 / QUANTUM) as f32 / divisor);
            let hemisphere = 2 * axis + usize::from(towards < 0.0);
            let (low, step) = (self.cells.low[axis], self.cells.step[axis]);
            let mut cross = |at: usize| {
                let plane = low + self.plane(axis, at) * step;
                let t = (plane - flight.origin[axis]) / flight.direction[axis];
                if t > 0.0 && t < flight.length {
                    let place = flight.origin + flight.direction * t;
                    if let Some(vertex) = self.vertex(place, axis, at) {
                        sums.add((vertex * HEMISPHERES + hemisphere) * NUMBERS, &quanta);
                    }
                }
            };
            // The planes between the ends, and one more on either side against rounding.
            let end = flight.origin[axis] + flight.direction[axis] * flight.length;
            let steps = |x: f32| (x - low) / step;
            let (a, b) = (steps(flight.origin[axis]), steps(end));
            let first = (a.min(b) - 2.0).max(0.0) as usize;
            let last = ((a.max(b) + 2.0).max(0.0) as usize).min(self.cells.count[axis]);
            (first..last).for_each(&mut cross);
        }
    }

    fn value(&self, sums: &Total<'_>, vertex: usize, power: f64) -> HemisphereVectors {
        core::array::from_fn(|hemisphere| {
            let axis = hemisphere / 2;
            let across = [(axis + 1) % 3, (axis + 2) % 3].map(|a| f64::from(self.cells.step[a]));
            let area = across[0] * across[1] * self.area_share(vertex, axis);
            let numbers: [i64; NUMBERS] = sums.get((vertex * HEMISPHERES + hemisphere) * NUMBERS);
            core::array::from_fn(|channel| {
                core::array::from_fn(|component| {
                    let sum = numbers[3 * channel + component] as f64;
                    if area > 0.0 { (sum * power * QUANTUM / area) as f32 } else { 0.0 }
                })
            })
        })
    }
}

#[cfg(test)]
mod tests;
