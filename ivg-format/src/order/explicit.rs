//! The order `explicit`: each bundle begins with the list of its vertices (`spec/ivg.md`, "Order").
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use crate::code::codes;
use crate::header::RecordId;
use crate::lattice::Lattice;
use alloc::vec::Vec;
use ivg_wire::{ByteOffset, Error, Part};

/// The most bytes that the index of a vertex takes: 48 bits of a linear index, 7 a byte (IVG-EXP-02).
pub(crate) const INDEX_BYTES: u64 = 7;

/// The list of vertices of a bundle: the first index, then the gap to each next one less 1, as numbers of variable
/// length (IVG-EXP-01).
#[derive(Clone, Debug)]
pub(crate) struct Listed<'a> {
    bytes: &'a [u8],
    /// The smallest index that the next vertex can have.
    least: u64,
    left: usize,
}

impl<'a> Listed<'a> {
    /// The vertices of a list that [`check`] has accepted.
    pub(crate) const fn new(bytes: &'a [u8], vertices: usize) -> Self {
        Self { bytes, least: 0, left: vertices }
    }

    pub(crate) fn next(&mut self) -> Option<u64> {
        self.left = self.left.checked_sub(1)?;
        let (number, rest) = number(self.bytes)?;
        let vertex = self.least.saturating_add(number);
        (self.bytes, self.least) = (rest, vertex.saturating_add(1));
        Some(vertex)
    }

    pub(crate) const fn left(&self) -> usize {
        self.left
    }
}

/// The number that begins `bytes`, and what follows; `None` if it is not in its shortest form, has more than
/// [`INDEX_BYTES`], or does not end (IVG-EXP-02).
fn number(bytes: &[u8]) -> Option<(u64, &[u8])> {
    let mut value = 0u64;
    for (at, &byte) in (0u32..).zip(bytes.iter().take(INDEX_BYTES as usize)) {
        value |= u64::from(byte & 0x7F).checked_shl(at.saturating_mul(7))?;
        if byte < 0x80 {
            let shortest = byte != 0 || at == 0;
            return shortest
                .then(|| (value, bytes.get(at as usize..).and_then(|rest| rest.get(1..)).unwrap_or(&[])));
        }
    }
    None
}

/// Checks the list of vertices of bundle `k`, which begins at `offset` (IVG-EXP-03).
pub(crate) fn check(
    lattice: &Lattice,
    k: u32,
    bytes: &[u8],
    vertices: usize,
    offset: ByteOffset,
) -> Result<(), Error> {
    let part = Part::Record(RecordId::Bundle(k).stored());
    let fail = |code, rest: &[u8]| {
        let at = bytes.len().saturating_sub(rest.len()) as u64;
        Err(Error::new(code, ByteOffset(offset.0.saturating_add(at)), part))
    };
    let count = lattice.vertex_count();
    let (mut rest, mut least) = (bytes, 0u64);
    for _ in 0..vertices {
        let Some((gap, after)) = number(rest) else {
            return fail(codes::INDEX_NUMBER, rest);
        };
        let vertex = least.saturating_add(gap);
        if vertex >= count || lattice.is_corner(vertex) {
            return fail(codes::INDEX_VERTEX, rest);
        }
        (rest, least) = (after, vertex.saturating_add(1));
    }
    if rest.is_empty() { Ok(()) } else { fail(codes::INDEX_LENGTH, rest) }
}

/// Appends the list of these vertices, which ascend.
pub(crate) fn write_list(out: &mut Vec<u8>, vertices: impl Iterator<Item = u64>) {
    let mut least = 0u64;
    for vertex in vertices {
        let mut gap = vertex.saturating_sub(least);
        least = vertex.saturating_add(1);
        while gap >= 0x80 {
            out.push((gap & 0x7F) as u8 | 0x80);
            gap >>= 7;
        }
        out.push(gap as u8);
    }
}

/// Bytes of the list of these vertices, which ascend.
pub(crate) fn list_len(vertices: impl Iterator<Item = u64>) -> u64 {
    let mut least = 0u64;
    vertices.fold(0u64, |bytes, vertex| {
        let gap = vertex.saturating_sub(least);
        least = vertex.saturating_add(1);
        let bits = u64::BITS.saturating_sub(gap.leading_zeros()).max(1);
        bytes.saturating_add(u64::from(bits.div_ceil(7)))
    })
}

#[cfg(test)]
mod tests;
