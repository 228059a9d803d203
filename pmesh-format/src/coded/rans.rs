//! The entropy coder: range asymmetric numeral systems with a state of 32 bits, words of 16 bits and probabilities of 15 bits
//! (PMESH-COD-02; Duda, "Asymmetric numeral systems", arXiv:1311.2540).
//!
//! The writer notes what it codes and works through it backwards in the end; the reader goes forwards.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use alloc::vec::Vec;

use super::models::{Binary, ONE, PROBABILITY_BITS, Symbols};

/// The state before the first and after the last symbol, and the least there is between symbols.
const LEAST: u32 = 1 << WORD_BITS;

/// Bits of a word of the payload.
const WORD_BITS: u32 = 16;

/// One side of the coder. What goes through it comes out again: the writer gives values, the reader finds them and ignores
/// what it is given.
pub(super) trait Coder: Default {
    /// A choice of two.
    fn bit(&mut self, model: &mut Binary, value: bool) -> bool;

    /// One of 16.
    fn symbol(&mut self, model: &mut Symbols, value: usize) -> usize;

    /// Whether it has failed; the writer never does.
    fn failed(&self) -> bool {
        false
    }

    /// A number of that many bits, at most 57 (what is left of 64 behind up to seven that have been read), all equally probable.
    fn raw_long(&mut self, bits: u32, value: u64) -> u64;

    /// A number of that many bits, 32 at most, all equally probable.
    #[inline(always)]
    fn raw(&mut self, bits: u32, value: u32) -> u32 {
        self.raw_long(bits, value.into()) as u32
    }
}

/// The range of probabilities of a symbol.
#[derive(Clone, Copy, Debug)]
struct Step {
    start: u16,
    frequency: u16,
}

/// The writer.
#[derive(Clone, Debug, Default)]
pub(super) struct Writer {
    steps: Vec<Step>,
    /// Raw bits in bytes, the first one that which will be last.
    raw: Vec<u8>,
    /// Raw bits.
    bits: usize,
}

impl Writer {
    /// The payload, of so many bytes at least: two states, words, padding, raw bits from the end on.
    pub(super) fn finish(self, least: usize) -> Vec<u8> {
        let mut words: Vec<u16> = Vec::new();
        let [mut state, mut other] = [LEAST; 2];
        for (k, step) in self.steps.iter().enumerate().rev() {
            // The state of the symbol, and that of the one behind it.
            if k.wrapping_add(1) != self.steps.len() {
                core::mem::swap(&mut state, &mut other);
            }
            let frequency = u32::from(step.frequency);
            if state >> (u32::BITS - PROBABILITY_BITS) >= frequency {
                words.push(state as u16);
                state >>= WORD_BITS;
            }
            let (high, low) = (state.checked_div(frequency), state.checked_rem(frequency));
            state = (high.unwrap_or(0) << PROBABILITY_BITS)
                .wrapping_add(low.unwrap_or(0))
                .wrapping_add(u32::from(step.start));
        }
        let mut bytes = [state, other].map(u32::to_le_bytes).as_flattened().to_vec();
        bytes.extend(words.iter().rev().flat_map(|word| word.to_le_bytes()));
        bytes.resize(bytes.len().max(least.saturating_sub(self.raw.len())), 0);
        bytes.extend(self.raw.iter().rev());
        bytes
    }

    fn push(&mut self, (start, frequency): (u32, u32)) {
        self.steps.push(Step { start: start as u16, frequency: frequency as u16 });
    }
}

impl Coder for Writer {
    fn bit(&mut self, model: &mut Binary, value: bool) -> bool {
        self.push(model.range(value));
        model.update(value);
        value
    }

    fn symbol(&mut self, model: &mut Symbols, value: usize) -> usize {
        self.push(model.range(value));
        model.update(value);
        value
    }

    fn raw_long(&mut self, bits: u32, value: u64) -> u64 {
        let value = value & low_bits(bits);
        for k in 0..bits {
            if self.bits.is_multiple_of(8) {
                self.raw.push(0);
            }
            if let Some(byte) = self.raw.last_mut() {
                *byte |= ((value >> k & 1) as u8) << (self.bits % 8);
            }
            self.bits = self.bits.wrapping_add(1);
        }
        value
    }
}

#[inline(always)]
fn low_bits(bits: u32) -> u64 {
    1u64.wrapping_shl(bits).wrapping_sub(1)
}

/// Bytes of the two states.
const STATES: usize = 8;

/// The reader.
#[derive(Clone, Debug, Default)]
pub(super) struct Reader<'a> {
    /// That of the next symbol, and that of the one behind it.
    states: [u32; 2],
    payload: &'a [u8],
    /// What follows the states.
    words: &'a [[u8; 2]],
    /// Words that have been read.
    word: usize,
    /// Raw bits that have been read.
    bits: usize,
}

impl<'a> Reader<'a> {
    /// Of a payload; `None` if it is too short for the states.
    pub(super) fn new(payload: &'a [u8]) -> Option<Self> {
        let (states, rest) = payload.split_first_chunk::<STATES>()?;
        let [a, b, c, d, e, f, g, h] = *states;
        let states = [u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h])];
        Some(Self { states, payload, words: rest.as_chunks().0, word: 0, bits: 0 })
    }

    /// The first byte that has not been read, and those up to the raw bits; the last of them holds their unused bits.
    pub(super) fn left(&self) -> (usize, impl Iterator<Item = u8>) {
        let start = self.word.saturating_mul(2).saturating_add(STATES);
        let end = self.payload.len().saturating_sub(self.bits.div_ceil(8));
        let used = self.bits % 8;
        let partial = self.payload.get(end).filter(|_| used > 0).map(|byte| byte >> used);
        (start, self.payload.get(start..end).unwrap_or_default().iter().copied().chain(partial))
    }

    /// Bytes that have not been read.
    pub(super) fn count_left(&self) -> usize {
        let front = self.word.saturating_mul(2).saturating_add(STATES);
        self.payload.len().saturating_sub(self.bits.div_ceil(8)).saturating_sub(front)
    }

    /// Whether the states are those of an end.
    pub(super) fn at_end(&self) -> bool {
        !self.failed() && self.states == [LEAST; 2]
    }

    #[inline(always)]
    fn advance(&mut self, start: u32, frequency: u32) {
        let [state, next] = self.states;
        let low = state & (ONE - 1);
        // Less than 2³², since the frequency is less than 2¹⁵ and the rest of the state less than 2¹⁷.
        let mut state =
            frequency.wrapping_mul(state >> PROBABILITY_BITS).wrapping_add(low.wrapping_sub(start));
        let word = self.words.get(self.word).map_or(0, |word| u16::from_le_bytes(*word));
        let wanting = state < LEAST;
        state = if wanting { state << WORD_BITS | u32::from(word) } else { state };
        self.word = self.word.wrapping_add(usize::from(wanting));
        self.states = [next, state];
    }

    /// Eight bytes up to that many from the end, as far as there are any.
    #[cold]
    fn few(&self, from: usize) -> u64 {
        let mut all = 0;
        for k in (0..8).rev() {
            let at = self.payload.len().checked_sub(from.saturating_add(k).saturating_add(1));
            let byte = at.and_then(|at| self.payload.get(at)).copied().unwrap_or(0);
            all = all << 8 | u64::from(byte);
        }
        all
    }
}

impl Coder for Reader<'_> {
    /// Words and raw bits may meet, but not overlap.
    #[inline(always)]
    fn failed(&self) -> bool {
        let front = self.word.wrapping_mul(2).wrapping_add(STATES);
        front.wrapping_add(self.bits.div_ceil(8)) > self.payload.len()
    }

    #[inline(always)]
    fn bit(&mut self, model: &mut Binary, _: bool) -> bool {
        let [state, _] = self.states;
        let value = model.find(state & (ONE - 1));
        let (start, frequency) = model.range(value);
        self.advance(start, frequency);
        model.update(value);
        value
    }

    #[inline(always)]
    fn symbol(&mut self, model: &mut Symbols, _: usize) -> usize {
        let [state, _] = self.states;
        let value = model.find(state & (ONE - 1));
        let (start, frequency) = model.range(value);
        self.advance(start, frequency);
        model.update(value);
        value
    }

    #[inline(always)]
    fn raw_long(&mut self, bits: u32, _: u64) -> u64 {
        let from = self.bits / 8;
        let start = self.payload.len().wrapping_sub(from).wrapping_sub(8);
        let eight = self.payload.get(start..).and_then(|rest| rest.first_chunk());
        let eight = eight.map_or_else(|| self.few(from), |eight| u64::from_be_bytes(*eight));
        let value = eight >> (self.bits % 8) & low_bits(bits);
        self.bits = self.bits.wrapping_add(bits as usize);
        value
    }
}
