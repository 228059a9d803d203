//! The column "maximum" of the limits, judged whatever limits a reader has.

use ivg_wire::{ByteOffset, ChunkArea, ContentId, Limits, Maximum, Step, codes, read_record};

/// A reader that refuses nothing of its own accord.
const UNLIMITED: Limits =
    Limits { header_bytes: u32::MAX, chunk_bytes: u32::MAX, chunks: u32::MAX, record_bytes: u32::MAX };

#[test]
fn a_chunk_of_the_greatest_length_is_awaited_and_one_byte_more_is_refused() {
    // 2³¹ − 8 bytes with the 20 of the envelope: a payload of 2³¹ − 28.
    let read = |payload: u64| {
        let head = [b"NEWS\0\0\0\0", &payload.to_le_bytes()[..]].concat();
        let mut area = ChunkArea::new(144, 144 + (1 << 40), ContentId(0));
        match area.read(&head, &UNLIMITED) {
            Ok(Step::NeedMore(more)) => Ok(more),
            Ok(step) => panic!("{step:?}"),
            Err(error) => Err((error.code(), error.offset())),
        }
    };
    assert_eq!(read((1 << 31) - 28), Ok(Maximum::CHUNK_BYTES as usize - 16));
    assert_eq!(read((1 << 31) - 27), Err((codes::CHUNK_LENGTH.number(), ByteOffset(152))));
}

#[test]
fn a_record_of_the_greatest_length_is_awaited() {
    // 2³¹ − 4 bytes with the 12 of the envelope. Whether a file may have such a record is the format's to say.
    let read = |payload| read_record(&[], ByteOffset(0), 1, payload, ContentId(0));
    assert_eq!(read((1 << 31) - 16), Ok(Step::NeedMore(Maximum::RECORD_BYTES as usize)));
    assert!(read((1 << 31) - 15).is_err());
}
