//! Ascending numbers in the form of Elias and Fano (PMESH-SWI-05): low bits packed, high bits as the places of ones.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use alloc::vec::Vec;

use crate::bits::{Packer, bytes_of, is_padded, number, word};

/// How many numbers are stored, below which limit, and in how many bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shape {
    /// How many numbers.
    pub(crate) count: u32,
    /// What none of them reaches; the count if there are any, or more.
    pub(crate) limit: u32,
    /// Low bits of each.
    pub(crate) low: u32,
    /// Bits in which the ones stand.
    pub(crate) high_bits: u64,
}

impl Shape {
    /// The shortest for that many numbers below `limit`.
    pub(crate) fn new(count: u32, limit: u32) -> Self {
        let high =
            |low: u32| u64::from(count).saturating_add(u64::from(limit.saturating_sub(1).unbounded_shr(low)));
        let all = |low: u32| u64::from(count).saturating_mul(low.into()).saturating_add(high(low));
        // Each bit more saves less than the one before: the first that saves nothing ends it.
        let low = if count == 0 {
            0
        } else {
            (0..u32::BITS).find(|&low| all(low.saturating_add(1)) >= all(low)).unwrap_or(0)
        };
        Self { count, limit, low, high_bits: if count == 0 { 0 } else { high(low) } }
    }

    /// Bits of all low parts.
    pub(crate) fn low_bits(self) -> u64 {
        u64::from(self.count).saturating_mul(self.low.into())
    }

    /// Bytes of the low parts.
    pub(crate) fn low_bytes(self) -> usize {
        bytes_of(self.low_bits())
    }

    /// Bytes of low and high parts.
    pub(crate) fn bytes(self) -> usize {
        self.low_bytes().saturating_add(bytes_of(self.high_bits))
    }

    /// Both parts of `numbers`, which ascend.
    pub(crate) fn write(self, numbers: &[u32]) -> Vec<u8> {
        let mut low = Packer::default();
        for &number in numbers {
            low.push(number & 1u32.unbounded_shl(self.low).wrapping_sub(1), self.low);
        }
        let mut bytes = low.finish();
        let start = bytes.len();
        bytes.resize(self.bytes(), 0);
        for (number, nth) in numbers.iter().zip(0u64..) {
            let at = u64::from(number.unbounded_shr(self.low)).saturating_add(nth);
            let place = usize::try_from(at >> 3).unwrap_or(usize::MAX);
            if let Some(byte) = bytes.get_mut(start.saturating_add(place)) {
                *byte |= 1 << (at & 7);
            }
        }
        bytes
    }
}

/// Reads the numbers in blocks. Whether they ascend is not looked at.
#[derive(Clone, Debug)]
pub(crate) struct Reader<'a> {
    shape: Shape,
    low: &'a [u8],
    high: &'a [u8],
    /// Ones of the present word that are left; where the next word begins; the place of the word's first bit less the numbers read.
    ones: u64,
    next: usize,
    base: u32,
    read: u32,
}

impl<'a> Reader<'a> {
    /// Of bytes as many as the shape has.
    pub(crate) fn new(shape: Shape, bytes: &'a [u8]) -> Self {
        let (low, high) = bytes.split_at_checked(shape.low_bytes()).unwrap_or((&[], &[]));
        Self { shape, low, high, ones: word(high, 0), next: 8, base: 0, read: 0 }
    }

    /// How many numbers are left.
    pub(crate) fn left(&self) -> usize {
        self.shape.count.saturating_sub(self.read) as usize
    }

    /// Reads as many numbers as `to` has; false if there are not so many ones.
    #[inline(always)]
    pub(crate) fn fill(&mut self, to: &mut [u32]) -> bool {
        let (mut ones, mut base) = (self.ones, self.base);
        for number in to.iter_mut() {
            while ones == 0 {
                if self.next >= self.high.len() {
                    return false;
                }
                ones = word(self.high, self.next);
                self.next = self.next.saturating_add(8);
                base = base.wrapping_add(64);
            }
            *number = base.wrapping_add(ones.trailing_zeros());
            base = base.wrapping_sub(1);
            ones &= ones.wrapping_sub(1);
        }
        (self.ones, self.base) = (ones, base);
        self.add_low(to);
        self.read = self.read.saturating_add(to.len() as u32);
        true
    }

    /// Puts the low bits to the high ones.
    #[inline(always)]
    fn add_low(&self, to: &mut [u32]) {
        let width = self.shape.low;
        if width == 0 {
            return;
        }
        let mut at = u64::from(self.read).saturating_mul(width.into());
        let mask = 1u64.unbounded_shl(width).wrapping_sub(1);
        let (fours, rest) = to.as_chunks_mut::<4>();
        // Four at once fit in a word, wherever in a byte they begin.
        if width <= 14 {
            for four in fours {
                let mut window = word(self.low, (at >> 3) as usize) >> (at & 7);
                for to in four {
                    *to = to.wrapping_shl(width) | (window & mask) as u32;
                    window >>= width;
                }
                at = at.wrapping_add(u64::from(width) << 2);
            }
        } else {
            for to in fours.as_flattened_mut() {
                *to = to.wrapping_shl(width) | number(self.low, at, width);
                at = at.wrapping_add(width.into());
            }
        }
        for to in rest {
            *to = to.wrapping_shl(width) | number(self.low, at, width);
            at = at.wrapping_add(width.into());
        }
    }

    /// Whether all numbers have been read and everything behind them is 0.
    pub(crate) fn is_clean(&self) -> bool {
        self.left() == 0
            && self.ones == 0
            && self.high.get(self.next..).unwrap_or(&[]).iter().all(|&byte| byte == 0)
            && is_padded(self.low, self.shape.low_bits())
    }
}

/// How many of the first `bits` bits are 1.
pub(crate) fn ones(bytes: &[u8], bits: u64) -> u64 {
    let whole = (bits >> 3) as usize;
    let count = |bytes: &[u8]| bytes.iter().map(|byte| u64::from(byte.count_ones())).sum::<u64>();
    let last = bytes
        .get(whole)
        .map_or(0, |&last| u32::from(last) & 1u32.unbounded_shl((bits & 7) as u32).wrapping_sub(1));
    count(bytes.get(..whole).unwrap_or(bytes)).saturating_add(last.count_ones().into())
}

#[cfg(test)]
mod tests;
