//! Vectors of `.pmesh`.

use super::edit::{HEADER_BYTES_AT, inserted, overwritten, with_chunk};
use super::{Format, Vector};
use pmesh_format::{EncodeOptions, Header, Limits, ProgressiveMesh, Step, Wedges, encode};
use std::ops::Range;

mod dictated;
mod forward;
mod refused;
mod refused_coded;
mod refused_frame;
mod refused_packets;
mod refused_switches;
mod variants;

/// Places of fields in the header (`spec/tables/pmesh.toml`).
mod at {
    pub(super) const MAJOR: usize = 8;
    pub(super) const MINOR: usize = 10;
    pub(super) const REQUIRED_FEATURES: usize = 12;
    pub(super) const CHECKSUM: usize = 28;
    pub(super) const VERTEX_COUNT: usize = 56;
    pub(super) const WEDGE_COUNT: usize = 60;
    pub(super) const FACE_COUNT: usize = 64;
    pub(super) const BASE_VERTICES: usize = 68;
    pub(super) const PACKET_COUNT: usize = 72;
    pub(super) const MODE: usize = 76;
    pub(super) const POSITIONS: usize = 77;
    pub(super) const ATTRIBUTES: usize = 78;
    pub(super) const ORIGIN: usize = 80;
    pub(super) const BOUNDS_MIN: usize = 104;
    pub(super) const BOUNDS_MAX: usize = 116;
    pub(super) const NORMAL_BITS: usize = 128;
    pub(super) const UV_BITS: usize = 129;
    pub(super) const UV_MIN: usize = 132;
    pub(super) const UV_MAX: usize = 140;
    pub(super) const END: usize = 152;
}

/// Places of fields in an entry of the directory, and its length.
mod entry {
    pub(super) const END_VERTEX: usize = 0;
    pub(super) const END_WEDGE: usize = 4;
    pub(super) const END_FACE: usize = 8;
    pub(super) const PAYLOAD_BYTES: usize = 12;
    pub(super) const ERROR: usize = 16;
    pub(super) const BYTES: usize = 20;
}

/// Bytes before the payload of a record, and of a chunk.
const RECORD_HEAD: usize = 8;
const CHUNK_HEAD: usize = 16;

const CODED_ATTRIBUTES: &str = "0051-coded-attributes";
const EMPTY: &str = "0001-empty";
const EQUAL_PACKETS: &str = "0009-equal-packets";
const OCTAHEDRON: &str = "0003-octahedron";
const ONE_PACKET: &str = "0004-one-packet";
const SEAM: &str = "0005-seam";

pub(super) fn vectors() -> Vec<Vector> {
    let mut vectors = accepted();
    vectors.extend(variants::accepted());
    vectors.extend(forward::accepted(&vectors));
    let refused = refused::refused(&vectors);
    vectors.extend(refused);
    vectors
}

/// A triangle, and three vertices above its middle and two sides that make it an octahedron: three splits.
fn octahedron() -> ProgressiveMesh {
    ProgressiveMesh {
        origin: [10.0, 0.0, -2.5],
        positions: vec![
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [-1.0, 0.0, 0.0],
            [0.0, -1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, 0.0, -1.0],
        ],
        wedges: Wedges { vertices: (0..6).collect(), ..Wedges::default() },
        base_vertices: 3,
        collapse: vec![2, 0, 1],
        wedge_collapse: vec![2, 0, 1],
        errors: vec![0.75, 0.5, 0.25],
        faces: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]],
        materials: Vec::new(),
        material_names: Vec::new(),
    }
}

/// Two triangles of a floor and two of a wall below it, with a vertex in the middle of the edge between: the vertices of the
/// edge have two wedges each, since normals differ.
fn seam() -> ProgressiveMesh {
    let (up, side) = ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    ProgressiveMesh {
        positions: vec![[0.0, 0.5, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.5, -1.0], [1.0, 0.5, 0.0]],
        wedges: Wedges {
            vertices: vec![0, 1, 1, 2, 2, 3, 4, 4],
            normals: vec![up, up, side, up, side, side, up, side],
            ..Wedges::default()
        },
        base_vertices: 3,
        collapse: vec![1, 1],
        wedge_collapse: vec![2, 1, 2],
        errors: vec![1.0, 0.25],
        faces: vec![[0, 1, 6], [0, 6, 3], [2, 5, 7], [7, 5, 4]],
        materials: vec![0, 0, 1, 1],
        material_names: vec!["floor".to_owned(), "Wände".to_owned()],
        ..ProgressiveMesh::default()
    }
}

fn coloured() -> ProgressiveMesh {
    let mut mesh = octahedron();
    mesh.wedges.colours = (0..6).map(|n| [n * 40, 255 - n, 7, 255]).collect();
    mesh.wedges.uvs = (0..6u8).map(|n| [f32::from(n) / 8.0, 1.0]).collect();
    mesh
}

fn triangle() -> ProgressiveMesh {
    ProgressiveMesh {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        wedges: Wedges { vertices: vec![0, 1, 2], ..Wedges::default() },
        base_vertices: 3,
        faces: vec![[0, 1, 2]],
        ..ProgressiveMesh::default()
    }
}

fn points() -> ProgressiveMesh {
    ProgressiveMesh { faces: Vec::new(), ..octahedron() }
}

fn accepted() -> Vec<Vector> {
    let file = |mesh: &ProgressiveMesh, vertices| {
        encode(mesh, &EncodeOptions::fixed(vertices)).expect("a sound mesh")
    };
    let octahedron = file(&octahedron(), 2);
    let list = [
        (EMPTY, file(&ProgressiveMesh::default(), 1), "no vertices: no packet"),
        ("0002-triangle", file(&triangle(), 1), "the coarsest level is the finest"),
        (OCTAHEDRON, octahedron.clone(), "three splits in three packets, an origin"),
        (
            ONE_PACKET,
            file(&coloured(), 100),
            "texture coordinates and colours; one packet brings four levels",
        ),
        (
            SEAM,
            file(&seam(), 1),
            "two wedges at the vertices of an edge, materials with names, a corner that switches on either side",
        ),
        ("0006-points", file(&points(), 3), "vertices without a face"),
        (
            "0007-unknown-chunk",
            with_chunk(&octahedron, b"NEWS", false, b"?"),
            "an ancillary chunk of unknown type is skipped",
        ),
        ("0008-newer-minor", newer_minor(&octahedron), "a newer minor version with a longer header"),
        (EQUAL_PACKETS, equal_packets(1.0), "packets of equal length: one vertex each"),
    ];
    list.into_iter().map(|(name, bytes, why)| Vector::accepted(Format::Pmesh, name, bytes, why)).collect()
}

/// Four packets, of which the last three have equal lengths; files of different `size` have different ids.
fn equal_packets(size: f32) -> Vec<u8> {
    let mut mesh = points();
    mesh.positions[5][2] = -size;
    encode(&mesh, &EncodeOptions::fixed(1)).expect("a sound mesh")
}

/// Eight more bytes of header, as a later minor version may append.
fn newer_minor(file: &[u8]) -> Vec<u8> {
    let file = overwritten(file, at::MINOR, &[9, 0]);
    let file = overwritten(&file, HEADER_BYTES_AT, &(at::END as u32 + 8).to_le_bytes());
    inserted(&file, at::END, &[0xA5; 8])
}

/// Where a packet lies in a file that is right.
fn packet(file: &[u8], k: u32) -> Range<usize> {
    let range = header(file).packet_range(k);
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
    let mut records: Vec<_> =
        (0..header.packet_count()).map(|k| (format!("packet {k}"), packet(file, k))).collect();
    let end = header.end_range();
    records.push(("end".to_owned(), end.start as usize..end.end as usize));
    records
}
