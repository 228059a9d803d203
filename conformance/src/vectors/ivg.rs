//! Vectors of `.ivg`.

use super::edit::{HEADER_BYTES_AT, in_envelope, in_header, inserted, overwritten, with_chunk};
use super::{Format, Vector};
use ivg_format::{
    BakedLight, EncodeOptions, Encoding, GridSource, Header, HemisphereVectors, Lattice, Limits, RecordId,
    Step, Units, encode,
};
use ivg_wire::splitmix64;
use std::ops::Range;

mod forward;
pub(super) mod limits;
mod orders;
mod refused;
mod variants;

/// Places of fields in the header (`spec/tables/ivg.toml`).
mod at {
    pub(super) const MAJOR: usize = 8;
    pub(super) const MINOR: usize = 10;
    pub(super) const REQUIRED_FEATURES: usize = 12;
    pub(super) const OPTIONAL_FEATURES: usize = 16;
    pub(super) const RESERVED_32: usize = 24;
    pub(super) const CHECKSUM: usize = 28;
    pub(super) const DIMS: usize = 56;
    pub(super) const ENCODING: usize = 62;
    pub(super) const ORIGIN: usize = 64;
    pub(super) const STEP: usize = 88;
    pub(super) const ORDER: usize = 112;
    pub(super) const SCALE_EXPONENT: usize = 114;
    pub(super) const VERTICES_PER_SLICE: usize = 116;
    pub(super) const BUNDLE_COUNT: usize = 128;
    pub(super) const VALIDITY_RECORDS: usize = 132;
    pub(super) const UNITS: usize = 136;
    pub(super) const RESERVED: usize = 137;
    pub(super) const END: usize = 144;
}

/// Bytes before the payload of a record, and of a chunk.
const RECORD_HEAD: usize = 8;
const CHUNK_HEAD: usize = 16;

const VALIDITY: &str = "0005-validity";

pub(super) fn vectors() -> Vec<Vector> {
    let mut vectors = accepted();
    vectors.extend(variants::accepted());
    vectors.extend(forward::accepted(&vectors));
    vectors.extend(orders::accepted());
    let refused = refused::refused(&vectors);
    vectors.extend(refused);
    vectors
}

/// Irradiance vectors that look like light: in each hemisphere, components along its axis that are positive. All numbers are
/// multiples of 1/256, so that they are the same on every machine.
fn light(lattice: &Lattice, seed: u64) -> Vec<HemisphereVectors> {
    let component = |vertex: u64, n: u64| (splitmix64(seed, vertex * 54 + n) >> 54) as f32 / 256.0;
    let vector = |vertex, hemisphere: usize, channel: usize| {
        [0, 1, 2].map(|axis: usize| {
            let value = component(vertex, (hemisphere * 9 + channel * 3 + axis) as u64);
            match axis == hemisphere / 2 {
                true if hemisphere.is_multiple_of(2) => value,
                true => -value,
                false => (value - 2.0) / 4.0,
            }
        })
    };
    (0..lattice.vertex_count())
        .map(|vertex| {
            [0, 1, 2, 3, 4, 5].map(|hemisphere| [0, 1, 2].map(|channel| vector(vertex, hemisphere, channel)))
        })
        .collect()
}

fn lattice(dims: [u16; 3]) -> Lattice {
    Lattice::new(dims, [-1.0, 0.0, 0.5], [1.0, 2.5, 3.5]).expect("finite bounds with an extent")
}

fn file(dims: [u16; 3], options: EncodeOptions) -> Vec<u8> {
    let lattice = lattice(dims);
    encode(&GridSource::new(lattice, &light(&lattice, 1)), &options).expect("a sound grid")
}

fn accepted() -> Vec<Vector> {
    let packed = EncodeOptions { vertices_per_slice: 2, seed: 7, ..EncodeOptions::default() };
    let exact = EncodeOptions { encoding: Encoding::VectorsF32, ..packed };
    let small = file([2, 3, 2], packed);
    let with_meta = with_chunk(&small, b"META", false, b"generator=conformance\n");
    let list = [
        ("0001-one-vertex", file([1, 1, 1], exact), "the smallest grid: one corner, no bundle"),
        ("0002-corners-only", file([2, 2, 2], packed), "every vertex is a corner: there is no bundle"),
        ("0003-packed", file([3, 5, 4], packed), "packed-oct24; the last bundles are smaller"),
        (
            "0004-vectors",
            file([4, 3, 2], EncodeOptions { units: Units::Photometric, ..exact }),
            "vectors-f32, photometric",
        ),
        (VALIDITY, with_validity(packed), "a validity section with blocked edges"),
        ("0006-lights", with_lights(packed), "the chunks LITE and META"),
        ("0007-line", file([5, 1, 1], packed), "one axis only: two corners, slices of one vertex"),
        ("0008-small", small.clone(), "a grid for the files to refuse to differ from"),
        ("0009-metadata", with_meta, "the chunk META alone"),
        (
            "0010-unknown-chunk",
            with_chunk(&small, b"NEWS", false, b"?"),
            "an ancillary chunk of unknown type is skipped",
        ),
        (
            "0011-optional-feature",
            in_header(&small, at::OPTIONAL_FEATURES, &[0x10]),
            "an unknown optional feature is ignored",
        ),
        ("0012-newer-minor", newer_minor(&small), "a newer minor version with a longer header"),
        ("0013-generation", generation(&small), "a bundle that came again with a higher generation"),
        ("0014-bright", bright(), "a scale exponent above 0: colours beyond the range of RGB9E5"),
    ];
    list.into_iter().map(|(name, bytes, why)| Vector::accepted(Format::Ivg, name, bytes, why)).collect()
}

fn with_validity(options: EncodeOptions) -> Vec<u8> {
    let lattice = lattice([3, 3, 3]);
    let vectors = light(&lattice, 2);
    let mut validity = [255; 27];
    validity[13] = 0;
    validity[14] = 128;
    let mut edges = [0; 27];
    (edges[0], edges[12], edges[13]) = (1, 0b011, 0b111);
    let source = GridSource {
        validity: Some(&validity),
        blocked_edges: Some(&edges),
        ..GridSource::new(lattice, &vectors)
    };
    encode(&source, &options).expect("a sound grid")
}

fn with_lights(options: EncodeOptions) -> Vec<u8> {
    let lattice = lattice([2, 2, 3]);
    let vectors = light(&lattice, 3);
    let source = GridSource {
        lights: &[
            BakedLight { name: "ceiling", direct_included: false },
            BakedLight { name: "lámpara", direct_included: true },
        ],
        meta: &[("generator", "conformance"), ("seed", "7")],
        ..GridSource::new(lattice, &vectors)
    };
    encode(&source, &options).expect("a sound grid")
}

fn bright() -> Vec<u8> {
    let lattice = lattice([2, 2, 2]);
    let mut vectors = light(&lattice, 4);
    vectors.iter_mut().flatten().flatten().flatten().for_each(|component| *component *= 1_048_576.0);
    encode(&GridSource::new(lattice, &vectors), &EncodeOptions::default()).expect("a sound grid")
}

/// Eight more bytes of header, as a later minor version may append.
fn newer_minor(file: &[u8]) -> Vec<u8> {
    let file = in_header(file, at::MINOR, &[9, 0]);
    let file = overwritten(&file, HEADER_BYTES_AT, &(at::END as u32 + 8).to_le_bytes());
    inserted(&file, at::END, &[0xA5; 8])
}

fn generation(file: &[u8]) -> Vec<u8> {
    let bundle = range(file, RecordId::Bundle(1));
    in_envelope(file, bundle.clone(), bundle.start + 4, &3u32.to_le_bytes())
}

/// Where a record lies in a file that is right.
fn range(file: &[u8], id: RecordId) -> Range<usize> {
    let range = header(file).record_range(id);
    range.start as usize..range.end as usize
}

fn header(file: &[u8]) -> Header {
    match Header::read(file, &Limits::default()) {
        Ok(Step::Consumed(_, header)) => header,
        other => panic!("not a file: {other:?}"),
    }
}

/// What the records are called, and where they lie.
pub(super) fn records(file: &[u8]) -> Vec<(String, Range<usize>)> {
    let header = header(file);
    let name = |id| match id {
        RecordId::Corners => "corners".to_owned(),
        RecordId::Validity(j) => format!("validity {j}"),
        RecordId::Bundle(k) => format!("bundle {k}"),
        RecordId::End => "end".to_owned(),
    };
    header.records().map(|id| (name(id), range(file, id))).collect()
}
