//! The order of importance: which vertices a client should get first, as bundles of the order `explicit`.
//!
//! A client fills in what it has not received. So the vertex to send next is the one without which the filled grid is
//! furthest from the true one. [`bundles`] plays the client: it fills what has been sent so far, compares, takes the
//! vertices that would help most, and fills again.
//!
//! *How much a vertex helps* is more than how wrong it is itself. The first value that arrives in an empty block stands for
//! the whole block, so a vertex that is unlike its surroundings makes them worse. With e the error of the filled
//! grid, a vertex i in the largest block without a received vertex is estimated to lower the sum of squares by
//!
//! ```text
//! w_i |e_i|² + Σ over the block's other vertices j of w_j (|e_j|² − |e_j − k e_i|²),   k = 1 − 0.7^l
//! ```
//!
//! where the block is a node of level l of the pyramid that [`fill`](crate::fill()) uses (so nothing is expected to help
//! behind a wall), and k is the share of a value that reaches the rest of it; at l = 0 only the first term is left.
//! Between two fills at most one vertex of a block is taken, since the first one changes what the others are worth.
//!
//! *Weights.* Surfaces look the light up; a vertex in free air is seen by nothing but what moves there. Vertices
//! [near surfaces](near_surfaces) have the weight 1, all others [`ImportanceOptions::free_weight`].
//!
//! What that brings is printed by `cargo run --release -p ivg-bake --example order_error`.

use std::collections::BTreeSet;

use ivg_format::{Quantity, Values};

use crate::pyramid::{NONE, Pyramid};
use crate::{FillOptions, FilledGrid, IrradianceGrid, VALIDITY_FREE};

/// The share of a value received in an empty block that does not reach the rest of the block at level 1; at level l,
/// its power l. Of 0.3 … 1 and several sequences the one with the least error on baked grids; the optimum is flat.
const LOST_PER_LEVEL: f64 = 0.7;

/// By how much each bundle is larger than the one before: as large as the error falls slowly.
const BUNDLE_GROWTH: f64 = 1.25;

/// How [`bundles`] ranks and bundles vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImportanceOptions {
    /// Vertices of the first bundle, at least 1. Each one after is a quarter larger.
    pub first_bundle: usize,
    /// The most vertices of a bundle, at least 1: for a file, vertices per slice times the vertices of the longest axis.
    pub largest_bundle: usize,
    /// The grid is filled anew when this share of what has been received is received again; above 0. Smaller values
    /// take more time, in proportion: a hundred fills at the default for 32³ vertices.
    pub refill_share: f64,
    /// Weight of the squared error of vertices that are not near a surface, 0 to 1; 1 weighs all alike.
    pub free_weight: f64,
    /// Whether a vertex is judged by what it does to its surroundings too, and blocks give one vertex between two fills.
    /// Without, the vertices with the largest errors are taken.
    pub look_ahead: bool,
}

impl ImportanceOptions {
    /// The defaults for bundles of at most `largest_bundle` vertices.
    #[must_use]
    pub const fn new(largest_bundle: usize) -> Self {
        Self { first_bundle: 32, largest_bundle, refill_share: 0.1, free_weight: 0.3, look_ahead: true }
    }
}

/// The valid vertices of a grid, corners left out, in bundles for [`ivg_format::GridSource::bundles`]: those that a client
/// misses most first. Deterministic.
///
/// The grid is one whose vertices all have values. Vertices inside geometry are in no bundle. Takes about
/// ln(vertices / 8) / `refill_share` fills of the grid, and memory for three more of it.
///
/// # Panics
///
/// If there is not enough memory.
#[must_use]
pub fn bundles(grid: &IrradianceGrid, options: &ImportanceOptions) -> Vec<Vec<u64>> {
    let ranked = Ranking::new(grid, options).ranked();
    let largest = options.largest_bundle.max(1);
    let mut bundles = Vec::new();
    let (mut rest, mut size) = (&ranked[..], options.first_bundle.max(1) as f64);
    while !rest.is_empty() {
        let (bundle, after) = rest.split_at((size as usize).min(largest).min(rest.len()));
        let mut bundle: Vec<u64> = bundle.iter().map(|&vertex| vertex as u64).collect();
        bundle.sort_unstable();
        bundles.push(bundle);
        (rest, size) = (after, size * BUNDLE_GROWTH);
    }
    bundles
}

/// For each vertex, whether a surface is near: geometry takes some of its surroundings (validity below 255), cuts one of its
/// edges, or holds one of the 26 vertices around it. The light of surfaces is looked up among these.
#[must_use]
pub fn near_surfaces(grid: &IrradianceGrid) -> Vec<bool> {
    (0..grid.vertex_count()).map(|index| is_near_surface(grid, index)).collect()
}

fn is_near_surface(grid: &IrradianceGrid, index: usize) -> bool {
    if grid.validity()[index] < VALIDITY_FREE || grid.blocked_edges()[index] != 0 {
        return true;
    }
    let lattice = grid.lattice();
    let at = lattice.coords(index as u64);
    let cut_below = |axis: usize| {
        let mut before = at;
        before[axis] = at[axis].wrapping_sub(1);
        let [i, j, k] = before;
        at[axis] > 0 && grid.blocked_edges()[lattice.index(i, j, k) as usize] >> axis & 1 == 1
    };
    if (0..3).any(cut_below) {
        return true;
    }
    let [x, y, z] = [0, 1, 2].map(|axis: usize| {
        at[axis].saturating_sub(1)..=at[axis].saturating_add(1).min(lattice.dims[axis] - 1)
    });
    z.into_iter()
        .any(|k| y.clone().any(|j| x.clone().any(|i| !grid.is_valid(lattice.index(i, j, k) as usize))))
}

/// A client that receives the grid, and what is left to send.
struct Ranking<'a> {
    grid: &'a IrradianceGrid,
    options: &'a ImportanceOptions,
    pyramid: Pyramid,
    weights: Vec<f64>,
    /// What the client has.
    client: FilledGrid,
    received: Vec<bool>,
    received_count: usize,
    missing: Vec<usize>,
}

/// A vertex that could be sent next.
struct Candidate {
    vertex: usize,
    gain: f64,
    /// Level and node of which one vertex is taken between two fills.
    block: (usize, usize),
}

/// The errors of one level: of its nodes without a received vertex, sums over their vertices.
struct Errors {
    known: Vec<bool>,
    /// Weighted errors, [`Ranking::width`] numbers a node.
    sums: Vec<f32>,
    weights: Vec<f64>,
}

impl<'a> Ranking<'a> {
    fn new(grid: &'a IrradianceGrid, options: &'a ImportanceOptions) -> Self {
        let near = near_surfaces(grid);
        let count = grid.vertex_count();
        let mut client = IrradianceGrid::with_limit(*grid.lattice(), grid.quantity(), u64::MAX)
            .expect("as many vertices as the given grid has");
        for vertex in 0..count {
            client.set_validity(vertex, grid.validity()[vertex]);
            client.set_blocked_edges(vertex, grid.blocked_edges()[vertex]);
        }
        let mut ranking = Self {
            grid,
            options,
            pyramid: Pyramid::of_grid(grid),
            weights: near.into_iter().map(|near| if near { 1.0 } else { options.free_weight }).collect(),
            client: FilledGrid::new(client, FillOptions::default()),
            received: vec![false; count],
            received_count: 0,
            missing: Vec::new(),
        };
        for corner in grid.lattice().corners() {
            ranking.receive(corner as usize);
        }
        ranking.missing = (0..count).filter(|&v| grid.is_valid(v) && !ranking.received[v]).collect();
        ranking
    }

    /// The client receives a vertex of the grid.
    fn receive(&mut self, vertex: usize) {
        match self.grid.values() {
            Values::Vectors(vectors) => self.client.set(vertex, &vectors[vertex]),
            Values::Radiance(radiance) => self.client.set(vertex, &radiance[vertex]),
        }
        self.received[vertex] = true;
        self.received_count += 1;
    }

    /// All missing vertices, the most important first.
    fn ranked(mut self) -> Vec<usize> {
        let mut ranked = Vec::with_capacity(self.missing.len());
        while !self.missing.is_empty() {
            let wanted = (self.received_count as f64 * self.options.refill_share) as usize;
            for vertex in self.next(wanted.max(1)) {
                self.receive(vertex);
                ranked.push(vertex);
            }
            self.missing.retain(|&vertex| !self.received[vertex]);
        }
        ranked
    }

    /// Up to `wanted` of the missing vertices, and at least one.
    fn next(&mut self, wanted: usize) -> Vec<usize> {
        let errors = self.errors();
        let mut candidates: Vec<Candidate> =
            self.missing.iter().map(|&vertex| self.judge(vertex, &errors)).collect();
        candidates.sort_by(|a, b| b.gain.total_cmp(&a.gain).then(a.vertex.cmp(&b.vertex)));
        let mut taken = BTreeSet::new();
        candidates
            .into_iter()
            .filter(|candidate| !self.options.look_ahead || taken.insert(candidate.block))
            .map(|candidate| candidate.vertex)
            .take(wanted)
            .collect()
    }

    /// How far the client's filled grid is off, at each vertex and summed over the empty nodes of the pyramid.
    fn errors(&mut self) -> Vec<Errors> {
        let width = self.width();
        let filled = self.client.grid();
        let mut sums: Vec<f32> =
            numbers(self.grid.values()).iter().zip(numbers(filled.values())).map(|(a, b)| a - b).collect();
        for (error, scale) in sums.iter_mut().zip(scales(self.grid.quantity()).cycle()) {
            *error *= scale;
        }
        let known = (0..self.grid.vertex_count())
            .map(|vertex| self.received[vertex] && self.grid.is_valid(vertex))
            .collect();
        let mut levels = vec![Errors { known, sums, weights: self.weights.clone() }];
        for level in &self.pyramid.levels[1..] {
            let finer = &levels[levels.len() - 1];
            let weigh = levels.len() == 1;
            let mut coarser = Errors {
                known: Vec::with_capacity(level.len()),
                sums: vec![0.0; level.len() * width],
                weights: vec![0.0; level.len()],
            };
            for node in 0..level.len() {
                let children = level.children(node);
                let known = children.iter().any(|&child| finer.known[child as usize]);
                coarser.known.push(known);
                // Nobody asks for the sums of a node that has a received vertex.
                for child in children.iter().map(|&child| child as usize).filter(|_| !known) {
                    let factor = if weigh { finer.weights[child] as f32 } else { 1.0 };
                    coarser.weights[node] += finer.weights[child];
                    let sum = &mut coarser.sums[node * width..][..width];
                    for (sum, error) in sum.iter_mut().zip(&finer.sums[child * width..][..width]) {
                        *sum += factor * error;
                    }
                }
            }
            levels.push(coarser);
        }
        levels
    }

    /// What a missing vertex is expected to bring.
    fn judge(&self, vertex: usize, errors: &[Errors]) -> Candidate {
        let width = self.width();
        let error = &errors[0].sums[vertex * width..][..width];
        let weight = self.weights[vertex];
        let own = dot(error, error);
        if !self.options.look_ahead {
            return Candidate { vertex, gain: weight * own, block: (0, vertex) };
        }
        // The largest node without a received vertex.
        let (mut level, mut node) = (0, vertex);
        let parent = |level: usize, node: usize| {
            let parent = self.pyramid.levels[level].parents[node];
            (parent != NONE).then_some(parent as usize)
        };
        while let Some(up) = parent(level, node).filter(|&up| !errors[level + 1].known[up]) {
            (level, node) = (level + 1, up);
        }
        if level == 0 {
            let block = parent(0, vertex).map_or((0, vertex), |up| (1, up));
            return Candidate { vertex, gain: weight * own, block };
        }
        let reach = 1.0 - LOST_PER_LEVEL.powi(i32::try_from(level).unwrap_or(i32::MAX));
        let others = dot(error, &errors[level].sums[node * width..][..width]) - weight * own;
        let their_weight = errors[level].weights[node] - weight;
        let gain = weight * own + 2.0 * reach * others - reach * reach * their_weight * own;
        Candidate { vertex, gain, block: (level, node) }
    }

    /// Numbers of a vertex.
    fn width(&self) -> usize {
        scales(self.grid.quantity()).len()
    }
}

fn numbers(values: Values<'_>) -> &[f32] {
    match values {
        Values::Vectors(vectors) => vectors.as_flattened().as_flattened().as_flattened(),
        Values::Radiance(radiance) => radiance.as_flattened().as_flattened(),
    }
}

/// What each number of a vertex counts: vectors as they are, radiance harmonics as they enter irradiance, whose bands are
/// multiplied by π, 2π/3 and π/4 (Ramamoorthi and Hanrahan 2001).
fn scales(quantity: Quantity) -> impl ExactSizeIterator<Item = f32> + Clone {
    let [first, second, third] = match quantity {
        Quantity::Vectors => [1.0; 3],
        Quantity::Radiance => [1.0, 2.0 / 3.0, 0.25],
    };
    let count = match quantity {
        Quantity::Vectors => 54,
        Quantity::Radiance => 27,
    };
    (0..count).map(move |n| match n % 9 {
        0 => first,
        1..=3 => second,
        _ => third,
    })
}

fn dot(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(&a, &b)| f64::from(a) * f64::from(b)).sum()
}

#[cfg(test)]
mod tests;
