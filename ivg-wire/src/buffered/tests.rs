//! A format of numbered records without header fields of its own, so that what belongs to the decoder alone is tested alone.

use alloc::vec;
use alloc::vec::Vec;

use super::*;
use crate::{
    ByteOffset, Chunk, ChunkArea, CommonHeader, ContentId, FormatId, Part, Step, Verdict, codes, decode_all,
    read_end, read_record, seal_header, write_end, write_record,
};

const FORMAT: FormatId =
    FormatId { magic: *b"\x89TST\r\n\x1A\n", major: 0, minor: 0, header_bytes: 56, features: 0 };
const CONTENT: ContentId = ContentId(7);

/// Two records of 4 bytes.
#[derive(Clone, Copy, Debug)]
enum Numbers {}

#[derive(Debug, PartialEq)]
enum Event<'a> {
    Header,
    Number(&'a [u8]),
    End,
}

impl Format for Numbers {
    type Header = CommonHeader;
    type Limits = crate::Limits;
    type Seen = ();
    type Record = u32;
    type Event<'a> = Event<'a>;
    const FIRST: u32 = 0;

    fn wire_limits(limits: &crate::Limits) -> &crate::Limits {
        limits
    }

    fn part(record: u32) -> Part {
        Part::Record(record)
    }

    fn read_header(input: &[u8], limits: &crate::Limits) -> Result<Step<(CommonHeader, ChunkArea)>, Error> {
        Ok(CommonHeader::read(input, &FORMAT, limits)?.map(|header| {
            let area = ChunkArea::new(u64::from(header.header_bytes), header.data_offset, header.content_id);
            (header, area)
        }))
    }

    fn header_event(_: &CommonHeader) -> Event<'_> {
        Event::Header
    }

    fn check_chunk(_: &CommonHeader, chunk: &Chunk<'_>, (): &mut ()) -> Result<(), Error> {
        chunk.skip_unknown()
    }

    fn chunk_event(_: Chunk<'_>) -> Event<'_> {
        Event::Header
    }

    fn read_record<'a>(
        header: &'a CommonHeader,
        record: u32,
        input: &'a [u8],
        offset: ByteOffset,
    ) -> Result<Step<Event<'a>>, Error> {
        if record == 2 {
            return Ok(read_end(input, offset, header.file_bytes, header.content_id)?.map(|()| Event::End));
        }
        let step = read_record(input, offset, record, 4, header.content_id)?;
        Ok(step.map(|record| Event::Number(record.payload)))
    }

    fn next_record(_: &CommonHeader, record: u32) -> Option<u32> {
        (record < 2).then_some(record + 1)
    }
}

fn file() -> Vec<u8> {
    let file_bytes = 56 + 2 * 16 + 20;
    let header = CommonHeader {
        minor: 0,
        required_features: 0,
        optional_features: 0,
        header_bytes: 56,
        content_id: CONTENT,
        data_offset: 56,
        file_bytes,
    };
    let mut bytes = header.to_bytes(&FORMAT).to_vec();
    seal_header(&mut bytes);
    write_record(&mut bytes, 0, 0, b"zero", CONTENT);
    write_record(&mut bytes, 1, 0, b"one!", CONTENT);
    write_end(&mut bytes, file_bytes, CONTENT);
    bytes
}

/// An error of a visitor that holds those of the decoder as well.
#[derive(Debug, PartialEq)]
enum Refused {
    File(Error),
    Number(Vec<u8>),
}

impl From<Error> for Refused {
    fn from(error: Error) -> Self {
        Self::File(error)
    }
}

/// Refuses the number `one!`.
fn not_one(event: &Event<'_>) -> Result<(), Refused> {
    match event {
        Event::Number(b"one!") => Err(Refused::Number(b"one!".to_vec())),
        _ => Ok(()),
    }
}

#[test]
fn the_error_of_a_visitor_ends_the_reading() {
    let bytes = file();
    let mut seen = 0;
    let read = decode_all::<Numbers, _>(&bytes, crate::Limits::new(), |event| {
        seen += 1;
        not_one(&event)
    });
    assert_eq!((read, seen), (Err(Refused::Number(b"one!".to_vec())), 3));
}

#[test]
fn the_error_of_the_file_comes_as_the_visitors() {
    let mut bytes = file();
    bytes[56 + 10] ^= 1;
    let read = decode_all::<Numbers, _>(&bytes, crate::Limits::new(), |event| not_one(&event));
    let Err(Refused::File(error)) = read else { panic!("{read:?}") };
    assert_eq!(error.code(), codes::RECORD_CHECKSUM.number(), "{error}");
    let cut = decode_all::<Numbers, _>(&file()[..80], crate::Limits::new(), |event| not_one(&event));
    let Err(Refused::File(error)) = cut else { panic!("{cut:?}") };
    assert_eq!((error.verdict(), error.offset()), (Verdict::NeedMore, ByteOffset(80)));
}

#[test]
fn a_refused_event_is_read_and_the_next_piece_goes_on_behind_it() {
    let bytes = file();
    for cut in 0..=bytes.len() {
        let mut decoder = BufferedDecoder::<Numbers>::new(crate::Limits::new());
        let mut refusals = 0;
        let mut ends = 0;
        for piece in [&bytes[..cut], &bytes[cut..], &[]] {
            let read = decoder.feed(piece, |event| {
                ends += u32::from(event == Event::End);
                not_one(&event)
            });
            match read {
                Ok(()) => {}
                Err(Refused::Number(_)) => refusals += 1,
                Err(Refused::File(error)) => panic!("cut at {cut}: {error}"),
            }
        }
        assert_eq!((refusals, ends, decoder.finish()), (1, 1, Ok(())), "cut at {cut}");
    }
}

#[test]
fn after_an_error_of_the_file_no_piece_is_kept() {
    let mut bytes = file();
    bytes[56 + 10] ^= 1;
    let mut decoder = BufferedDecoder::<Numbers>::new(crate::Limits::new());
    decoder.feed(&bytes[..60], |_| {}).unwrap();
    let error = decoder.feed(&bytes[60..], |_| {}).unwrap_err();
    for _ in 0..3 {
        assert_eq!(decoder.feed(&vec![0; 1000], |_| {}), Err(error));
        assert_eq!(decoder.buffer.capacity(), 0);
    }
    assert_eq!(decoder.finish(), Err(error));
}
