//! Which faces of the parent switch to the new vertex, where they go round and it takes a run of them (PMESH-COD-09).

use super::geometry::logarithm;
use super::models::Binary;
use super::rans::Coder;
use super::ring::MOST;

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

    /// A run of some but not all of at least two faces. `lengths`: the squared length of the edge at which each face begins.
    #[inline(always)]
    pub(super) fn code<C: Coder>(&mut self, coder: &mut C, lengths: &[u64], run: Run) -> Run {
        let count = lengths.len();
        let wrap = |k: usize| if k >= count { k - count } else { k };
        if count == 2 {
            let second = coder.bit(&mut self.further[7], run.first == 1);
            return Run { first: usize::from(second), count: 1 };
        }
        let mean = logarithm(lengths.iter().sum::<u64>() / count as u64) as i32;
        let mut steps = [0u8; MOST];
        for (step, &length) in steps.iter_mut().zip(lengths) {
            *step = (((logarithm(length) as i32 - mean) >> 2) + 8).clamp(0, 15) as u8;
        }
        let step = |k: usize| usize::from(steps[k & (MOST - 1)]);
        // Edges by descending length, equal ones by place.
        let mut by_length = [0u8; MOST];
        for k in 0..count {
            let mut at = k;
            while at > 0 && lengths[usize::from(by_length[at - 1])] < lengths[k] {
                by_length[at] = by_length[at - 1];
                at -= 1;
            }
            by_length[at] = k as u8;
        }
        let ranked = |rank: usize| usize::from(by_length[rank & (MOST - 1)]);
        let faces = count.min(10) - 3;
        // Whether the edge at which a face begins lies inside the run.
        let inside = |k: usize| {
            let from = wrap(k + count - run.first.min(count));
            from >= 1 && from < run.count
        };
        if coder.bit(&mut self.single[faces * 16 + step(ranked(0))], run.count == 1) {
            return self.single(coder, lengths, run.first);
        }
        let mut skipped = 0u32;
        let mut rank = 0;
        let seed = loop {
            let k = ranked(rank);
            if rank + 1 == count {
                break k;
            }
            let beside = step(wrap(k + 1)).max(step(wrap(k + count - 1)));
            let model = &mut self.seed[(rank.min(3) * 16 + step(k)) * 16 + beside];
            if coder.bit(model, inside(k)) {
                break k;
            }
            skipped |= 1 << k;
            rank += 1;
        };
        let (mut low, mut high, mut inner) = (seed, seed, 1usize);
        let left_first = lengths[wrap(seed + count - 1)] >= lengths[wrap(seed + 1)];
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
    fn single<C: Coder>(&mut self, coder: &mut C, lengths: &[u64], first: usize) -> Run {
        let count = lengths.len();
        let mut faces: [u8; MOST] = core::array::from_fn(|k| k as u8);
        let around = |k: u8| {
            let k = usize::from(k);
            lengths[k] + lengths[if k + 1 == count { 0 } else { k + 1 }]
        };
        faces[..count].sort_by_key(|&k| core::cmp::Reverse(around(k)));
        let mut rank = 0;
        while rank + 1 < count && coder.bit(&mut self.further[rank.min(6)], usize::from(faces[rank]) != first)
        {
            rank += 1;
        }
        Run { first: faces[rank].into(), count: 1 }
    }
}
