//! Files of `.ivg` to refuse.

use super::super::edit::{
    DATA_OFFSET_AT, FILE_BYTES_AT, HEADER_BYTES_AT, flipped, in_envelope, in_header, inserted, last_chunk,
    overwritten, read_u64, with_chunk,
};
use super::super::{Format, Refused, Vector};
use super::{CHUNK_HEAD, RECORD_HEAD, VALIDITY, at, header, light, range, variants};
use ivg_format::{EncodeOptions, GridSource, RecordId, codes as ivg, encode};
use ivg_wire::codes as wire;

pub(super) fn refused(accepted: &[Vector]) -> Vec<Vector> {
    let twin = |name: &str| &accepted.iter().find(|vector| vector.name == name).expect("a name").bytes[..];
    let mut list = container(twin("0008-small"), twin("0009-metadata"));
    list.extend(newer(twin("0012-newer-minor")));
    list.extend(records(twin("0007-line"), twin("0008-small")));
    list.extend(lattices(twin("0008-small"), twin("0001-one-vertex")));
    list.extend(registries(twin("0008-small")));
    list.extend(values(twin("0008-small"), twin("0004-vectors"), twin("0005-validity")));
    list.extend(chunks(twin("0006-lights"), twin("0009-metadata")));
    list.extend(lists(twin("0008-small")));
    list.extend(super::limits::refused(twin("0008-small"), twin("0009-metadata")));
    list.extend(super::forward::refused(twin("0008-small")));
    list.extend(variants::refused(
        twin(variants::HARMONICS),
        twin(variants::OCTREE),
        twin(variants::EXPLICIT_SMALL),
        twin("0008-small"),
    ));
    list.extend(variants::directories_with_validity(twin(variants::EXPLICIT_VALIDITY)));
    list.into_iter().map(|refused| Vector::refused(Format::Ivg, refused)).collect()
}

fn container(small: &[u8], meta: &[u8]) -> Vec<Refused> {
    let (s, m) = ("0008-small", "0009-metadata");
    let longer = |field: usize, by: usize| {
        in_header(small, field, &((read_u64(small, field) + by) as u64).to_le_bytes())
    };
    let mangled = [&small[..4], &small[5..]].concat();
    vec![
        (s, "signature", wire::MAGIC, in_header(small, 1, b"J"), "another format's signature"),
        (s, "line-ends", wire::MAGIC, mangled, "the signature after a transfer as text: CR LF became LF"),
        (s, "major", wire::MAJOR_VERSION, in_header(small, at::MAJOR, &[1]), "another major version"),
        (
            s,
            "feature",
            wire::REQUIRED_FEATURE,
            in_header(small, at::REQUIRED_FEATURES, &[4]),
            "an unknown required feature",
        ),
        (
            s,
            "header-bytes",
            wire::HEADER_BYTES,
            in_header(small, HEADER_BYTES_AT, &[152]),
            "a header length of another version",
        ),
        (
            s,
            "header-checksum",
            wire::HEADER_CHECKSUM,
            flipped(small, at::CHECKSUM),
            "a bit of the header's checksum",
        ),
        (s, "header-damaged", wire::HEADER_CHECKSUM, flipped(small, at::ORIGIN), "a bit of a header field"),
        (
            s,
            "header-reserved",
            wire::RESERVED,
            in_header(small, at::RESERVED_32, &[1]),
            "the reserved field of the common header",
        ),
        (
            s,
            "reserved",
            wire::RESERVED,
            in_header(small, at::RESERVED, &[1]),
            "a reserved byte of the specific header",
        ),
        (
            s,
            "data-offset",
            wire::DATA_OFFSET,
            in_header(small, DATA_OFFSET_AT, &[136]),
            "records begin inside the header",
        ),
        (
            s,
            "data-unaligned",
            wire::DATA_OFFSET,
            longer(DATA_OFFSET_AT, 4),
            "the data offset is no multiple of 8",
        ),
        (
            s,
            "data-beyond",
            wire::DATA_OFFSET,
            in_header(small, DATA_OFFSET_AT, &(small.len().next_multiple_of(8) as u64 + 8).to_le_bytes()),
            "records begin behind the end of the file",
        ),
        (
            s,
            "file-bytes",
            wire::FILE_BYTES,
            longer(FILE_BYTES_AT, 4),
            "the file length does not follow from the header",
        ),
        (
            m,
            "chunk-checksum",
            wire::CHUNK_CHECKSUM,
            flipped(meta, at::END + CHUNK_HEAD),
            "a bit of a chunk's payload",
        ),
    ]
}

/// Lengths of headers that no minor version may have.
fn newer(file: &[u8]) -> Vec<Refused> {
    let header_bytes = |mistake, value: u32, why| {
        let file = in_header(file, HEADER_BYTES_AT, &value.to_le_bytes());
        ("0012-newer-minor", mistake, wire::HEADER_BYTES, file, why)
    };
    vec![
        header_bytes("header-bytes-unaligned", 148, "a header length that is no multiple of 8"),
        header_bytes("header-bytes-short", 136, "a header shorter than that of the known version"),
        header_bytes("header-bytes-maximum", 65_544, "a header longer than any may be"),
    ]
}

fn records(line: &[u8], small: &[u8]) -> Vec<Refused> {
    let (l, s) = ("0007-line", "0008-small");
    let bundle = range(small, RecordId::Bundle(1));
    let end = range(small, RecordId::End);
    // Three vertices of 42 bytes: two bytes of padding before the checksum.
    let padded = range(line, RecordId::Bundle(1));
    let trailing = [small, &[0]].concat();
    let with_other_id = in_envelope(small, bundle.clone(), bundle.start, &[2]);
    let other_length = in_envelope(small, end.clone(), end.start + RECORD_HEAD, &[1]);
    vec![
        (
            s,
            "record-checksum",
            wire::RECORD_CHECKSUM,
            flipped(small, bundle.start + RECORD_HEAD),
            "a bit of a bundle",
        ),
        (
            s,
            "record-mixed",
            wire::RECORD_CHECKSUM,
            other_version(small),
            "a bundle of another version of the file",
        ),
        (s, "record-id", wire::RECORD_ID, with_other_id, "bundle 2 where bundle 1 belongs"),
        (
            l,
            "record-padding",
            wire::RECORD_PADDING,
            in_envelope(line, padded.clone(), padded.end - 5, &[1]),
            "padding that is not zero",
        ),
        (s, "end", wire::END_MISMATCH, other_length, "the end record names another length"),
        (
            s,
            "end-generation",
            wire::END_MISMATCH,
            in_envelope(small, end.clone(), end.start + 4, &[1]),
            "an end record that came again",
        ),
        (s, "trailing", wire::TRAILING_BYTES, trailing, "a byte behind the end record"),
    ]
}

/// The first bundle comes from a grid with other light, as when a cache mixes versions.
fn other_version(small: &[u8]) -> Vec<u8> {
    let header = header(small);
    let options = EncodeOptions {
        vertices_per_slice: header.vertices_per_slice,
        seed: header.seed,
        ..EncodeOptions::default()
    };
    let other = encode(&GridSource::new(header.lattice, &light(&header.lattice, 99)), &options)
        .expect("a sound grid");
    let bundle = range(small, RecordId::Bundle(1));
    overwritten(small, bundle.start, &other[bundle])
}

fn lattices(small: &[u8], one: &[u8]) -> Vec<Refused> {
    let (s, o) = ("0008-small", "0001-one-vertex");
    let number = |value: f64| value.to_le_bytes();
    let edited = |field: usize, bytes: &[u8]| in_header(small, field, bytes);
    vec![
        (s, "no-vertices", ivg::DIMENSIONS, edited(at::DIMS + 2, &[0, 0]), "an axis without vertices"),
        (s, "origin-nan", ivg::ORIGIN, edited(at::ORIGIN, &number(f64::NAN)), "an origin that is no number"),
        (
            s,
            "last-infinite",
            ivg::ORIGIN,
            edited(at::STEP + 8, &number(f64::MAX)),
            "the last vertex lies at infinity",
        ),
        (s, "step-negative", ivg::STEP, edited(at::STEP, &number(-1.0)), "a negative step"),
        (s, "step-zero", ivg::STEP, edited(at::STEP, &number(0.0)), "no step between two vertices"),
        (
            o,
            "step-single",
            ivg::STEP,
            in_header(one, at::STEP, &number(1.0)),
            "a step on an axis of one vertex",
        ),
        (
            s,
            "exponent-high",
            ivg::SCALE_EXPONENT,
            edited(at::SCALE_EXPONENT, &113i16.to_le_bytes()),
            "the scale exponent is too high",
        ),
        (
            s,
            "exponent-low",
            ivg::SCALE_EXPONENT,
            edited(at::SCALE_EXPONENT, &(-126i16).to_le_bytes()),
            "the scale exponent is too low",
        ),
        (
            s,
            "no-share",
            ivg::SLICE_VERTICES,
            edited(at::VERTICES_PER_SLICE, &[0]),
            "bundles that take no vertex",
        ),
        (
            s,
            "bundle-count",
            ivg::BUNDLE_COUNT,
            edited(at::BUNDLE_COUNT, &[9]),
            "more bundles than the lattice has vertices for",
        ),
        (
            s,
            "validity-count",
            ivg::VALIDITY_COUNT,
            edited(at::VALIDITY_RECORDS, &[2]),
            "more validity records than the lattice needs",
        ),
        (
            s,
            "record-huge",
            ivg::RECORD_TOO_LARGE,
            super::limits::huge(small, u16::MAX, u32::MAX),
            "a bundle of 12 TB, in a file of a few hundred bytes",
        ),
    ]
}

fn registries(small: &[u8]) -> Vec<Refused> {
    let s = "0008-small";
    let edited = |field: usize, value: u8| in_header(small, field, &[value]);
    vec![
        (s, "encoding-0", ivg::ENCODING_FORBIDDEN, edited(at::ENCODING, 0), "encoding 0 does not exist"),
        (
            s,
            "encoding-unknown",
            ivg::ENCODING_UNKNOWN,
            edited(at::ENCODING, 200),
            "an encoding that nobody has defined",
        ),
        (s, "order-0", ivg::ORDER_FORBIDDEN, edited(at::ORDER, 0), "order 0 does not exist"),
        (s, "order-unknown", ivg::ORDER_UNKNOWN, edited(at::ORDER, 200), "an order that nobody has defined"),
        (s, "units-unknown", ivg::UNITS_UNKNOWN, edited(at::UNITS, 2), "units that nobody has defined"),
    ]
}

fn values(small: &[u8], exact: &[u8], validity: &[u8]) -> Vec<Refused> {
    let (s, e, v) = ("0008-small", "0004-vectors", VALIDITY);
    let corners = range(small, RecordId::Corners);
    // Behind the colours of eight vertices, the high 12 bits of the first direction.
    let direction = corners.start + RECORD_HEAD + 8 * 6 * 4;
    let forbidden = in_envelope(small, corners, direction, &[0, 0xF0, 0xFF]);
    let numbers = range(exact, RecordId::Bundle(1));
    let number = |value: f32| {
        in_envelope(exact, numbers.clone(), numbers.start + RECORD_HEAD + 4, &value.to_le_bytes())
    };
    let scaled = in_header(&number(f32::MAX), at::SCALE_EXPONENT, &[1]);
    let block = range(validity, RecordId::Validity(0));
    let edges = block.start + RECORD_HEAD + 27;
    let unused = in_envelope(validity, block.clone(), edges + 10, &[0x80]);
    // Vertex 2 is the last along x; its three bits begin at bit 6.
    let outside = in_envelope(validity, block, edges, &[validity[edges] | 0x40]);
    vec![
        (s, "direction", ivg::DIRECTION_CODE, forbidden, "a direction with the forbidden coordinate 4095"),
        (e, "nan", ivg::NOT_FINITE, number(f32::NAN), "a component that is no number"),
        (e, "infinite", ivg::NOT_FINITE, number(f32::NEG_INFINITY), "a component that is infinite"),
        (
            e,
            "scaled-infinite",
            ivg::NOT_FINITE,
            scaled,
            "a component that becomes infinite when it is scaled",
        ),
        (v, "unused-bits", ivg::UNUSED_BITS, unused, "a bit behind the last blocked edge"),
        (v, "edge-outside", ivg::EDGE_OUTSIDE, outside, "a blocked edge that leads out of the lattice"),
    ]
}

fn chunks(lights: &[u8], meta: &[u8]) -> Vec<Refused> {
    let (l, m) = ("0006-lights", "0009-metadata");
    let chunk = last_chunk(meta, 22);
    let edited = |at: usize, bytes: &[u8]| in_envelope(meta, chunk.clone(), chunk.start + at, bytes);
    let first = at::END..at::END + 48;
    let light =
        |at: usize, bytes: &[u8]| in_envelope(lights, first.clone(), first.start + CHUNK_HEAD + at, bytes);
    vec![
        (m, "chunk-length", wire::CHUNK_LENGTH, edited(8, &[200]), "a chunk that reaches into the records"),
        (
            m,
            "chunk-room",
            wire::CHUNK_LENGTH,
            inserted(meta, read_u64(meta, DATA_OFFSET_AT), &[0; 8]),
            "too few bytes for a chunk between the last one and the records",
        ),
        (m, "chunk-padding", wire::CHUNK_PADDING, edited(CHUNK_HEAD + 22, &[1]), "padding that is not zero"),
        (
            m,
            "chunk-length-wraps",
            wire::CHUNK_LENGTH,
            edited(8, &[0xFF; 8]),
            "a chunk of 2⁶⁴ - 1 bytes, which with its envelope are 19 in 64 bits",
        ),
        (m, "chunk-flags", wire::RESERVED, edited(4, &[2]), "a reserved flag of a chunk"),
        (m, "chunk-reserved", wire::RESERVED, edited(5, &[1]), "the first reserved byte of a chunk"),
        (m, "chunk-reserved-second", wire::RESERVED, edited(6, &[1]), "the second reserved byte of a chunk"),
        (m, "chunk-reserved-last", wire::RESERVED, edited(7, &[1]), "the last reserved byte of a chunk"),
        (
            m,
            "chunk-repeated",
            wire::CHUNK_REPEATED,
            with_chunk(meta, b"META", false, b"seed=1\n"),
            "META twice",
        ),
        (
            m,
            "chunk-critical",
            wire::CHUNK_CRITICAL,
            with_chunk(meta, b"MUST", true, b""),
            "a critical chunk of unknown type",
        ),
        (m, "metadata", ivg::METADATA, edited(CHUNK_HEAD, b"G"), "a key with a capital letter"),
        (m, "metadata-line", ivg::METADATA, edited(CHUNK_HEAD + 21, b"!"), "the last line does not end"),
        (m, "metadata-utf8", ivg::METADATA, edited(CHUNK_HEAD + 10, &[0xFF]), "a value that is not UTF-8"),
        (m, "metadata-no-value", ivg::METADATA, edited(CHUNK_HEAD + 9, b"-"), "a line without ="),
        (l, "lights", ivg::LIGHTS, light(0, &[3]), "fewer lights than the list declares"),
        (l, "lights-more", ivg::LIGHTS, light(0, &[1]), "a light more than the list declares"),
        (l, "light-name", ivg::LIGHTS, light(8, &[0xFF]), "a name that is not UTF-8"),
        (
            l,
            "light-name-length",
            ivg::LIGHTS,
            light(17, &[9]),
            "a last name that goes a byte beyond the list",
        ),
        (
            l,
            "light-name-length-first",
            ivg::LIGHTS,
            light(6, &[20]),
            "a first name that goes a byte beyond the list",
        ),
        (l, "light-flags", wire::RESERVED, light(4, &[2]), "a reserved flag of a light"),
        (l, "light-reserved", wire::RESERVED, light(5, &[1]), "the reserved byte of a light"),
        (
            l,
            "lights-repeated",
            wire::CHUNK_REPEATED,
            with_chunk(lights, b"LITE", false, &[0; 4]),
            "a second list of lights, which is empty",
        ),
    ]
}

/// Lists of lights that end too early, and a line without a key. What a reader finds behind them, if it goes on, is padding,
/// which looks like lights without a name, and then the checksum, which has reserved bits.
fn lists(small: &[u8]) -> Vec<Refused> {
    let list = |mistake, code, kind, payload: &[u8], why| {
        ("0008-small", mistake, code, with_chunk(small, kind, false, payload), why)
    };
    vec![
        list("lights-none", ivg::LIGHTS, b"LITE", &[], "a list of lights without a count"),
        list("lights-count-cut", ivg::LIGHTS, b"LITE", &[1, 0, 0], "a list that ends within the count"),
        list(
            "light-flags-cut",
            ivg::LIGHTS,
            b"LITE",
            b"\x02\0\0\0\0\0\x03\0abc\0",
            "a list that ends behind the flags of its last light",
        ),
        list(
            "light-length-cut",
            ivg::LIGHTS,
            b"LITE",
            &[3, 0, 0, 0, 0, 0],
            "a list that ends before the length of its first name",
        ),
        list("metadata-key", ivg::METADATA, b"META", b"=conformance\n", "a key without a letter"),
    ]
}
