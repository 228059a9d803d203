//! Vectors of the encodings and orders beside `packed-oct24`, `vectors-f32` and `slices`.

use super::super::edit::{DATA_OFFSET_AT, in_envelope, in_header, overwritten, with_chunk};
use super::super::{Format, Refused, Vector};
use super::{CHUNK_HEAD, RECORD_HEAD, at, lattice, light, range};
use ivg_format::{
    EncodeOptions, Encoding, GridSource, Lattice, Order, RadianceHarmonics, RecordId, codes as ivg, encode,
};
use ivg_wire::{codes as wire, splitmix64};
use std::ops::Range;

pub(super) const HARMONICS: &str = "0015-harmonics";
pub(super) const OCTREE: &str = "0016-octree";
/// Lists with numbers of two bytes.
const EXPLICIT: &str = "0017-explicit";
pub(super) const EXPLICIT_SMALL: &str = "0018-explicit-small";
pub(super) const EXPLICIT_VALIDITY: &str = "0019-explicit-validity";

const XYZ: &str = "0020-packed-xyz24";
const HALF: &str = "0021-pair-f16";
const HALF_PADDED: &str = "0022-pair-f16x4";
const SINGLE: &str = "0023-pair-f32";

/// The chunk `DIRE` of either small file: three entries, four bytes of padding.
const DIRECTORY: Range<usize> = at::END..at::END + 48;

/// Harmonics of radiance that is never negative: a mean, and no more than half of it in every other coefficient.
fn radiance(lattice: &Lattice, seed: u64) -> Vec<RadianceHarmonics> {
    let number = |vertex: u64, n: u64| (splitmix64(seed, vertex * 27 + n) >> 54) as f32 / 1024.0;
    (0..lattice.vertex_count())
        .map(|vertex| {
            [0, 1, 2].map(|channel: u64| {
                let mean = number(vertex, channel * 9) + 0.25;
                std::array::from_fn(|k| match k {
                    0 => mean,
                    k => mean * (number(vertex, channel * 9 + k as u64) - 0.5),
                })
            })
        })
        .collect()
}

fn harmonics() -> Vec<u8> {
    let lattice = lattice([3, 2, 4]);
    let options =
        EncodeOptions { encoding: Encoding::Sh2, vertices_per_slice: 2, seed: 7, ..EncodeOptions::new() };
    encode(&GridSource::new(lattice, &radiance(&lattice, 5)), &options).expect("a sound grid")
}

/// Light in one of the encodings with a direction and a colour for each hemisphere.
fn directed(encoding: Encoding) -> Vec<u8> {
    let lattice = lattice([2, 3, 2]);
    let options = EncodeOptions { encoding, vertices_per_slice: 2, seed: 7, ..EncodeOptions::new() };
    encode(&GridSource::new(lattice, &light(&lattice, 10)), &options).expect("a sound grid")
}

/// A file in whose corners number `n`, counted from 0, is overwritten.
fn with_number(file: &[u8], n: usize, bytes: &[u8]) -> Vec<u8> {
    let corners = range(file, RecordId::Corners);
    in_envelope(file, corners.clone(), corners.start + RECORD_HEAD + n * bytes.len(), bytes)
}

fn negative_zero() -> Vec<u8> {
    with_number(&directed(Encoding::PairF32), 4, &(-0.0f32).to_le_bytes())
}

fn octree() -> Vec<u8> {
    let lattice = lattice([5, 2, 3]);
    let options =
        EncodeOptions { order: Order::Octree, vertices_per_slice: 2, seed: 7, ..EncodeOptions::new() };
    encode(&GridSource::new(lattice, &light(&lattice, 6)), &options).expect("a sound grid")
}

/// Every fourth vertex in a bundle, so that a list has numbers of one byte and of two.
fn explicit() -> Vec<u8> {
    let lattice = lattice([5, 6, 7]);
    let others: Vec<u64> = (0..lattice.vertex_count()).filter(|&vertex| !lattice.is_corner(vertex)).collect();
    let bundles: Vec<Vec<u64>> = (0..4)
        .map(|first| others.iter().copied().filter(|vertex| vertex % 4 == 3 - first).collect())
        .collect();
    let options = EncodeOptions {
        encoding: Encoding::Sh2,
        order: Order::Explicit,
        vertices_per_slice: 8,
        ..EncodeOptions::new()
    };
    let radiance = radiance(&lattice, 8);
    let source = GridSource { bundles: Some(&bundles), ..GridSource::new(lattice, &radiance) };
    encode(&source, &options).expect("a sound grid")
}

/// 2 × 3 × 3 vertices, ten of them in three bundles; or nine, if the tenth lies inside geometry.
fn explicit_small(validity: bool) -> Vec<u8> {
    let lattice = lattice([2, 3, 3]);
    let vectors = light(&lattice, 9);
    let mut valid = [255; 18];
    valid[9] = 0;
    let third = if validity { vec![10, 11, 14, 15] } else { vec![9, 10, 11, 14, 15] };
    let source = GridSource {
        bundles: Some(&[vec![6, 7], vec![2, 3, 8], third]),
        validity: validity.then_some(&valid),
        ..GridSource::new(lattice, &vectors)
    };
    let options = EncodeOptions { order: Order::Explicit, vertices_per_slice: 2, ..EncodeOptions::new() };
    encode(&source, &options).expect("a sound grid")
}

pub(super) fn accepted() -> Vec<Vector> {
    let list = [
        (HARMONICS, harmonics(), "sh2-28"),
        (OCTREE, octree(), "the order octree; the last bundle is smaller"),
        (EXPLICIT, explicit(), "the order explicit, sh2-28; numbers of two bytes in the lists"),
        (EXPLICIT_SMALL, explicit_small(false), "the order explicit; for files to refuse to differ from"),
        (EXPLICIT_VALIDITY, explicit_small(true), "a vertex inside geometry is in no bundle"),
        (XYZ, directed(Encoding::PackedXyz24), "packed-xyz24"),
        (HALF, directed(Encoding::PairF16), "pair-f16"),
        (HALF_PADDED, directed(Encoding::PairF16x4), "pair-f16x4"),
        (SINGLE, directed(Encoding::PairF32), "pair-f32"),
        ("0024-negative-zero", negative_zero(), "a component of a colour that is -0 is read as 0"),
    ];
    list.into_iter().map(|(name, bytes, why)| Vector::accepted(Format::Ivg, name, bytes, why)).collect()
}

pub(super) fn refused(harmonics: &[u8], octree: &[u8], explicit: &[u8], slices: &[u8]) -> Vec<Refused> {
    let corners = range(harmonics, RecordId::Corners);
    // Behind the means of eight corners.
    let ratio = in_envelope(harmonics, corners.clone(), corners.start + RECORD_HEAD + 8 * 4 + 5, &[0x80]);
    let mut list = vec![
        (HARMONICS, "ratio", ivg::RATIO_CODE, ratio, "a ratio with the forbidden code -128"),
        (
            HARMONICS,
            "scale-exponent-harmonics",
            ivg::SCALE_EXPONENT,
            in_header(harmonics, at::SCALE_EXPONENT, &111i16.to_le_bytes()),
            "a scale with which coefficients can exceed binary32",
        ),
        (
            OCTREE,
            "octree-bundles",
            ivg::BUNDLE_COUNT,
            in_header(octree, at::BUNDLE_COUNT, &[4]),
            "more bundles than the lattice has vertices for",
        ),
        (
            "0008-small",
            "directory-other-order",
            ivg::DIRECTORY_FORBIDDEN,
            with_chunk(slices, b"DIRE", true, &[0; 8]),
            "a directory in a file of the order slices",
        ),
    ];
    list.extend(directed_codes());
    list.extend(directories(explicit));
    list.extend(lists(explicit));
    list
}

/// Numbers of the corners, eight vertices: 144 numbers of colours, then 144 of directions; with a fourth, 192 of each.
fn directed_codes() -> Vec<Refused> {
    let [xyz, half, padded, single] =
        [Encoding::PackedXyz24, Encoding::PairF16, Encoding::PairF16x4, Encoding::PairF32].map(directed);
    let f16 = |bits: u16| bits.to_le_bytes();
    let f32 = |value: f32| value.to_le_bytes();
    // Behind 48 colours of four bytes, the codes are bytes.
    let code = |n: usize, bytes: &[u8]| {
        let corners = range(&xyz, RecordId::Corners);
        in_envelope(&xyz, corners.clone(), corners.start + RECORD_HEAD + 192 + n, bytes)
    };
    vec![
        (
            XYZ,
            "xyz-least",
            ivg::DIRECTION_CODE,
            code(4, &[0x80]),
            "a coordinate with the forbidden value -128",
        ),
        (XYZ, "xyz-zero", ivg::DIRECTION_CODE, code(3, &[0; 3]), "a direction without a length"),
        (
            HALF,
            "half-negative",
            ivg::PAIR_COLOUR,
            with_number(&half, 5, &f16(0x8001)),
            "a colour less than 0",
        ),
        (HALF, "half-infinite", ivg::PAIR_COLOUR, with_number(&half, 5, &f16(0x7C00)), "an infinite colour"),
        (
            HALF,
            "half-long",
            ivg::PAIR_DIRECTION,
            with_number(&half, 150, &f16(0x3C01)),
            "a component above 1",
        ),
        (
            HALF,
            "half-nan",
            ivg::PAIR_DIRECTION,
            with_number(&half, 150, &f16(0x7E00)),
            "a component that is no number",
        ),
        (
            HALF_PADDED,
            "half-padded-negative",
            ivg::PAIR_COLOUR,
            with_number(&padded, 6, &f16(0xBC00)),
            "a colour less than 0",
        ),
        (
            HALF_PADDED,
            "half-padded-long",
            ivg::PAIR_DIRECTION,
            with_number(&padded, 193, &f16(0xBC01)),
            "a component below -1",
        ),
        (
            HALF_PADDED,
            "half-fourth",
            wire::RESERVED,
            with_number(&padded, 7, &f16(0x3C00)),
            "a fourth number that is not 0",
        ),
        (
            HALF_PADDED,
            "half-fourth-sign",
            wire::RESERVED,
            with_number(&padded, 195, &f16(0x8000)),
            "a fourth number of -0",
        ),
        (
            SINGLE,
            "single-negative",
            ivg::PAIR_COLOUR,
            with_number(&single, 143, &f32(-1e-30)),
            "a colour less than 0",
        ),
        (
            SINGLE,
            "single-nan",
            ivg::PAIR_COLOUR,
            with_number(&single, 143, &f32(f32::NAN)),
            "a colour that is no number",
        ),
        (
            SINGLE,
            "single-scaled",
            ivg::PAIR_COLOUR,
            in_header(&with_number(&single, 143, &f32(f32::MAX)), at::SCALE_EXPONENT, &[1]),
            "a colour that becomes infinite when it is scaled",
        ),
        (
            SINGLE,
            "single-long",
            ivg::PAIR_DIRECTION,
            with_number(&single, 144, &f32(1.0f32.next_up())),
            "a component above 1",
        ),
    ]
}

/// A file whose directory says something else of bundle `n`, counted from 0.
fn with_entry(file: &[u8], n: usize, vertices: u32, index_bytes: u32) -> Vec<u8> {
    let bytes = [vertices.to_le_bytes(), index_bytes.to_le_bytes()].concat();
    in_envelope(file, DIRECTORY, DIRECTORY.start + CHUNK_HEAD + 8 * n, &bytes)
}

/// With a validity section, vertices may be in no bundle: that their sum is not W does not tell what is wrong with an entry.
pub(super) fn directories_with_validity(file: &[u8]) -> Vec<Refused> {
    // Nine of ten vertices are in bundles of 2, 3 and 4.
    let list = [
        ("directory-empty-validity", with_entry(file, 0, 0, 0), "a bundle without vertices"),
        (
            "directory-share-validity",
            in_header(file, at::VERTICES_PER_SLICE, &[1]),
            "four vertices in a bundle that may have three",
        ),
        ("directory-sum-validity", with_entry(file, 0, 4, 4), "eleven vertices of ten"),
    ];
    list.map(|(mistake, bytes, why)| (EXPLICIT_VALIDITY, mistake, ivg::DIRECTORY_VERTICES, bytes, why))
        .to_vec()
}

/// A lattice of 48 million vertices, and a directory with a bundle of 46 million: 2.25 GB.
fn with_large_bundle(file: &[u8]) -> Vec<u8> {
    let vertices = 46_000_000;
    let file = overwritten(file, at::DIMS, &[2u16, 400, 60_000].map(u16::to_le_bytes).concat());
    let file = in_header(&file, at::VERTICES_PER_SLICE, &800u32.to_le_bytes());
    with_entry(&file, 0, vertices, 7 * vertices)
}

fn directories(file: &[u8]) -> Vec<Refused> {
    let entry = |n, vertices, index_bytes| with_entry(file, n, vertices, index_bytes);
    let header = |field: usize, bytes: &[u8]| in_header(file, field, bytes);
    let list = [
        (
            "directory-type",
            ivg::DIRECTORY_ABSENT,
            in_envelope(file, DIRECTORY, DIRECTORY.start, b"DIRX"),
            "the first chunk is of another type",
        ),
        (
            "directory-none",
            ivg::DIRECTORY_ABSENT,
            header(DATA_OFFSET_AT, &[at::END as u8]),
            "there is no chunk",
        ),
        (
            "directory-repeated",
            wire::CHUNK_REPEATED,
            with_chunk(file, b"DIRE", true, &file[DIRECTORY][CHUNK_HEAD..CHUNK_HEAD + 24]),
            "the same directory twice",
        ),
        (
            "directory-length",
            ivg::DIRECTORY_ENTRIES,
            header(at::BUNDLE_COUNT, &[2]),
            "an entry more than there are bundles",
        ),
        (
            "explicit-bundles",
            ivg::BUNDLE_COUNT,
            header(at::BUNDLE_COUNT, &[11]),
            "more bundles than vertices that are not corners",
        ),
        ("directory-empty", ivg::DIRECTORY_VERTICES, entry(0, 0, 0), "a bundle without vertices"),
        ("directory-share", ivg::DIRECTORY_VERTICES, entry(0, 7, 7), "more vertices than a bundle may have"),
        ("directory-sum", ivg::DIRECTORY_VERTICES, entry(0, 6, 6), "more vertices than the lattice has"),
        (
            "directory-lacking",
            ivg::DIRECTORY_VERTICES,
            entry(0, 1, 1),
            "a vertex is in no bundle, and none is invalid",
        ),
        (
            "directory-record-huge",
            ivg::RECORD_TOO_LARGE,
            with_large_bundle(file),
            "a bundle longer than a record may be",
        ),
        ("directory-index-short", ivg::DIRECTORY_INDEX, entry(2, 5, 4), "fewer index bytes than vertices"),
        (
            "directory-index-long",
            ivg::DIRECTORY_INDEX,
            entry(0, 2, 15),
            "more than seven index bytes a vertex",
        ),
    ];
    list.map(|(mistake, code, bytes, why)| (EXPLICIT_SMALL, mistake, code, bytes, why)).to_vec()
}

/// Lists of vertices: bundle 1 has 06 00 (vertices 6 and 7), bundle 2 has 02 00 04 (2, 3 and 8).
fn lists(file: &[u8]) -> Vec<Refused> {
    let bundle = range(file, RecordId::Bundle(1));
    let first = |bytes: &[u8]| in_envelope(file, bundle.clone(), bundle.start + RECORD_HEAD, bytes);
    let list = [
        ("index-form", ivg::INDEX_NUMBER, first(&[0x86, 0x00]), "a number with more bytes than it needs"),
        ("index-cut", ivg::INDEX_NUMBER, first(&[0x06, 0x80]), "a number without a last byte"),
        ("index-corner", ivg::INDEX_VERTEX, first(&[0x04]), "a list that names a corner"),
        (
            "index-outside",
            ivg::INDEX_VERTEX,
            first(&[0x12]),
            "a list that names a vertex outside the lattice",
        ),
        (
            "index-length",
            ivg::INDEX_LENGTH,
            longer_list(file),
            "a byte behind the list, in the place of one of padding",
        ),
    ];
    list.map(|(mistake, code, bytes, why)| (EXPLICIT_SMALL, mistake, code, bytes, why)).to_vec()
}

/// Bundle 2 with a fourth index byte. Its record keeps its length, for it has three bytes of padding.
fn longer_list(file: &[u8]) -> Vec<u8> {
    let bundle = range(file, RecordId::Bundle(2));
    let record = &file[bundle.clone()];
    let (head, values) = record.split_at(RECORD_HEAD + 3);
    let values = &values[..3 * 42];
    let longer = [head, &[0x00], values, &[0, 0]].concat();
    let file = in_envelope(file, DIRECTORY, DIRECTORY.start + CHUNK_HEAD + 8 + 4, &[4]);
    in_envelope(&file, bundle.clone(), bundle.start, &longer)
}
