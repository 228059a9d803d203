use super::*;
use crate::{ErrorKind, Verdict};
use quickcheck::quickcheck;

const CONTENT: ContentId = ContentId(0x0123_4567_89AB_CDEF);

fn written(payload: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    write_record(&mut out, 5, 2, payload, CONTENT);
    out
}

#[test]
fn what_is_written_is_read() {
    for length in 0..20u8 {
        let payload: Vec<u8> = (0..length).map(|b| b | 0x80).collect();
        let bytes = written(&payload);
        assert_eq!(bytes.len() as u64, record_len(u64::from(length)).unwrap());
        let step = read_record(&bytes, ByteOffset(40), 5, u64::from(length), CONTENT).unwrap();
        let record = Record { id: 5, generation: 2, offset: ByteOffset(40), payload: &payload };
        assert_eq!(step, Step::Consumed(bytes.len(), record));
    }
}

#[test]
fn a_record_made_in_place_is_the_one_appended() {
    for length in 0..20u8 {
        let payload: Vec<u8> = (0..length).map(|b| b | 0x80).collect();
        let expected = written(&payload);
        let mut record = alloc::vec![0; expected.len()];
        begin_record(&mut record, 5, 2)[..payload.len()].copy_from_slice(&payload);
        seal(&mut record, CONTENT);
        assert_eq!(record, expected);
    }
}

#[test]
fn every_truncation_names_the_missing_bytes() {
    let bytes = written(b"seven b");
    for n in 0..bytes.len() {
        let step = read_record(&bytes[..n], ByteOffset(0), 5, 7, CONTENT);
        assert_eq!(step, Ok(Step::NeedMore(bytes.len() - n)));
    }
}

#[test]
fn every_flipped_bit_fails_the_checksum() {
    let bytes = written(b"payload!");
    for bit in 0..bytes.len() * 8 {
        let mut damaged = bytes.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        let error = read_record(&damaged, ByteOffset(100), 5, 8, CONTENT).unwrap_err();
        assert!(matches!(error.kind(), ErrorKind::Checksum { .. }), "bit {bit}: {error}");
        assert_eq!((error.verdict(), error.offset()), (Verdict::Invalid, ByteOffset(116)));
    }
}

#[test]
fn a_record_of_another_file_fails_the_checksum() {
    let error = read_record(&written(b"x"), ByteOffset(0), 5, 1, ContentId(1)).unwrap_err();
    assert_eq!(error.code(), codes::RECORD_CHECKSUM.number());
}

#[test]
fn another_id_is_refused() {
    let error = read_record(&written(b"x"), ByteOffset(8), 6, 1, CONTENT).unwrap_err();
    assert_eq!((error.code(), error.offset()), (codes::RECORD_ID.number(), ByteOffset(8)));
}

#[test]
fn padding_must_be_zero() {
    let mut bytes = written(b"x");
    bytes[10] = 1;
    let crc = CONTENT.crc32(&bytes[..12]);
    bytes[12..].copy_from_slice(&crc.to_le_bytes());
    let error = read_record(&bytes, ByteOffset(0), 5, 1, CONTENT).unwrap_err();
    assert_eq!((error.code(), error.offset()), (codes::RECORD_PADDING.number(), ByteOffset(9)));
}

#[test]
fn an_impossible_length_is_refused_without_waiting() {
    for length in [u64::MAX, u64::MAX - 11, 1 << 31] {
        let error = read_record(&[], ByteOffset(0), 1, length, CONTENT).unwrap_err();
        assert_eq!(error.verdict(), Verdict::Limit, "{length}");
    }
}

#[test]
fn the_end_record_names_the_length_of_the_file() {
    let mut bytes = Vec::new();
    write_end(&mut bytes, 1234, CONTENT);
    assert_eq!(bytes.len() as u64, record_len(END_PAYLOAD).unwrap());
    assert_eq!(read_end(&bytes, ByteOffset(0), 1234, CONTENT), Ok(Step::Consumed(20, ())));
    let error = read_end(&bytes, ByteOffset(0), 1235, CONTENT).unwrap_err();
    assert_eq!((error.code(), error.offset()), (codes::END_MISMATCH.number(), ByteOffset(8)));
    let mut updated = Vec::new();
    write_record(&mut updated, END_RECORD, 1, &1234u64.to_le_bytes(), CONTENT);
    let error = read_end(&updated, ByteOffset(0), 1234, CONTENT).unwrap_err();
    assert_eq!((error.code(), error.offset()), (codes::END_MISMATCH.number(), ByteOffset(4)), "generation 1");
}

quickcheck! {
    fn arbitrary_bytes_never_panic(bytes: Vec<u8>, id: u32, length: u16) -> bool {
        let _ = read_record(&bytes, ByteOffset(u64::MAX), id, u64::from(length), CONTENT);
        true
    }
}
