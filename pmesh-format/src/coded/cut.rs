//! Which faces of the parent switch to the new vertex, where they go round and it takes a run of them (PMESH-COD-09).

use super::geometry::{divide, logarithm};
use super::models::Binary;
use super::rans::Coder;
use super::ring::FEW;

/// The models of a cut.
#[derive(Clone, Debug)]
pub(super) struct Cuts {
    /// Whether a single face switches; by the number of faces and the length of the longest edge.
    single: [Binary; 8 * 16],
    /// Whether it is not yet the face in this place.
    further: [Binary; 8],
    /// Whether the longest edge that is left goes over; by how many were longer, its length and that of its neighbours.
    seed: [Binary; 4 * 16 * 16],
    /// Whether the next edge goes over as well; by how many did, the side, how many are left, and its length.
    extend: [Binary; 4 * 2 * 8 * 16],
}

/// A run of faces: the first one, and how many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Run {
    pub(super) first: usize,
    pub(super) count: usize,
}

impl Cuts {
    pub(super) fn new() -> Self {
        let even = Binary::new(1 << 14);
        Self {
            single: [Binary::new(1 << 11); 128],
            further: [even; 8],
            seed: [even; 1024],
            extend: [even; 1024],
        }
    }

    /// A run of some but not all of at least two faces. `lengths`: the squared length of the edge at which each of the `count`
    /// faces begins, then zeros.
    #[inline(always)]
    pub(super) fn code<C: Coder, const N: usize>(
        &mut self,
        coder: &mut C,
        lengths: &[u64; N],
        count: usize,
        run: Run,
    ) -> Run {
        let wrap = |k: usize| if k >= count { k - count } else { k };
        let length = |k: usize| lengths[k & (N - 1)];
        if count == 2 {
            let second = coder.bit(&mut self.further[7], run.first == 1);
            return Run { first: usize::from(second), count: 1 };
        }
        let all = if N == FEW { lengths.iter().sum() } else { lengths[..count].iter().sum() };
        let mean = logarithm(divide(all, count as u32)) as i32;
        let step = |k: usize| (((logarithm(length(k)) as i32 - mean) >> 2) + 8).clamp(0, 15) as usize;
        // Edges by descending length, equal ones by place: looked for one by one, since the first few are enough.
        let mut ranking = Ranking::<N>::new(count, length);
        let mut k = ranking.next();
        let faces = count.min(10) - 3;
        // Whether the edge at which a face begins lies inside the run.
        let inside = |k: usize| {
            let from = wrap(k + count - run.first.min(count));
            from >= 1 && from < run.count
        };
        if coder.bit(&mut self.single[faces * 16 + step(k)], run.count == 1) {
            let around = Ranking::<N>::new(count, |k| length(k) + length(wrap(k + 1)));
            return self.single(coder, around, count, run.first);
        }
        let mut skipped = 0u32;
        let mut rank = 0;
        while rank + 1 < count {
            let beside = step(wrap(k + 1)).max(step(wrap(k + count - 1)));
            let model = &mut self.seed[(rank.min(3) * 16 + step(k)) * 16 + beside];
            if coder.bit(model, inside(k)) {
                break;
            }
            skipped |= 1 << k;
            rank += 1;
            k = ranking.next();
        }
        let (mut low, mut high, mut inner) = (k, k, 1usize);
        let left_first = length(wrap(k + count - 1)) >= length(wrap(k + 1));
        for side in 0..2 {
            let left = (side == 0) == left_first;
            while inner + 3 <= count {
                let next = if left { wrap(low + count - 1) } else { wrap(high + 1) };
                if skipped >> next & 1 == 1 {
                    break;
                }
                let context = ((inner.min(4) - 1) * 2 + side) * 8 + (count - inner).min(7);
                if !coder.bit(&mut self.extend[context * 16 + step(next)], inside(next)) {
                    break;
                }
                inner += 1;
                if left { low = next } else { high = next }
            }
        }
        Run { first: wrap(low + count - 1), count: inner + 1 }
    }

    /// One face: the place among all by the descending length of the edges beside it.
    #[inline(always)]
    fn single<C: Coder, const N: usize>(
        &mut self,
        coder: &mut C,
        mut ranking: Ranking<N>,
        count: usize,
        first: usize,
    ) -> Run {
        let mut rank = 0;
        let mut face = ranking.next();
        while rank + 1 < count && coder.bit(&mut self.further[rank.min(6)], face != first) {
            rank += 1;
            face = ranking.next();
        }
        Run { first: face, count: 1 }
    }
}

/// Places by descending length, equal ones ascending.
struct Ranking<const N: usize> {
    /// Length × 64 + 63 − place; 0 for those that have been named and those that do not exist.
    keys: [u64; N],
}

impl<const N: usize> Ranking<N> {
    #[inline(always)]
    fn new(count: usize, length: impl Fn(usize) -> u64) -> Self {
        let mut keys = [0; N];
        for (k, key) in keys.iter_mut().enumerate().take(if N == FEW { N } else { count }) {
            *key = if k < count { length(k) << 6 | (63 - k as u64) } else { 0 };
        }
        Self { keys }
    }

    /// The next place.
    #[inline(always)]
    fn next(&mut self) -> usize {
        let most = self.keys.iter().fold(0, |most, &key| most.max(key));
        let place = 63 - (most & 63) as usize;
        self.keys[place & (N - 1)] = 0;
        place
    }
}
