//! A sequence of bits, as switch codes are stored.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use alloc::vec::Vec;

use crate::room::reserve;

/// A sequence of bits, the first in bit 0 of byte 0.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bits {
    /// What lies behind the last bit is 0; there is a word more than the bits need, so that any window lies in two.
    words: Vec<u64>,
    len: u64,
}

impl Bits {
    /// How many bits there are.
    pub(crate) fn len(&self) -> u64 {
        self.len
    }

    /// Appends the lowest `count` bits of `value`, whose others are 0; at most 64.
    pub(crate) fn push(&mut self, value: u64, count: u32) {
        let (word, place) = split(self.len);
        let end = self.len.saturating_add(u64::from(count));
        self.resize(end);
        if let Some([low, high]) = self.words.get_mut(word..).and_then(|words| words.first_chunk_mut()) {
            *low |= value << place;
            *high |= value.unbounded_shr(u64::BITS.saturating_sub(place));
        }
    }

    /// Appends all bits of `bytes`.
    pub(crate) fn append(&mut self, bytes: &[u8]) {
        reserve(&mut self.words, bytes.len().div_ceil(8).saturating_add(2), usize::MAX);
        let mut whole = bytes.chunks_exact(8);
        for word in whole.by_ref() {
            self.push(word.try_into().map_or(0, u64::from_le_bytes), u64::BITS);
        }
        for &byte in whole.remainder() {
            self.push(byte.into(), u8::BITS);
        }
    }

    /// Drops all bits from `len` on.
    pub(crate) fn truncate(&mut self, len: u64) {
        self.resize(len.min(self.len));
        let (word, place) = split(self.len);
        if let Some([low, high]) = self.words.get_mut(word..).and_then(|words| words.first_chunk_mut()) {
            *low &= (1u64 << place).wrapping_sub(1);
            *high = 0;
        }
    }

    /// The `count` bits from `at` on, at most 32; 0 for those that are not there.
    #[inline]
    pub(crate) fn get(&self, at: u64, count: u32) -> u32 {
        let (word, place) = split(at);
        let Some([low, high]) = self.words.get(word..).and_then(|words| words.first_chunk()) else {
            return 0;
        };
        // In two steps, since no shift goes by 64.
        let window = low >> place | (high << 1) << (63u32.saturating_sub(place));
        window as u32 & 1u32.unbounded_shl(count).wrapping_sub(1)
    }

    /// The bytes; unused bits of the last are zero.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let mut bytes: Vec<u8> = self.words.iter().flat_map(|word| word.to_le_bytes()).collect();
        bytes.truncate(usize::try_from(self.len.div_ceil(8)).unwrap_or(usize::MAX));
        bytes
    }

    /// Sets the length; new bits are 0.
    fn resize(&mut self, len: u64) {
        self.len = len;
        let words = split(len).0.saturating_add(2);
        if words > self.words.capacity() {
            reserve(&mut self.words, 2, usize::MAX);
        }
        self.words.resize(words, 0);
    }
}

/// The word in which a bit lies, and its place there.
fn split(bit: u64) -> (usize, u32) {
    (usize::try_from(bit >> 6).unwrap_or(usize::MAX), (bit & 63) as u32)
}

#[cfg(test)]
mod tests;
