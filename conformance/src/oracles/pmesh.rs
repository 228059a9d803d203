//! What must hold of the reader of `.pmesh` for any bytes.

use super::stream::{End, Seen, Transcript, transcribe};
use super::{digest, pieces, slice};
use crate::bounds::{Bound, Budget};
use crate::reference::{Fault, Reference};
use ivg_wire::{Error, Part, Verdict};
use pmesh_format::{
    Decoder, Event, Header, LevelChange, Limits, Mode, Packet, Replay, Step, check, check_level, decode_all,
    decode_packet,
};

/// The decoder alone keeps the packet directory, once (COM-LIM-03).
const DECODER: Budget = Budget { held: MEMORY, allocated: MEMORY };
const MEMORY: Bound = Bound { fixed: 65_536, per_byte: 4 };

/// The replay keeps for each byte of file at most 8/3 bytes (a face of 12 bytes: its corners, their places in the lists of
/// slots, and up to two marks that it has changed, 32 bytes in all); a growing array holds at most three times that while it
/// moves, and what a packet reports beside it is no longer. What it allocates in all is dominated by these reports: a switch
/// code of one bit may mark a face, 4 bytes, and report it, 8 bytes, in arrays that grow by doubling.
const REPLAY: Budget = Budget {
    held: Bound { fixed: 65_536, per_byte: 12 },
    allocated: Bound { fixed: 65_536, per_byte: 4 * 8 * (4 + 8) },
};

/// A coded packet has at least a byte for four vertices and faces (PMESH-COD-12). A vertex takes less than 150 bytes in replay and
/// coder together, with the places for its slots, a face less than 50; growing arrays hold three times that while they move. The
/// models are there twice while a packet is read. Each byte may make a reader look at 64 slots, of which each may be a face to
/// report, as above.
const CODED: Budget = Budget {
    held: Bound { fixed: 3 * 65_536, per_byte: 600 },
    allocated: Bound { fixed: 3 * 65_536, per_byte: 4 * 64 * (4 + 8) },
};

/// The models are copied for every packet, so that one that is refused leaves no trace.
const MODELS: u64 = 32_768;

/// The budget of the replay for a file.
fn budget(data: &[u8], limits: &Limits) -> Budget {
    match Header::read(data, limits) {
        Ok(Step::Consumed(_, header)) if header.mode == Mode::Coded => {
            let models = MODELS * u64::from(header.packet_count());
            let Bound { fixed, per_byte } = CODED.allocated;
            Budget { allocated: Bound { fixed: fixed + models, per_byte }, ..CODED }
        }
        _ => REPLAY,
    }
}

/// What a caller sees who has all the bytes at once and replays them.
#[must_use]
pub fn read(data: &[u8]) -> Transcript {
    read_in_pieces(data, [])
}

/// What a caller sees who gets the bytes in pieces of these lengths and replays them.
#[must_use]
pub fn read_in_pieces(data: &[u8], pieces: impl IntoIterator<Item = usize>) -> Transcript {
    let mut decoder = Decoder::new(Limits::default());
    let mut replay = Replay::default();
    let mut failed = None;
    transcribe(data, pieces, |window| {
        if let Some(error) = failed {
            return Err(error);
        }
        let step = match decoder.push(window)? {
            Step::NeedMore(more) => Step::NeedMore(more),
            Step::Consumed(used, event) => {
                let change = replay.accept(&event).inspect_err(|&error| failed = Some(error))?;
                Step::Consumed(used, see(&event, change.as_ref()))
            }
        };
        Ok(step)
    })
}

fn see(event: &Event<'_>, change: Option<&LevelChange>) -> Seen {
    let (digest, is_record) = match event {
        Event::Header(header) => (digest(("header", format!("{header:?}"))), false),
        Event::Chunk(chunk) => {
            (digest(("chunk", chunk.kind, chunk.critical, chunk.offset, chunk.payload)), false)
        }
        Event::Packet(packet) => (digest((see_packet(packet), format!("{change:?}"))), true),
        Event::End => (digest("end"), false),
        other => panic!("an event that this oracle does not know: {other:?}"),
    };
    Seen { digest, is_record, is_end: *event == Event::End }
}

fn see_packet(packet: &Packet<'_>) -> u64 {
    let arrays = [
        packet.position_bytes(),
        packet.normal_bytes(),
        packet.uv_bytes(),
        packet.colour_bytes(),
        packet.corner_bytes(),
        packet.parent_bytes(),
        packet.material_bytes(),
    ];
    digest((packet.index(), format!("{:?}", packet.entry()), packet.payload(), arrays))
}

/// Vertices times faces and wedges, at most, for the second reader, which goes through all of them for each vertex.
const MOST_FOR_REFERENCE: u64 = 1 << 18;

/// A fuzzer shows the second reader one input in so many: it takes longer than everything else together, and `pmesh_vs_c` compares with
/// a fast one.
const SHOWN_TO_REFERENCE: u8 = 8;

/// A fuzzer has one input in so many read packet by packet as well: that reads everything twice more.
const READ_ALONE: u8 = 4;

/// Whether an input is among the one in so many that a fuzzer shows to something slow: its bytes choose. Outside of a fuzzer, all are.
fn is_chosen(data: &[u8], one_in: u8) -> bool {
    !cfg!(fuzzing) || data.iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte)).is_multiple_of(one_in)
}

/// The second reader of a file's packets; `None` if they would keep it busy for long.
pub(super) fn reference<'a>(header: &'a Header, data: &[u8]) -> Option<Reference<'a>> {
    let things = u64::from(header.face_count) + u64::from(header.wedge_count);
    (is_chosen(data, SHOWN_TO_REFERENCE) && u64::from(header.vertex_count) * things <= MOST_FOR_REFERENCE)
        .then(|| Reference::new(header))
}

/// Any bytes give events and a verdict, within the bounds on memory. Each packet, read alone by its range, is that of the
/// stream, and what a second reader makes of it. What has been accepted is a valid mesh at its level.
///
/// # Panics
///
/// When that does not hold.
pub fn pmesh_decode(data: &[u8]) {
    let limits = Limits::default();
    let bare = DECODER.spend("decoding .pmesh", data.len(), || decode_all(data, &limits, |_| {}));
    let checked = budget(data, &limits).spend("replaying .pmesh", data.len(), || check(data, &limits));
    if !is_chosen(data, READ_ALONE) {
        return;
    }
    let transcript = read(data);
    match (checked, transcript.end) {
        (Ok(()), End::Complete) => assert_eq!(bare, Ok(())),
        (Err(error), End::NeedMore) => assert_eq!((bare, error.verdict()), (Err(error), Verdict::NeedMore)),
        (Err(error), End::Refused(streamed)) => assert_eq!(error, streamed),
        (checked, end) => panic!("at once {checked:?}, in a stream {end:?}"),
    }
    if let Ok(Step::Consumed(_, header)) = Header::read(data, &limits) {
        packets_alone(data, &header, &transcript);
    }
}

/// Reads each whole packet by its range and replays it; compares with what the stream said, and with what the second reader says.
fn packets_alone(data: &[u8], header: &Header, transcript: &Transcript) {
    let mut replay = Replay::new(header);
    let mut reference = reference(header, data);
    let mut end = header.data_offset;
    for k in 0..header.packet_count() {
        let range = header.packet_range(k);
        assert_eq!(range.start, end, "packet {k} does not begin where the one before ends");
        end = range.end;
        let Some(bytes) = slice(data, range.start, range.end) else { return };
        let packet = decode_packet(header, k, bytes);
        let judged = match (&packet, &mut reference) {
            (Ok(packet), Some(reference)) => Some(reference.take(packet.payload())),
            _ => None,
        };
        let alone: Result<LevelChange, Error> = packet.and_then(|packet| replay.apply(&packet));
        if let Some(judged) = judged {
            let found = alone.as_ref().map(drop).map_err(|error| Fault {
                code: error.code(),
                at: (error.offset().0 - range.start - RECORD_HEAD) as usize,
            });
            assert_eq!(judged, found, "packet {k}: the second reader judges otherwise");
        }
        match (alone, transcript.end) {
            (Ok(_), _) if (k as usize) < transcript.records => {
                let mesh = replay.mesh();
                check_level(&mesh).unwrap_or_else(|fault| panic!("after packet {k}: {fault}"));
                assert_eq!(mesh.positions.len() as u32, header.packets[k as usize].vertices.end);
                if let Some(reference) = &reference {
                    assert_eq!(reference.level(replay.level()), Some(mesh), "after packet {k}");
                }
            }
            // Chunks between header and packets may be refused; whoever fetches packets alone does not read them.
            (_, End::Refused(error))
                if !matches!(error.part(), Part::Record(_)) && transcript.records == 0 =>
            {
                return;
            }
            (Err(alone), End::Refused(streamed)) if k as usize == transcript.records => {
                assert_eq!(alone, streamed, "packet {k} is refused otherwise in the stream");
                return;
            }
            (alone, end) => panic!("packet {k}: alone {alone:?}, the stream ended with {end:?}"),
        }
    }
    assert_eq!(header.end_range(), end..header.file_bytes, "the end record does not end the file");
}

/// Bytes of a record before its payload.
const RECORD_HEAD: u64 = 8;

/// Any split of the bytes gives the same events, the same error, the same offset.
///
/// # Panics
///
/// When that does not hold.
pub fn pmesh_chunks(data: &[u8]) {
    assert_eq!(read_in_pieces(data, pieces(data)), read(data));
}
