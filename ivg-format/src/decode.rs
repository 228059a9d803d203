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
use alloc::vec::Vec;
use ivg_wire::{
    ByteOffset, Chunk, ChunkArea, ChunkKind, Error, Part, Record, Step, codes, read_end, read_record,
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
#[derive(Clone, Debug)]
pub struct Decoder {
    limits: Limits,
    header: Option<Header>,
    state: State,
    offset: u64,
}

#[derive(Clone, Copy, Debug)]
enum State {
    Header,
    Chunks(ChunkArea, Seen),
    Record(RecordId),
    Ended,
    Failed(Error),
}

/// Which of the chunks that may appear once have appeared.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    lights: bool,
    metadata: bool,
}

impl Decoder {
    /// A decoder that accepts files within `limits`.
    #[must_use]
    pub const fn new(limits: Limits) -> Self {
        Self { limits, header: None, state: State::Header, offset: 0 }
    }

    /// The header, once it has been read.
    #[must_use]
    pub const fn header(&self) -> Option<&Header> {
        self.header.as_ref()
    }

    /// How many bytes have been consumed: where in the file the next input must begin.
    #[must_use]
    pub const fn offset(&self) -> ByteOffset {
        ByteOffset(self.offset)
    }

    /// Whether the end record has been read.
    #[must_use]
    pub const fn is_finished(&self) -> bool {
        matches!(self.state, State::Ended)
    }

    /// Reads the next event from the bytes at [`Decoder::offset`].
    ///
    /// After the end record, empty input is answered with `NeedMore(0)` and any other with an error, since a
    /// file ends there; who reads a file inside a longer stream stops at [`Event::End`].
    ///
    /// # Errors
    ///
    /// What is wrong with the file, see [`Error`]; the same error again for every call after the first. The
    /// error does not depend on how the bytes were split.
    pub fn push<'a>(&'a mut self, input: &'a [u8]) -> Result<Step<Event<'a>>, Error> {
        let Self { limits, header, state, offset } = self;
        match advance(limits, header, state, *offset, input) {
            Ok(Step::Consumed(used, event)) => {
                *offset = offset.saturating_add(used as u64);
                Ok(Step::Consumed(used, event))
            }
            Ok(Step::NeedMore(more)) => Ok(Step::NeedMore(more)),
            Err(error) => {
                *state = State::Failed(error);
                Err(error)
            }
        }
    }

    /// The error of an input that ends here, although the file does not.
    fn truncated(&self, rest: usize) -> Error {
        let part = match self.state {
            State::Header => Part::Header,
            State::Chunks(..) => Part::Chunks,
            State::Record(id) => Part::Record(id.stored()),
            State::Ended => Part::AfterEnd,
            State::Failed(error) => return error,
        };
        Error::truncated(ByteOffset(self.offset.saturating_add(rest as u64)), part)
    }
}

fn advance<'a>(
    limits: &Limits,
    header: &'a mut Option<Header>,
    state: &mut State,
    offset: u64,
    input: &'a [u8],
) -> Result<Step<Event<'a>>, Error> {
    match (*state, header) {
        (State::Failed(error), _) => Err(error),
        (State::Chunks(mut area, mut seen), header) => {
            let step = area.read(input, &limits.wire)?;
            if let Step::Consumed(_, chunk) = &step {
                check_chunk(chunk, &mut seen, header.as_ref())?;
                *state = after_chunk(area, seen);
            }
            Ok(step.map(Event::Chunk))
        }
        (State::Record(id), Some(header)) => {
            let step = read_event(header, id, input, ByteOffset(offset))?;
            if let Step::Consumed(..) = step {
                *state = header.next_record(id).map_or(State::Ended, State::Record);
            }
            Ok(step)
        }
        (State::Ended, _) if input.is_empty() => Ok(Step::NeedMore(0)),
        (State::Ended, _) => Err(Error::new(codes::TRAILING_BYTES, ByteOffset(offset), Part::AfterEnd)),
        // A record is never expected before there is a header.
        (State::Header | State::Record(_), place) => {
            Ok(Header::read_with_chunks(input, limits)?.map(|read| {
                *state = after_chunk(read.chunks, Seen::default());
                Event::Header(place.insert(read.header))
            }))
        }
    }
}

fn after_chunk(area: ChunkArea, seen: Seen) -> State {
    if area.is_done() { State::Record(RecordId::Corners) } else { State::Chunks(area, seen) }
}

fn check_chunk(chunk: &Chunk<'_>, seen: &mut Seen, header: Option<&Header>) -> Result<(), Error> {
    let once = |kind: ChunkKind, seen: &mut bool| {
        if core::mem::replace(seen, true) {
            return Err(Error::new(codes::CHUNK_REPEATED, chunk.offset, Part::Chunk(kind)));
        }
        Ok(())
    };
    match chunk.kind {
        LIGHTS => {
            once(LIGHTS, &mut seen.lights)?;
            metadata::lights(chunk).map(drop)
        }
        METADATA => {
            once(METADATA, &mut seen.metadata)?;
            metadata::metadata(chunk).map(drop)
        }
        // The one of the order explicit has been read with the header.
        DIRECTORY => {
            let again = header.is_some_and(|header| header.order == Order::Explicit);
            let code = if again { codes::CHUNK_REPEATED } else { ours::DIRECTORY_FORBIDDEN };
            Err(Error::new(code, chunk.offset, Part::Chunk(DIRECTORY)))
        }
        _ => chunk.skip_unknown(),
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
    match read_event(header, id, bytes, offset)? {
        Step::NeedMore(_) => {
            Err(Error::truncated(ByteOffset(range.start.saturating_add(bytes.len() as u64)), part))
        }
        Step::Consumed(used, _) if used < bytes.len() => {
            Err(Error::new(codes::RECORD_LENGTH, ByteOffset(range.end), part))
        }
        Step::Consumed(_, event) => Ok(event),
    }
}

/// Reads a whole file: every event in order, and nothing after the end record.
///
/// # Errors
///
/// As [`Decoder::push`]; truncated if the file ends too early, malformed if it goes on after the end record.
/// Events before the error have been seen by `visit`.
pub fn decode_all(bytes: &[u8], limits: &Limits, visit: impl FnMut(Event<'_>)) -> Result<(), Error> {
    let mut decoder = Decoder::new(*limits);
    let used = read_all(&mut decoder, bytes, visit)?;
    if decoder.is_finished() { Ok(()) } else { Err(decoder.truncated(bytes.len().saturating_sub(used))) }
}

/// Reads events as long as `input` has whole ones; says how many bytes they were.
fn read_all(decoder: &mut Decoder, input: &[u8], mut visit: impl FnMut(Event<'_>)) -> Result<usize, Error> {
    let mut used = 0usize;
    while let Step::Consumed(more, event) = decoder.push(input.get(used..).unwrap_or(&[]))? {
        visit(event);
        used = used.saturating_add(more);
    }
    Ok(used)
}

/// A decoder that owns the buffer: takes the bytes of a file in pieces of any size, as a network delivers them.
///
/// It holds at most the bytes of one header, chunk or record besides the piece just given.
#[derive(Clone, Debug)]
pub struct BufferedDecoder {
    decoder: Decoder,
    buffer: Vec<u8>,
}

impl BufferedDecoder {
    /// A decoder that accepts files within `limits`.
    #[must_use]
    pub const fn new(limits: Limits) -> Self {
        Self { decoder: Decoder::new(limits), buffer: Vec::new() }
    }

    /// The header, once it has been read.
    #[must_use]
    pub const fn header(&self) -> Option<&Header> {
        self.decoder.header()
    }

    /// Whether the end record has been read.
    #[must_use]
    pub const fn is_finished(&self) -> bool {
        self.decoder.is_finished()
    }

    /// Takes the next piece and shows `visit` every event that it completes.
    ///
    /// # Errors
    ///
    /// As [`Decoder::push`], trailing bytes included.
    pub fn feed(&mut self, piece: &[u8], visit: impl FnMut(Event<'_>)) -> Result<(), Error> {
        // Events are read straight from the piece while nothing is waiting; only what is left is copied.
        if self.buffer.is_empty() {
            let used = read_all(&mut self.decoder, piece, visit)?;
            self.buffer.extend_from_slice(piece.get(used..).unwrap_or(&[]));
        } else {
            self.buffer.extend_from_slice(piece);
            let used = read_all(&mut self.decoder, &self.buffer, visit)?;
            self.buffer.drain(..used);
        }
        Ok(())
    }

    /// Says that there are no more pieces.
    ///
    /// # Errors
    ///
    /// Truncated if the end record has not been read; or the error that [`BufferedDecoder::feed`] returned.
    pub fn finish(&self) -> Result<(), Error> {
        if self.is_finished() { Ok(()) } else { Err(self.decoder.truncated(self.buffer.len())) }
    }
}
