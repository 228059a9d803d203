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
pub(super) trait Coder {
    /// A choice of two.
    fn bit(&mut self, model: &mut Binary, value: bool) -> bool;

    /// One of 16.
    fn symbol(&mut self, model: &mut Symbols, value: usize) -> usize;

    /// Whether it has failed; the writer never does.
    fn failed(&self) -> bool {
        false
    }

    /// A number of that many bits, 16 at most, all equally probable.
    fn raw(&mut self, bits: u32, value: u32) -> u32;
}

/// What a writer has noted: a range of probabilities, or with frequency 0 that many raw bits.
#[derive(Clone, Copy, Debug)]
struct Step {
    start: u16,
    frequency: u16,
    bits: u8,
}

/// The writer.
#[derive(Clone, Debug, Default)]
pub(super) struct Writer {
    steps: Vec<Step>,
}

impl Writer {
    /// The payload: the state as u32, then words.
    pub(super) fn finish(self) -> Vec<u8> {
        let mut words: Vec<u16> = Vec::new();
        let mut state = LEAST;
        for step in self.steps.iter().rev() {
            let frequency = u32::from(step.frequency);
            if frequency == 0 {
                let bits = u32::from(step.bits);
                if state.unbounded_shr(u32::BITS.saturating_sub(bits)) != 0 {
                    words.push(state as u16);
                    state >>= WORD_BITS;
                }
                state = state << bits | u32::from(step.start);
            } else {
                if state >> (u32::BITS - PROBABILITY_BITS) >= frequency {
                    words.push(state as u16);
                    state >>= WORD_BITS;
                }
                let (high, low) = (state.checked_div(frequency), state.checked_rem(frequency));
                state = (high.unwrap_or(0) << PROBABILITY_BITS)
                    .wrapping_add(low.unwrap_or(0))
                    .wrapping_add(u32::from(step.start));
            }
        }
        let mut bytes = state.to_le_bytes().to_vec();
        bytes.extend(words.iter().rev().flat_map(|word| word.to_le_bytes()));
        bytes
    }
}

impl Coder for Writer {
    fn bit(&mut self, model: &mut Binary, value: bool) -> bool {
        let (start, frequency) = model.range(value);
        self.steps.push(Step { start: start as u16, frequency: frequency as u16, bits: 0 });
        model.update(value);
        value
    }

    fn symbol(&mut self, model: &mut Symbols, value: usize) -> usize {
        let (start, frequency) = model.range(value);
        self.steps.push(Step { start: start as u16, frequency: frequency as u16, bits: 0 });
        model.update(value);
        value
    }

    fn raw(&mut self, bits: u32, value: u32) -> u32 {
        self.steps.push(Step { start: value as u16, frequency: 0, bits: bits as u8 });
        value
    }
}

/// The reader.
#[derive(Clone, Debug)]
pub(super) struct Reader<'a> {
    state: u32,
    words: &'a [[u8; 2]],
    /// Bytes of the payload that are no whole word behind the others.
    rest: &'a [u8],
    /// Words that were wanted beyond the last.
    missing: u32,
}

impl<'a> Reader<'a> {
    /// Of a payload; `None` if it is too short for a state.
    pub(super) fn new(payload: &'a [u8]) -> Option<Self> {
        let (state, rest) = payload.split_first_chunk()?;
        let (words, rest) = rest.as_chunks();
        Some(Self { state: u32::from_le_bytes(*state), words, rest, missing: 0 })
    }

    /// Bytes that have not been read.
    pub(super) fn left(&self) -> impl Iterator<Item = u8> {
        self.words.as_flattened().iter().chain(self.rest).copied()
    }

    /// Whether the state is that of an end.
    pub(super) fn at_end(&self) -> bool {
        self.missing == 0 && self.state == LEAST
    }

    #[inline(always)]
    fn refill(&mut self) {
        if self.state < LEAST {
            let word = match self.words.split_first() {
                Some((word, words)) => {
                    self.words = words;
                    u16::from_le_bytes(*word)
                }
                None => {
                    self.missing = self.missing.saturating_add(1);
                    0
                }
            };
            self.state = self.state << WORD_BITS | u32::from(word);
        }
    }

    #[inline(always)]
    fn advance(&mut self, start: u32, frequency: u32) {
        let low = self.state & (ONE - 1);
        // Less than 2³², since the frequency is less than 2¹⁵ and the rest of the state less than 2¹⁷.
        self.state =
            frequency.wrapping_mul(self.state >> PROBABILITY_BITS).wrapping_add(low.wrapping_sub(start));
        self.refill();
    }
}

impl Coder for Reader<'_> {
    #[inline(always)]
    fn failed(&self) -> bool {
        self.missing > 0
    }

    #[inline(always)]
    fn bit(&mut self, model: &mut Binary, _: bool) -> bool {
        let value = model.find(self.state & (ONE - 1));
        let (start, frequency) = model.range(value);
        self.advance(start, frequency);
        model.update(value);
        value
    }

    #[inline(always)]
    fn symbol(&mut self, model: &mut Symbols, _: usize) -> usize {
        let value = model.find(self.state & (ONE - 1));
        let (start, frequency) = model.range(value);
        self.advance(start, frequency);
        model.update(value);
        value
    }

    #[inline(always)]
    fn raw(&mut self, bits: u32, _: u32) -> u32 {
        let value = self.state & (1u32.unbounded_shl(bits)).wrapping_sub(1);
        self.state = self.state.unbounded_shr(bits);
        self.refill();
        value
    }
}
