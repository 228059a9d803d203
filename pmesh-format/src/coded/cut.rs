//! Which faces of the parent switch to the new vertex, where they go round and it takes a run of them (PMESH-COD-09).

use super::Fault;
use super::models::Symbols;
use super::priors::{COUNTS, RANKS};
use super::rans::Coder;
use super::ring::FEW;
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
    /// each of the `count` faces begins, zeros behind them; `again`: these, from the first on once more, zeros behind them.
    #[inline(always)]
    pub(super) fn code<C: Coder, const N: usize>(
        &mut self,
        coder: &mut C,
        [lengths, again]: [&[i32]; 2],
        count: usize,
        given: Option<Run>,
    ) -> Result<Option<Run>, Fault> {
        let size = count.min(SIZES + 1) - 2;
        let all: i32 = lengths.iter().sum();
        let most = lengths.iter().fold(0, |most: i32, &length| most.max(length));
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
        let lanes = lanes::<N>(count);
        let mut weights = [0i32; N];
        for j in from..to {
            if let Some(shifted) = again.get(j..).and_then(|all| all.first_chunk::<N>()) {
                for k in 0..lanes {
                    weights[k] += shifted[k];
                }
            }
        }
        // By descending weight, equal ones ascending; 0 for places without a face.
        let mut keys = [0u32; N];
        let (mut best, mut second) = (0, 0);
        // At most 31 × 3 × 2²⁰ × 2⁵, which fits.
        for k in 0..lanes {
            let key = ((weights[k] as u32) << 5) + (32 - k as u32);
            let key = if (k as i32) < count as i32 { key } else { 0 };
            keys[k] = key;
            second = second.max(key.min(best));
            best = best.max(key);
        }
        let weight = |key: u32| u64::from((key - 1) >> 5);
        let apart = (weight(best) - weight(second)) * 8 * count as u64;
        let all = all as u64;
        let level = usize::from(apart >= all) + usize::from(apart >= 2 * all) + usize::from(apart >= 4 * all);
        let known = given.map_or(0, |run| keys.iter().filter(|&&key| key > keys[run.first]).count());
        let found = number(coder, &mut self.ranks[taken.min(RUNS) - 1][size][level], known);
        if found >= count {
            return Err((codes::CORNER, 0));
        }
        let mut key = if found == 0 { best } else { second };
        for _ in 1..found {
            key =
                keys[..lanes].iter().fold(0, |most, &other| if other < key { other.max(most) } else { most });
        }
        Ok(Some(Run { first: 31 - ((key - 1) & 31) as usize, count: taken }))
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

/// How many of `N` places are gone through for so many faces: of few always all, so that nothing depends on how many there are.
#[inline(always)]
fn lanes<const N: usize>(count: usize) -> usize {
    if N == FEW { N } else { count.min(N) }
}
