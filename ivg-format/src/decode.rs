//! Reading: the push decoder, and everything else as a loop over it.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use crate::bundle::Bundle;
use crate::code::codes as ours;
use crate::directory::DIRECTORY;
use crate::encoding::Order;
use crate::header::{Header, RecordId};
use crate::limits::Limits;
use crate::metadata::{self, LIGHTS, METADATA};
use crate::validity::ValidityBlock;
use ivg_wire::{
    Answer, ByteOffset, Chunk, ChunkArea, Error, Format, Part, Record, Step, codes, fetched_alone, once,
    read_end, read_record,
};

/// What a decoder found. Payloads are windows into the caller's bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Event<'a> {
    /// The header, checked; for the order `explicit`, the directory behind it too, whose chunk has no event of its own.
    Header(&'a Header),
    /// A chunk: `LITE` and `META` checked, others as they are.
    Chunk(Chunk<'a>),
    /// The corner vertices.
    Corners(Bundle<'a>),
    /// A block of the validity section.
    Validity(ValidityBlock<'a>),
    /// A bundle of vertices.
    Bundle(Bundle<'a>),
    /// The end record: the file is whole.
    End,
}

/// A push decoder of one file, from its first byte on. It keeps no bytes, for the caller owns the buffer, and allocates
/// nothing but the directory of a file of the order `explicit`: twice the bytes that it has in the file.
///
/// ```
/// # use ivg_format::{Decoder, EncodeOptions, Event, GridSource, Lattice, Limits, encode};
/// # use ivg_wire::Step;
/// # let lattice = Lattice::new([2, 3, 2], [0.0; 3], [1.0; 3])?;
/// # let vectors = [[[[1.0, 0.0, 0.0]; 3]; 6]; 12];
/// # let file = encode(&GridSource::new(lattice, &vectors), &EncodeOptions::default())?;
/// let mut decoder = Decoder::new(Limits::default());
/// let mut rest = &file[..];
/// loop {
///     match decoder.push(rest)? {
///         Step::NeedMore(bytes) => panic!("{bytes} more bytes, please"),
///         Step::Consumed(used, event) => {
///             rest = &rest[used..];
///             match event {
///                 Event::Bundle(bundle) => println!("{} vertices", bundle.len()),
///                 Event::End => break,
///                 _ => {}
///             }
///         }
///     }
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub type Decoder = ivg_wire::Decoder<Ivg>;

/// A decoder that owns the buffer: takes the bytes of a file in pieces of any size, as a network delivers them.
///
/// It holds at most the bytes of one header, chunk or record besides the piece just given.
pub type BufferedDecoder = ivg_wire::BufferedDecoder<Ivg>;

/// The .ivg format, as the decoders of `ivg_wire` know it.
#[derive(Clone, Copy, Debug)]
pub enum Ivg {}

/// Which of the chunks that may appear once have appeared.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seen {
    lights: bool,
    metadata: bool,
}

impl Format for Ivg {
    type Header = Header;
    type Limits = Limits;
    type Seen = Seen;
    type Record = RecordId;
    type Event<'a> = Event<'a>;
    const FIRST: RecordId = RecordId::Corners;

    fn wire_limits(limits: &Limits) -> &ivg_wire::Limits {
        &limits.wire
    }

    fn part(record: RecordId) -> Part {
        Part::Record(record.stored())
    }

    fn read_header(input: &[u8], limits: &Limits) -> Result<Step<(Header, ChunkArea)>, Error> {
        Ok(Header::read_with_chunks(input, limits)?.map(|read| (read.header, read.chunks)))
    }

    fn header_event(header: &Header) -> Event<'_> {
        Event::Header(header)
    }

    fn check_chunk(header: &Header, chunk: &Chunk<'_>, seen: &mut Seen) -> Result<(), Error> {
        match chunk.kind {
            LIGHTS => {
                once(chunk, &mut seen.lights)?;
                metadata::lights(chunk).map(drop)
            }
            METADATA => {
                once(chunk, &mut seen.metadata)?;
                metadata::metadata(chunk).map(drop)
            }
            // The one of the order explicit has been read with the header.
            DIRECTORY => {
                let again = header.order == Order::Explicit;
                let code = if again { codes::CHUNK_REPEATED } else { ours::DIRECTORY_FORBIDDEN };
                Err(Error::new(code, chunk.offset, Part::Chunk(DIRECTORY)))
            }
            _ => chunk.skip_unknown(),
        }
    }

    fn chunk_event(chunk: Chunk<'_>) -> Event<'_> {
        Event::Chunk(chunk)
    }

    fn read_record<'a>(
        header: &'a Header,
        record: RecordId,
        input: &'a [u8],
        offset: ByteOffset,
    ) -> Result<Step<Event<'a>>, Error> {
        read_event(header, record, input, offset)
    }

    fn next_record(header: &Header, record: RecordId) -> Option<RecordId> {
        header.next_record(record)
    }
}

/// Reads and checks one record, which begins `input`.
fn read_event<'a>(
    header: &'a Header,
    id: RecordId,
    input: &'a [u8],
    offset: ByteOffset,
) -> Result<Step<Event<'a>>, Error> {
    if id == RecordId::End {
        return Ok(read_end(input, offset, header.file_bytes, header.content_id)?.map(|()| Event::End));
    }
    let step = read_record(input, offset, id.stored(), header.payload_len(id), header.content_id)?;
    let (used, record) = match step {
        Step::NeedMore(more) => return Ok(Step::NeedMore(more)),
        Step::Consumed(used, record) => (used, record),
    };
    let Record { generation, payload, .. } = record;
    let at = record.payload_offset();
    let event = match id {
        RecordId::Validity(j) => Event::Validity(ValidityBlock::check(header, j, generation, payload, at)?),
        RecordId::Corners => Event::Corners(Bundle::check(header, id, generation, payload, at)?),
        _ => Event::Bundle(Bundle::check(header, id, generation, payload, at)?),
    };
    Ok(Step::Consumed(used, event))
}

/// Reads one record that was fetched alone: `bytes` are those of [`Header::record_range`] (COM-REC-06).
///
/// # Errors
///
/// As [`Decoder::push`]; truncated if bytes are missing, malformed if there are more, or if the file has no
/// such record.
pub fn decode_record<'a>(header: &'a Header, id: RecordId, bytes: &'a [u8]) -> Result<Event<'a>, Error> {
    let range = header.record_range(id);
    let part = Part::Record(id.stored());
    let offset = ByteOffset(range.start);
    if range.is_empty() {
        return Err(Error::new(codes::RECORD_ID, offset, part));
    }
    fetched_alone(read_event(header, id, bytes, offset)?, &range, bytes.len(), part)
}

/// Reads a whole file: every event in order, and nothing after the end record.
///
/// # Errors
///
/// As [`Decoder::push`]; truncated if the file ends too early, malformed if it goes on after the end record; what `visit`
/// refuses. Events before the error have been seen by `visit`.
pub fn decode_all<A: Answer>(
    bytes: &[u8],
    limits: &Limits,
    visit: impl FnMut(Event<'_>) -> A,
) -> Result<(), A::Error> {
    ivg_wire::decode_all::<Ivg, A>(bytes, *limits, visit)
}
