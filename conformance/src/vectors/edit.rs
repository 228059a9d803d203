//! Makes a file wrong in one place, and puts the checksums right again, so that the one mistake is what a reader finds.
//! Positions are those of `spec/common.md`. All functions panic when the file is too short for what they do.

use ivg_wire::{ChunkKind, ContentId, seal, seal_header, write_chunk, write_record};
use std::ops::Range;

/// Length of the header, u32.
pub const HEADER_BYTES_AT: usize = 20;
/// Checksum of the header, u32.
pub const HEADER_CHECKSUM: Range<usize> = 28..32;
/// Content id, u64.
pub const CONTENT_ID_AT: usize = 32;
/// Where the records begin, u64.
pub const DATA_OFFSET_AT: usize = 40;
/// Length of the file, u64.
pub const FILE_BYTES_AT: usize = 48;
/// Bytes of the end record: id and generation, length of the file, checksum.
const END_BYTES: usize = 20;

/// Overwrites bytes and leaves every checksum as it was.
#[must_use]
pub fn overwritten(file: &[u8], at: usize, bytes: &[u8]) -> Vec<u8> {
    let mut file = file.to_vec();
    file[at..at + bytes.len()].copy_from_slice(bytes);
    file
}

/// Turns one bit of a byte and leaves every checksum as it was.
#[must_use]
pub fn flipped(file: &[u8], at: usize) -> Vec<u8> {
    overwritten(file, at, &[file[at] ^ 1])
}

/// Overwrites bytes of the header and puts its checksum right.
#[must_use]
pub fn in_header(file: &[u8], at: usize, bytes: &[u8]) -> Vec<u8> {
    let mut file = overwritten(file, at, bytes);
    reseal_header(&mut file);
    file
}

/// Overwrites bytes of the chunk or record that lies in `envelope`, and puts its checksum right.
#[must_use]
pub fn in_envelope(file: &[u8], envelope: Range<usize>, at: usize, bytes: &[u8]) -> Vec<u8> {
    assert!(envelope.contains(&at), "the edit lies outside the envelope");
    let mut file = overwritten(file, at, bytes);
    reseal(&mut file, envelope);
    file
}

/// Puts a chunk behind those that are there, and moves what follows.
#[must_use]
pub fn with_chunk(file: &[u8], kind: &[u8; 4], critical: bool, payload: &[u8]) -> Vec<u8> {
    inserted(file, read_u64(file, DATA_OFFSET_AT), &chunk(file, kind, critical, payload))
}

/// A chunk as it may stand in this file.
#[must_use]
pub fn chunk(file: &[u8], kind: &[u8; 4], critical: bool, payload: &[u8]) -> Vec<u8> {
    let mut chunk = Vec::new();
    write_chunk(&mut chunk, ChunkKind(*kind), critical, payload, content_id(file));
    chunk
}

/// Where the chunk that was put in last lies.
#[must_use]
pub fn last_chunk(file: &[u8], payload: usize) -> Range<usize> {
    let end = read_u64(file, DATA_OFFSET_AT);
    let length = ivg_wire::chunk_len(payload as u64).expect("short") as usize;
    end - length..end
}

/// Puts bytes in between header and records, and corrects what stands in header and end record of their places.
#[must_use]
pub fn inserted(file: &[u8], at: usize, bytes: &[u8]) -> Vec<u8> {
    let mut file = file.to_vec();
    file.splice(at..at, bytes.iter().copied());
    for field in [DATA_OFFSET_AT, FILE_BYTES_AT] {
        let value = read_u64(&file, field) + bytes.len();
        file[field..field + 8].copy_from_slice(&(value as u64).to_le_bytes());
    }
    reseal_header(&mut file);
    let end = file.len() - END_BYTES..file.len();
    let length = (file.len() as u64).to_le_bytes();
    let at = end.start + 8;
    in_envelope(&file, end, at, &length)
}

/// Puts bytes into the record that lies in `record`, and corrects what stands in header and end record of the length.
#[must_use]
pub fn lengthened(file: &[u8], record: Range<usize>, at: usize, bytes: &[u8]) -> Vec<u8> {
    let mut file = file.to_vec();
    file.splice(at..at, bytes.iter().copied());
    let content = content_id(&file);
    seal(&mut file[record.start..record.end + bytes.len()], content);
    let length = (file.len() as u64).to_le_bytes();
    let file = in_header(&file, FILE_BYTES_AT, &length);
    let end = file.len() - END_BYTES..file.len();
    in_envelope(&file, end.clone(), end.start + 8, &length)
}

/// Puts a record with this payload in place of the one that lies in `record`, and corrects what stands in header and end record of
/// the length.
#[must_use]
pub fn replaced(file: &[u8], record: Range<usize>, id: u32, payload: &[u8]) -> Vec<u8> {
    let content = content_id(file);
    let mut bytes = file[..record.start].to_vec();
    write_record(&mut bytes, id, 0, payload, content);
    bytes.extend_from_slice(&file[record.end..]);
    let length = (bytes.len() as u64).to_le_bytes();
    let file = in_header(&bytes, FILE_BYTES_AT, &length);
    let end = file.len() - END_BYTES..file.len();
    in_envelope(&file, end.clone(), end.start + 8, &length)
}

/// The number at a place of the header, which is small in every vector.
#[must_use]
pub fn read_u64(file: &[u8], at: usize) -> usize {
    usize::try_from(read_any_u64(file, at)).expect("a short file")
}

/// Computes the header's checksum anew. The length of the header is taken from the file as far as it lies inside it.
pub fn reseal_header(file: &mut [u8]) {
    let field = file[HEADER_BYTES_AT..].first_chunk().expect("4 bytes");
    let length = file.len().min(u32::from_le_bytes(*field) as usize);
    seal_header(&mut file[..length]);
}

/// Computes the checksum of a chunk or record anew.
pub fn reseal(file: &mut [u8], envelope: Range<usize>) {
    let content = content_id(file);
    seal(&mut file[envelope], content);
}

fn content_id(file: &[u8]) -> ContentId {
    ContentId(read_any_u64(file, CONTENT_ID_AT))
}

fn read_any_u64(file: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(*file[at..].first_chunk().expect("8 bytes"))
}

#[cfg(test)]
mod tests;
