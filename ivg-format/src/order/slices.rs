//! The order `slices`: which vertices a bundle holds (`spec/ivg.md`, "Order"). Integers only.
//!
//! The lattice is cut into slices across its longest axis. The vertices of a slice, corners left out, are
//! visited in a permutation of the slice's own; bundle k takes the next `S` of every slice, or what remains.
//! The permutation is evaluated index by index: nothing is stored, whatever the size of the slice.

use crate::lattice::Lattice;
use ivg_wire::splitmix64;

/// Rounds of the Feistel network (IVG-ORD-10).
const ROUNDS: usize = 6;

/// Ranks that are followed at once: one after the other, each round would wait for the round before.
const AT_ONCE: usize = 8;

/// A permutation of 0..count: a Feistel network over the next power of two, walked along its cycles until the
/// result is less than count (IVG-ORD-09, IVG-ORD-10).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Permutation {
    count: u32,
    right_bits: u32,
    left_mask: u32,
    right_mask: u32,
    keys: [u32; ROUNDS],
}

impl Permutation {
    /// The permutation of `count` vertices of slice `slice`.
    pub(crate) fn new(count: u32, seed: u64, slice: u32) -> Self {
        let bits = (u32::BITS - count.saturating_sub(1).leading_zeros()).max(2);
        let (left_bits, right_bits) = (bits / 2, bits - bits / 2);
        let first = u64::from(slice) * ROUNDS as u64;
        let mut keys = [0; ROUNDS];
        for (key, n) in keys.iter_mut().zip(first..) {
            *key = (splitmix64(seed, n) >> 32) as u32;
        }
        let mask = |bits: u32| (1u32 << bits) - 1;
        Self { count, right_bits, left_mask: mask(left_bits), right_mask: mask(right_bits), keys }
    }

    /// Where `rank` goes. `rank` must be less than the count: then the walk ends, because the network permutes
    /// and so returns to numbers below the count; over all ranks it visits each number at most once.
    pub(crate) fn at(&self, rank: u32) -> u32 {
        debug_assert!(rank < self.count, "rank outside the permutation");
        self.walk(self.network(rank))
    }

    /// On from a number to the next below the count.
    fn walk(&self, mut number: u32) -> u32 {
        while number >= self.count {
            number = self.network(number);
        }
        number
    }

    /// Where the first step from some ranks goes; some of them may be beyond the count.
    fn first_steps(&self, first: u32) -> [u32; AT_ONCE] {
        let mut left = [0; AT_ONCE];
        let mut right = [0; AT_ONCE];
        for n in 0..AT_ONCE {
            let rank = first.wrapping_add(n as u32);
            (left[n], right[n]) = (rank >> self.right_bits, rank & self.right_mask);
        }
        for pair in self.keys.chunks_exact(2) {
            for n in 0..AT_ONCE {
                left[n] ^= mix32(right[n].wrapping_add(pair[0])) & self.left_mask;
            }
            for n in 0..AT_ONCE {
                right[n] ^= mix32(left[n].wrapping_add(pair[1])) & self.right_mask;
            }
        }
        core::array::from_fn(|n| left[n] << self.right_bits | right[n])
    }

    fn network(&self, number: u32) -> u32 {
        let (mut left, mut right) = (number >> self.right_bits, number & self.right_mask);
        for pair in self.keys.chunks_exact(2) {
            left ^= mix32(right.wrapping_add(pair[0])) & self.left_mask;
            right ^= mix32(left.wrapping_add(pair[1])) & self.right_mask;
        }
        left << self.right_bits | right
    }
}

/// The finaliser of `MurmurHash3` (Appleby), modulo 2³² (IVG-ORD-10).
const fn mix32(word: u32) -> u32 {
    let z = (word ^ (word >> 16)).wrapping_mul(0x85EB_CA6B);
    let z = (z ^ (z >> 13)).wrapping_mul(0xC2B2_AE35);
    z ^ (z >> 16)
}

/// The slices of a lattice and how many vertices each contributes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slices {
    /// The axis across which the lattice is cut, and the two others, ascending.
    axes: [usize; 3],
    dims: [u16; 3],
    /// Vertices of an inner slice.
    inner: u64,
    /// Vertices of the first and of the last slice, corners left out.
    outer: u64,
    /// Vertices that a bundle takes from a slice.
    per_slice: u64,
    seed: u64,
}

impl Slices {
    pub(crate) fn new(lattice: &Lattice, per_slice: u32, seed: u64) -> Self {
        let axes = match lattice.longest_axis() {
            0 => [0, 1, 2],
            1 => [1, 0, 2],
            _ => [2, 0, 1],
        };
        let [_, b, c] = axes.map(|axis| u64::from(lattice.dims[axis]));
        let corners = b.min(2) * c.min(2);
        Self {
            axes,
            dims: lattice.dims,
            inner: b * c,
            outer: (b * c).saturating_sub(corners),
            per_slice: u64::from(per_slice),
            seed,
        }
    }

    fn slice_count(&self) -> u64 {
        u64::from(self.dims[self.axes[0]])
    }

    fn outer_slices(&self) -> u64 {
        self.slice_count().min(2)
    }

    fn inner_slices(&self) -> u64 {
        self.slice_count().saturating_sub(2)
    }

    /// Number of bundles (IVG-ORD-04); 0 where every vertex is a corner.
    pub(crate) fn bundle_count(&self) -> u64 {
        let most = if self.inner_slices() > 0 { self.inner } else { self.outer };
        most.div_ceil(self.per_slice.max(1))
    }

    /// Vertices of one slice of `slice_vertices` in bundle `k`, counted from 1.
    fn share(&self, slice_vertices: u64, k: u32) -> u64 {
        let before = u64::from(k.saturating_sub(1)).saturating_mul(self.per_slice);
        slice_vertices.saturating_sub(before).min(self.per_slice)
    }

    /// Vertices of bundle `k`, counted from 1. It never grows with k.
    pub(crate) fn bundle_len(&self, k: u32) -> u64 {
        // At most 65,535 slices of 65,535² vertices: no overflow.
        self.outer_slices() * self.share(self.outer, k) + self.inner_slices() * self.share(self.inner, k)
    }

    /// Number of leading bundles to which every slice contributes its full share, so that all of them have
    /// the same length.
    pub(crate) fn full_bundles(&self) -> u64 {
        self.outer.checked_div(self.per_slice).unwrap_or(0)
    }

    /// The vertex at place `n` of bundle `k`, or `None` beyond its end.
    pub(crate) fn vertex(&self, lattice: &Lattice, k: u32, n: u64) -> Option<u64> {
        let (outer, inner) = (self.share(self.outer, k), self.share(self.inner, k));
        let last = self.slice_count() - 1;
        let (slice, place) = if n < outer {
            (0, n)
        } else {
            let m = n - outer;
            match m.checked_div(inner) {
                Some(s) if s < self.inner_slices() => (s + 1, m % inner),
                _ => (last, m - inner * self.inner_slices()),
            }
        };
        let is_outer = slice == 0 || slice == last;
        if place >= if is_outer { outer } else { inner } || slice > last {
            return None;
        }
        let rank = u64::from(k.saturating_sub(1)) * self.per_slice + place;
        Some(self.locate(lattice, slice, self.permutation(slice as u32).at(rank as u32)))
    }

    /// The vertices of bundle `k`, counted from 1; none for 0.
    pub(crate) fn walk(&self, lattice: &Lattice, k: u32) -> Walk {
        let left = if k == 0 { 0 } else { self.bundle_len(k) };
        let share = self.share(self.outer, k);
        let permutation = self.permutation(0);
        Walk {
            slices: *self,
            lattice: *lattice,
            k,
            slice: 0,
            place: 0,
            share,
            permutation,
            steps: [0; AT_ONCE],
            left,
        }
    }

    fn is_outer(&self, slice: u64) -> bool {
        slice == 0 || slice + 1 == self.slice_count()
    }

    fn permutation(&self, slice: u32) -> Permutation {
        let count = if self.is_outer(u64::from(slice)) { self.outer } else { self.inner };
        Permutation::new(count as u32, self.seed, slice)
    }

    /// The linear index of the vertex of a slice with this number (IVG-ORD-08).
    fn locate(&self, lattice: &Lattice, slice: u64, number: u32) -> u64 {
        // A slice has fewer than 2³² vertices.
        let [b, c] = [self.dims[self.axes[1]], self.dims[self.axes[2]]].map(u32::from);
        let mut local = number;
        if self.is_outer(slice) {
            // Step over the corners of the slice, ascending; where an axis has one vertex, some coincide.
            for row in [0, c - 1].iter().take(c.min(2) as usize) {
                for column in [0, b - 1].iter().take(b.min(2) as usize) {
                    if local >= column + b * row {
                        local += 1;
                    }
                }
            }
        }
        let mut at = [0u16; 3];
        at[self.axes[0]] = slice as u16;
        at[self.axes[1]] = (local % b) as u16;
        at[self.axes[2]] = (local / b) as u16;
        lattice.index(at[0], at[1], at[2])
    }
}

/// The vertices of a bundle in stored order: slices ascending, each in the order of its permutation.
#[derive(Clone, Debug)]
pub(crate) struct Walk {
    slices: Slices,
    lattice: Lattice,
    k: u32,
    slice: u64,
    place: u64,
    share: u64,
    permutation: Permutation,
    /// The first steps from the ranks of this place and those before and after it that were taken with it.
    steps: [u32; AT_ONCE],
    left: u64,
}

impl Walk {
    pub(crate) fn next(&mut self) -> Option<u64> {
        self.left = self.left.checked_sub(1)?;
        while self.place >= self.share {
            self.slice += 1;
            self.place = 0;
            let count = if self.slices.is_outer(self.slice) { self.slices.outer } else { self.slices.inner };
            self.share = self.slices.share(count, self.k);
            self.permutation = self.slices.permutation(self.slice as u32);
        }
        let among = self.place as usize % AT_ONCE;
        if among == 0 {
            let rank = u64::from(self.k - 1) * self.slices.per_slice + self.place;
            self.steps = self.permutation.first_steps(rank as u32);
        }
        self.place += 1;
        Some(self.slices.locate(&self.lattice, self.slice, self.permutation.walk(self.steps[among])))
    }

    pub(crate) const fn left(&self) -> u64 {
        self.left
    }
}

#[cfg(test)]
mod tests;
