extern crate std;
use super::*;
use std::string::ToString;

#[test]
fn an_error_says_what_where_and_against_which_clause() {
    let error = Error::new(codes::CHUNK_PADDING, ByteOffset(0x1A4), Part::Chunk(ChunkKind(*b"META")));
    assert_eq!(error.to_string(), "the chunk's padding is not zero at byte 0x1a4 in chunk META (COM-CHK-04)");
    let error = Error::checksum(codes::RECORD_CHECKSUM, 1, 0xABCD_EF01, ByteOffset(16), Part::Record(9));
    assert_eq!(
        error.to_string(),
        "the record's checksum does not fit; fetch the record again: stored 0x00000001, computed 0xabcdef01, \
         at byte 0x10 in record 9 (COM-REC-05)"
    );
}

#[test]
fn the_kind_follows_from_the_verdict_of_the_code() {
    for &code in codes::ALL {
        let error = Error::new(code, ByteOffset(0), Part::Header);
        assert_eq!((error.verdict(), error.code()), (code.rule().verdict, code.number()));
    }
}

#[test]
fn verdicts_have_exit_codes_that_no_crash_has() {
    let verdicts = [Verdict::Ok, Verdict::NeedMore, Verdict::Invalid, Verdict::Unsupported, Verdict::Limit];
    assert_eq!(verdicts.map(Verdict::exit_code), [0, 40, 41, 42, 43]);
}

#[test]
fn an_error_stays_small_enough_to_return_by_value() {
    assert!(size_of::<Error>() <= 40, "{}", size_of::<Error>());
}
