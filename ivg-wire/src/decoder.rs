//! The push decoder that all our formats share: header, chunks, records, end; a format says what each of them means.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use core::fmt::Debug;
use core::mem;

use crate::chunk::{Chunk, ChunkArea};
use crate::code::codes;
use crate::error::{ByteOffset, Error, Part};
use crate::limits;
use crate::step::Step;

/// What a format has to say so that [`Decoder`] can read its files.
///
/// Implemented by the format crates for an empty type each, which name their decoders by it.
pub trait Format {
    /// The checked header, with whatever must be known before the first record.
    type Header: Clone + Debug;
    /// What a caller is willing to spend on one file.
    type Limits: Copy + Debug;
    /// Which of the chunks that may appear once have appeared.
    type Seen: Copy + Debug + Default;
    /// Names a record, the end record included.
    type Record: Copy + Debug;
    /// What was found: windows into the caller's bytes.
    type Event<'a>;
    /// The record behind the chunks.
    const FIRST: Self::Record;

    /// The limits that all formats share.
    fn wire_limits(limits: &Self::Limits) -> &limits::Limits;

    /// The part of the file that an input lies in which ends inside `record`.
    fn part(record: Self::Record) -> Part;

    /// Reads the header, which begins `input`, and says which chunks follow.
    ///
    /// # Errors
    ///
    /// What is wrong with the header, or more than `limits` allow.
    fn read_header(input: &[u8], limits: &Self::Limits) -> Result<Step<(Self::Header, ChunkArea)>, Error>;

    /// The event of the header.
    fn header_event(header: &Self::Header) -> Self::Event<'_>;

    /// Checks a chunk whose checksum fits.
    ///
    /// # Errors
    ///
    /// What is wrong with it; it has been seen before and may not be repeated; it is critical and unknown.
    fn check_chunk(header: &Self::Header, chunk: &Chunk<'_>, seen: &mut Self::Seen) -> Result<(), Error>;

    /// The event of a chunk that has been checked.
    fn chunk_event(chunk: Chunk<'_>) -> Self::Event<'_>;

    /// Reads `record`, which begins `input` and lies at `offset`.
    ///
    /// # Errors
    ///
    /// What is wrong with it.
    fn read_record<'a>(
        header: &'a Self::Header,
        record: Self::Record,
        input: &'a [u8],
        offset: ByteOffset,
    ) -> Result<Step<Self::Event<'a>>, Error>;

    /// The record after `record`; `None` after the end record.
    fn next_record(header: &Self::Header, record: Self::Record) -> Option<Self::Record>;
}

/// A push decoder of one file, from its first byte on. It keeps no bytes: the caller owns the buffer.
#[derive(Clone, Debug)]
pub struct Decoder<F: Format> {
    limits: F::Limits,
    header: Option<F::Header>,
    state: State<F::Seen, F::Record>,
    offset: u64,
}

#[derive(Clone, Copy, Debug)]
enum State<S, R> {
    Header,
    Chunks(ChunkArea, S),
    Record(R),
    Ended,
    Failed(Error),
}

impl<F: Format> Decoder<F> {
    /// A decoder that accepts files within `limits`.
    #[must_use]
    pub const fn new(limits: F::Limits) -> Self {
        Self { limits, header: None, state: State::Header, offset: 0 }
    }

    /// The header, once it has been read.
    #[must_use]
    pub const fn header(&self) -> Option<&F::Header> {
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
    /// After the end record, empty input is answered with `NeedMore(0)` and any other with an error, since a file ends
    /// there; who reads a file inside a longer stream stops at the event of the end.
    ///
    /// # Errors
    ///
    /// What is wrong with the file, see [`Error`]; the same error again for every call after the first. The error does not
    /// depend on how the bytes were split.
    pub fn push<'a>(&'a mut self, input: &'a [u8]) -> Result<Step<F::Event<'a>>, Error> {
        let Self { limits, header, state, offset } = self;
        match advance::<F>(limits, header, state, *offset, input) {
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

    /// Says that the file ends here, `rest` bytes after [`Decoder::offset`].
    ///
    /// # Errors
    ///
    /// Truncated if the end record has not been read; or the error that [`Decoder::push`] returned.
    pub fn finish(&self, rest: usize) -> Result<(), Error> {
        let part = match self.state {
            State::Header => Part::Header,
            State::Chunks(..) => Part::Chunks,
            State::Record(record) => F::part(record),
            State::Ended => return Ok(()),
            State::Failed(error) => return Err(error),
        };
        Err(Error::truncated(ByteOffset(self.offset.saturating_add(rest as u64)), part))
    }

    /// Whether [`Decoder::push`] has returned an error.
    pub(crate) const fn has_failed(&self) -> bool {
        matches!(self.state, State::Failed(_))
    }

    /// Reads events as long as `input` has whole ones. Says how many bytes they were, that of a refused one included.
    pub(crate) fn read_all<A: Answer>(
        &mut self,
        input: &[u8],
        visit: &mut impl FnMut(F::Event<'_>) -> A,
    ) -> (usize, Result<(), A::Error>) {
        let mut used = 0usize;
        loop {
            match self.push(input.get(used..).unwrap_or(&[])) {
                Ok(Step::NeedMore(_)) => return (used, Ok(())),
                Ok(Step::Consumed(more, event)) => {
                    used = used.saturating_add(more);
                    if let Err(refused) = visit(event).into_result() {
                        return (used, Err(refused));
                    }
                }
                Err(error) => return (used, Err(error.into())),
            }
        }
    }
}

fn advance<'a, F: Format>(
    limits: &F::Limits,
    header: &'a mut Option<F::Header>,
    state: &mut State<F::Seen, F::Record>,
    offset: u64,
    input: &'a [u8],
) -> Result<Step<F::Event<'a>>, Error> {
    match (*state, header) {
        (State::Failed(error), _) => Err(error),
        (State::Chunks(mut area, mut seen), Some(header)) => {
            let step = area.read(input, F::wire_limits(limits))?;
            if let Step::Consumed(_, chunk) = &step {
                F::check_chunk(header, chunk, &mut seen)?;
                *state = after_chunk::<F>(area, seen);
            }
            Ok(step.map(F::chunk_event))
        }
        (State::Record(record), Some(header)) => {
            let step = F::read_record(header, record, input, ByteOffset(offset))?;
            if let Step::Consumed(..) = step {
                *state = F::next_record(header, record).map_or(State::Ended, State::Record);
            }
            Ok(step)
        }
        (State::Ended, _) if input.is_empty() => Ok(Step::NeedMore(0)),
        (State::Ended, _) => Err(Error::new(codes::TRAILING_BYTES, ByteOffset(offset), Part::AfterEnd)),
        // Chunks and records are never expected before there is a header.
        (State::Header | State::Chunks(..) | State::Record(_), place) => Ok(F::read_header(input, limits)?
            .map(|(read, area)| {
                *state = after_chunk::<F>(area, F::Seen::default());
                F::header_event(place.insert(read))
            })),
    }
}

fn after_chunk<F: Format>(area: ChunkArea, seen: F::Seen) -> State<F::Seen, F::Record> {
    if area.is_done() { State::Record(F::FIRST) } else { State::Chunks(area, seen) }
}

/// Notes that a chunk which may appear once has appeared.
///
/// # Errors
///
/// It had appeared before (COM-CHK-07).
pub fn once(chunk: &Chunk<'_>, seen: &mut bool) -> Result<(), Error> {
    if mem::replace(seen, true) {
        return Err(Error::new(codes::CHUNK_REPEATED, chunk.offset, Part::Chunk(chunk.kind)));
    }
    Ok(())
}

/// What a visitor of events answers: nothing, so that reading goes on, or a result whose error ends it.
///
/// The error is the visitor's own and must hold those of the decoder as well: [`Error`] itself, `Box<dyn Error>`, or an
/// enum with a variant for it.
pub trait Answer {
    /// What reading with such a visitor fails with.
    type Error: From<Error>;

    /// The answer as a result.
    ///
    /// # Errors
    ///
    /// What the visitor refused.
    fn into_result(self) -> Result<(), Self::Error>;
}

impl Answer for () {
    type Error = Error;

    fn into_result(self) -> Result<(), Error> {
        Ok(())
    }
}

impl<E: From<Error>> Answer for Result<(), E> {
    type Error = E;

    fn into_result(self) -> Self {
        self
    }
}

/// Reads a whole file: every event in order, and nothing after the end record.
///
/// # Errors
///
/// As [`Decoder::push`]; truncated if the file ends too early, malformed if it goes on after the end record; what `visit`
/// refuses. Events before the error have been seen by `visit`.
pub fn decode_all<F: Format, A: Answer>(
    bytes: &[u8],
    limits: F::Limits,
    mut visit: impl FnMut(F::Event<'_>) -> A,
) -> Result<(), A::Error> {
    let mut decoder = Decoder::<F>::new(limits);
    let (used, read) = decoder.read_all(bytes, &mut visit);
    read?;
    Ok(decoder.finish(bytes.len().saturating_sub(used))?)
}
