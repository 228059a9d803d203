//! What newer writers of `.pmesh` may write, to be skipped or refused as unsupported; and files beyond the default limits of a reader.

use super::super::edit::{
    DATA_OFFSET_AT, FILE_BYTES_AT, chunk, in_envelope, in_header, inserted, overwritten, read_u64, with_chunk,
};
use super::super::{Format, Refused, Vector, ivg};
use super::{CHUNK_HEAD, OCTAHEDRON, SEAM, at, entry, header};
use ivg_wire::codes as wire;
use pmesh_format::codes as mesh;

/// Where bits that a reader may ignore stand.
const OPTIONAL_FEATURES: usize = 16;

fn directory(file: &[u8]) -> std::ops::Range<usize> {
    let payload = header(file).packets.len() * entry::BYTES;
    at::END..at::END + ivg_wire::chunk_len(payload as u64).expect("short") as usize
}

pub(super) fn accepted(there: &[Vector]) -> Vec<Vector> {
    let file = |name: &str| &there.iter().find(|vector| vector.name == name).expect("a name").bytes[..];
    let (octahedron, seam) = (file(OCTAHEDRON), file(SEAM));
    let middle = directory(seam);
    let large: Vec<u8> = (0..3000u32).map(|n| (n % 251) as u8).collect();
    let news = chunk(seam, b"NEWS", false, b"new");
    let names = middle.end..read_u64(seam, DATA_OFFSET_AT);
    let list = [
        (
            "0060-optional-features",
            in_header(octahedron, OPTIONAL_FEATURES, &[0xFF; 4]),
            "every optional feature bit",
        ),
        (
            "0061-chunk-middle",
            inserted(seam, middle.end, &news),
            "an unknown ancillary chunk between two known ones",
        ),
        (
            "0062-chunk-last",
            with_chunk(seam, b"NEWS", false, b"new"),
            "an unknown ancillary chunk behind known ones",
        ),
        (
            "0063-chunk-empty",
            with_chunk(octahedron, b"NEWS", false, b""),
            "an unknown ancillary chunk without a payload",
        ),
        (
            "0064-chunk-large",
            with_chunk(octahedron, b"NEWS", false, &large),
            "an unknown ancillary chunk of 3000 bytes",
        ),
        (
            "0065-known-ancillary",
            in_envelope(seam, middle.clone(), middle.start + 4, &[0]),
            "a directory without the critical flag, which is not looked at for known types",
        ),
        (
            "0066-known-critical",
            in_envelope(seam, names.clone(), names.start + 4, &[1]),
            "names of materials with the critical flag, which is not looked at for known types",
        ),
        (
            "0067-minor",
            in_header(octahedron, at::MINOR, &[0xFF, 0xFF]),
            "the greatest minor version, with the known header",
        ),
    ];
    list.into_iter().map(|(name, bytes, why)| Vector::accepted(Format::Pmesh, name, bytes, why)).collect()
}

pub(super) fn refused(file: &[u8]) -> Vec<Refused> {
    let o = OCTAHEDRON;
    let edited = |field: usize, bytes: &[u8]| in_header(file, field, bytes);
    let mut list = vec![
        (o, "major-2", wire::MAJOR_VERSION, edited(at::MAJOR, &[2]), "major version 2"),
        (
            o,
            "feature-high",
            wire::REQUIRED_FEATURE,
            edited(at::REQUIRED_FEATURES, &[0, 0, 0, 0x80]),
            "the highest required feature",
        ),
        (o, "mode-private", mesh::MODE_UNKNOWN, edited(at::MODE, &[0xC1]), "a private mode"),
        (
            o,
            "positions-private",
            mesh::POSITIONS_UNKNOWN,
            edited(at::POSITIONS, &[0xC1]),
            "a private encoding of positions",
        ),
        (
            o,
            "attributes-high",
            wire::RESERVED,
            edited(at::ATTRIBUTES + 1, &[0x80]),
            "the highest reserved bit of the attributes",
        ),
    ];
    list.extend(limits(file));
    list
}

fn limits(file: &[u8]) -> Vec<Refused> {
    let o = OCTAHEDRON;
    let behind = directory(file).end;
    let many = inserted(file, behind, &chunk(file, b"MANY", false, b"").repeat(1024));
    let declared = |vertices: u32| {
        let file = overwritten(file, at::WEDGE_COUNT, &vertices.to_le_bytes());
        in_header(&file, at::VERTEX_COUNT, &vertices.to_le_bytes())[..at::END].to_vec()
    };
    vec![
        (o, "limit-counts", mesh::LIMIT_COUNTS, declared(1 << 30), "1,073,741,824 vertices in 152 bytes"),
        (o, "header", wire::LIMIT_HEADER_BYTES, ivg::limits::long_header(file, at::END), "a header of 8 KiB"),
        (
            o,
            "chunk",
            wire::LIMIT_CHUNK_BYTES,
            long_directory(file),
            "a directory of 4 MB, of which the first bytes are there",
        ),
        (o, "chunks", wire::LIMIT_CHUNKS, many, "1025 chunks"),
        (o, "entry-bytes-limit", wire::LIMIT_RECORD_BYTES, long_packet(file), "a packet of 1 GiB"),
    ]
}

/// Header and directory of a file whose first packet has 1 GiB.
fn long_packet(file: &[u8]) -> Vec<u8> {
    let (long, chunk) = (1u32 << 30, directory(file));
    let before = header(file).packets[0].payload_bytes;
    let field = chunk.start + CHUNK_HEAD + entry::PAYLOAD_BYTES;
    let longer = in_envelope(file, chunk.clone(), field, &long.to_le_bytes());
    let length = |payload: u32| (u64::from(payload) + 12).next_multiple_of(4);
    let bytes = read_u64(file, FILE_BYTES_AT) as u64 - length(before) + length(long);
    in_header(&longer, FILE_BYTES_AT, &bytes.to_le_bytes())[..chunk.end].to_vec()
}

/// The first bytes of the directory of 200,000 packets, one a vertex.
fn long_directory(file: &[u8]) -> Vec<u8> {
    let packets = 200_000u32;
    let payload = u64::from(packets) * entry::BYTES as u64;
    let mut file = file[..at::END + CHUNK_HEAD].to_vec();
    for (field, count) in [
        (at::VERTEX_COUNT, packets),
        (at::WEDGE_COUNT, packets),
        (at::BASE_VERTICES, 1),
        (at::PACKET_COUNT, packets),
    ] {
        file = overwritten(&file, field, &count.to_le_bytes());
    }
    let data = at::END as u64 + ivg_wire::chunk_len(payload).expect("four megabytes");
    file = overwritten(&file, DATA_OFFSET_AT, &data.to_le_bytes());
    // How long the packets are would stand in the directory.
    file = in_header(&file, FILE_BYTES_AT, &(data + (1 << 24)).to_le_bytes());
    overwritten(&file, at::END + 8, &payload.to_le_bytes())
}
