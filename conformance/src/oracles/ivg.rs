//! What must hold of the reader of `.ivg` for any bytes.

use super::stream::{End, Seen, Transcript, transcribe};
use super::{digest, pieces, slice};
use crate::bounds::{Bound, Budget};
use ivg_format::{
    Bundle, Decoder, Event, Header, Limits, Order, RecordId, ValidityBlock, VertexValues, decode_all,
    decode_record,
};
use ivg_wire::{Error, Part, Step, Verdict};

/// The decoder keeps no bytes and needs no tables but the directory of the order `explicit`, of which it holds twice the
/// bytes that it has in the file (spec/ivg.md, IVG-LIM-03), and allocates that once.
const BUDGET: Budget =
    Budget { held: Bound { fixed: SHARED, per_byte: 2 }, allocated: Bound { fixed: SHARED, per_byte: 2 } };

/// Vertices of a bundle that are read while allocations are counted.
const FEW: usize = 4;

/// Bytes of the two counters of shared ownership.
const SHARED: u64 = 16;

/// What a caller sees who has all the bytes at once.
#[must_use]
pub fn read(data: &[u8]) -> Transcript {
    read_in_pieces(data, [])
}

/// What a caller sees who gets the bytes in pieces of these lengths.
#[must_use]
pub fn read_in_pieces(data: &[u8], pieces: impl IntoIterator<Item = usize>) -> Transcript {
    let mut decoder = Decoder::new(Limits::default());
    transcribe(data, pieces, |window| Ok(decoder.push(window)?.map(|event| see(&event))))
}

fn see(event: &Event<'_>) -> Seen {
    let (digest, is_record) = match event {
        Event::Header(header) => (digest(("header", format!("{header:?}"))), false),
        Event::Chunk(chunk) => {
            (digest(("chunk", chunk.kind, chunk.critical, chunk.offset, chunk.payload)), false)
        }
        Event::Corners(bundle) | Event::Bundle(bundle) => (see_bundle(bundle), true),
        Event::Validity(block) => (see_validity(block), true),
        Event::End => (digest("end"), false),
        other => panic!("an event that this oracle does not know: {other:?}"),
    };
    Seen { digest, is_record, is_end: matches!(event, Event::End) }
}

fn see_bundle(bundle: &Bundle<'_>) -> u64 {
    let count = bundle.header().lattice.vertex_count();
    let mut vertices = 0;
    let mut mixed = Mixed::default();
    for (vertex, values) in bundle.iter() {
        assert!(vertex < count, "a vertex outside the lattice");
        let numbers = numbers(&values);
        let finite = numbers.iter().fold(true, |finite, number| finite & number.is_finite());
        assert!(finite, "numbers that are not finite: {numbers:?}");
        mixed.add(vertex);
        numbers.iter().for_each(|number| mixed.add(u64::from(number.to_bits())));
        vertices += 1;
    }
    assert_eq!(vertices, bundle.len());
    digest((bundle.id(), bundle.generation(), bundle.payload(), mixed.0))
}

/// The numbers of a vertex, one after the other.
fn numbers(values: &VertexValues) -> &[f32] {
    match values {
        VertexValues::Vectors(vectors) => vectors.as_flattened().as_flattened(),
        VertexValues::Radiance(radiance) => radiance.as_flattened(),
    }
}

/// Mixes words into one without a comparison: a fuzzer looks at each comparison, of which a hash table's function has many.
#[derive(Default)]
struct Mixed(u64);

impl Mixed {
    fn add(&mut self, word: u64) {
        self.0 = (self.0.rotate_left(5) ^ word).wrapping_mul(ODD);
    }
}

/// Any odd number with about as many ones as zeros.
const ODD: u64 = 0x9E37_79B9_7F4A_7C15;

fn see_validity(block: &ValidityBlock<'_>) -> u64 {
    let edges: Vec<u8> = (0..block.len()).map(|n| block.blocked_edges(n)).collect();
    digest((block.id(), block.generation(), block.first_vertex(), block.validity(), edges))
}

/// Any bytes give events and a verdict, and allocate no more than the specification allows. Each record, read alone by its
/// range, is the record of the stream. A whole file has every vertex once.
///
/// # Panics
///
/// When that does not hold.
pub fn ivg_decode(data: &[u8]) {
    ivg_decode_for(data, |_| {});
}

/// As [`ivg_decode`], with an application that gets every event while allocations are counted.
pub(super) fn ivg_decode_for(data: &[u8], application: impl Fn(&Event<'_>)) {
    let bare = BUDGET.spend("decoding .ivg", data.len(), || {
        decode_all(data, &Limits::default(), |event| {
            // Reading what an event shows must not allocate either. The transcript reads everything.
            if let Event::Bundle(bundle) | Event::Corners(bundle) = event {
                for vertex in bundle.iter().take(FEW) {
                    std::hint::black_box(vertex);
                }
            }
            application(&event);
        })
    });
    let transcript = read(data);
    match (bare, transcript.end) {
        (Ok(()), End::Complete) => every_vertex_once(data),
        (Err(error), End::NeedMore) => assert_eq!(error.verdict(), Verdict::NeedMore),
        (Err(error), End::Refused(streamed)) => assert_eq!(error, streamed),
        (bare, end) => panic!("at once {bare:?}, in a stream {end:?}"),
    }
    if let Ok(Step::Consumed(_, header)) = Header::read(data, &Limits::default()) {
        records_alone(data, &header, &transcript);
    }
}

/// Compares each whole record, fetched by its range, with the event that the stream gave for it.
fn records_alone(data: &[u8], header: &Header, transcript: &Transcript) {
    // Only records and the end come after the first record.
    let first_record = transcript.events.len() - transcript.records - usize::from(transcript.has_ended);
    let mut streamed = transcript.events[first_record..].iter();
    let mut end = header.data_offset;
    for id in header.records() {
        let range = header.record_range(id);
        assert_eq!(range.start, end, "{id:?} does not begin where the record before it ends");
        end = range.end;
        let Some(bytes) = slice(data, range.start, range.end) else { return };
        let alone: Result<u64, Error> = decode_record(header, id, bytes).map(|event| see(&event).digest);
        match (streamed.next(), transcript.end) {
            (Some(&streamed), _) => assert_eq!(alone, Ok(streamed), "{id:?} is another when read alone"),
            (None, End::Refused(error)) => {
                // Where the stream was refused at this record, so is the record; what is behind may be right or wrong.
                if error.part() == Part::Record(id.stored()) {
                    assert_eq!(alone, Err(error), "{id:?} is refused in the stream only");
                }
                return;
            }
            (None, end) => panic!("{id:?} is there, and the stream ended with {end:?}"),
        }
    }
    assert_eq!(end, header.file_bytes, "the last record does not end with the file");
}

fn every_vertex_once(data: &[u8]) {
    // As many as the file has vertices, all of which it brings, or validity of: no more than it has bytes.
    let mut seen: Vec<bool> = Vec::new();
    // Readers need not check that no list of the order explicit names a vertex twice or leaves one out (IVG-EXP-04).
    let mut lists = false;
    let decoded = decode_all(data, &Limits::default(), |event| {
        if let Event::Bundle(bundle) | Event::Corners(bundle) = event {
            let header = bundle.header();
            seen.resize(header.lattice.vertex_count() as usize, false);
            lists = header.order == Order::Explicit;
            for vertex in bundle.vertices() {
                let before = std::mem::replace(&mut seen[vertex as usize], true);
                assert!(!before || lists, "vertex {vertex} comes twice");
                let is_corner = header.lattice.is_corner(vertex);
                assert_eq!(
                    is_corner,
                    bundle.id() == RecordId::Corners,
                    "vertex {vertex} in {:?}",
                    bundle.id()
                );
            }
        }
    });
    assert_eq!(decoded, Ok(()));
    assert!(lists || seen.iter().all(|&seen| seen), "vertices are missing");
}

/// Any split of the bytes gives the same events, the same error, the same offset.
///
/// # Panics
///
/// When that does not hold.
pub fn ivg_chunks(data: &[u8]) {
    assert_eq!(read_in_pieces(data, pieces(data)), read(data));
}
