//! Small files, and tools to change them in one place with all checksums made anew.

use ivg_format::{
    BakedLight, EncodeOptions, Encoding, Error, Event, GridSource, Header, HemisphereVectors, Lattice,
    Limits, Order, Quantity, RadianceHarmonics, Step, decode_all, encode,
};
use std::ops::Range;

/// Vectors that a packed encoding can hold, different for every vertex, hemisphere and channel.
pub(crate) fn vectors(lattice: &Lattice) -> Vec<HemisphereVectors> {
    (0..lattice.vertex_count())
        .map(|v| {
            std::array::from_fn(|h| {
                std::array::from_fn(|k| {
                    std::array::from_fn(|i| {
                        let size = ((v * 18 + h as u64 * 3 + k as u64) % 37) as f32 / 8.0;
                        let sign = if h % 2 == 0 { 1.0 } else { -1.0 };
                        if i == h / 2 { size * sign } else { size * 0.25 * (i as f32 - 0.5) }
                    })
                })
            })
        })
        .collect()
}

/// Radiance harmonics that an encoding can hold, different for every vertex and channel, within the bounds of radiance that
/// is never negative.
pub(crate) fn radiance(lattice: &Lattice) -> Vec<RadianceHarmonics> {
    (0..lattice.vertex_count())
        .map(|v| {
            std::array::from_fn(|channel| {
                let mean = ((v * 3 + channel as u64) % 29) as f32 / 4.0;
                std::array::from_fn(
                    |k| if k == 0 { mean } else { mean * ((v as usize + k) % 9) as f32 / 9.0 },
                )
            })
        })
        .collect()
}

pub(crate) fn lattice(dims: [u16; 3]) -> Lattice {
    Lattice::new(dims, [0.0; 3], [1.0, 2.0, 4.0]).unwrap()
}

pub(crate) fn options(encoding: Encoding, vertices_per_slice: u32) -> EncodeOptions {
    EncodeOptions { encoding, vertices_per_slice, seed: 7, ..EncodeOptions::new() }
}

/// A file with everything that a file can have.
pub(crate) fn full() -> Vec<u8> {
    let lattice = lattice([2, 4, 3]);
    let vectors = vectors(&lattice);
    let validity: Vec<u8> = (0..24).map(|v| v * 10).collect();
    // Every edge that stays inside is blocked at every other vertex.
    let blocked: Vec<u8> = (0..24)
        .map(|v| {
            let at = lattice.coords(v);
            let inside = (0..3).filter(|&a| at[a] + 1 < lattice.dims[a]).fold(0, |bits, a| bits | 1 << a);
            if v % 2 == 0 { inside } else { 0 }
        })
        .collect();
    let lights = [
        BakedLight { name: "ceiling lamp", direct_included: false },
        BakedLight { name: "sun", direct_included: true },
    ];
    let source = GridSource {
        validity: Some(&validity),
        blocked_edges: Some(&blocked),
        lights: &lights,
        meta: &[("generator", "laws"), ("photons", "1000")],
        ..GridSource::new(lattice, &vectors)
    };
    encode(&source, &options(Encoding::PackedOct24, 2)).unwrap()
}

/// A file of another order than `slices`, of 42 bytes a vertex, without chunks but the directory.
pub(crate) fn ordered(dims: [u16; 3], order: Order, vertices_per_slice: u32) -> Vec<u8> {
    let lattice = lattice(dims);
    let (values, bundles) = (vectors(&lattice), bundles(&lattice, vertices_per_slice, |_| true));
    let source = GridSource {
        bundles: (order == Order::Explicit).then_some(&bundles),
        ..GridSource::new(lattice, &values)
    };
    encode(&source, &EncodeOptions { order, ..options(Encoding::PackedOct24, vertices_per_slice) }).unwrap()
}

/// The vertices that `keep` keeps, corners left out, scattered over bundles of 1, 2, 3 … vertices, as many as allowed.
pub(crate) fn bundles(lattice: &Lattice, per_slice: u32, keep: impl Fn(u64) -> bool) -> Vec<Vec<u64>> {
    let most = per_slice as usize * usize::from(lattice.dims.into_iter().max().unwrap());
    let count = lattice.vertex_count();
    let mut left: Vec<u64> = (0..count).filter(|&v| !lattice.is_corner(v) && keep(v)).collect();
    left.sort_by_key(|v| (v * 7919 % 65_537, *v));
    let mut bundles: Vec<Vec<u64>> = vec![];
    while !left.is_empty() {
        let size = (bundles.len() + 1).min(most).min(left.len());
        bundles.push(left.drain(..size).collect());
    }
    bundles
}

/// A file of the order `explicit` with all chunks, in which the vertices inside geometry are in no bundle.
pub(crate) fn full_explicit() -> Vec<u8> {
    let lattice = lattice([3, 3, 2]);
    let validity: Vec<u8> = (0..18).map(|v| if v % 5 == 4 { 0 } else { 255 }).collect();
    let (values, bundles) = (vectors(&lattice), bundles(&lattice, 2, |v| validity[v as usize] != 0));
    let lights = [BakedLight { name: "lamp", direct_included: false }];
    let source = GridSource {
        validity: Some(&validity),
        bundles: Some(&bundles),
        lights: &lights,
        meta: &[("generator", "laws")],
        ..GridSource::new(lattice, &values)
    };
    encode(&source, &EncodeOptions { order: Order::Explicit, ..options(Encoding::PackedOct24, 2) }).unwrap()
}

pub(crate) fn plain(dims: [u16; 3], encoding: Encoding, vertices_per_slice: u32) -> Vec<u8> {
    let lattice = lattice(dims);
    let options = options(encoding, vertices_per_slice);
    match encoding.quantity() {
        Quantity::Vectors => encode(&GridSource::new(lattice, &vectors(&lattice)), &options),
        Quantity::Radiance => encode(&GridSource::new(lattice, &radiance(&lattice)), &options),
    }
    .unwrap()
}

/// One file of each kind that matters to a decoder's states.
pub(crate) fn samples() -> Vec<Vec<u8>> {
    let mut samples = vec![
        full(),
        plain([1, 1, 1], Encoding::PackedOct24, 64),
        plain([2, 2, 2], Encoding::PackedXyz24, 1),
        plain([1, 3, 2], Encoding::PackedOct24, 1),
        ordered([2, 3, 3], Order::Octree, 2),
        ordered([2, 3, 3], Order::Explicit, 2),
        ordered([2, 1, 2], Order::Explicit, 1),
        full_explicit(),
    ];
    samples.extend(Encoding::ALL.iter().map(|&encoding| plain([1, 3, 1], encoding, 1)));
    samples
}

/// Everything a decoder says of a whole file.
pub(crate) fn one_shot(bytes: &[u8]) -> (Vec<String>, Option<Error>) {
    let mut events = vec![];
    let result = decode_all(bytes, &Limits::default(), |event| events.push(describe(&event)));
    (events, result.err())
}

/// An event as text, every value of it read.
pub(crate) fn describe(event: &Event<'_>) -> String {
    match event {
        Event::Corners(bundle) | Event::Bundle(bundle) => {
            let values: Vec<_> = bundle.iter().collect();
            let packed: Vec<_> = (0..bundle.len()).map(|n| bundle.packed(n)).collect();
            format!("{:?} {} {values:?} {packed:?}", bundle.id(), bundle.generation())
        }
        Event::Validity(block) => {
            let edges: Vec<_> = (0..block.len()).map(|n| block.blocked_edges(n)).collect();
            format!("{block:?} {edges:?}")
        }
        other => format!("{other:?}"),
    }
}

pub(crate) fn header(bytes: &[u8]) -> Header {
    match Header::read(bytes, &Limits::default()).unwrap() {
        Step::Consumed(_, header) => header,
        Step::NeedMore(more) => panic!("{more} bytes of the header are missing"),
    }
}

/// The envelopes of a file: chunks and records.
pub(crate) fn envelopes(bytes: &[u8]) -> Vec<Range<usize>> {
    let header = header(bytes);
    let mut ranges = vec![];
    let mut start = header.header_bytes as usize;
    while (start as u64) < header.data_offset {
        let length = u64::from_le_bytes(bytes[start + 8..start + 16].try_into().unwrap());
        let end = start + ivg_wire::chunk_len(length).unwrap() as usize;
        ranges.push(start..end);
        start = end;
    }
    for id in header.records() {
        let range = header.record_range(id);
        ranges.push(range.start as usize..range.end as usize);
    }
    ranges
}

/// The file with `edit` applied and every checksum made anew; the envelopes stay where they were.
pub(crate) fn edited(bytes: &[u8], edit: impl FnOnce(&mut [u8])) -> Vec<u8> {
    let envelopes = envelopes(bytes);
    let mut out = bytes.to_vec();
    edit(&mut out);
    ivg_wire::seal_header(&mut out[..144]);
    let content = ivg_wire::ContentId(u64::from_le_bytes(out[32..40].try_into().unwrap()));
    for range in envelopes {
        ivg_wire::seal(&mut out[range], content);
    }
    out
}

/// The file with one more chunk in front of the others, but behind the directory, and everything that follows from it.
pub(crate) fn with_chunk(bytes: &[u8], kind: [u8; 4], critical: bool, payload: &[u8]) -> Vec<u8> {
    let header = header(bytes);
    let at = if header.order == Order::Explicit { envelopes(bytes)[0].end } else { 144 };
    with_chunk_at(bytes, at, kind, critical, payload)
}

/// The file with one more chunk at byte `at`, and everything that follows from it.
pub(crate) fn with_chunk_at(
    bytes: &[u8],
    at: usize,
    kind: [u8; 4],
    critical: bool,
    payload: &[u8],
) -> Vec<u8> {
    let header = header(bytes);
    let mut chunk = vec![];
    ivg_wire::write_chunk(&mut chunk, ivg_wire::ChunkKind(kind), critical, payload, header.content_id);
    let longer = chunk.len() as u64;
    let mut out = bytes[..at].to_vec();
    out.extend(chunk);
    out.extend(&bytes[at..]);
    out[40..48].copy_from_slice(&(header.data_offset + longer).to_le_bytes());
    out[48..56].copy_from_slice(&(header.file_bytes + longer).to_le_bytes());
    ivg_wire::seal_header(&mut out[..144]);
    let end = out.len() - 20;
    out[end + 8..end + 16].copy_from_slice(&(header.file_bytes + longer).to_le_bytes());
    ivg_wire::seal(&mut out[end..], header.content_id);
    out
}
