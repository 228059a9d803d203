//! Records: the bulk of a file, each with its own checksum so that it can be fetched and verified alone
//! (`spec/common.md`, "Records").
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use crate::code::codes;
use crate::crc::{ContentId, compare};
use crate::error::{ByteOffset, Error, Part};
use crate::limits::Maximum;
use crate::step::Step;
use alloc::vec::Vec;
use core::ops::Range;

/// Bytes of a record besides payload and padding: 8 before, 4 after.
pub const RECORD_OVERHEAD: u64 = 12;

/// The id of the end record.
pub const END_RECORD: u32 = 0xFFFF_FFFF;

/// Bytes of the end record's payload: the file's length.
pub const END_PAYLOAD: u64 = 8;

const HEADER_BYTES: usize = 8;

/// Where in a record its generation is.
const GENERATION_AT: u64 = 4;

/// A record whose checksum fits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Record<'a> {
    /// Which record it is.
    pub id: u32,
    /// 0 in a fresh file; of two records with one id, the higher generation counts.
    pub generation: u32,
    /// Where the record begins in the file.
    pub offset: ByteOffset,
    /// The payload, without padding.
    pub payload: &'a [u8],
}

impl Record<'_> {
    /// Where the payload begins in the file.
    #[must_use]
    pub const fn payload_offset(&self) -> ByteOffset {
        ByteOffset(self.offset.0.saturating_add(HEADER_BYTES as u64))
    }
}

/// Length of a record with a payload of `payload` bytes: envelope, payload, and padding to a multiple of 4;
/// `None` if that exceeds 64 bits.
#[must_use]
pub const fn record_len(payload: u64) -> Option<u64> {
    match payload.checked_add(RECORD_OVERHEAD) {
        Some(bare) => bare.checked_next_multiple_of(4),
        None => None,
    }
}

/// Reads the record that begins `input` and lies at `offset` in the file. Its `id` and the length of its
/// payload follow from the header, which is why they are given, not read.
///
/// The caller has compared [`record_len`] with its limits.
///
/// # Errors
///
/// In this order: length, checksum, id, padding.
pub fn read_record(
    input: &[u8],
    offset: ByteOffset,
    id: u32,
    payload_len: u64,
    content: ContentId,
) -> Result<Step<Record<'_>>, Error> {
    let part = Part::Record(id);
    let fail = |code, at: u64| Err(Error::new(code, ByteOffset(offset.0.saturating_add(at)), part));
    let total = match record_len(payload_len) {
        Some(total) if total <= u64::from(Maximum::RECORD_BYTES) => total as usize,
        _ => return fail(codes::LIMIT_RECORD_BYTES, 0),
    };
    let payload_len = payload_len as usize;
    let Some(record) = input.get(..total) else {
        return Ok(Step::NeedMore(total.saturating_sub(input.len())));
    };
    let Some((body, crc)) = record.split_last_chunk::<4>() else {
        return fail(codes::RECORD_LENGTH, 0);
    };
    let crc_at = ByteOffset(offset.0.saturating_add(body.len() as u64));
    compare(codes::RECORD_CHECKSUM, u32::from_le_bytes(*crc), content.crc32(body), crc_at, part)?;
    let Some((head, after)) = body.split_first_chunk::<HEADER_BYTES>() else {
        return fail(codes::RECORD_LENGTH, 0);
    };
    let [i0, i1, i2, i3, g0, g1, g2, g3] = *head;
    if u32::from_le_bytes([i0, i1, i2, i3]) != id {
        return fail(codes::RECORD_ID, 0);
    }
    let Some((payload, padding)) = after.split_at_checked(payload_len) else {
        return fail(codes::RECORD_LENGTH, 0);
    };
    if padding.iter().any(|&b| b != 0) {
        return fail(codes::RECORD_PADDING, (HEADER_BYTES as u64).saturating_add(payload.len() as u64));
    }
    let generation = u32::from_le_bytes([g0, g1, g2, g3]);
    Ok(Step::Consumed(total, Record { id, generation, offset, payload }))
}

/// Reads the end record and compares it with the header's file length (COM-REC-07).
///
/// # Errors
///
/// As [`read_record`]; and malformed, at the field at fault, if the generation is not 0 or the length differs.
pub fn read_end(
    input: &[u8],
    offset: ByteOffset,
    file_bytes: u64,
    content: ContentId,
) -> Result<Step<()>, Error> {
    match read_record(input, offset, END_RECORD, END_PAYLOAD, content)? {
        Step::NeedMore(more) => Ok(Step::NeedMore(more)),
        Step::Consumed(used, record) => {
            let fail = |at| Err(Error::new(codes::END_MISMATCH, at, Part::Record(END_RECORD)));
            if record.generation != 0 {
                return fail(ByteOffset(offset.0.saturating_add(GENERATION_AT)));
            }
            if record.payload != file_bytes.to_le_bytes() {
                return fail(record.payload_offset());
            }
            Ok(Step::Consumed(used, ()))
        }
    }
}

/// What was read of a record that was fetched alone: `given` bytes for those of `range` (COM-REC-06).
///
/// # Errors
///
/// Truncated if bytes are missing, malformed if there are more than the record has.
pub fn fetched_alone<T>(step: Step<T>, range: &Range<u64>, given: usize, part: Part) -> Result<T, Error> {
    match step {
        Step::NeedMore(_) => {
            Err(Error::truncated(ByteOffset(range.start.saturating_add(given as u64)), part))
        }
        Step::Consumed(used, _) if used < given => {
            Err(Error::new(codes::RECORD_LENGTH, ByteOffset(range.end), part))
        }
        Step::Consumed(_, read) => Ok(read),
    }
}

/// Makes the checksum of a whole chunk or record anew: the last four bytes, over all before them (COM-CRC-02).
pub fn seal(envelope: &mut [u8], content: ContentId) {
    if let Some((body, crc)) = envelope.split_last_chunk_mut::<4>() {
        *crc = content.crc32(body).to_le_bytes();
    }
}

/// Begins a record in place: writes what is before the payload into `record`, which has the length [`record_len`] and is 0, and
/// returns the rest, to which the payload goes. [`seal`] ends it.
pub fn begin_record(record: &mut [u8], id: u32, generation: u32) -> &mut [u8] {
    let Some((head, rest)) = record.split_first_chunk_mut::<HEADER_BYTES>() else { return &mut [] };
    let ([i0, i1, i2, i3], [g0, g1, g2, g3]) = (id.to_le_bytes(), generation.to_le_bytes());
    *head = [i0, i1, i2, i3, g0, g1, g2, g3];
    rest
}

/// Appends a record to `out`.
pub fn write_record(out: &mut Vec<u8>, id: u32, generation: u32, payload: &[u8], content: ContentId) {
    let start = out.len();
    out.extend_from_slice(&id.to_le_bytes());
    out.extend_from_slice(&generation.to_le_bytes());
    out.extend_from_slice(payload);
    let padding = payload.len().next_multiple_of(4).saturating_sub(payload.len());
    out.resize(out.len().saturating_add(padding), 0);
    let crc = content.crc32(out.get(start..).unwrap_or(&[]));
    out.extend_from_slice(&crc.to_le_bytes());
}

/// Appends the end record of a file that will be `file_bytes` long.
pub fn write_end(out: &mut Vec<u8>, file_bytes: u64, content: ContentId) {
    write_record(out, END_RECORD, 0, &file_bytes.to_le_bytes(), content);
}

#[cfg(test)]
mod tests;
