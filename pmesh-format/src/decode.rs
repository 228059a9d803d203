//! Reading: the push decoder, and everything else as a loop over it.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use alloc::vec::Vec;

use ivg_wire::{ByteOffset, Chunk, ChunkArea, Error, Part, Step, codes, read_end, read_record};

use crate::code::codes as mesh_codes;
use crate::header::Header;
use crate::limits::Limits;
use crate::material::material_names;
use crate::packet::Packet;
use crate::replay::Replay;
use crate::wire::{DIRECTORY, MATERIALS};

/// What a decoder found. Payloads are windows into the caller's bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Event<'a> {
    /// The header with the packet directory, checked.
    Header(&'a Header),
    /// A chunk after the directory: `MTRL` checked, others as they are.
    Chunk(Chunk<'a>),
    /// A packet. Its checksum fits; what it says is checked by [`Replay`].
    Packet(Packet<'a>),
    /// The end record: the file is whole.
    End,
}

/// A push decoder of one file, from its first byte on. It keeps no bytes but the directory: the caller owns the buffer.
///
/// ```
/// # use pmesh_format::{Decoder, EncodeOptions, Event, Limits, ProgressiveMesh, Replay, Wedges, encode};
/// # use ivg_wire::Step;
/// # let mesh = ProgressiveMesh {
/// #     positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
/// #     wedges: Wedges { vertices: vec![0, 1, 2], ..Wedges::default() },
/// #     base_vertices: 3,
/// #     faces: vec![[0, 1, 2]],
/// #     ..ProgressiveMesh::default()
/// # };
/// # let file = encode(&mesh, &EncodeOptions::default())?;
/// let mut decoder = Decoder::new(Limits::default());
/// let mut replay = Replay::default();
/// let mut rest = &file[..];
/// loop {
///     match decoder.push(rest)? {
///         Step::NeedMore(bytes) => panic!("{bytes} more bytes, please"),
///         Step::Consumed(used, event) => {
///             rest = &rest[used..];
///             replay.accept(&event)?;
///             if event == Event::End {
///                 break;
///             }
///         }
///     }
/// }
/// assert_eq!(replay.indices(), [[0, 1, 2]]);
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
    Chunks { area: ChunkArea, materials_seen: bool },
    Packet(u32),
    Ended,
    Failed(Error),
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
    /// After the end record, empty input is answered with `NeedMore(0)` and any other with an error, since a file ends
    /// there; who reads a file inside a longer stream stops at [`Event::End`].
    ///
    /// # Errors
    ///
    /// What is wrong with the file, see [`Error`]; the same error again for every call after the first. The error does not
    /// depend on how the bytes were split.
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
            State::Chunks { .. } => Part::Chunks,
            State::Packet(k) => Part::Record(k),
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
        (State::Chunks { mut area, mut materials_seen }, _) => {
            let step = area.read(input, &limits.wire)?;
            if let Step::Consumed(_, chunk) = &step {
                check_chunk(chunk, &mut materials_seen)?;
                *state = after_chunk(area, materials_seen);
            }
            Ok(step.map(Event::Chunk))
        }
        (State::Packet(k), Some(header)) => {
            if k < header.packet_count() {
                let step = read_packet(header, k, input)?;
                if let Step::Consumed(..) = step {
                    *state = State::Packet(k.saturating_add(1));
                }
                return Ok(step.map(Event::Packet));
            }
            let step = read_end(input, ByteOffset(offset), header.file_bytes, header.content_id)?;
            if let Step::Consumed(..) = step {
                *state = State::Ended;
            }
            Ok(step.map(|()| Event::End))
        }
        (State::Ended, _) if input.is_empty() => Ok(Step::NeedMore(0)),
        (State::Ended, _) => Err(Error::new(codes::TRAILING_BYTES, ByteOffset(offset), Part::AfterEnd)),
        // A packet is never expected before there is a header.
        (State::Header | State::Packet(_), place) => {
            Ok(Header::read_both(input, limits)?.map(|(read, area)| {
                *state = after_chunk(area, false);
                Event::Header(place.insert(read))
            }))
        }
    }
}

fn after_chunk(area: ChunkArea, materials_seen: bool) -> State {
    if area.is_done() { State::Packet(0) } else { State::Chunks { area, materials_seen } }
}

fn check_chunk(chunk: &Chunk<'_>, materials_seen: &mut bool) -> Result<(), Error> {
    let repeated = Error::new(codes::CHUNK_REPEATED, chunk.offset, Part::Chunk(chunk.kind));
    match chunk.kind {
        DIRECTORY => Err(repeated),
        MATERIALS if core::mem::replace(materials_seen, true) => Err(repeated),
        MATERIALS => material_names(chunk).map(drop),
        _ => chunk.skip_unknown(),
    }
}

/// Reads the record of packet `k`, which begins `input`.
fn read_packet<'a>(header: &'a Header, k: u32, input: &'a [u8]) -> Result<Step<Packet<'a>>, Error> {
    let Some(entry) = header.packets.get(k as usize) else {
        return Err(Error::new(mesh_codes::PACKET_ORDER, ByteOffset(header.data_offset), Part::Record(k)));
    };
    let offset = ByteOffset(entry.bytes.start);
    let step = read_record(input, offset, k, u64::from(entry.payload_bytes), header.content_id)?;
    match step {
        Step::NeedMore(more) => Ok(Step::NeedMore(more)),
        // A packet is never replaced by another one: all later ones would have to be as well.
        Step::Consumed(_, record) if record.generation != 0 => {
            let generation = ByteOffset(offset.0.saturating_add(4));
            Err(Error::new(codes::RESERVED, generation, Part::Record(k)))
        }
        Step::Consumed(used, record) => {
            let packet = Packet::new(header, entry, k, record.payload, record.payload_offset());
            Ok(Step::Consumed(used, packet))
        }
    }
}

/// Reads one packet that was fetched alone: `bytes` are those of [`Header::packet_range`] (COM-REC-06).
///
/// # Errors
///
/// As [`Decoder::push`]; truncated if bytes are missing, malformed if there are more, or if the file has no such packet.
pub fn decode_packet<'a>(header: &'a Header, k: u32, bytes: &'a [u8]) -> Result<Packet<'a>, Error> {
    let range = header.packet_range(k);
    match read_packet(header, k, bytes)? {
        Step::NeedMore(_) => {
            let end = ByteOffset(range.start.saturating_add(bytes.len() as u64));
            Err(Error::truncated(end, Part::Record(k)))
        }
        Step::Consumed(used, _) if used < bytes.len() => {
            Err(Error::new(codes::RECORD_LENGTH, ByteOffset(range.end), Part::Record(k)))
        }
        Step::Consumed(_, packet) => Ok(packet),
    }
}

/// Reads a whole file: every event in order, and nothing after the end record. What packets say is not checked; see
/// [`check`].
///
/// # Errors
///
/// As [`Decoder::push`]; truncated if the file ends too early, malformed if it goes on after the end record. Events before
/// the error have been seen by `visit`.
pub fn decode_all(bytes: &[u8], limits: &Limits, mut visit: impl FnMut(Event<'_>)) -> Result<(), Error> {
    let mut decoder = Decoder::new(*limits);
    let used = read_all(&mut decoder, bytes, |event| {
        visit(event);
        Ok(())
    })?;
    if decoder.is_finished() { Ok(()) } else { Err(decoder.truncated(bytes.len().saturating_sub(used))) }
}

/// Checks a whole file: everything that the specification demands of it.
///
/// # Errors
///
/// The first rule that it breaks; truncated if it is valid as far as it goes.
pub fn check(bytes: &[u8], limits: &Limits) -> Result<(), Error> {
    let mut decoder = Decoder::new(*limits);
    let mut replay = Replay::default();
    let used = read_all(&mut decoder, bytes, |event| replay.accept(&event).map(drop))?;
    if decoder.is_finished() { Ok(()) } else { Err(decoder.truncated(bytes.len().saturating_sub(used))) }
}

/// Reads events as long as `input` has whole ones; says how many bytes they were.
fn read_all(
    decoder: &mut Decoder,
    input: &[u8],
    mut visit: impl FnMut(Event<'_>) -> Result<(), Error>,
) -> Result<usize, Error> {
    let mut used = 0usize;
    while let Step::Consumed(more, event) = decoder.push(input.get(used..).unwrap_or(&[]))? {
        visit(event)?;
        used = used.saturating_add(more);
    }
    Ok(used)
}

/// A decoder that owns the buffer: takes the bytes of a file in pieces of any size, as a network delivers them.
///
/// It holds at most the bytes of one header, chunk or packet besides the piece just given.
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
    pub fn feed(&mut self, piece: &[u8], mut visit: impl FnMut(Event<'_>)) -> Result<(), Error> {
        let visit = |event: Event<'_>| {
            visit(event);
            Ok(())
        };
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

#[cfg(test)]
mod tests;
