//! A packet: a window on the payload of one record, as arrays.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use core::ops::Range;

use ivg_wire::{ByteOffset, Code, Error, Part};

use crate::code::codes;
use crate::header::{Header, PacketEntry};
use crate::storage::Mode;
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

    /// Positions of its vertices: three binary32 numbers each, relative to the origin \[m\]; quantised, four u16 each, the
    /// last 0 (PMESH-POS-03).
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

    /// Corners of its faces as mapped at the end of the packet, three u32 wedge indices each.
    #[must_use]
    pub fn corner_bytes(&self) -> &'a [u8] {
        self.part(|layout| layout.corners)
    }

    /// Parents of its vertices from the base on, packed (PMESH-COL-01).
    #[must_use]
    pub fn parent_bytes(&self) -> &'a [u8] {
        self.part(|layout| layout.parents)
    }

    /// Materials of its faces, one u16 each; empty if the file has none.
    #[must_use]
    pub fn material_bytes(&self) -> &'a [u8] {
        self.part(|layout| layout.materials)
    }

    /// Where the arrays of a raw packet lie in the payload; the directory was checked for that.
    fn layout(&self) -> Option<PacketLayout> {
        (self.header.mode == Mode::Raw).then(|| self.header.layout(self.entry)).flatten()
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
            let Some(&byte) = self.bytes.get(self.at) else { return Err(codes::PACKET_LENGTH) };
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

/// How many corners of earlier faces a raw packet switches (PMESH-SWI-05): the first number of its payload.
pub(crate) fn switch_count(payload: &[u8]) -> u32 {
    payload.first_chunk().map_or(0, |bytes| u32::from_le_bytes(*bytes))
}
