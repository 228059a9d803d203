//! What must hold of files that are right but for some fields: an input chooses an accepted file and what to do to its fields, chunks
//! and records. Bytes that a fuzzer changes rarely get past a header; most of these do.
//!
//! `pmesh_packets` makes up what is inside packets, whose tables hang together bit by bit; here lies what is around them: the header,
//! the directory, the envelopes, which records there are, and single numbers inside them.

use super::{ivg_decode, pmesh_decode, pmesh_lod};
use crate::choices::Choices;
use crate::vectors::edit::{CONTENT_ID_AT, DATA_OFFSET_AT, FILE_BYTES_AT, HEADER_BYTES_AT};
use crate::vectors::{Format, vectors};
use ivg_wire::{ContentId, seal, seal_header};
use std::sync::OnceLock;

/// Longest file that is edited \[bytes\]: fuzzers are slow on long ones.
const LONGEST: usize = 2048;
/// How many edits a file gets: few more often than many, since the first mistake that is found hides the others.
const EDITS: [usize; 8] = [1, 1, 1, 1, 2, 2, 3, 6];
/// Bytes of an entry of the directory of `.pmesh`, and of one of `.ivg`: fields of both are words.
const WORD: usize = 4;
/// Places in a chunk: its length, u64, and its payload.
const CHUNK_LENGTH_AT: usize = 8;
const CHUNK_PAYLOAD_AT: usize = 16;
/// Places in a record: its payload; in the end record that is the length of the file.
const RECORD_PAYLOAD_AT: usize = 8;
/// Bytes of a checksum.
const CHECKSUM: usize = 4;

/// An accepted file in its parts.
#[derive(Debug, Clone)]
struct Parts {
    header: Vec<u8>,
    chunks: Vec<Vec<u8>>,
    /// Records, the end record last.
    records: Vec<Vec<u8>>,
}

/// Lengths of the fields of a header, in bytes, from its beginning to its end (`spec/tables/common.toml`, then the format's).
const COMMON_FIELDS: [usize; 11] = [8, 2, 2, 4, 4, 4, 4, 4, 8, 8, 8];
const IVG_FIELDS: [usize; 20] = [2, 2, 2, 2, 8, 8, 8, 8, 8, 8, 2, 2, 4, 8, 4, 4, 1, 1, 2, 4];
const PMESH_FIELDS: [usize; 26] =
    [4, 4, 4, 4, 4, 1, 1, 2, 8, 8, 8, 4, 4, 4, 4, 4, 4, 1, 1, 2, 4, 4, 4, 4, 2, 2];

/// A file that is right but for the edits that the bytes choose.
#[must_use]
pub fn edited(format: Format, data: &[u8]) -> Vec<u8> {
    let mut choices = Choices::new(data);
    let bases = bases(format);
    let mut parts = bases[choices.below(bases.len())].clone();
    let other = &bases[choices.below(bases.len())];
    let keep = choices.byte();
    for _ in 0..EDITS[choices.below(EDITS.len())] {
        if choices.is_used_up() {
            break;
        }
        parts.edit(format, other, &mut choices);
    }
    let mut file = parts.into_file(keep);
    if keep & CUT == CUT {
        let length = choices.below(file.len() + 1);
        file.truncate(length);
    }
    file
}

/// What an input may ask for beside edits: lengths, or checksums, left as they were; the file cut off, by both bits.
const STALE_LENGTHS: u8 = 0x10;
const STALE_CHECKSUMS: u8 = 0x20;
const CUT: u8 = 0xC0;

/// The accepted vectors of a format that are short, in their parts.
fn bases(format: Format) -> &'static [Parts] {
    static BASES: [OnceLock<Vec<Parts>>; 2] = [OnceLock::new(), OnceLock::new()];
    BASES[usize::from(format == Format::Pmesh)].get_or_init(|| {
        vectors()
            .iter()
            .filter(|vector| {
                vector.format == format && vector.code.is_none() && vector.bytes.len() <= LONGEST
            })
            .map(|vector| Parts::of(format, &vector.bytes))
            .collect()
    })
}

impl Parts {
    fn of(format: Format, file: &[u8]) -> Self {
        let word = |at: usize| u32::from_le_bytes(*file[at..].first_chunk().expect("a whole file")) as usize;
        let header = word(HEADER_BYTES_AT);
        let data = word(DATA_OFFSET_AT);
        let mut chunks = Vec::new();
        let mut at = header;
        while at < data {
            let length = ivg_wire::chunk_len(word(at + CHUNK_LENGTH_AT) as u64).expect("short") as usize;
            chunks.push(file[at..at + length].to_vec());
            at += length;
        }
        let records = match format {
            Format::Ivg => crate::vectors::ivg_records(file),
            Format::Pmesh => crate::vectors::pmesh_records(file),
        };
        let records = records.into_iter().map(|(_, range)| file[range].to_vec()).collect();
        Self { header: file[..header].to_vec(), chunks, records }
    }

    /// Does one thing to the file.
    fn edit(&mut self, format: Format, other: &Self, choices: &mut Choices<'_>) {
        match choices.byte() % 16 {
            0..2 => {
                let own: &[usize] = if format == Format::Ivg { &IVG_FIELDS } else { &PMESH_FIELDS };
                let lengths = COMMON_FIELDS.iter().chain(own);
                let which = choices.below(COMMON_FIELDS.len() + own.len());
                let at = lengths.clone().take(which).sum::<usize>();
                let length = lengths.clone().nth(which).copied().unwrap_or(1);
                set(&mut self.header, at, length, choices);
            }
            2..5 => edit_one(&mut self.chunks, CHUNK_PAYLOAD_AT, choices),
            5..12 => edit_one(&mut self.records, RECORD_PAYLOAD_AT, choices),
            12 => rearrange(&mut self.chunks, &other.chunks, choices),
            13 => rearrange(&mut self.records, &other.records, choices),
            14 => resize_one(&mut self.chunks, CHUNK_PAYLOAD_AT, choices),
            _ => resize_one(&mut self.records, RECORD_PAYLOAD_AT, choices),
        }
    }

    /// The file, with lengths and checksums put right unless they are to be left.
    fn into_file(mut self, keep: u8) -> Vec<u8> {
        let content = self.header.get(CONTENT_ID_AT..).and_then(<[u8]>::first_chunk).copied();
        let content = ContentId(u64::from_le_bytes(content.unwrap_or_default()));
        let total = |parts: &[Vec<u8>]| parts.iter().map(Vec::len).sum::<usize>();
        let data_offset = self.header.len() + total(&self.chunks);
        let file_bytes = data_offset + total(&self.records);
        if keep & STALE_LENGTHS == 0 {
            put_u64(&mut self.header, DATA_OFFSET_AT, data_offset);
            put_u64(&mut self.header, FILE_BYTES_AT, file_bytes);
            if let Some(end) = self.records.last_mut() {
                put_u64(end, RECORD_PAYLOAD_AT, file_bytes);
            }
        }
        if keep & STALE_CHECKSUMS == 0 {
            seal_header(&mut self.header);
            self.chunks.iter_mut().chain(&mut self.records).for_each(|part| seal(part, content));
        }
        [vec![self.header], self.chunks, self.records].concat().concat()
    }
}

fn put_u64(bytes: &mut [u8], at: usize, value: usize) {
    if let Some(field) = bytes.get_mut(at..at + 8) {
        field.copy_from_slice(&(value as u64).to_le_bytes());
    }
}

/// Sets the field of so many bytes to a value that may be a border of something, or that is near the one it had.
fn set(part: &mut [u8], at: usize, length: usize, choices: &mut Choices<'_>) {
    let Some(field) = part.get_mut(at..at + length) else { return };
    let bits = 8 * field.len() as u32;
    let mut before = [0; 8];
    before[..field.len()].copy_from_slice(field);
    let before = u64::from_le_bytes(before);
    let bit = 1u64.checked_shl(u32::from(choices.byte()) % bits).unwrap_or(0);
    let value = match choices.byte() % 12 {
        0 => 0,
        1 => u64::MAX,
        2 => 1 << (bits - 1),
        3 => (1 << (bits - 1)) - 1,
        4 => before.wrapping_add(1),
        5 => before.wrapping_sub(1),
        6 => before.wrapping_neg(),
        7 => before ^ bit,
        8 => bit,
        9 => u64::from(choices.byte()),
        // The first bits of infinity and NaN.
        10 if length == 8 => f64::INFINITY.to_bits() | choices.long() & 1,
        10 => u64::from(f32::INFINITY.to_bits() | choices.word() & 1),
        _ => choices.long(),
    };
    field.copy_from_slice(&value.to_le_bytes()[..length]);
}

/// Sets a number of one of the parts: in its head, or anywhere in the payload; words more often than bytes.
fn edit_one(parts: &mut [Vec<u8>], payload_at: usize, choices: &mut Choices<'_>) {
    let which = choices.below(parts.len());
    let Some(part) = parts.get_mut(which) else { return };
    let payload = part.len().saturating_sub(payload_at + CHECKSUM);
    match choices.byte() % 8 {
        0 => set(part, 0, WORD, choices),
        1 => set(part, payload_at - WORD, WORD, choices),
        2 => set(part, payload_at - 2 * WORD, WORD, choices),
        3..6 => {
            let at = payload_at + WORD * choices.below(payload / WORD);
            set(part, at, WORD, choices);
        }
        6 => {
            let at = payload_at + choices.below(payload);
            set(part, at, 1, choices);
        }
        _ => {
            let at = payload_at + choices.below(payload);
            set(part, at, 2, choices);
        }
    }
}

/// Drops, repeats or swaps parts, or takes one of another file.
fn rearrange(parts: &mut Vec<Vec<u8>>, others: &[Vec<u8>], choices: &mut Choices<'_>) {
    let (a, b) = (choices.below(parts.len()), choices.below(parts.len().max(others.len())));
    match choices.byte() % 4 {
        0 if a < parts.len() => drop(parts.remove(a)),
        1 if a < parts.len() => parts.insert(a, parts[a].clone()),
        2 if b < parts.len() => parts.swap(a, b),
        _ => {
            if let Some(other) = others.get(b) {
                parts.insert(a, other.clone());
            }
        }
    }
}

/// Makes the payload of one of the parts some bytes longer or shorter; a chunk says so or not.
fn resize_one(parts: &mut [Vec<u8>], payload_at: usize, choices: &mut Choices<'_>) {
    let which = choices.below(parts.len());
    let Some(part) = parts.get_mut(which) else { return };
    let change = 1 + choices.below(2 * WORD);
    let (shorter, says) = (choices.byte() & 1 != 0, choices.byte() & 1 != 0);
    let end = part.len().saturating_sub(CHECKSUM).max(payload_at.min(part.len()));
    let added = if shorter {
        let start = end.saturating_sub(change).max(payload_at.min(end));
        part.drain(start..end);
        0usize.wrapping_sub(end - start)
    } else {
        part.splice(end..end, std::iter::repeat_n(0, change));
        change
    };
    if says && payload_at == CHUNK_PAYLOAD_AT && part.len() >= CHUNK_PAYLOAD_AT {
        let length = u64::from_le_bytes(*part[CHUNK_LENGTH_AT..].first_chunk().expect("8 bytes"));
        put_u64(part, CHUNK_LENGTH_AT, (length as usize).wrapping_add(added));
    }
}

/// What holds for any bytes, of a grid that is right but for some fields.
///
/// # Panics
///
/// When that does not hold.
pub fn ivg_fields(data: &[u8]) {
    ivg_decode(&edited(Format::Ivg, data));
}

/// What holds for any bytes, of a mesh that is right but for some fields.
///
/// # Panics
///
/// When that does not hold.
pub fn pmesh_fields(data: &[u8]) {
    let file = edited(Format::Pmesh, data);
    pmesh_decode(&file);
    pmesh_lod(&file);
}

#[cfg(test)]
mod tests;
