//! From the mean over a cell to the light at the point that its vertex looks from, to first order.
//!
//! The mean of light that changes evenly over the part of a cell that counts is the light at that part's centre. Next to
//! a surface the centre is not where the vertex looks from: of a vertex on a wall it lies a quarter of a step before the wall.
//! So the change of the light from the one to the other is added, with the gradient of a plane fitted to the vertex and those of
//! its 26 neighbours that it sees (weighted least squares, each at the centre of its own part, nearer ones and those whose parts are
//! larger counting more). Taking many neighbours instead of two costs hardly any noise; being linear in what photons left, it is in
//! what batches show. The values are the same for any number of threads.
//!
//! No irradiance along an axis is made smaller than half of what it was, so that nothing becomes negative.

use glam::{DMat3, DVec3, Vec3};

use crate::BakeError;
use crate::dual::Boxes;
use crate::estimate::held::{AXES, Linear};
use crate::region::{Region, Regions, SUB, SUB_CELLS};
use crate::stage::Stage;
use crate::validity::ASIDE;
use crate::workers::{Workers, map};

/// Neighbours of a vertex and itself.
const AROUND: usize = 27;

/// Weight of a vertex whose lattice coordinates differ from those of the middle one by a vector of squared length 0, 1, 2, 3:
/// exp(−n / 1.5). Narrower weights follow light better and are noisier: measured at 32³ in a box with the bunny, bias 2.8 %
/// and noise + 6 % on the bounds; exp(−n / 0.6): 2.7 % and + 12 %; two vertices an axis alone: 2.6 % and + 24 %; no correction: 3.2 %.
const WEIGHTS: [f64; 4] = [1.0, 0.513_417_119_032_592, 0.263_597_138_115_727, 0.135_335_283_236_613];

/// Added to the variance of the neighbours' places along each axis, in squared steps: where there are no neighbours along an
/// axis nothing is known about the gradient along it, and it counts as 0.
const RIDGE: f64 = 0.01;

/// Distance of centre and vertex along an axis, in steps, up to which they count as one: an eighth of a sub-cell.
const CENTRED: f64 = 1.0 / 64.0;

/// Smallest share of an irradiance along an axis that is left.
const LEAST_LEFT: f32 = 0.5;

/// What must be known about a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Place {
    /// Sub-cells of its cell that count.
    pub(crate) cells: u16,
    /// Sum over these of twice the distance of their middles from that of the cell, in sub-cells. 0 where all count.
    pub(crate) moments: [i16; 3],
    /// How far beside itself the vertex looks from along each axis, in 32nds of a step: −1, 0 or 1.
    pub(crate) aside: [i8; 3],
    /// Which neighbours it sees, if the light at its centre is to be carried over to it: bit n is number n of [`neighbours`].
    pub(crate) open: u32,
}

/// Offsets of the neighbours of a vertex on the lattice, x fastest.
fn neighbours() -> impl Iterator<Item = [i8; 3]> {
    (0..AROUND as i8).map(|n| [n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1]).filter(|offset| *offset != [0; 3])
}

impl Place {
    /// Centre of the part that counts, in steps from the vertex.
    fn centre(&self) -> DVec3 {
        DVec3::from(self.moments.map(f64::from)) / (f64::from(self.cells.max(1)) * 2.0 * SUB as f64)
    }

    /// Where the vertex looks from, in steps from it.
    fn eye(&self) -> DVec3 {
        DVec3::from(self.aside.map(f64::from)) * f64::from(ASIDE)
    }

    /// From the centre to where the vertex looks from, in steps; `None` if that is nothing.
    fn way(&self) -> Option<DVec3> {
        let way = self.eye() - self.centre();
        (self.cells > 0 && way.abs().max_element() > CENTRED).then_some(way)
    }
}

/// The places of all vertices of a lattice.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Centring {
    pub(crate) places: Vec<Place>,
    /// Vertices along each axis.
    pub(crate) count: [usize; 3],
}

impl Centring {
    /// Finds the places; `eyes` is where the vertices look from, `valid` says which of them light reaches.
    ///
    /// # Errors
    ///
    /// [`BakeError::Cancelled`].
    pub(crate) fn new(
        stage: &Stage<'_>,
        cells: &Boxes,
        regions: &Regions,
        eyes: &[Vec3],
        valid: impl Fn(usize) -> bool + Sync,
        workers: &Workers<'_>,
    ) -> Result<Self, BakeError> {
        let step = Vec3::from(cells.step);
        let places = map(workers, cells.len(), |vertex| {
            let at = cells.coords(vertex);
            let mut place = match regions.get(vertex) {
                Region::Whole => return Place { cells: SUB_CELLS as u16, ..Place::default() },
                Region::Nothing => return Place::default(),
                Region::Part(part) => {
                    let (cells, moments) = (part.mask.count() as u16, part.mask.moments());
                    Place { cells, moments, ..Place::default() }
                }
            };
            let eye = eyes[vertex];
            place.aside = ((eye - cells.middle(at)) / (step * ASIDE)).round().to_array().map(|x| x as i8);
            if place.way().is_none() {
                return place;
            }
            for (n, offset) in neighbours().enumerate() {
                let seen = beside(cells.count, at, offset)
                    .is_some_and(|next| valid(next) && !stage.sight().occluded(eye, eyes[next] - eye, 1.0));
                place.open |= u32::from(seen) << n;
            }
            place
        })?;
        Ok(Self { places, count: cells.count })
    }

    /// All cells count whole, and vertices lie in their middle.
    pub(crate) fn even(cells: &Boxes) -> Self {
        let place = Place { cells: SUB_CELLS as u16, ..Place::default() };
        Self { places: vec![place; cells.len()], count: cells.count }
    }

    /// What vertices hold from the means over their cells.
    ///
    /// # Errors
    ///
    /// [`BakeError::Cancelled`].
    pub(crate) fn apply<T: Linear>(&self, values: &mut [T], workers: &Workers<'_>) -> Result<(), BakeError> {
        let touched: Vec<usize> = (0..values.len()).filter(|&v| self.places[v].open != 0).collect();
        let all = &*values;
        let carried = map(workers, touched.len(), |n| self.carried(touched[n], all))?;
        touched.into_iter().zip(carried).for_each(|(vertex, value)| values[vertex] = value);
        Ok(())
    }

    /// What a vertex holds.
    fn carried<T: Linear>(&self, vertex: usize, means: &[T]) -> T {
        let mut change = T::default();
        let (weights, count) = self.weights(vertex);
        for &(other, weight) in &weights[..count] {
            change.add(&means[other], [weight; 3]);
        }
        let mut value = means[vertex];
        let (was, changes) = (value.axes(), change.axes());
        let mut shares = [1f32; 3];
        for (n, (was, change)) in was.into_iter().zip(changes).enumerate() {
            // Numbers of a channel lie together.
            let share = &mut shares[n / (AXES / 3)];
            let most = (1.0 - LEAST_LEFT) * was.max(0.0);
            if -change * *share > most {
                *share = most / -change;
            }
        }
        value.add(&change, shares);
        value
    }

    /// The change from the centre of a vertex' part to the vertex, as weights of the vertices around; they add up to 0.
    fn weights(&self, vertex: usize) -> ([(usize, f32); AROUND], usize) {
        let mut weights = [(0, 0.0); AROUND];
        let place = &self.places[vertex];
        let Some(way) = place.way() else { return (weights, 0) };
        let [nx, ny, _] = self.count;
        let at = [vertex % nx, vertex / nx % ny, vertex / nx / ny];
        let mut around = [(0, DVec3::ZERO, 0.0); AROUND];
        let mut count = 0;
        let mut note = |index: usize, offset: [i8; 3]| {
            let other = &self.places[index];
            let squared: i8 = offset.iter().map(|x| x * x).sum();
            let share = (2.0 * f64::from(other.cells) / f64::from(SUB_CELLS)).min(1.0);
            let offset = DVec3::from(offset.map(f64::from));
            around[count] = (index, offset + other.centre(), WEIGHTS[squared as usize] * share);
            count += 1;
        };
        note(vertex, [0; 3]);
        for (_, offset) in neighbours().enumerate().filter(|(n, _)| place.open >> n & 1 == 1) {
            // A file may name neighbours beyond the lattice.
            let next = beside(self.count, at, offset).filter(|&next| self.places[next].cells > 0);
            next.into_iter().for_each(|next| note(next, offset));
        }
        let around = &mut around[..count];
        let sum: f64 = around.iter().map(|(.., weight)| weight).sum();
        let mean = around.iter().map(|(_, p, weight)| *p * (*weight / sum)).sum::<DVec3>();
        let mut variance = DMat3::from_diagonal(DVec3::splat(RIDGE));
        for (_, p, weight) in around.iter_mut() {
            (*p, *weight) = (*p - mean, *weight / sum);
            let scaled = *p * *weight;
            variance += DMat3::from_cols(scaled * p.x, scaled * p.y, scaled * p.z);
        }
        let solved = variance.inverse() * way;
        for (out, (index, p, weight)) in weights.iter_mut().zip(around) {
            *out = (*index, (*weight * p.dot(solved)) as f32);
        }
        (weights, count)
    }
}

/// Index of the vertex beside another one; `None` beyond the lattice.
fn beside(count: [usize; 3], at: [usize; 3], offset: [i8; 3]) -> Option<usize> {
    let mut next = [0; 3];
    for a in 0..3 {
        next[a] = at[a].checked_add_signed(isize::from(offset[a])).filter(|&x| x < count[a])?;
    }
    Some(next[0] + count[0] * (next[1] + count[1] * next[2]))
}

#[cfg(test)]
mod tests;
