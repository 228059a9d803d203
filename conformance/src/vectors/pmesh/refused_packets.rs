//! Files of `.pmesh` to refuse for what a raw packet says of collapses, wedges and faces.

use super::super::Refused;
use super::super::parts::Parts;
use super::refused::{payload, with_payload};
use super::{OCTAHEDRON, ONE_PACKET, SEAM, header};
use pmesh_format::codes as mesh;

/// The file with something else in packet `k`.
pub(super) fn lie(file: &[u8], k: u32, edit: impl FnOnce(&mut Parts)) -> Vec<u8> {
    let mut parts = Parts::read(&header(file), k, &payload(file, k));
    edit(&mut parts);
    with_payload(file, k, &parts.payload())
}

/// The payload of packet `k` up to its parents and behind them.
fn behind_parents(file: &[u8], k: u32) -> (Vec<u8>, Vec<u8>) {
    let whole = payload(file, k);
    let parts = Parts::read(&header(file), k, &whole);
    let parts = Parts { wedge_counts: Vec::new(), wedge_targets: Vec::new(), ..parts };
    let (before, behind) = whole.split_at(parts.before_slots().len());
    (before.to_vec(), behind.to_vec())
}

pub(super) fn collapses(file: &[u8], one_packet: &[u8]) -> Vec<Refused> {
    let o = OCTAHEDRON;
    let last = header(file).packet_count() - 1;
    let own = header(file).packets[last as usize].vertices.start;
    let parent = |k: u32, parent: u32| lie(file, k, |parts| parts.parents[0] = parent);
    let (mut padded, behind) = behind_parents(file, last);
    *padded.last_mut().expect("a parent") |= 0x80;
    padded.extend(behind);
    vec![
        (o, "parent-itself", mesh::PARENT, parent(last, own), "a vertex that collapses onto itself"),
        (o, "parent-later", mesh::PARENT, parent(1, 4), "a vertex that collapses onto a later one"),
        (
            ONE_PACKET,
            "parents-cycle",
            mesh::PARENT,
            lie(one_packet, 0, |parts| parts.parents[..2].copy_from_slice(&[4, 3])),
            "two vertices that collapse onto each other",
        ),
        (
            o,
            "parents-padding",
            mesh::PACKET_PADDING,
            with_payload(file, last, &padded),
            "a bit behind the last parent",
        ),
    ]
}

pub(super) fn faces(file: &[u8], seam: &[u8]) -> Vec<Refused> {
    let o = OCTAHEDRON;
    let later = header(file).packets[1].wedges.end;
    let corner = |n: usize, wedge: u32| lie(file, 1, |parts| parts.corners[0][n] = wedge);
    let twice = |n: usize, of: usize| lie(file, 1, |parts| parts.corners[1][n] = parts.corners[1][of]);
    let last_face = |parts: &mut Parts| parts.corners.last_mut().expect("a face")[2] = 0xFFFF_FFFF;
    vec![
        (o, "corner", mesh::CORNER, lie(file, 1, last_face), "a face that names a wedge that does not exist"),
        (o, "corner-later", mesh::CORNER, corner(0, later), "a face that names a wedge of the next packet"),
        (o, "face-twice", mesh::FACE_VERTICES, twice(1, 0), "a face whose first two corners are one vertex"),
        (
            o,
            "face-twice-last",
            mesh::FACE_VERTICES,
            twice(2, 1),
            "a face whose last two corners are one vertex",
        ),
        (
            o,
            "face-twice-ends",
            mesh::FACE_VERTICES,
            twice(2, 0),
            "a face whose first and last corners are one vertex",
        ),
        (
            SEAM,
            "face-two-wedges",
            mesh::FACE_VERTICES,
            // Vertex 1 has the wedges 1 and 2.
            lie(seam, 0, |parts| parts.corners[0] = [0, 1, 2]),
            "a face with two wedges of one vertex",
        ),
    ]
}

pub(super) fn wedges(file: &[u8]) -> Vec<Refused> {
    // The first packet has vertices of one, two and two wedges; the last has one vertex of two, and where these go.
    let count = |n: usize, count: u32| lie(file, 0, |parts| parts.wedge_counts[n] = count);
    let instead = |k: u32, bytes: &[u8]| with_payload(file, k, &[&behind_parents(file, k).0, bytes].concat());
    let bytes = |k: u32, at: usize, with: &[u8]| {
        let mut behind = behind_parents(file, k).1;
        behind.splice(at..=at, with.iter().copied());
        instead(k, &behind)
    };
    vec![
        (SEAM, "wedges-few", mesh::WEDGE_COUNT, count(2, 1), "fewer wedges than the packet has"),
        (SEAM, "wedges-many", mesh::WEDGE_COUNT, count(0, 2), "more wedges than the packet has"),
        (SEAM, "wedges-0", mesh::WEDGE_COUNT, count(1, 0), "a vertex without a wedge"),
        (
            SEAM,
            "wedges-0-of-all",
            mesh::WEDGE_COUNT,
            lie(file, 0, |parts| parts.wedge_counts = vec![1, 0, 4]),
            "a vertex without a wedge, though the packet has as many as it should",
        ),
        (
            SEAM,
            "varint-33-bits",
            mesh::VARINT,
            instead(0, &[0x81, 0x80, 0x80, 0x80, 0x10]),
            "a number of 33 bits",
        ),
        (
            SEAM,
            "varint-6-bytes",
            mesh::VARINT,
            instead(0, &[0x81, 0x80, 0x80, 0x80, 0x80, 0x01]),
            "a number that goes on after its fifth byte",
        ),
        (
            SEAM,
            "varint-cut",
            mesh::PACKET_LENGTH,
            instead(0, &[1, 2]),
            "a payload that ends before the last number of wedges",
        ),
        (
            SEAM,
            "varint-cut-within",
            mesh::PACKET_LENGTH,
            instead(0, &[1, 2, 0x82]),
            "a payload that ends within the last number of wedges",
        ),
        (SEAM, "varint", mesh::VARINT, bytes(2, 1, &[0x80, 0x00]), "a number longer than it needs to be"),
        (
            SEAM,
            "wedge-target",
            mesh::WEDGE_TARGET,
            lie(file, 2, |parts| parts.wedge_targets[0] = 2),
            "a wedge that the parent does not have",
        ),
    ]
}
