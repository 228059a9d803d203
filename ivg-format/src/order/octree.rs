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

/// Corners of a lattice.
const MOST_CORNERS: u64 = 8;

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
        let whole = Cell::whole(lattice.dims);
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

    /// The linear index of the vertex with this rank, which must be less than the count (IVG-OCT-05).
    pub(crate) fn at(&self, mut rank: u64) -> u64 {
        debug_assert!(rank < self.count, "rank outside the order");
        let [nx, ny, _] = self.dims.map(u64::from);
        let strides = [1, nx, nx * ny];
        let mut cell = Cell::whole(self.dims);
        let (mut vertex, mut depth) = (0, 0);
        while let Some(cut) = cell.cut() {
            let hash = splitmix64(self.seed, 32 * vertex + depth) as usize & (cut.children() - 1);
            let (turn, rank_in_child) = self.turn(&cell, &cut, hash, rank);
            let child = cut.child(&cell, cut.number(turn, hash));
            for ((stride, to), from) in strides.iter().zip(child.low).zip(cell.low) {
                vertex += stride * u64::from(to - from);
            }
            cell = child;
            (rank, depth) = (rank_in_child, depth + 1);
        }
        vertex
    }

    /// The turn of the child that holds the vertex of rank `rank` of a cell, and the vertex's rank there.
    fn turn(&self, cell: &Cell, cut: &Cut, hash: usize, rank: u64) -> (usize, u64) {
        let children = cut.children();
        // While no child is exhausted, which the smallest is first, all take part; children are a power of two.
        let in_all = |smallest: u64| {
            let (turn, round) = (rank as usize & (children - 1), rank >> cut.count);
            (round < smallest).then_some((turn, round))
        };
        // A child has at most eight corners less than vertices: near enough for all but the last rounds.
        let corners = if cell.has_corners(self.dims) { MOST_CORNERS } else { 0 };
        if let Some(found) = in_all(cut.smallest(cell).saturating_sub(corners)) {
            return found;
        }
        let mut counts = [0; MOST_CHILDREN];
        let mut smallest = u64::MAX;
        for (turn, count) in counts.iter_mut().enumerate().take(children) {
            *count = cut.child(cell, cut.number(turn, hash)).count(self.dims);
            smallest = smallest.min(*count);
        }
        if let Some(found) = in_all(smallest) {
            return found;
        }
        // Rounds between one child's end and the next one's all have the same children.
        let (mut before, mut rank) = (0, rank);
        loop {
            let left = counts.iter().filter(|&&count| count > before);
            let (taking, next) = left.fold((0, u64::MAX), |(n, least), &count| (n + 1, least.min(count)));
            debug_assert!(taking > 0, "rank outside the cell");
            let vertices = (next - before) * taking;
            if rank < vertices {
                let place = (rank % taking) as usize;
                let turn = (0..children).filter(|&turn| counts[turn] > before).nth(place);
                return (turn.unwrap_or(0), before + rank / taking);
            }
            rank -= vertices;
            before = next;
        }
    }
}

/// A box of vertices.
#[derive(Clone, Copy, Debug)]
struct Cell {
    low: [u32; 3],
    extent: [u32; 3],
}

impl Cell {
    fn whole(dims: [u16; 3]) -> Self {
        Self { low: [0; 3], extent: dims.map(u32::from) }
    }

    /// Whether it has a corner of the lattice: an end of every axis.
    fn has_corners(&self, dims: [u16; 3]) -> bool {
        (0..3).all(|a| self.low[a] == 0 || self.low[a] + self.extent[a] == u32::from(dims[a]))
    }

    /// Vertices that are not corners of the lattice.
    fn count(&self, dims: [u16; 3]) -> u64 {
        let (mut vertices, mut corners) = (1, 1);
        for ((&low, &extent), n) in self.low.iter().zip(&self.extent).zip(dims.map(u32::from)) {
            vertices *= u64::from(extent);
            // Of the two ends of the axis, which are one where it has a single vertex.
            corners *= u64::from(low == 0) + u64::from(n > 1 && low + extent == n);
        }
        vertices - corners
    }

    /// How it is cut (IVG-OCT-02); `None` for a single vertex.
    fn cut(&self) -> Option<Cut> {
        let longest = self.extent[0].max(self.extent[1]).max(self.extent[2]);
        if longest == 1 {
            return None;
        }
        // An extent of 1 never passes: the longest is 2 or more.
        let along = self.extent.map(|extent| u32::from(2 * extent > longest));
        Some(Cut { along, count: along[0] + along[1] + along[2] })
    }
}

/// Along which axes a cell is cut. All that follows is arithmetic without branches, for which part a vertex is in cannot be
/// predicted.
#[derive(Clone, Copy, Debug)]
struct Cut {
    /// 1 for the axes that are cut, else 0.
    along: [u32; 3],
    /// How many, at least one.
    count: u32,
}

impl Cut {
    fn children(&self) -> usize {
        1 << self.count
    }

    /// The number of the child whose turn it is (IVG-OCT-04).
    fn number(&self, turn: usize, hash: usize) -> usize {
        usize::from(TURNS[self.count as usize - 1][turn]) ^ hash
    }

    /// Vertices of the smallest child: the upper part along every axis.
    fn smallest(&self, cell: &Cell) -> u64 {
        (0..3).map(|axis| u64::from(cell.extent[axis] >> self.along[axis])).product()
    }

    /// The child with this number: one bit for each axis that is cut, set for the upper part.
    fn child(&self, cell: &Cell, number: usize) -> Cell {
        let (mut child, mut bits) = (*cell, number as u32);
        for axis in 0..3 {
            let (cut, extent) = (self.along[axis], cell.extent[axis]);
            let upper = bits & cut;
            bits >>= cut;
            // The whole extent where the axis is not cut.
            let lower = extent - cut * (extent / 2);
            child.low[axis] += upper * lower;
            child.extent[axis] = lower - upper * (2 * lower - extent);
        }
        child
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
