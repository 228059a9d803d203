//! Reading: the push decoder, and everything else as a loop over it.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use ivg_wire::{
    Answer, ByteOffset, Chunk, ChunkArea, Error, Format, Part, Step, codes, fetched_alone, once, read_end,
    read_record,
};

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
pub type Decoder = ivg_wire::Decoder<Pmesh>;

/// A decoder that owns the buffer: takes the bytes of a file in pieces of any size, as a network delivers them.
///
/// It holds at most the bytes of one header, chunk or packet besides the piece just given.
///
/// ```
/// # use pmesh_format::{BufferedDecoder, EncodeOptions, Error, Limits, ProgressiveMesh, Replay, Wedges, encode};
/// # let mesh = ProgressiveMesh {
/// #     positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
/// #     wedges: Wedges { vertices: vec![0, 1, 2], ..Wedges::default() },
/// #     base_vertices: 3,
/// #     faces: vec![[0, 1, 2]],
/// #     ..ProgressiveMesh::default()
/// # };
/// # let file = encode(&mesh, &EncodeOptions::default()).unwrap();
/// let mut decoder = BufferedDecoder::new(Limits::default());
/// let mut replay = Replay::default();
/// for piece in file.chunks(100) {
///     decoder.feed(piece, |event| replay.accept(&event).map(drop))?;
///     // All levels so far can be shown, from the first packet on.
/// }
/// decoder.finish()?;
/// # Ok::<(), Error>(())
/// ```
pub type BufferedDecoder = ivg_wire::BufferedDecoder<Pmesh>;

/// The .pmesh format, as the decoders of `ivg_wire` know it.
#[derive(Clone, Copy, Debug)]
pub enum Pmesh {}

impl Format for Pmesh {
    type Header = Header;
    type Limits = Limits;
    /// Whether the names of materials have appeared.
    type Seen = bool;
    /// Index of the packet; the number of packets for the end record.
    type Record = u32;
    type Event<'a> = Event<'a>;
    const FIRST: u32 = 0;

    fn wire_limits(limits: &Limits) -> &ivg_wire::Limits {
        &limits.wire
    }

    fn part(record: u32) -> Part {
        Part::Record(record)
    }

    fn read_header(input: &[u8], limits: &Limits) -> Result<Step<(Header, ChunkArea)>, Error> {
        Header::read_both(input, limits)
    }

    fn header_event(header: &Header) -> Event<'_> {
        Event::Header(header)
    }

    fn check_chunk(_: &Header, chunk: &Chunk<'_>, materials_seen: &mut bool) -> Result<(), Error> {
        match chunk.kind {
            DIRECTORY => Err(Error::new(codes::CHUNK_REPEATED, chunk.offset, Part::Chunk(DIRECTORY))),
            MATERIALS => {
                once(chunk, materials_seen)?;
                material_names(chunk).map(drop)
            }
            _ => chunk.skip_unknown(),
        }
    }

    fn chunk_event(chunk: Chunk<'_>) -> Event<'_> {
        Event::Chunk(chunk)
    }

    fn read_record<'a>(
        header: &'a Header,
        record: u32,
        input: &'a [u8],
        offset: ByteOffset,
    ) -> Result<Step<Event<'a>>, Error> {
        if record < header.packet_count() {
            return Ok(read_packet(header, record, input)?.map(Event::Packet));
        }
        Ok(read_end(input, offset, header.file_bytes, header.content_id)?.map(|()| Event::End))
    }

    fn next_record(header: &Header, record: u32) -> Option<u32> {
        (record < header.packet_count()).then(|| record.saturating_add(1))
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
    fetched_alone(read_packet(header, k, bytes)?, &range, bytes.len(), Part::Record(k))
}

/// Reads a whole file: every event in order, and nothing after the end record. What packets say is not checked; see
/// [`check`].
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
    ivg_wire::decode_all::<Pmesh, A>(bytes, *limits, visit)
}

/// Checks a whole file: everything that the specification demands of it.
///
/// # Errors
///
/// The first rule that it breaks; truncated if it is valid as far as it goes.
pub fn check(bytes: &[u8], limits: &Limits) -> Result<(), Error> {
    Replay::from_file(bytes, limits).map(drop)
}

#[cfg(test)]
mod tests;
