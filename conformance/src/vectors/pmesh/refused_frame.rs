//! Files of `.pmesh` to refuse for their frame, their header, or the order of their records.

use super::super::Refused;
use super::super::edit::{
    DATA_OFFSET_AT, FILE_BYTES_AT, HEADER_BYTES_AT, flipped, in_envelope, in_header, overwritten, read_u64,
    with_chunk,
};
use super::{CHUNK_HEAD, CODED_ATTRIBUTES, EMPTY, EQUAL_PACKETS, OCTAHEDRON, RECORD_HEAD, SEAM, at, packet};
use ivg_wire::codes as wire;
use pmesh_format::codes as mesh;

pub(super) fn container(file: &[u8]) -> Vec<Refused> {
    let o = OCTAHEDRON;
    let first = packet(file, 0);
    let end = file.len() - 20..file.len();
    let longer = ((read_u64(file, FILE_BYTES_AT) + 4) as u64).to_le_bytes();
    let no_chunks = in_header(file, DATA_OFFSET_AT, &(at::END as u64).to_le_bytes());
    vec![
        (o, "signature", wire::MAGIC, in_header(file, 1, b"IVG"), "the signature of another format"),
        (o, "major", wire::MAJOR_VERSION, in_header(file, at::MAJOR, &[1]), "another major version"),
        (
            o,
            "feature",
            wire::REQUIRED_FEATURE,
            in_header(file, at::REQUIRED_FEATURES, &[1]),
            "an unknown required feature",
        ),
        (
            o,
            "header-bytes",
            wire::HEADER_BYTES,
            in_header(file, HEADER_BYTES_AT, &[120]),
            "a header length of another version",
        ),
        (
            o,
            "header-checksum",
            wire::HEADER_CHECKSUM,
            flipped(file, at::CHECKSUM),
            "a bit of the header's checksum",
        ),
        (
            o,
            "attributes",
            wire::RESERVED,
            in_header(file, at::ATTRIBUTES, &[0x20]),
            "a reserved bit of the attributes",
        ),
        (
            o,
            "parameters-reserved",
            wire::RESERVED,
            in_header(file, at::NORMAL_BITS + 2, &[1]),
            "a reserved field behind the bits of coded attributes",
        ),
        (
            o,
            "header-end",
            wire::RESERVED,
            in_header(file, at::END - 4, &[1]),
            "a reserved field at the end of the header",
        ),
        (
            o,
            "parameters",
            mesh::PARAMETERS,
            in_header(file, at::NORMAL_BITS, &[10]),
            "bits of coded normals in a file without them",
        ),
        (
            o,
            "file-bytes",
            wire::FILE_BYTES,
            in_header(file, FILE_BYTES_AT, &longer),
            "the file length does not follow from the directory",
        ),
        (
            o,
            "chunk-checksum",
            wire::CHUNK_CHECKSUM,
            flipped(file, at::END + CHUNK_HEAD),
            "a bit of the directory",
        ),
        (
            o,
            "chunk-critical",
            wire::CHUNK_CRITICAL,
            with_chunk(file, b"MUST", true, b""),
            "a critical chunk of unknown type",
        ),
        (
            o,
            "directory-repeated",
            wire::CHUNK_REPEATED,
            with_chunk(file, b"PDIR", true, b""),
            "a second directory",
        ),
        (
            o,
            "record-checksum",
            wire::RECORD_CHECKSUM,
            flipped(file, first.start + RECORD_HEAD),
            "a bit of a packet",
        ),
        (
            o,
            "record-id",
            wire::RECORD_ID,
            in_envelope(file, first.clone(), first.start, &[1]),
            "packet 1 where packet 0 belongs",
        ),
        (
            o,
            "record-generation",
            wire::RESERVED,
            in_envelope(file, first.clone(), first.start + 4, &[1]),
            "a packet that came again",
        ),
        (
            o,
            "end",
            wire::END_MISMATCH,
            in_envelope(file, end.clone(), end.start + RECORD_HEAD, &[0]),
            "the end record names another length",
        ),
        (
            o,
            "end-generation",
            wire::END_MISMATCH,
            in_envelope(file, end.clone(), end.start + 4, &[1]),
            "an end record that came again",
        ),
        (o, "trailing", wire::TRAILING_BYTES, [file, &[0]].concat(), "a byte behind the end record"),
        (o, "no-directory", mesh::DIRECTORY_MISSING, no_chunks, "records begin where the directory should"),
    ]
}

/// Packets 1, 2 and 3 have one length, so that any of them fits where another belongs.
pub(super) fn records(file: &[u8]) -> Vec<Refused> {
    let record = |file: &[u8], k: u32| file[packet(file, k)].to_vec();
    let with = |k: u32, bytes: &[u8]| overwritten(file, packet(file, k).start, bytes);
    let other = super::equal_packets(0.5);
    let both = |bytes: &[u8], k: u32| overwritten(bytes, packet(file, k).start, &record(file, 3 - k));
    vec![
        (
            EQUAL_PACKETS,
            "packets-swapped",
            wire::RECORD_ID,
            both(&with(1, &record(file, 2)), 2),
            "packets 1 and 2 in the other order",
        ),
        (
            EQUAL_PACKETS,
            "packet-repeated",
            wire::RECORD_ID,
            with(2, &record(file, 1)),
            "packet 1 again where packet 2 belongs",
        ),
        (
            EQUAL_PACKETS,
            "packet-missing",
            wire::RECORD_ID,
            with(2, &record(file, 3)),
            "packet 3 where packet 2 belongs",
        ),
        (
            EQUAL_PACKETS,
            "packet-of-another-file",
            wire::RECORD_CHECKSUM,
            with(2, &record(&other, 2)),
            "packet 2 of another version of the mesh",
        ),
    ]
}

pub(super) fn headers(file: &[u8]) -> Vec<Refused> {
    let o = OCTAHEDRON;
    let edited = |field: usize, bytes: &[u8]| in_header(file, field, bytes);
    let count = |field: usize, count: u32| edited(field, &count.to_le_bytes());
    let nan = f32::NAN.to_le_bytes();
    vec![
        (
            o,
            "vertex-count",
            mesh::COUNTS,
            count(at::VERTEX_COUNT, (1 << 30) + 1),
            "more vertices than the format holds",
        ),
        (
            o,
            "vertices-and-wedges",
            mesh::COUNTS,
            edited(at::VERTEX_COUNT, &[(1u32 << 30) + 1; 2].map(u32::to_le_bytes).concat()),
            "more vertices than the format holds, and as many wedges",
        ),
        (
            o,
            "wedge-count",
            mesh::COUNTS,
            count(at::WEDGE_COUNT, 7),
            "more wedges than vertices, and no attributes",
        ),
        (o, "face-count", mesh::COUNTS, count(at::FACE_COUNT, u32::MAX), "more faces than the format holds"),
        (o, "base-0", mesh::COUNTS, count(at::BASE_VERTICES, 0), "vertices without a base"),
        (
            o,
            "base-above",
            mesh::COUNTS,
            count(at::BASE_VERTICES, 7),
            "more vertices in the base than there are",
        ),
        (o, "packets-0", mesh::COUNTS, count(at::PACKET_COUNT, 0), "vertices without a packet"),
        (o, "packets-many", mesh::COUNTS, count(at::PACKET_COUNT, 5), "more packets than splits and one"),
        (o, "mode-0", mesh::MODE_FORBIDDEN, edited(at::MODE, &[0]), "mode 0 does not exist"),
        (o, "mode-unknown", mesh::MODE_UNKNOWN, edited(at::MODE, &[200]), "a mode that nobody has defined"),
        (
            o,
            "positions-0",
            mesh::POSITIONS_FORBIDDEN,
            edited(at::POSITIONS, &[0]),
            "position encoding 0 does not exist",
        ),
        (
            o,
            "positions-unknown",
            mesh::POSITIONS_UNKNOWN,
            edited(at::POSITIONS, &[200]),
            "an encoding of positions that nobody has defined",
        ),
        (
            o,
            "origin",
            mesh::MESH_ORIGIN,
            edited(at::ORIGIN + 8, &f64::INFINITY.to_le_bytes()),
            "an origin at infinity",
        ),
        (o, "bounds-nan", mesh::BOUNDS, edited(at::BOUNDS_MIN, &nan), "bounds that are no number"),
        (
            o,
            "bounds-infinite",
            mesh::BOUNDS,
            edited(at::BOUNDS_MIN, &f32::NEG_INFINITY.to_le_bytes()),
            "bounds without end, which hold every position",
        ),
        (
            o,
            "bounds-max-nan",
            mesh::BOUNDS,
            edited(at::BOUNDS_MAX, &nan),
            "a greatest coordinate that is no number",
        ),
        (
            o,
            "bounds-max-infinite",
            mesh::BOUNDS,
            edited(at::BOUNDS_MAX, &f32::INFINITY.to_le_bytes()),
            "a greatest coordinate at infinity",
        ),
        (
            o,
            "bounds-crossed",
            mesh::BOUNDS,
            edited(at::BOUNDS_MAX + 4, &(-2.0f32).to_le_bytes()),
            "bounds that are inside out",
        ),
    ]
}

/// Counts that do not fit each other where there is no vertex, or where vertices have several wedges.
pub(super) fn counts(empty: &[u8], seam: &[u8]) -> Vec<Refused> {
    let one = |field: usize| in_header(empty, field, &[1]);
    let bare = in_header(seam, at::ATTRIBUTES, &[0x18]);
    // Normals and seams, without which there is one wedge a vertex.
    let wedges = in_header(&overwritten(empty, at::ATTRIBUTES, &[0x11]), at::WEDGE_COUNT, &[1]);
    vec![
        (EMPTY, "faces-alone", mesh::COUNTS, one(at::FACE_COUNT), "a face without vertices"),
        (EMPTY, "base-alone", mesh::COUNTS, one(at::BASE_VERTICES), "a base without vertices"),
        (EMPTY, "wedges-alone", mesh::COUNTS, wedges, "a wedge without vertices"),
        (EMPTY, "packets-alone", mesh::COUNTS, one(at::PACKET_COUNT), "a packet without vertices"),
        (
            SEAM,
            "wedges-few",
            mesh::COUNTS,
            in_header(seam, at::WEDGE_COUNT, &[4]),
            "fewer wedges than vertices",
        ),
        (
            SEAM,
            "wedges-too-many",
            mesh::COUNTS,
            in_header(seam, at::WEDGE_COUNT, &((1u32 << 30) + 1).to_le_bytes()),
            "more wedges than the format holds",
        ),
        (SEAM, "wedges-bare", mesh::COUNTS, bare, "several wedges a vertex, and no attribute to differ in"),
    ]
}

/// What coded attributes are quantised with (PMESH-HDR-08): in a file with coded texture coordinates, and in one without.
pub(super) fn parameters(plain: &[u8], coded: &[u8]) -> Vec<Refused> {
    let of = |twin, file: &[u8], mistake, field: usize, bytes: &[u8], why| {
        (twin, mistake, mesh::PARAMETERS, in_header(file, field, bytes), why)
    };
    let plain = |mistake, field, bytes: &[u8], why| of(OCTAHEDRON, plain, mistake, field, bytes, why);
    let coded = |mistake, field, bytes: &[u8], why| of(CODED_ATTRIBUTES, coded, mistake, field, bytes, why);
    let number = f32::to_le_bytes;
    vec![
        coded("normal-bits-few", at::NORMAL_BITS, &[3], "fewer bits of normals than there may be"),
        coded("normal-bits-many", at::NORMAL_BITS, &[17], "more bits of normals than there may be"),
        coded("uv-bits-few", at::UV_BITS, &[0], "no bits of texture coordinates"),
        coded("uv-bits-many", at::UV_BITS, &[17], "more bits of texture coordinates than there may be"),
        plain("uv-bits-unused", at::UV_BITS, &[10], "bits of texture coordinates in a file without them"),
        coded("uv-min-infinite", at::UV_MIN, &number(f32::NEG_INFINITY), "a bound without end"),
        plain(
            "uv-min-unused",
            at::UV_MIN,
            &number(-1.0),
            "a bound of texture coordinates that are not there",
        ),
        coded("uv-max-nan", at::UV_MAX + 4, &number(f32::NAN), "a bound that is no number"),
        coded(
            "uv-max-crossed",
            at::UV_MAX,
            &number(0.0),
            "bounds of texture coordinates that are inside out",
        ),
        plain("uv-max-unused", at::UV_MAX, &number(1.0), "a bound of texture coordinates that are not there"),
    ]
}
