//! The three columns of the limits: what every reader accepts, what a reader may refuse, what no file may have.

use crate::files::{edited, header, lattice, one_shot, options, plain, vectors, with_chunk};
use ivg_format::{Encoding, GridSource, Header, Limits, Step, Verdict, codes, decode_all, encode};
use ivg_wire::{ChunkKind, codes as common, seal, seal_header, write_chunk};

/// A reader that accepts what is guaranteed and no more (`spec/tables/limits.toml`).
fn guaranteed() -> Limits {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../spec/tables/limits.toml");
    let table: toml::Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
    let number = |name: &str| {
        let rows = table["limit"].as_array().unwrap();
        let row = rows.iter().find(|row| row["name"].as_str() == Some(name)).unwrap();
        row["guaranteed"].as_integer().unwrap()
    };
    let wire = |name| u32::try_from(number(name)).unwrap();
    Limits {
        vertices: number("vertices") as u64,
        wire: ivg_wire::Limits {
            header_bytes: wire("header_bytes"),
            chunk_bytes: wire("chunk_bytes"),
            chunks: wire("chunks"),
            record_bytes: wire("record_bytes"),
        },
    }
}

/// Verdict of a reader with the guaranteed limits.
fn judged(file: &[u8]) -> Option<(Verdict, u16)> {
    decode_all(file, &guaranteed(), |_| {}).err().map(|error| (error.verdict(), error.code()))
}

const fn limit(code: ivg_wire::Code) -> Option<(Verdict, u16)> {
    Some((Verdict::Limit, code.number()))
}

/// A file of a newer minor version with a header of so many bytes.
fn with_header(header_bytes: usize) -> Vec<u8> {
    let file = plain([2, 2, 2], Encoding::PackedOct24, 1);
    let longer = header_bytes - 144;
    let mut out = [&file[..144], &vec![0x5A; longer], &file[144..]].concat();
    out[10] = 9;
    out[20..24].copy_from_slice(&(header_bytes as u32).to_le_bytes());
    for at in [40, 48] {
        let number = u64::from_le_bytes(out[at..at + 8].try_into().unwrap()) + longer as u64;
        out[at..at + 8].copy_from_slice(&number.to_le_bytes());
    }
    seal_header(&mut out[..header_bytes]);
    let (end, length) = (out.len() - 20, out.len() as u64);
    out[end + 8..end + 16].copy_from_slice(&length.to_le_bytes());
    let content = ivg_wire::ContentId(u64::from_le_bytes(out[32..40].try_into().unwrap()));
    seal(&mut out[end..], content);
    out
}

#[test]
fn headers_of_the_guaranteed_length_are_read() {
    assert_eq!(judged(&with_header(4096)), None);
    assert_eq!(judged(&with_header(4104)), limit(common::LIMIT_HEADER_BYTES));
}

#[test]
fn chunks_of_the_guaranteed_length_and_number_are_read() {
    let file = plain([2, 2, 2], Encoding::PackedOct24, 1);
    // 20 bytes of envelope and no padding.
    assert_eq!(judged(&with_chunk(&file, *b"NEWS", false, &vec![1; 65_516])), None);
    let longer = with_chunk(&file, *b"NEWS", false, &vec![1; 65_517]);
    assert_eq!(judged(&longer), limit(common::LIMIT_CHUNK_BYTES));
    let mut many = file;
    for _ in 0..64 {
        many = with_chunk(&many, *b"NEWS", false, b"");
    }
    assert_eq!(judged(&many), None);
    assert_eq!(judged(&with_chunk(&many, *b"NEWS", false, b"")), limit(common::LIMIT_CHUNKS));
}

#[test]
fn lists_as_long_as_a_guaranteed_chunk_are_read() {
    let file = plain([2, 2, 2], Encoding::PackedOct24, 1);
    // A count, and four bytes a light without a name: 16,378 of them fill the chunk.
    let lights = |count: u32| {
        let payload = [&count.to_le_bytes()[..], &[0; 4].repeat(count as usize)].concat();
        judged(&with_chunk(&file, *b"LITE", false, &payload))
    };
    assert_eq!(lights(16_378), None);
    assert_eq!(lights(16_379), limit(common::LIMIT_CHUNK_BYTES));
    let name = |length: u16| {
        let payload =
            [&[1, 0, 0, 0, 0, 0][..], &length.to_le_bytes(), &vec![b'n'; usize::from(length)]].concat();
        judged(&with_chunk(&file, *b"LITE", false, &payload))
    };
    assert_eq!(name(65_508), None);
    assert_eq!(name(65_509), limit(common::LIMIT_CHUNK_BYTES));
    let metadata = |length: usize| {
        let payload = [&b"key="[..], &vec![b'v'; length - 5], b"\n"].concat();
        judged(&with_chunk(&file, *b"META", false, &payload))
    };
    assert_eq!(metadata(65_516), None);
    assert_eq!(metadata(65_517), limit(common::LIMIT_CHUNK_BYTES));
}

#[test]
fn records_of_the_guaranteed_length_are_read() {
    // Slices of one vertex, so that a bundle holds every vertex but the two corners: 4854 × 216 + 12 bytes, 100 short
    // of 2²⁰.
    let file = |n: u16| {
        let lattice = lattice([n, 1, 1]);
        encode(&GridSource::new(lattice, &vectors(&lattice)), &options(Encoding::VectorsF32, 1)).unwrap()
    };
    assert_eq!(judged(&file(4856)), None);
    assert_eq!(judged(&file(4857)), limit(common::LIMIT_RECORD_BYTES));
}

/// The header of a lattice without chunks, S = 1, no validity section; its file length is not set.
fn header_of(dims: [u16; 3], bundles: u32) -> Vec<u8> {
    let mut bytes = plain([3, 3, 3], Encoding::PackedOct24, 1)[..144].to_vec();
    for (axis, n) in dims.into_iter().enumerate() {
        bytes[56 + 2 * axis..][..2].copy_from_slice(&n.to_le_bytes());
        let step = if n == 1 { 0.0f64 } else { 1.0 };
        bytes[88 + 8 * axis..][..8].copy_from_slice(&step.to_le_bytes());
    }
    bytes[128..132].copy_from_slice(&bundles.to_le_bytes());
    seal_header(&mut bytes);
    bytes
}

#[test]
fn lattices_of_the_guaranteed_size_are_read() {
    let read = |dims, bundles| Header::read(&header_of(dims, bundles), &guaranteed()).unwrap_err().code();
    // What comes after the limits is judged: the length of the file, which is that of another lattice.
    assert_eq!(read([128, 128, 64], 128 * 64), common::FILE_BYTES.number());
    assert_eq!(read([128, 128, 65], 128 * 65), codes::LIMIT_VERTICES.number());
}

#[test]
fn there_are_fewer_bundles_than_ids_for_them() {
    // m / S bundles, with m = 65,535² and S = 1: the number that follows, and still too many.
    let bytes = header_of([65_535; 3], 65_535 * 65_535);
    let unlimited = Limits { vertices: u64::MAX, ..Limits::new() };
    let error = Header::read(&bytes, &unlimited).unwrap_err();
    assert_eq!((error.code(), error.offset().0), (codes::BUNDLE_COUNT.number(), 128));
    // Half as many fit, and something else is at fault.
    let mut bytes = header_of([65_535; 3], (65_535u64 * 65_535).div_ceil(2) as u32);
    bytes[116..120].copy_from_slice(&2u32.to_le_bytes());
    seal_header(&mut bytes);
    assert!((65_535u64 * 65_535).div_ceil(2) < 1 << 31);
    assert_eq!(Header::read(&bytes, &unlimited).unwrap_err().code(), common::FILE_BYTES.number());
}

#[test]
fn a_record_longer_than_any_may_be_is_invalid_whatever_the_limits() {
    let unlimited = Limits {
        vertices: u64::MAX,
        wire: ivg_wire::Limits { record_bytes: u32::MAX, ..ivg_wire::Limits::new() },
    };
    let read = |per_slice: u32, bundles: u32| {
        let mut bytes = header_of([65_535, 1000, 1], bundles);
        bytes[116..120].copy_from_slice(&per_slice.to_le_bytes());
        seal_header(&mut bytes);
        Header::read(&bytes, &unlimited).unwrap_err()
    };
    // 780 × 65,535 × 42 bytes and 12 are less than 2³¹ − 4, with 781 they are more.
    assert_eq!(read(780, 2).code(), common::FILE_BYTES.number());
    let error = read(781, 2);
    assert_eq!((error.verdict(), error.code()), (Verdict::Invalid, codes::RECORD_TOO_LARGE.number()));
}

#[test]
fn there_are_at_most_65_535_chunks_whatever_the_limits() {
    let file = plain([2, 2, 2], Encoding::PackedOct24, 1);
    let content = header(&file).content_id;
    let mut one = vec![];
    write_chunk(&mut one, ChunkKind(*b"NEWS"), false, b"", content);
    let limits =
        Limits { wire: ivg_wire::Limits { chunks: u32::MAX, ..ivg_wire::Limits::new() }, ..Limits::new() };
    let count = |chunks: usize| {
        let longer = chunks * one.len();
        let mut bytes = [&file[..144], &one.repeat(chunks)].concat();
        for at in [40, 48] {
            let number = u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) + longer as u64;
            bytes[at..at + 8].copy_from_slice(&number.to_le_bytes());
        }
        seal_header(&mut bytes[..144]);
        let error = decode_all(&bytes, &limits, |_| {}).unwrap_err();
        (error.verdict(), error.code())
    };
    assert_eq!(count(65_535), (Verdict::NeedMore, common::TRUNCATED.number()), "the records are missing");
    assert_eq!(count(65_536), (Verdict::Invalid, common::CHUNK_COUNT.number()));
}

#[test]
fn private_and_reserved_values_are_unsupported_wherever_they_stand() {
    let file = plain([2, 2, 2], Encoding::PackedOct24, 1);
    for (at, bytes) in [(62, &[0xFF, 0xFF][..]), (62, &[0, 0xC0]), (112, &[0xFF, 0xFF]), (136, &[0xC0])] {
        let bad = edited(&file, |file| file[at..at + bytes.len()].copy_from_slice(bytes));
        assert_eq!(one_shot(&bad).1.unwrap().verdict(), Verdict::Unsupported, "{bytes:02x?} at {at}");
    }
}

#[test]
fn a_header_is_read_wherever_its_bytes_end() {
    let file = plain([2, 2, 2], Encoding::PackedOct24, 1);
    assert!(matches!(Header::read(&file, &guaranteed()), Ok(Step::Consumed(144, _))));
    assert!(matches!(Header::read(&file[..143], &guaranteed()), Ok(Step::NeedMore(1))));
}
