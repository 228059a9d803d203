//! What is judged first when several things are wrong at once.
//!
//! Every list below holds mistakes in the order in which the specification judges them. The n-th case has mistake n
//! and all that come after it, and mistake n must be the one reported.

use crate::files::{edited, header, one_shot, plain, with_chunk};
use ivg_format::{Decoder, Encoding, Event, Header, Limits, RecordId, Step, codes, decode_all};
use ivg_wire::{Code, ContentId, codes as common, seal, seal_header};

/// A mistake: its code, where it is reported, how it is made.
type Mistake = (Code, u64, fn(&mut Judged));

/// A header with the limits under which it is read, and whether its checksum is made anew.
struct Judged {
    bytes: Vec<u8>,
    limits: Limits,
    sealed: bool,
}

impl Judged {
    fn put(&mut self, at: usize, bytes: &[u8]) {
        self.bytes[at..at + bytes.len()].copy_from_slice(bytes);
    }
}

/// A header of 300 × 300 × 300 vertices, all of a slice in one bundle, which is longer than a record may be only
/// where a vertex takes 216 bytes.
fn large() -> Judged {
    let mut bytes = plain([3, 3, 3], Encoding::PackedOct24, 64)[..144].to_vec();
    for at in [56, 58, 60] {
        bytes[at..at + 2].copy_from_slice(&300u16.to_le_bytes());
    }
    bytes[116..120].copy_from_slice(&u32::MAX.to_le_bytes());
    bytes[128..132].copy_from_slice(&1u32.to_le_bytes());
    let bundle = (300u64.pow(3) - 8) * 42 + 12;
    bytes[48..56].copy_from_slice(&(144 + 348 + bundle + 20).to_le_bytes());
    let wire = ivg_wire::Limits { record_bytes: u32::MAX, ..ivg_wire::Limits::new() };
    Judged { bytes, limits: Limits { wire, ..Limits::new() }, sealed: true }
}

const HEADER: &[Mistake] = &[
    (common::MAGIC, 3, |h| h.put(3, b"X")),
    (common::MAJOR_VERSION, 8, |h| h.put(8, &[1])),
    (common::HEADER_BYTES, 20, |h| h.put(20, &[148, 0, 0, 0])),
    (common::LIMIT_HEADER_BYTES, 20, |h| {
        h.put(10, &[9]);
        h.put(20, &8192u32.to_le_bytes());
    }),
    (common::HEADER_CHECKSUM, 28, |h| h.sealed = false),
    (common::RESERVED, 24, |h| h.put(24, &[1])),
    (common::REQUIRED_FEATURE, 12, |h| h.put(12, &[1])),
    (common::DATA_OFFSET, 40, |h| h.put(40, &[4])),
    (codes::DIMENSIONS, 56, |h| h.put(56, &[0, 0])),
    (codes::ORIGIN, 64, |h| h.put(64, &f64::NAN.to_le_bytes())),
    (codes::STEP, 88, |h| h.put(88, &(-1.0f64).to_le_bytes())),
    (codes::DIMENSIONS, 58, |h| h.put(58, &[0, 0])),
    (codes::ORIGIN, 72, |h| h.put(72, &f64::NAN.to_le_bytes())),
    (codes::STEP, 96, |h| h.put(96, &(-1.0f64).to_le_bytes())),
    (codes::DIMENSIONS, 60, |h| h.put(60, &[0, 0])),
    (codes::ORIGIN, 80, |h| h.put(80, &f64::NAN.to_le_bytes())),
    (codes::STEP, 104, |h| h.put(104, &(-1.0f64).to_le_bytes())),
    (codes::ENCODING_FORBIDDEN, 62, |h| h.put(62, &[0, 0])),
    (codes::ORDER_FORBIDDEN, 112, |h| h.put(112, &[0, 0])),
    (codes::SCALE_EXPONENT, 114, |h| h.put(114, &113i16.to_le_bytes())),
    (codes::UNITS_UNKNOWN, 136, |h| h.put(136, &[2])),
    (codes::SLICE_VERTICES, 116, |h| h.put(116, &[0; 4])),
    (codes::BUNDLE_COUNT, 128, |h| h.put(128, &[2])),
    (codes::VALIDITY_COUNT, 132, |h| h.put(132, &[1])),
    // vectors-f32: 216 bytes a vertex.
    (codes::RECORD_TOO_LARGE, 116, |h| h.put(62, &[6, 0])),
    (codes::LIMIT_VERTICES, 56, |h| h.limits.vertices = 26_999_999),
    (common::LIMIT_RECORD_BYTES, 116, |h| h.limits.wire.record_bytes = 1 << 20),
    (common::RESERVED, 137, |h| h.put(143, &[1])),
    (common::FILE_BYTES, 48, |h| h.put(48, &[1])),
];

#[test]
fn the_header_is_judged_in_the_order_of_the_specification() {
    for (first, (code, at, _)) in HEADER.iter().enumerate() {
        let mut judged = large();
        for (_, _, make) in HEADER[first..].iter().rev() {
            make(&mut judged);
        }
        if judged.sealed {
            seal_header(&mut judged.bytes);
        }
        let error = Header::read(&judged.bytes, &judged.limits).unwrap_err();
        assert_eq!((error.code(), error.offset().0), (code.number(), *at), "mistake {first}: {error}");
    }
    let mut right = large();
    seal_header(&mut right.bytes);
    assert!(matches!(Header::read(&right.bytes, &right.limits), Ok(Step::Consumed(144, _))));
}

/// A file whose first chunk is critical and unknown, and whose second, if there is one, is a `META` that comes again.
fn with_chunks(critical: bool) -> Vec<u8> {
    let file = with_chunk(&plain([2, 2, 2], Encoding::PackedOct24, 1), *b"META", false, b"");
    if critical { with_chunk(&file, *b"NEWS", true, b"news!") } else { file }
}

/// A mistake in the first chunk, which begins at byte 144 and has a payload of 5 bytes and 7 of padding.
type ChunkMistake = (Code, u64, fn(&mut [u8], &mut Limits, &mut bool));

const CHUNK: &[ChunkMistake] = &[
    (common::LIMIT_CHUNKS, 144, |_, limits, _| limits.wire.chunks = 0),
    (common::CHUNK_LENGTH, 152, |bytes, _, _| bytes[159] = 0x80),
    (common::LIMIT_CHUNK_BYTES, 152, |_, limits, _| limits.wire.chunk_bytes = 31),
    (common::CHUNK_CHECKSUM, 172, |_, _, sealed| *sealed = false),
    (common::RESERVED, 148, |bytes, _, _| bytes[150] = 1),
    (common::CHUNK_PADDING, 165, |bytes, _, _| bytes[165] = 1),
    (common::CHUNK_CRITICAL, 144, |_, _, _| {}),
];

#[test]
fn a_chunk_is_judged_in_the_order_of_the_specification() {
    for (first, (code, at, _)) in CHUNK.iter().enumerate() {
        let (mut bytes, mut limits, mut sealed) = (with_chunks(true), Limits::new(), true);
        let content = header(&bytes).content_id;
        for (_, _, make) in CHUNK[first..].iter().rev() {
            make(&mut bytes, &mut limits, &mut sealed);
        }
        if sealed {
            seal(&mut bytes[144..176], content);
        } else {
            bytes[172] ^= 1;
        }
        let error = decode_all(&bytes, &limits, |_| {}).unwrap_err();
        assert_eq!((error.code(), error.offset().0), (code.number(), *at), "mistake {first}: {error}");
    }
}

#[test]
fn a_chunk_is_known_to_come_again_before_its_payload_is_read() {
    let again = with_chunk(&with_chunks(false), *b"META", false, b"no pair");
    // The bad one comes first here, so it is its payload that is at fault; swapped, it is that it comes again.
    assert_eq!(one_shot(&again).1.unwrap().code(), codes::METADATA.number());
    let content = header(&again).content_id;
    let mut swapped = again.clone();
    let (bad, good) = (again[144..176].to_vec(), again[176..200].to_vec());
    swapped[144..168].copy_from_slice(&good);
    swapped[168..200].copy_from_slice(&bad);
    seal(&mut swapped[168..200], content);
    let error = one_shot(&swapped).1.unwrap();
    assert_eq!((error.code(), error.offset().0), (common::CHUNK_REPEATED.number(), 168));
}

#[test]
fn an_unknown_chunk_is_skipped_only_if_its_checksum_fits() {
    let mut file = with_chunk(&plain([2, 2, 2], Encoding::PackedOct24, 1), *b"NEWS", false, b"news!");
    assert_eq!(one_shot(&file).1, None);
    file[160] ^= 1;
    assert_eq!(one_shot(&file).1.unwrap().code(), common::CHUNK_CHECKSUM.number());
}

/// A mistake in a record of one vertex of `packed-oct24`: 42 bytes of payload, 2 of padding.
type RecordMistake = (Code, usize, fn(&mut [u8]));

const RECORD: &[RecordMistake] = &[
    (common::RECORD_CHECKSUM, 52, |record| record[52] ^= 1),
    (common::RECORD_ID, 0, |record| record[0] = 2),
    (common::RECORD_PADDING, 50, |record| record[50] = 1),
    (codes::DIRECTION_CODE, 32, |record| record[32..35].fill(0xFF)),
];

#[test]
fn a_record_is_judged_in_the_order_of_the_specification() {
    let file = plain([1, 3, 2], Encoding::PackedOct24, 1);
    let header = header(&file);
    let range = header.record_range(RecordId::Bundle(1));
    for (first, (code, at, _)) in RECORD.iter().enumerate() {
        let mut bytes = file.clone();
        let record = &mut bytes[range.start as usize..range.end as usize];
        for (_, _, make) in RECORD[first.max(1)..].iter().rev() {
            make(record);
        }
        seal(record, header.content_id);
        if first == 0 {
            RECORD[0].2(record);
        }
        let error = one_shot(&bytes).1.unwrap();
        assert_eq!((error.code(), error.offset().0), (code.number(), range.start + *at as u64), "{first}");
    }
}

#[test]
fn the_end_records_generation_is_judged_before_its_length() {
    let file = plain([2, 2, 2], Encoding::PackedOct24, 1);
    let end = file.len() - 20;
    for (bytes, at) in [(&[4, 8][..], 4), (&[8], 8)] {
        let bad = edited(&file, |file| bytes.iter().for_each(|&at| file[end + at] ^= 1));
        let error = one_shot(&bad).1.unwrap();
        assert_eq!((error.code(), error.offset().0), (common::END_MISMATCH.number(), (end + at) as u64));
    }
}

#[test]
fn a_file_inside_a_longer_stream_ends_with_its_end_record() {
    let file = plain([2, 3, 2], Encoding::PackedOct24, 1);
    let stream = [&file[..], &file].concat();
    let (mut decoder, mut used) = (Decoder::new(Limits::default()), 0);
    loop {
        match decoder.push(&stream[used..]).unwrap() {
            Step::Consumed(more, event) => {
                used += more;
                if event == Event::End {
                    break;
                }
            }
            Step::NeedMore(more) => panic!("{more} more bytes asked for"),
        }
    }
    // Exactly the file's bytes: the caller goes on from there.
    assert_eq!((used, decoder.offset().0), (file.len(), file.len() as u64));
    assert_eq!(&stream[used..], file);
}

#[test]
fn another_content_id_changes_every_checksum_but_the_headers() {
    // The id alone is changed, and every envelope keeps its bytes: none may be accepted.
    let file = plain([2, 3, 2], Encoding::PackedOct24, 1);
    let mut other = file.clone();
    other[32] ^= 1;
    seal_header(&mut other[..144]);
    assert_eq!(one_shot(&other).1.unwrap().code(), common::RECORD_CHECKSUM.number());
    let id = |file: &[u8]| header(file).content_id;
    assert_ne!(id(&file), id(&other));
    assert_ne!(id(&file), ContentId(0), "a writer gives every file an id");
}
