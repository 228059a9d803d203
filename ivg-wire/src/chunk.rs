//! Chunks: small metadata between header and records (`spec/common.md`, "Chunks").
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use crate::code::codes;
use crate::crc::{ContentId, compare};
use crate::error::{ByteOffset, Error, Part};
use crate::limits::{Limits, Maximum};
use crate::step::Step;
use alloc::vec::Vec;
use core::fmt;
use core::mem::offset_of;
use zerocopy::little_endian::U64;
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

/// Bytes of a chunk besides payload and padding: 16 before, 4 after.
pub const CHUNK_OVERHEAD: u64 = 20;

/// Bit 0 of the flags: a reader that does not know the type must refuse the file.
const CRITICAL: u8 = 1;

/// The four bytes that name a chunk's type.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ChunkKind(pub [u8; 4]);

impl fmt::Display for ChunkKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0.escape_ascii())
    }
}

impl fmt::Debug for ChunkKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ChunkKind({self})")
    }
}

/// The bytes before a chunk's payload.
#[derive(Clone, Copy, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
struct Wire {
    kind: [u8; 4],
    flags: u8,
    reserved: [u8; 3],
    length: U64,
}

const HEADER_BYTES: usize = size_of::<Wire>();
const _: () = assert!(HEADER_BYTES == 16);

/// A chunk whose checksum fits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chunk<'a> {
    /// The type.
    pub kind: ChunkKind,
    /// Whether a reader that does not know the type must refuse the file.
    pub critical: bool,
    /// Where the chunk begins in the file.
    pub offset: ByteOffset,
    /// The payload, without padding.
    pub payload: &'a [u8],
}

impl Chunk<'_> {
    /// Where the payload begins in the file.
    #[must_use]
    pub const fn payload_offset(&self) -> ByteOffset {
        ByteOffset(self.offset.0.saturating_add(HEADER_BYTES as u64))
    }

    /// For a reader that does not know the type: ancillary chunks are skipped, critical ones are refused
    /// (COM-CHK-06).
    ///
    /// # Errors
    ///
    /// Unsupported if the chunk is critical.
    pub const fn skip_unknown(&self) -> Result<(), Error> {
        if self.critical {
            return Err(Error::new(codes::CHUNK_CRITICAL, self.offset, Part::Chunk(self.kind)));
        }
        Ok(())
    }
}

/// Length of a chunk with a payload of `payload` bytes: envelope, payload, and padding to a multiple of 8;
/// `None` if that exceeds 64 bits.
#[must_use]
pub const fn chunk_len(payload: u64) -> Option<u64> {
    match payload.checked_add(CHUNK_OVERHEAD) {
        Some(bare) => bare.checked_next_multiple_of(8),
        None => None,
    }
}

/// The chunks of a file, read one after the other: where the next begins, where they end, how many there were.
#[derive(Clone, Copy, Debug)]
pub struct ChunkArea {
    next: u64,
    end: u64,
    count: u32,
    content: ContentId,
}

impl ChunkArea {
    /// The area from `start` (the header's length) to `end` (the data offset).
    #[must_use]
    pub const fn new(start: u64, end: u64, content: ContentId) -> Self {
        Self { next: start, end, count: 0, content }
    }

    /// Whether all chunks have been read.
    #[must_use]
    pub const fn is_done(&self) -> bool {
        self.next >= self.end
    }

    /// Reads the next chunk; `input` begins where it begins. Call only while [`ChunkArea::is_done`] is false.
    ///
    /// # Errors
    ///
    /// In this order: number of chunks, length, checksum, reserved bits and bytes, padding.
    pub fn read<'a>(&mut self, input: &'a [u8], limits: &Limits) -> Result<Step<Chunk<'a>>, Error> {
        let start = self.next;
        let fail = |code, at: u64, part| Err(Error::new(code, ByteOffset(start.saturating_add(at)), part));
        if self.count >= Maximum::CHUNKS {
            return fail(codes::CHUNK_COUNT, 0, Part::Chunks);
        }
        if self.count >= limits.chunks {
            return fail(codes::LIMIT_CHUNKS, 0, Part::Chunks);
        }
        let room = self.end.saturating_sub(start);
        if room < CHUNK_OVERHEAD {
            return fail(codes::CHUNK_LENGTH, 0, Part::Chunks);
        }
        let Ok((wire, _)) = Wire::ref_from_prefix(input) else {
            return Ok(Step::NeedMore(HEADER_BYTES.saturating_sub(input.len())));
        };
        let kind = ChunkKind(wire.kind);
        let part = Part::Chunk(kind);
        let payload_len = wire.length.get();
        let total = match chunk_len(payload_len) {
            Some(total) if total <= room && total <= u64::from(Maximum::CHUNK_BYTES) => total,
            _ => return fail(codes::CHUNK_LENGTH, offset_of!(Wire, length) as u64, part),
        };
        if total > u64::from(limits.chunk_bytes) {
            return fail(codes::LIMIT_CHUNK_BYTES, offset_of!(Wire, length) as u64, part);
        }
        // No larger than Maximum::CHUNK_BYTES, so the conversions lose nothing.
        let (total_len, payload_len) = (total as usize, payload_len as usize);
        let Some(chunk) = input.get(..total_len) else {
            return Ok(Step::NeedMore(total_len.saturating_sub(input.len())));
        };
        let Some((body, crc)) = chunk.split_last_chunk::<4>() else {
            return fail(codes::CHUNK_LENGTH, 0, part);
        };
        let crc_at = ByteOffset(start.saturating_add(body.len() as u64));
        compare(codes::CHUNK_CHECKSUM, u32::from_le_bytes(*crc), self.content.crc32(body), crc_at, part)?;
        if wire.flags & !CRITICAL != 0 || wire.reserved != [0; 3] {
            return fail(codes::RESERVED, offset_of!(Wire, flags) as u64, part);
        }
        let after = body.get(HEADER_BYTES..).unwrap_or(&[]);
        let Some((payload, padding)) = after.split_at_checked(payload_len) else {
            return fail(codes::CHUNK_LENGTH, offset_of!(Wire, length) as u64, part);
        };
        if padding.iter().any(|&b| b != 0) {
            let padding_at = (HEADER_BYTES as u64).saturating_add(payload.len() as u64);
            return fail(codes::CHUNK_PADDING, padding_at, part);
        }
        self.next = start.saturating_add(total);
        self.count = self.count.saturating_add(1);
        let critical = wire.flags & CRITICAL != 0;
        Ok(Step::Consumed(total_len, Chunk { kind, critical, offset: ByteOffset(start), payload }))
    }
}

/// Appends a chunk to `out`.
pub fn write_chunk(out: &mut Vec<u8>, kind: ChunkKind, critical: bool, payload: &[u8], content: ContentId) {
    let start = out.len();
    let length = payload.len() as u64;
    let wire = Wire {
        kind: kind.0,
        flags: if critical { CRITICAL } else { 0 },
        reserved: [0; 3],
        length: length.into(),
    };
    out.extend_from_slice(wire.as_bytes());
    out.extend_from_slice(payload);
    let bare = payload.len().saturating_add(HEADER_BYTES).saturating_add(4);
    let padding = bare.next_multiple_of(8).saturating_sub(bare);
    out.resize(out.len().saturating_add(padding), 0);
    let crc = content.crc32(out.get(start..).unwrap_or(&[]));
    out.extend_from_slice(&crc.to_le_bytes());
}

#[cfg(test)]
mod tests;
