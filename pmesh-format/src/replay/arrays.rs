//! Appending the arrays of a packet: copied where they lie as they are needed, checked many at once.

use alloc::vec::Vec;

use zerocopy::little_endian::{F32, U16, U32};
use zerocopy::{FromBytes, Immutable, KnownLayout};

use crate::room::reserve;

/// An element of an array, and how packets store it.
pub(super) trait Element: Copy + FromBytes + Immutable + KnownLayout {
    /// The same in little-endian bytes, wherever they lie.
    type Stored: Copy + FromBytes + Immutable + KnownLayout;

    fn read(stored: Self::Stored) -> Self;
}

impl<const N: usize> Element for [f32; N] {
    type Stored = [F32; N];

    fn read(stored: [F32; N]) -> Self {
        stored.map(F32::get)
    }
}

impl Element for [u32; 3] {
    type Stored = [U32; 3];

    fn read(stored: [U32; 3]) -> Self {
        stored.map(U32::get)
    }
}

impl Element for [u8; 4] {
    type Stored = [u8; 4];

    fn read(stored: [u8; 4]) -> Self {
        stored
    }
}

impl Element for u16 {
    type Stored = U16;

    fn read(stored: U16) -> Self {
        stored.get()
    }
}

/// Appends the elements in `bytes`, whose number the directory was checked for, to an array that has `total` in the end.
pub(super) fn append<T: Element>(to: &mut Vec<T>, bytes: &[u8], total: usize) {
    match <[T]>::ref_from_bytes(bytes) {
        Ok(elements) if cfg!(target_endian = "little") => {
            reserve(to, elements.len(), total);
            to.extend_from_slice(elements);
        }
        _ => {
            let stored = elements::<T::Stored>(bytes);
            reserve(to, stored.len(), total);
            to.extend(stored.iter().map(|&element| T::read(element)));
        }
    }
}

/// The elements of an array of the payload.
pub(super) fn elements<T: FromBytes + Immutable + KnownLayout>(bytes: &[u8]) -> &[T] {
    <[T]>::ref_from_bytes(bytes).unwrap_or(&[])
}

/// Checks every element; the index of the first that is not good. Without branches for each: they are good.
pub(super) fn check<T>(elements: &[T], good: impl Fn(&T) -> bool) -> Result<(), usize> {
    match elements.iter().fold(true, |all, element| all & good(element)) {
        true => Ok(()),
        false => Err(elements.iter().position(|element| !good(element)).unwrap_or(0)),
    }
}

/// Whether all positions lie in the box, which is finite: four at a time, so that they fill the registers of a processor.
pub(super) fn inside(positions: &[[f32; 3]], [low, high]: [[f32; 3]; 2]) -> bool {
    let low: [f32; 12] = core::array::from_fn(|k| low[k % 3]);
    let high: [f32; 12] = core::array::from_fn(|k| high[k % 3]);
    let (blocks, rest) = positions.as_flattened().as_chunks::<12>();
    let mut good = [u32::MAX; 12];
    for block in blocks {
        for k in 0..12 {
            good[k] &= if (low[k] <= block[k]) & (block[k] <= high[k]) { u32::MAX } else { 0 };
        }
    }
    let rest = rest.iter().enumerate().all(|(k, x)| (low[k]..=high[k]).contains(x));
    rest & good.iter().all(|&good| good == u32::MAX)
}

#[cfg(test)]
mod tests;
