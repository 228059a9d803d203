extern crate std;
use super::*;
use crate::Verdict;
use alloc::vec::Vec;
use quickcheck::quickcheck;

const FORMAT: FormatId =
    FormatId { magic: *b"\x89TST\r\n\x1A\n", major: 0, minor: 1, header_bytes: 64, features: 0b101 };

fn common() -> CommonHeader {
    CommonHeader {
        minor: 1,
        required_features: 0b100,
        optional_features: 0xFFFF_0000,
        header_bytes: 64,
        content_id: ContentId(0xFEDC_BA98_7654_3210),
        data_offset: 96,
        file_bytes: 116,
    }
}

fn sealed(header: CommonHeader) -> Vec<u8> {
    let mut bytes = header.to_bytes(&FORMAT).to_vec();
    bytes.resize(header.header_bytes as usize, 0xAA);
    seal_header(&mut bytes);
    bytes
}

fn read(bytes: &[u8]) -> Result<Step<CommonHeader>, Error> {
    CommonHeader::read(bytes, &FORMAT, &Limits::new())
}

#[track_caller]
fn refused(bytes: &[u8], code: crate::Code, at: u64) {
    let error = read(bytes).unwrap_err();
    assert_eq!((error.code(), error.offset()), (code.number(), ByteOffset(at)), "{error}");
}

#[test]
fn what_is_written_is_read() {
    assert_eq!(read(&sealed(common())), Ok(Step::Consumed(64, common())));
}

#[test]
fn every_truncation_needs_more() {
    let bytes = sealed(common());
    for n in 0..bytes.len() {
        // Its length is known after 24 bytes.
        let goal = if n < 24 { 32 } else { 64 };
        assert_eq!(read(&bytes[..n]), Ok(Step::NeedMore(goal - n)), "{n} bytes");
    }
}

#[test]
fn every_flipped_bit_is_refused() {
    let bytes = sealed(common());
    for bit in 0..bytes.len() * 8 {
        let mut damaged = bytes.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        // A flip in the minor version makes a longer header possible, but not a fitting checksum.
        assert!(read(&damaged).is_err(), "bit {bit} of byte {}", bit / 8);
    }
}

#[test]
fn mangled_signatures_are_refused_at_the_first_wrong_byte() {
    refused(b"\x89TST\n\x1A\n\0", codes::MAGIC, 4);
    refused(b"\x09TST\r\n\x1A\n", codes::MAGIC, 0);
    refused(b"\xEF\xBB\xBF\x89TST", codes::MAGIC, 0);
    refused(b"\x89TST\r\r\n\x1A", codes::MAGIC, 5);
    refused(b"\x89tst", codes::MAGIC, 1);
}

#[test]
fn another_major_version_is_unsupported_once_its_bytes_are_there() {
    let mut bytes = sealed(common());
    bytes[8] = 1;
    assert!(matches!(read(&bytes[..9]), Ok(Step::NeedMore(_))));
    refused(&bytes[..10], codes::MAJOR_VERSION, 8);
    refused(&bytes, codes::MAJOR_VERSION, 8);
}

#[test]
fn a_wrong_length_is_refused_once_its_bytes_are_there() {
    let bytes = sealed(CommonHeader { header_bytes: 72, ..common() });
    assert!(matches!(read(&bytes[..23]), Ok(Step::NeedMore(_))));
    refused(&bytes[..24], codes::HEADER_BYTES, 20);
}

#[test]
fn a_newer_minor_version_may_have_a_longer_header() {
    let newer = CommonHeader { minor: 2, header_bytes: 72, ..common() };
    assert_eq!(read(&sealed(newer)), Ok(Step::Consumed(72, newer)));
    refused(&sealed(CommonHeader { minor: 1, header_bytes: 72, ..common() }), codes::HEADER_BYTES, 20);
    refused(&sealed(CommonHeader { minor: 2, header_bytes: 56, ..common() }), codes::HEADER_BYTES, 20);
    refused(&sealed(CommonHeader { minor: 2, header_bytes: 76, ..common() }), codes::HEADER_BYTES, 20);
}

#[test]
fn header_lengths_beyond_limit_and_maximum_are_refused_without_waiting() {
    let with = |header_bytes| CommonHeader { minor: 2, header_bytes, ..common() }.to_bytes(&FORMAT);
    refused(&with(4104), codes::LIMIT_HEADER_BYTES, 20);
    refused(&with(65_544), codes::HEADER_BYTES, 20);
    refused(&with(0xFFFF_FFF8), codes::HEADER_BYTES, 20);
}

#[test]
fn unknown_required_features_and_reserved_fields_need_a_newer_reader() {
    let bytes = sealed(CommonHeader { required_features: 0b111, ..common() });
    refused(&bytes, codes::REQUIRED_FEATURE, 12);
    let mut bytes = sealed(common());
    bytes[24] = 1;
    seal_header(&mut bytes);
    refused(&bytes, codes::RESERVED, 24);
    assert_eq!(read(&bytes).unwrap_err().verdict(), Verdict::Unsupported);
}

#[test]
fn the_data_offset_must_fit_between_header_and_end() {
    for data_offset in [0, 56, 92, 120, u64::MAX - 7] {
        refused(&sealed(CommonHeader { data_offset, ..common() }), codes::DATA_OFFSET, 40);
    }
}

#[test]
fn the_file_length_must_follow_from_the_header() {
    assert_eq!(common().expect_file_bytes(Some(116)), Ok(()));
    for implied in [None, Some(115)] {
        let error = common().expect_file_bytes(implied).unwrap_err();
        assert_eq!((error.code(), error.offset()), (codes::FILE_BYTES.number(), ByteOffset(48)));
    }
}

quickcheck! {
    fn arbitrary_bytes_never_panic(tail: Vec<u8>, newer: bool) -> bool {
        let mut bytes = common().to_bytes(&FORMAT).to_vec();
        bytes[10] = u8::from(newer) + 1;
        bytes.truncate(20);
        bytes.extend(tail);
        let _ = read(&bytes);
        true
    }
}

/// Name, offset and size of a field in the rows of a table of `spec/tables/common.toml`.
fn spec_fields(key: &str) -> Vec<(std::string::String, u64)> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../spec/tables/common.toml");
    let table: toml::Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
    let rows = table[key].as_array().unwrap();
    rows.iter()
        .map(|row| (row["name"].as_str().unwrap().into(), row["offset"].as_integer().unwrap() as u64))
        .collect()
}

#[test]
fn every_field_lies_where_the_specification_says() {
    macro_rules! fields {
        ($($field:ident)*) => { [$((stringify!($field), offset_of!(Wire, $field) as u64)),*] };
    }
    let ours = fields! {
        magic major minor required_features optional_features header_bytes reserved header_crc content_id
        data_offset file_bytes
    };
    let spec = spec_fields("header");
    assert!(spec.iter().map(|(name, at)| (name.as_str(), *at)).eq(ours), "{spec:?}");
}
