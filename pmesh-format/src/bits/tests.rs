use std::vec::Vec;

use quickcheck::quickcheck;

use super::*;

/// The bits one by one.
fn bit(bytes: &[u8], at: usize) -> u32 {
    bytes.get(at / 8).map_or(0, |byte| u32::from(byte >> (at % 8) & 1))
}

quickcheck! {
    /// Bits pushed in pieces of any size, cut, and continued are those that were given, one after the other.
    fn bits_are_those_given(first: Vec<u8>, pieces: Vec<(u32, u8)>, cut: u16, more: Vec<u8>) -> bool {
        let mut bits = Bits::default();
        let mut expected: Vec<u32> = Vec::new();
        bits.append(&first);
        expected.extend((0..8 * first.len()).map(|at| bit(&first, at)));
        for (value, count) in pieces {
            let count = u32::from(count) % 33;
            let value = u64::from(value) & ((1 << count) - 1);
            bits.push(value, count);
            expected.extend((0..count).map(|k| (value >> k & 1) as u32));
        }
        let cut = usize::from(cut) % (expected.len() + 1);
        bits.truncate(cut as u64);
        expected.truncate(cut);
        bits.append(&more);
        expected.extend((0..8 * more.len()).map(|at| bit(&more, at)));
        let bytes = bits.to_bytes();
        let padding = 8 * bytes.len() - expected.len();
        bits.len() == expected.len() as u64
            && padding < 8
            && (0..8 * bytes.len()).all(|at| bit(&bytes, at) == expected.get(at).copied().unwrap_or(0))
            && (0..expected.len() + 70).all(|at| {
                let count = (at % 33) as u32;
                let window = (0..count as usize).map(|k| expected.get(at + k).copied().unwrap_or(0) << k).sum::<u32>();
                bits.get(at as u64, count) == window
            })
    }
}
