//! Files of `.ivg` beyond the default limits of a reader, but within those of the format: few bytes that declare many.

use super::super::Refused;
use super::super::edit::{
    CONTENT_ID_AT, DATA_OFFSET_AT, FILE_BYTES_AT, HEADER_BYTES_AT, chunk, in_header, inserted, overwritten,
    read_u64,
};
use super::{CHUNK_HEAD, at};
use ivg_format::codes as ivg;
use ivg_wire::codes as wire;

/// Bytes a vertex in `packed-oct24`, and around a payload.
const VERTEX_BYTES: u64 = 42;
const ENVELOPE: u64 = 12;
const END_RECORD: u64 = 20;

pub(super) fn refused(small: &[u8], meta: &[u8]) -> Vec<Refused> {
    let (s, m) = ("0008-small", "0009-metadata");
    let many_chunks = inserted(small, at::END, &chunk(small, b"MANY", false, b"").repeat(1025));
    vec![
        (s, "header", wire::LIMIT_HEADER_BYTES, long_header(small, at::END), "a header of 8 KiB"),
        (
            m,
            "chunk",
            wire::LIMIT_CHUNK_BYTES,
            long_chunk(meta),
            "a chunk of 4 MiB, of which the first bytes are there",
        ),
        (s, "chunks", wire::LIMIT_CHUNKS, many_chunks, "1025 chunks"),
        (s, "record", wire::LIMIT_RECORD_BYTES, declared(small, 500, 4096), "bundles of 82 MiB"),
        (
            s,
            "vertices",
            ivg::LIMIT_VERTICES,
            declared(small, u16::MAX, 64),
            "281,462,092,005,375 vertices in 144 bytes",
        ),
    ]
}

/// The first bytes of a file of a newer minor version with a header of 8 KiB, `header` bytes of which are known.
pub(in super::super) fn long_header(file: &[u8], header: usize) -> Vec<u8> {
    let longer = 8192u32;
    let more = u64::from(longer) - header as u64;
    let mut file = overwritten(file, at::MINOR, &[9]);
    file = overwritten(&file, HEADER_BYTES_AT, &longer.to_le_bytes());
    for field in [DATA_OFFSET_AT, FILE_BYTES_AT] {
        file = overwritten(&file, field, &(read_u64(&file, field) as u64 + more).to_le_bytes());
    }
    // As far as the checksum can be made without the rest.
    file.truncate(CONTENT_ID_AT);
    file
}

/// A header that declares a cube of `side`³ vertices with a share of `per_slice`.
pub(super) fn huge(small: &[u8], side: u16, per_slice: u32) -> Vec<u8> {
    let bundles = (u64::from(side) * u64::from(side)).div_ceil(u64::from(per_slice));
    let file = overwritten(small, at::DIMS, &[side.to_le_bytes(); 3].concat());
    let file = overwritten(&file, at::VERTICES_PER_SLICE, &per_slice.to_le_bytes());
    in_header(&file, at::BUNDLE_COUNT, &u32::try_from(bundles).expect("32 bits").to_le_bytes())
}

/// The header alone, with a lattice of `side`³ vertices, and the length of the file that it would be (IVG-REC-03).
fn declared(small: &[u8], side: u16, per_slice: u32) -> Vec<u8> {
    let (n, share) = (u64::from(side), u64::from(per_slice));
    let record = |vertices: u64| (vertices * VERTEX_BYTES + ENVELOPE).next_multiple_of(4);
    let (inner, outer) = (n * n, n * n - 4);
    // Bundles to which every slice gives its whole share; then those to which some give less.
    let whole = outer / share;
    let rest = (whole..inner.div_ceil(share)).map(|k| {
        let of = |m: u64| share.min(m.saturating_sub(k * share));
        record((n - 2) * of(inner) + 2 * of(outer))
    });
    let length = at::END as u64 + record(8) + whole * record(n * share) + rest.sum::<u64>() + END_RECORD;
    let file = huge(small, side, per_slice);
    let mut file = in_header(&file, FILE_BYTES_AT, &length.to_le_bytes());
    file.truncate(at::END);
    file
}

fn long_chunk(meta: &[u8]) -> Vec<u8> {
    // Instead of the chunk of 22 bytes.
    let (chunk, long) = (48, 4u64 << 20);
    let mut file = meta[..at::END + CHUNK_HEAD].to_vec();
    for field in [DATA_OFFSET_AT, FILE_BYTES_AT] {
        file = in_header(&file, field, &(read_u64(&file, field) as u64 - chunk + long).to_le_bytes());
    }
    overwritten(&file, at::END + 8, &(long - 20).to_le_bytes())
}
