use super::*;
use crate::Verdict;
use quickcheck::quickcheck;

const CONTENT: ContentId = ContentId(42);
const KIND: ChunkKind = ChunkKind(*b"TEST");

fn written(critical: bool, payload: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    write_chunk(&mut out, KIND, critical, payload, CONTENT);
    out
}

/// Reads one chunk from an area that begins at byte 144 and is as long as the input, or longer.
fn read(bytes: &[u8], room: u64) -> Result<Step<Chunk<'_>>, Error> {
    ChunkArea::new(144, 144 + room, CONTENT).read(bytes, &Limits::new())
}

/// The chunk after `edit`, with a checksum that fits.
fn edited(payload: &[u8], edit: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let mut bytes = written(false, payload);
    edit(&mut bytes);
    let end = bytes.len() - 4;
    let crc = CONTENT.crc32(&bytes[..end]);
    bytes[end..].copy_from_slice(&crc.to_le_bytes());
    bytes
}

#[test]
fn what_is_written_is_read_at_every_payload_length() {
    for length in 0..20u8 {
        let payload: Vec<u8> = (0..length).map(|b| b | 0x80).collect();
        let bytes = written(length % 2 == 0, &payload);
        assert_eq!(bytes.len() as u64, chunk_len(u64::from(length)).unwrap());
        assert_eq!(bytes.len() % 8, 0);
        let chunk =
            Chunk { kind: KIND, critical: length % 2 == 0, offset: ByteOffset(144), payload: &payload };
        assert_eq!(read(&bytes, bytes.len() as u64), Ok(Step::Consumed(bytes.len(), chunk)));
    }
}

#[test]
fn every_truncation_needs_more() {
    let bytes = written(false, b"payload");
    for n in 0..bytes.len() {
        assert!(matches!(read(&bytes[..n], bytes.len() as u64), Ok(Step::NeedMore(1..))), "{n} bytes");
    }
}

#[test]
fn every_flipped_bit_is_refused() {
    let bytes = written(false, b"payload");
    for bit in 0..bytes.len() * 8 {
        let mut damaged = bytes.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        // The area ends with the chunk, so that a longer length cannot look like a missing rest.
        let error = read(&damaged, bytes.len() as u64).unwrap_err();
        assert_eq!(error.verdict(), Verdict::Invalid, "bit {bit}: {error}");
    }
}

#[test]
fn a_length_beyond_the_area_is_refused_from_the_first_sixteen_bytes() {
    let mut bytes = written(false, b"payload");
    for length in [13, 1 << 31, u64::MAX - 19, u64::MAX] {
        bytes[8..16].copy_from_slice(&u64::to_le_bytes(length));
        let error = read(&bytes[..16], 32).unwrap_err();
        assert_eq!(
            (error.code(), error.offset()),
            (codes::CHUNK_LENGTH.number(), ByteOffset(152)),
            "{length}"
        );
    }
}

#[test]
fn a_length_beyond_the_limit_is_refused_before_waiting() {
    let mut bytes = written(false, b"payload");
    bytes[8..16].copy_from_slice(&(1u64 << 20).to_le_bytes());
    let error = read(&bytes[..16], 1 << 30).unwrap_err();
    assert_eq!(error.code(), codes::LIMIT_CHUNK_BYTES.number());
}

#[test]
fn a_rest_too_short_for_a_chunk_is_refused() {
    for room in [1, 8, 19] {
        assert_eq!(read(&[], room).unwrap_err().code(), codes::CHUNK_LENGTH.number());
    }
}

#[test]
fn reserved_bits_and_bytes_need_a_newer_reader() {
    for (at, value) in [(4, 2), (4, 0x81), (5, 1), (7, 0x80)] {
        let bytes = edited(b"payload", |b| b[at] = value);
        let error = read(&bytes, bytes.len() as u64).unwrap_err();
        assert_eq!((error.code(), error.verdict()), (codes::RESERVED.number(), Verdict::Unsupported));
    }
}

#[test]
fn padding_must_be_zero() {
    let bytes = edited(b"payload", |b| b[23] = 1);
    let error = read(&bytes, bytes.len() as u64).unwrap_err();
    assert_eq!((error.code(), error.offset()), (codes::CHUNK_PADDING.number(), ByteOffset(144 + 23)));
}

#[test]
fn unknown_chunks_are_skipped_unless_critical() {
    for critical in [false, true] {
        let bytes = written(critical, b"");
        let Ok(Step::Consumed(_, chunk)) = read(&bytes, bytes.len() as u64) else { panic!("not read") };
        assert_eq!(chunk.skip_unknown().is_err(), critical);
    }
}

#[test]
fn the_number_of_chunks_is_limited() {
    let one = written(false, b"");
    let bytes = one.repeat(3);
    let limits = Limits { chunks: 2, ..Limits::new() };
    let mut area = ChunkArea::new(0, bytes.len() as u64, CONTENT);
    let mut rest = &bytes[..];
    for _ in 0..2 {
        let Ok(Step::Consumed(used, _)) = area.read(rest, &limits) else { panic!("not read") };
        rest = &rest[used..];
    }
    let error = area.read(rest, &limits).unwrap_err();
    assert_eq!((error.code(), error.offset()), (codes::LIMIT_CHUNKS.number(), ByteOffset(48)));
}

#[test]
fn a_kind_that_is_not_text_is_shown_escaped() {
    extern crate std;
    assert_eq!(std::format!("{}", ChunkKind(*b"A\n\xFF\"")), "A\\n\\xff\\\"");
}

quickcheck! {
    fn arbitrary_bytes_never_panic(bytes: Vec<u8>, start: u64, room: u64) -> bool {
        let mut area = ChunkArea::new(start, start.saturating_add(room), CONTENT);
        let _ = area.read(&bytes, &Limits::new());
        true
    }
}
