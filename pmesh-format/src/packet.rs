//! A packet: a window on the payload of one record, as arrays.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use core::ops::Range;

use ivg_wire::{ByteOffset, Code, Error, Part};

use crate::code::codes;
use crate::header::{Header, PacketEntry};
use crate::wire::PacketLayout;

/// A packet whose checksum fits. Its arrays lie in the caller's bytes, little-endian, ready to be copied into the buffers of
/// a graphics processor. Whether what they say is valid is found out by [`Replay::apply`](crate::Replay::apply).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Packet<'a> {
    header: &'a Header,
    entry: &'a PacketEntry,
    index: u32,
    payload: &'a [u8],
    offset: ByteOffset,
}

impl<'a> Packet<'a> {
    pub(crate) fn new(
        header: &'a Header,
        entry: &'a PacketEntry,
        index: u32,
        payload: &'a [u8],
        offset: ByteOffset,
    ) -> Self {
        Self { header, entry, index, payload, offset }
    }

    /// The header of the file that it belongs to.
    #[must_use]
    pub const fn header(&self) -> &'a Header {
        self.header
    }

    /// Which packet it is, counted from 0.
    #[must_use]
    pub const fn index(&self) -> u32 {
        self.index
    }

    /// What the directory says of it.
    #[must_use]
    pub const fn entry(&self) -> &'a PacketEntry {
        self.entry
    }

    /// The whole payload.
    #[must_use]
    pub const fn payload(&self) -> &'a [u8] {
        self.payload
    }

    /// Positions of its vertices relative to the origin, three binary32 numbers each \[m\].
    #[must_use]
    pub fn position_bytes(&self) -> &'a [u8] {
        self.part(|layout| layout.positions)
    }

    /// Normals of its wedges, three binary32 numbers each; empty if the file has none.
    #[must_use]
    pub fn normal_bytes(&self) -> &'a [u8] {
        self.part(|layout| layout.normals)
    }

    /// Texture coordinates of its wedges, two binary32 numbers each; empty if the file has none.
    #[must_use]
    pub fn uv_bytes(&self) -> &'a [u8] {
        self.part(|layout| layout.uvs)
    }

    /// Colours of its wedges, four bytes each; empty if the file has none.
    #[must_use]
    pub fn colour_bytes(&self) -> &'a [u8] {
        self.part(|layout| layout.colours)
    }

    /// Corners of its faces as mapped where each is introduced, three u32 wedge indices each.
    #[must_use]
    pub fn corner_bytes(&self) -> &'a [u8] {
        self.part(|layout| layout.corners)
    }

    /// Parents of its vertices from the base on, one u32 each.
    #[must_use]
    pub fn parent_bytes(&self) -> &'a [u8] {
        self.part(|layout| layout.parents)
    }

    /// Materials of its faces, one u16 each; empty if the file has none.
    #[must_use]
    pub fn material_bytes(&self) -> &'a [u8] {
        self.part(|layout| layout.materials)
    }

    /// Where the arrays lie in the payload; the directory was checked for that.
    pub(crate) fn layout(&self) -> Option<PacketLayout> {
        self.header.layout(self.entry)
    }

    fn part(&self, which: impl FnOnce(PacketLayout) -> Range<usize>) -> &'a [u8] {
        self.layout().and_then(|layout| self.payload.get(which(layout))).unwrap_or(&[])
    }

    /// The error `code` at byte `at` of the payload.
    #[cold]
    pub(crate) fn error(&self, code: Code, at: usize) -> Error {
        Error::new(code, ByteOffset(self.offset.0.saturating_add(at as u64)), Part::Record(self.index))
    }
}

/// Reads numbers of variable length: seven bits a byte, the lowest first, bit 7 set where more follow (PMESH-PKT-04).
#[derive(Clone, Debug)]
pub(crate) struct Varints<'a> {
    bytes: &'a [u8],
    /// Where the next number begins.
    pub(crate) at: usize,
}

impl<'a> Varints<'a> {
    /// Of the payload of a packet, from byte `at` on.
    pub(crate) fn new(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    /// The next number.
    ///
    /// # Errors
    /// The payload ends, the number is not in its shortest form, or it does not fit in 32 bits.
    pub(crate) fn read(&mut self) -> Result<u32, Code> {
        let mut value = 0u32;
        for shift in (0..35).step_by(7) {
            let Some(&byte) = self.bytes.get(self.at) else { return Err(codes::SWITCH_LENGTH) };
            self.at = self.at.saturating_add(1);
            let bits = u32::from(byte & 0x7F);
            if (shift == 28 && bits > 0xF) || (shift > 0 && byte == 0) {
                return Err(codes::VARINT);
            }
            value |= bits << shift;
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err(codes::VARINT)
    }
}

/// Appends a number of variable length.
pub(crate) fn write_varint(out: &mut alloc::vec::Vec<u8>, mut value: u32) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

/// A sequence of bits, the first in bit 0 of byte 0.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bits {
    bytes: alloc::vec::Vec<u8>,
    len: u64,
}

impl Bits {
    /// How many bits there are.
    pub(crate) fn len(&self) -> u64 {
        self.len
    }

    /// Appends the lowest `count` bits of `value`.
    pub(crate) fn push(&mut self, value: u32, count: u32) {
        for bit in 0..count {
            let (byte, place) = split(self.len);
            if place == 0 {
                self.bytes.push(0);
            }
            if let Some(byte) = self.bytes.get_mut(byte) {
                *byte |= ((value >> bit & 1) as u8) << place;
            }
            self.len = self.len.saturating_add(1);
        }
    }

    /// Drops all bits from `len` on.
    pub(crate) fn truncate(&mut self, len: u64) {
        self.len = len.min(self.len);
        let (bytes, place) = split(self.len);
        self.bytes.truncate(bytes.saturating_add(usize::from(place > 0)));
        if let (Some(last), true) = (self.bytes.last_mut(), place > 0) {
            *last &= (1u8 << place).wrapping_sub(1);
        }
    }

    /// The `count` bits from `at` on; `None` if they are not all there.
    pub(crate) fn get(&self, at: u64, count: u32) -> Option<u32> {
        if at.checked_add(u64::from(count))? > self.len {
            return None;
        }
        read_bits(&self.bytes, at, count)
    }

    /// The bytes; unused bits of the last are zero.
    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

/// The `count` bits of `bytes` from bit `at` on; `None` if they are not all there.
pub(crate) fn read_bits(bytes: &[u8], at: u64, count: u32) -> Option<u32> {
    let mut value = 0;
    for bit in 0..count {
        let (byte, place) = split(at.checked_add(u64::from(bit))?);
        value |= u32::from(bytes.get(byte)? >> place & 1) << bit;
    }
    Some(value)
}

/// The byte in which a bit lies, and its place there.
fn split(bit: u64) -> (usize, u32) {
    (usize::try_from(bit >> 3).unwrap_or(usize::MAX), (bit & 7) as u32)
}

/// Bits of a switch code for a vertex with that many wedges: enough for 0 to `wedges` (PMESH-SWI-02).
pub(crate) fn code_bits(wedges: u32) -> u32 {
    u32::BITS.saturating_sub(wedges.leading_zeros())
}
