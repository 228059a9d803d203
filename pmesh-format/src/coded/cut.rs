//! Which faces of the parent switch to the new vertex, where they go round and it takes a run of them (PMESH-COD-09).

use super::Fault;
use super::models::Symbols;
use super::priors::{COUNTS, RANKS};
use super::rans::Coder;
use crate::code::codes;

/// Numbers of faces that have models of their own: 2 to 10 or more.
const SIZES: usize = 9;

/// Degrees by which lengths stand out.
const LEVELS: usize = 4;

/// Runs of 1, 2, 3, 4 or more faces.
const RUNS: usize = 4;

/// The greatest number that one symbol says; with this one a raw number follows.
const LAST: usize = 15;

/// Bits of that raw number.
const MORE_BITS: u32 = 5;

/// The models of a cut.
#[derive(Clone, Debug)]
pub(super) struct Cuts {
    /// How many faces switch, 0 for a split that is not regular; by the number of faces and how much the longest edge stands out.
    counts: [[Symbols; LEVELS]; SIZES],
    /// The rank of the run among all; by its faces, the number of faces, and how much the first rank stands out.
    ranks: [[[Symbols; LEVELS]; SIZES]; RUNS],
}

/// A run of faces: the first one, and how many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Run {
    pub(super) first: usize,
    pub(super) count: usize,
}

impl Cuts {
    pub(super) fn new() -> Self {
        Self {
            counts: COUNTS.map(|starts| [Symbols::new(starts); LEVELS]),
            ranks: core::array::from_fn(|run| {
                [core::array::from_fn(|level| Symbols::new(RANKS[run * LEVELS + level])); SIZES]
            }),
        }
    }

    /// A run of some but not all of at least two faces; `None` if the split is not regular. `lengths`: those of the edges at which
    /// each of the `count` faces begins, twice, and zeros behind them; `first`: the face with the first slot.
    #[inline(always)]
    pub(super) fn code<C: Coder, const N: usize>(
        &mut self,
        coder: &mut C,
        lengths: &[[i32; N]; 3],
        count: usize,
        first: usize,
        given: Option<Run>,
    ) -> Result<Option<Run>, Fault> {
        let size = count.min(SIZES + 1) - 2;
        let (mut all, mut most) = (0, 0);
        for k in 0..N {
            let length = if k < count { lengths[0][k] } else { 0 };
            all += length;
            most = length.max(most);
        }
        let level = stands_out(4 * most * count as i32, [5 * all, 6 * all, 8 * all]);
        let known = given.map_or(0, |run| run.count);
        let taken = number(coder, &mut self.counts[size][level], known);
        if taken == 0 {
            return Ok(None);
        }
        if taken >= count {
            return Err((codes::CORNER, 0));
        }
        // The edges inside a run, or those at either end of a single face.
        let (from, to) = if taken == 1 { (0, 2) } else { (1, taken) };
        let mut weights = [0i32; N];
        for j in from..to {
            if let Some(shifted) = lengths.as_flattened().get(j..).and_then(|all| all.first_chunk::<N>()) {
                for k in 0..N {
                    weights[k] += shifted[k];
                }
            }
        }
        // By descending weight, equal ones by how far they are behind the first face; 0 for places without a face.
        let mut keys = [0u32; N];
        for k in 0..N {
            let behind = if k >= first { k - first } else { k + count - first } as u32;
            keys[k] = if k < count { ((weights[k] as u32) << 5 | (31 - (behind & 31))) + 1 } else { 0 };
        }
        let best = keys.iter().fold(0, |most, &key| key.max(most));
        let second = keys.iter().fold(0, |most, &key| if key == best { most } else { key.max(most) });
        // At most 2²⁷ × 32 × 8 would not fit.
        let apart = u64::from(((best - 1) >> 5) - ((second - 1) >> 5)) * 8 * count as u64;
        let level = [1, 2, 4].iter().map(|&x| usize::from(apart >= x * all as u64)).sum::<usize>();
        let mut ranks = [0u32; N];
        for &key in &keys {
            for k in 0..N {
                ranks[k] += u32::from(key > keys[k]);
            }
        }
        let known = given.map_or(0, |run| ranks[run.first] as usize);
        let found = number(coder, &mut self.ranks[taken.min(RUNS) - 1][size][level], known);
        if found >= count {
            return Err((codes::CORNER, 0));
        }
        let mut first = 0;
        for k in 0..N {
            first |= if ranks[k] == found as u32 && k < count { k } else { 0 };
        }
        Ok(Some(Run { first, count: taken }))
    }
}

#[inline(always)]
fn stands_out(x: i32, thresholds: [i32; LEVELS - 1]) -> usize {
    thresholds.iter().map(|&threshold| usize::from(x >= threshold)).sum()
}

/// A number up to 46.
#[inline(always)]
fn number<C: Coder>(coder: &mut C, model: &mut Symbols, known: usize) -> usize {
    let symbol = coder.symbol(model, known.min(LAST));
    if symbol == LAST {
        return LAST + coder.raw(MORE_BITS, known.wrapping_sub(LAST) as u32) as usize;
    }
    symbol
}
