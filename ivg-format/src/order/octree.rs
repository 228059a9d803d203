//! The order `octree`: every prefix of it is spread evenly over the volume (`spec/ivg.md`, "Order").
//!
//! A cell, at first the whole lattice, is cut in two along each of its longer axes. Its vertices are taken from the
//! children in turn, one of each that has any left, round by round; and those of a child likewise from its own
//! children. How the children of a cell follow each other comes from a hash of the seed and the cell. Which vertex
//! has a rank is found by going down once: nothing is stored.

use crate::lattice::Lattice;
use ivg_wire::splitmix64;

/// Children of a cell that is cut along three axes.
const MOST_CHILDREN: usize = 8;

/// The children of a cell that is cut along one, two, three axes in the order of their turns, before the cell's hash
/// is applied: of eight, the first four have no common face (IVG-OCT-04).
const TURNS: [[u8; MOST_CHILDREN]; 3] =
    [[0, 1, 0, 0, 0, 0, 0, 0], [0, 3, 1, 2, 0, 0, 0, 0], [0, 3, 5, 6, 7, 4, 2, 1]];

/// The order of the vertices of one lattice, corners left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Octree {
    dims: [u16; 3],
    /// Vertices that are not corners.
    count: u64,
    per_bundle: u64,
    seed: u64,
}

impl Octree {
    pub(crate) fn new(lattice: &Lattice, per_slice: u32, seed: u64) -> Self {
        let longest = u64::from(lattice.dims[lattice.longest_axis()]);
        let whole = Cell { low: [0; 3], extent: lattice.dims };
        // At most 2³² vertices of each of 65,535 slices: no overflow.
        let per_bundle = u64::from(per_slice) * longest;
        Self { dims: lattice.dims, count: whole.count(lattice.dims), per_bundle, seed }
    }

    /// Number of bundles (IVG-OCT-01).
    pub(crate) fn bundle_count(&self) -> u64 {
        self.count.div_ceil(self.per_bundle.max(1))
    }

    /// The ranks of bundle `k`, counted from 1.
    fn ranks(&self, k: u32) -> core::ops::Range<u64> {
        let first = u64::from(k.saturating_sub(1)).saturating_mul(self.per_bundle).min(self.count);
        first..first.saturating_add(self.per_bundle).min(self.count)
    }

    /// Vertices of bundle `k`, counted from 1.
    pub(crate) fn bundle_len(&self, k: u32) -> u64 {
        let ranks = self.ranks(k);
        ranks.end - ranks.start
    }

    /// Number of bundles before the last one, which may be smaller.
    pub(crate) fn full_bundles(&self) -> u64 {
        self.count.checked_div(self.per_bundle).unwrap_or(0)
    }

    /// The vertex at place `n` of bundle `k`, or `None` beyond its end.
    pub(crate) fn vertex(&self, k: u32, n: u64) -> Option<u64> {
        let ranks = self.ranks(k);
        let rank = ranks.start.checked_add(n)?;
        ranks.contains(&rank).then(|| self.at(rank))
    }

    pub(crate) fn walk(&self, k: u32) -> Walk {
        Walk { octree: *self, ranks: if k == 0 { 0..0 } else { self.ranks(k) } }
    }

    /// The linear index of the vertex with this rank, which must be less than the count (IVG-OCT-02, IVG-OCT-03).
    pub(crate) fn at(&self, mut rank: u64) -> u64 {
        debug_assert!(rank < self.count, "rank outside the order");
        let mut cell = Cell { low: [0; 3], extent: self.dims };
        let mut depth = 0;
        while cell.extent != [1; 3] {
            (cell, rank) = cell.child_with(rank, self.dims, self.seed, depth);
            depth += 1;
        }
        index(self.dims, cell.low)
    }
}

fn index([nx, ny, _]: [u16; 3], [i, j, k]: [u16; 3]) -> u64 {
    u64::from(i) + u64::from(nx) * (u64::from(j) + u64::from(ny) * u64::from(k))
}

/// A box of vertices.
#[derive(Clone, Copy, Debug)]
struct Cell {
    low: [u16; 3],
    extent: [u16; 3],
}

impl Cell {
    /// Vertices that are not corners of the lattice.
    fn count(&self, dims: [u16; 3]) -> u64 {
        let (mut vertices, mut corners) = (1, 1);
        for ((&low, &extent), n) in self.low.iter().zip(&self.extent).zip(dims) {
            vertices *= u64::from(extent);
            // Of the two ends of the axis, which are one where it has a single vertex.
            corners *= u64::from(low == 0) + u64::from(n > 1 && low + extent == n);
        }
        vertices - corners
    }

    /// The child that holds the vertex of rank `rank` of this cell, and the vertex's rank there.
    fn child_with(&self, mut rank: u64, dims: [u16; 3], seed: u64, depth: u64) -> (Self, u64) {
        let longest = u32::from(self.extent.into_iter().fold(1, u16::max));
        let split = self.extent.map(|e| e > 1 && 2 * u32::from(e) > longest);
        // At least the longest axis: a cell with a choice has an extent of 2 or more.
        let axes = split.into_iter().filter(|&s| s).count();
        let children = 1usize << axes;
        let hash = splitmix64(seed, 32 * index(dims, self.low) + depth) as usize % children;

        let child = |turn: usize| {
            let mut which = usize::from(TURNS[axes - 1][turn]) ^ hash;
            let mut child = *self;
            for axis in (0..3).filter(|&axis| split[axis]) {
                let lower = self.extent[axis].div_ceil(2);
                if which & 1 == 0 {
                    child.extent[axis] = lower;
                } else {
                    child.low[axis] += lower;
                    child.extent[axis] -= lower;
                }
                which >>= 1;
            }
            child
        };
        let mut counts = [0; MOST_CHILDREN];
        for (turn, count) in counts.iter_mut().enumerate().take(children) {
            *count = child(turn).count(dims);
        }
        // Rounds between one child's end and the next one's all have the same children.
        let mut before = 0;
        loop {
            let left = counts.iter().filter(|&&count| count > before);
            let (taking, next) = left.fold((0, u64::MAX), |(n, least), &count| (n + 1, least.min(count)));
            debug_assert!(taking > 0, "rank outside the cell");
            let vertices = (next - before) * taking;
            if rank < vertices {
                let place = (rank % taking) as usize;
                let turn = (0..children).filter(|&turn| counts[turn] > before).nth(place);
                return (child(turn.unwrap_or(0)), before + rank / taking);
            }
            rank -= vertices;
            before = next;
        }
    }
}

/// The vertices of consecutive ranks.
#[derive(Clone, Debug)]
pub(crate) struct Walk {
    octree: Octree,
    ranks: core::ops::Range<u64>,
}

impl Walk {
    pub(crate) fn next(&mut self) -> Option<u64> {
        self.ranks.next().map(|rank| self.octree.at(rank))
    }

    pub(crate) fn left(&self) -> u64 {
        self.ranks.end - self.ranks.start
    }
}

#[cfg(test)]
mod tests;
