//! Push-pull: values for the vertices that have not arrived (Web3D 2008, section 4.1).
//!
//! *Pull*: going up the [pyramid](crate::pyramid), a node gets the mean of its children that have a value. Weights
//! saturate at 1 (Gortler et al., The Lumigraph, 1996): one received vertex makes a node fully known, so that it does
//! not matter how densely a region has been received. *Push*: going down, a node without a value of its own gets one
//! interpolated from the coarser level, where it lies a quarter of a step from its parent on each axis. The optional *smoothing* after each push step replaces what was pushed by the mean of it
//! (weight 6) and its six neighbours (weight 1 each).
//!
//! Nothing crosses an invalid vertex or a blocked edge as long as the received vertices reach the place some other
//! way. What they do not reach (invalid vertices, rooms of which nothing has arrived) is filled in a second run
//! through a pyramid without obstructions: a guess, better than darkness, that lookups use only when no corner of a
//! cell is reachable.
//!
//! Time and memory are proportional to the number of vertices.

use crate::pyramid::{Level, NONE, Pyramid};
use crate::{HemisphereVectors, IrradianceGrid};

/// What [`fill()`] does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FillOptions {
    /// Smooth after each push step. Costs time; takes away the blocks of the pyramid.
    pub smooth: bool,
}

impl Default for FillOptions {
    /// With smoothing.
    fn default() -> Self {
        Self { smooth: true }
    }
}

/// The same grid with a value at every vertex: received vertices as they are, all others by push-pull.
///
/// What arrived for an invalid vertex is not light and is replaced too; the given grid keeps it.
///
/// Guarantees:
/// - received vectors of valid vertices come out bit for bit;
/// - the result depends on which vertices were received, not on their order: every node is computed from all its
///   children, or its coarser neighbours, in order of their numbers;
/// - each component of a filled vector lies between the smallest and the largest received one: every value is a
///   mean that cannot leave the range by rounding;
/// - with nothing received from a valid vertex, all values are zero.
#[must_use]
pub fn fill(grid: &IrradianceGrid, options: &FillOptions) -> IrradianceGrid {
    let mut vectors = grid.vectors().to_vec();
    let mut known: Vec<bool> =
        (0..grid.vertex_count()).map(|index| grid.is_received(index) && grid.is_valid(index)).collect();

    let pyramid = Pyramid::of_grid(grid);
    let reached = push_pull(&pyramid, &mut vectors, &known, options);
    if reached.contains(&false) {
        known = reached;
        let reached = push_pull(&Pyramid::unobstructed(grid), &mut vectors, &known, options);
        for (vectors, _) in vectors.iter_mut().zip(reached).filter(|(_, reached)| !reached) {
            *vectors = [[[0.0; 3]; 3]; 6];
        }
    }
    grid.filled_with(vectors)
}

/// Fills what is not known at level 0 and says which vertices have a value afterwards.
fn push_pull(
    pyramid: &Pyramid,
    vectors: &mut [HemisphereVectors],
    known: &[bool],
    options: &FillOptions,
) -> Vec<bool> {
    let mut coarse: Vec<Values> = Vec::with_capacity(pyramid.levels.len());
    for level in &pyramid.levels[1..] {
        let values = match coarse.last() {
            None => Values::pull(level, vectors, known),
            Some(finer) => Values::pull(level, &finer.vectors, &finer.has_value),
        };
        coarse.push(values);
    }
    let mut has_value = known.to_vec();
    for (index, pair) in pyramid.levels.windows(2).enumerate().rev() {
        // The values of level n are coarse[n - 1]; those of level 0 are the caller's.
        let (finer, coarser) = coarse.split_at_mut(index);
        match finer.last_mut() {
            Some(finer) => push(pair, &coarser[0], &mut finer.vectors, &mut finer.has_value, options),
            None => push(pair, &coarser[0], vectors, &mut has_value, options),
        }
    }
    has_value
}

/// The values of one coarse level.
struct Values {
    vectors: Vec<HemisphereVectors>,
    has_value: Vec<bool>,
}

impl Values {
    fn pull(level: &Level, finer: &[HemisphereVectors], known: &[bool]) -> Self {
        let mut values =
            Self { vectors: Vec::with_capacity(level.len()), has_value: Vec::with_capacity(level.len()) };
        for node in 0..level.len() {
            let mut mean = Mean::new();
            for &child in level.children(node).iter().filter(|&&child| known[child as usize]) {
                mean.add(&finer[child as usize], 1.0);
            }
            values.vectors.push(mean.value);
            values.has_value.push(mean.weight > 0.0);
        }
        values
    }
}

/// Gives every node of the finer of two levels that has no value of its own the one interpolated from `coarser`, if
/// there is one.
fn push(
    levels: &[Level],
    coarser: &Values,
    vectors: &mut [HemisphereVectors],
    has_value: &mut [bool],
    options: &FillOptions,
) {
    let level = &levels[0];
    let mut stencil = Stencil::default();
    let mut pushed = Vec::new();
    for node in 0..level.len() {
        let parent = level.parents[node];
        // A node without a parent has no links either; a parent without a value is cut off from all that is known.
        if has_value[node] || parent == NONE || !coarser.has_value[parent as usize] {
            continue;
        }
        vectors[node] = stencil.interpolate(&levels[1], &coarser.vectors, parent, level.outward(node));
        has_value[node] = true;
        pushed.push(node);
    }
    if options.smooth {
        // All are computed before any is stored: the result must not depend on the order of the nodes.
        let smoothed: Vec<HemisphereVectors> =
            pushed.iter().map(|&node| smooth(level, vectors, node)).collect();
        pushed.iter().zip(smoothed).for_each(|(&node, value)| vectors[node] = value);
    }
}

/// The mean of a node and its linked neighbours. All of them have values, for they are joined to each other.
fn smooth(level: &Level, vectors: &[HemisphereVectors], node: usize) -> HemisphereVectors {
    let mut mean = Mean::new();
    mean.add(&vectors[node], 6.0);
    for direction in 0..6 {
        let links = level.links(node, direction);
        for &other in links {
            mean.add(&vectors[other as usize], 1.0 / links.len() as f32);
        }
    }
    mean.value
}

/// Trilinear interpolation in a coarser level that goes only where links lead.
#[derive(Default)]
struct Stencil {
    /// Nodes reached in the parent's cell and the seven around it, numbered by the axes stepped along (bits 0, 1, 2).
    reached: [Vec<u32>; 8],
}

impl Stencil {
    /// The value at a child of `parent`, a quarter of a step from it in each of the `outward` directions.
    fn interpolate(
        &mut self,
        level: &Level,
        vectors: &[HemisphereVectors],
        parent: u32,
        outward: [usize; 3],
    ) -> HemisphereVectors {
        self.reached.iter_mut().for_each(Vec::clear);
        self.reached[0].push(parent);
        let mut mean = Mean::new();
        for corner in 0..8usize {
            for axis in (0..3).filter(|axis| corner >> axis & 1 == 1) {
                let (before, after) = self.reached.split_at_mut(corner);
                for &node in &before[corner & !(1 << axis)] {
                    after[0].extend_from_slice(level.links(node as usize, outward[axis]));
                }
            }
            let nodes = &mut self.reached[corner];
            nodes.sort_unstable();
            nodes.dedup();
            // On each axis 3/4 of the weight is the parent's, 1/4 the neighbour's: 27, 9, 3, 1 of 64.
            let weight = 3.0_f32.powi(3 - corner.count_ones().cast_signed());
            for &node in nodes.iter() {
                mean.add(&vectors[node as usize], weight / nodes.len() as f32);
            }
        }
        mean.value
    }
}

/// A weighted mean that stays between the smallest and the largest value added, whatever the rounding.
///
/// Each value moves the mean by a share t of the way to it: the whole way for the first, which is exact, and at most
/// half of it for the others, of which none weighs more than the first. The difference and the product are rounded by
/// less than 2^-22 together, so the exact sum does not pass the new value; rounding is monotone, so the rounded sum
/// does not either.
struct Mean {
    value: HemisphereVectors,
    weight: f32,
}

impl Mean {
    fn new() -> Self {
        Self { value: [[[0.0; 3]; 3]; 6], weight: 0.0 }
    }

    fn add(&mut self, value: &HemisphereVectors, weight: f32) {
        self.weight += weight;
        let share = weight / self.weight;
        let mean = self.value.as_flattened_mut().as_flattened_mut();
        for (mean, value) in mean.iter_mut().zip(value.as_flattened().as_flattened()) {
            *mean += share * (value - *mean);
        }
    }
}

#[cfg(test)]
mod tests;
