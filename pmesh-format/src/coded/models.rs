//! Adaptive models: how probable each value is, learnt from those before (PMESH-COD-04).
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use crate::machine::{Lanes, approach, not_above};

/// Bits of a probability.
pub(super) const PROBABILITY_BITS: u32 = 15;

/// The probability 1.
pub(super) const ONE: u32 = 1 << PROBABILITY_BITS;

/// Values after which a binary model learns no more slowly.
const BINARY_MOST: u16 = 60;

/// The least probability of either value of a binary model.
const BINARY_LEAST: i32 = 32;

/// The least frequency that a symbol of 16 tends to.
const SYMBOL_LEAST: i16 = 8;

/// Values after which a model of 16 symbols learns more slowly.
const SLOWER: [u16; 2] = [20, 80];

/// By how many bits the first steps of a model of 16 symbols are shortened.
const FIRST_SHIFT: u32 = 4;

/// A choice of two.
#[derive(Clone, Copy, Debug)]
pub(super) struct Binary {
    /// The probability of `true`, 1 to 2¹⁵ − 1.
    probability: u16,
    /// Values seen, [`BINARY_MOST`] at most.
    seen: u16,
}

/// 65,536 / (n + 1.6), rounded down, for n values seen.
#[expect(clippy::indexing_slicing, reason = "a constant")]
const RATES: [u16; 64] = {
    let mut rates = [0; 64];
    let mut n = 0;
    while n < rates.len() {
        rates[n] = (655_360 / (10 * n + 16)) as u16;
        n += 1;
    }
    rates
};

impl Binary {
    /// With that probability of `true` before anything is known.
    pub(super) const fn new(probability: u16) -> Self {
        Self { probability, seen: 0 }
    }

    /// Start and width of the range of a value.
    #[inline(always)]
    pub(super) fn range(&self, value: bool) -> (u32, u32) {
        let p = u32::from(self.probability);
        if value { (0, p) } else { (p, ONE.wrapping_sub(p)) }
    }

    /// The value in whose range a number lies.
    #[inline(always)]
    pub(super) fn find(&self, at: u32) -> bool {
        at < u32::from(self.probability)
    }

    #[inline(always)]
    pub(super) fn update(&mut self, value: bool) {
        let p = i32::from(self.probability);
        let target = if value { (ONE as i32).wrapping_sub(BINARY_LEAST) } else { BINARY_LEAST };
        let rate = RATES.get(usize::from(self.seen) & 63).copied().unwrap_or(0);
        // |difference| < 2¹⁵ and rate < 2¹⁶; the result lies between both.
        self.probability = p.wrapping_add(target.wrapping_sub(p).wrapping_mul(i32::from(rate)) >> 16) as u16;
        self.seen = self.seen.wrapping_add(u16::from(self.seen < BINARY_MOST));
    }
}

/// By how many bits the step of a model of 16 symbols is shortened that has seen so many values.
#[expect(clippy::indexing_slicing, reason = "a constant")]
const SHIFTS: [u8; 128] = {
    let mut shifts = [FIRST_SHIFT as u8; 128];
    let mut seen = 0;
    while seen < shifts.len() {
        shifts[seen] += (seen >= SLOWER[0] as usize) as u8 + (seen >= SLOWER[1] as usize) as u8;
        seen += 1;
    }
    shifts
};

/// One of 16.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(super) struct Symbols {
    /// Where the range of each symbol begins; strictly increasing, the first 0.
    starts: Lanes,
    seen: u16,
}

/// What the starts tend to when a symbol comes again and again.
#[expect(clippy::indexing_slicing, reason = "a constant")]
const TARGETS: [Lanes; 16] = {
    let mut targets = [[[0; 8]; 2]; 16];
    let mut symbol = 0;
    while symbol < 16 {
        let mut i = 0;
        while i < 16 {
            let above = i > symbol;
            let small = SYMBOL_LEAST * i as i16;
            targets[symbol][i / 8][i % 8] =
                if above { (ONE as i32 - SYMBOL_LEAST as i32 * (16 - i as i32)) as i16 } else { small };
            i += 1;
        }
        symbol += 1;
    }
    targets
};

impl Symbols {
    /// With these starts before anything is known.
    pub(super) const fn new(starts: [i16; 16]) -> Self {
        let [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] = starts;
        Self { starts: [[a, b, c, d, e, f, g, h], [i, j, k, l, m, n, o, p]], seen: 0 }
    }

    /// Start and width of the range of a symbol.
    #[inline(always)]
    pub(super) fn range(&self, symbol: usize) -> (u32, u32) {
        let [start, end] = [symbol & 15, symbol.wrapping_add(1) & 15]
            .map(|k| self.starts.as_flattened().get(k).copied().unwrap_or(0) as u32);
        // Behind the last one 0 begins again.
        (start, end.wrapping_sub(start) & (ONE - 1))
    }

    /// The symbol in whose range a number lies.
    #[inline(always)]
    pub(super) fn find(&self, at: u32) -> usize {
        not_above(&self.starts, at as i16).wrapping_sub(1)
    }

    #[inline(always)]
    pub(super) fn update(&mut self, symbol: usize) {
        let seen = usize::from(self.seen) & (SHIFTS.len().wrapping_sub(1));
        let shift = SHIFTS.get(seen).copied().unwrap_or(0);
        if let Some(targets) = TARGETS.get(symbol & 15) {
            approach(&mut self.starts, targets, shift.into());
        }
        let [_, late] = SLOWER;
        self.seen = self.seen.wrapping_add(u16::from(self.seen < late));
    }
}
