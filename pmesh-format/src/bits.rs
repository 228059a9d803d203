//! Packed numbers, as raw packets store them (PMESH-PKT-02): one after the other, least significant bit first.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use alloc::vec::Vec;

/// Bits of a number below `count`: ⌈log₂ count⌉.
#[inline(always)]
pub(crate) const fn width(count: u32) -> u32 {
    u32::BITS.saturating_sub(count.saturating_sub(1).leading_zeros())
}

/// Bytes of that many bits.
pub(crate) fn bytes_of(bits: u64) -> usize {
    usize::try_from(bits.div_ceil(8)).unwrap_or(usize::MAX)
}

/// The eight bytes from byte `at` on; 0 for those that are not there.
#[inline(always)]
pub(crate) fn word(bytes: &[u8], at: usize) -> u64 {
    match bytes.get(at..).and_then(|rest| rest.first_chunk()) {
        Some(word) => u64::from_le_bytes(*word),
        None => last_word(bytes, at),
    }
}

#[cold]
#[inline(never)]
fn last_word(bytes: &[u8], at: usize) -> u64 {
    let mut word = [0; 8];
    word.iter_mut().zip(bytes.get(at..).unwrap_or(&[])).for_each(|(to, from)| *to = *from);
    u64::from_le_bytes(word)
}

/// The number of `width` bits, at most 32, that begins at bit `at`; 0 for bits that are not there.
#[inline(always)]
pub(crate) fn number(bytes: &[u8], at: u64, width: u32) -> u32 {
    let window = word(bytes, (at >> 3) as usize) >> (at & 7);
    (window & 1u64.unbounded_shl(width).wrapping_sub(1)) as u32
}

/// Numbers of `width` bits each, from bit 0 on.
pub(crate) fn numbers(bytes: &[u8], width: u32) -> impl Iterator<Item = u32> + '_ {
    let mut at = 0u64;
    core::iter::repeat_with(move || {
        let number = number(bytes, at, width);
        at = at.saturating_add(width.into());
        number
    })
}

/// Whether the bits of the last byte that a part of `bits` bits does not use are 0.
pub(crate) fn is_padded(part: &[u8], bits: u64) -> bool {
    match (part.last(), (bits & 7) as u32) {
        (Some(&last), used @ 1..) => u32::from(last) >> used == 0,
        _ => true,
    }
}

/// Writes packed numbers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Packer {
    bytes: Vec<u8>,
    /// Bits that do not fill a byte yet, and how many.
    word: u64,
    count: u32,
}

impl Packer {
    /// Appends the lowest `width` bits of `number`, whose others are 0; at most 32.
    pub(crate) fn push(&mut self, number: u32, width: u32) {
        self.word |= u64::from(number) << self.count;
        self.count = self.count.saturating_add(width);
        while self.count >= u8::BITS {
            self.bytes.push(self.word as u8);
            self.word >>= u8::BITS;
            self.count = self.count.saturating_sub(u8::BITS);
        }
    }

    /// The bytes; unused bits of the last are 0.
    pub(crate) fn finish(mut self) -> Vec<u8> {
        if self.count > 0 {
            self.bytes.push(self.word as u8);
        }
        self.bytes
    }
}

#[cfg(test)]
mod tests;
