//! Files of `.pmesh` to refuse.

use super::super::edit::{in_envelope, in_header, last_chunk, replaced, with_chunk};
use super::super::{Format, Refused, Vector};
use super::refused_frame as frame;
use super::{
    CHUNK_HEAD, EMPTY, EQUAL_PACKETS, OCTAHEDRON, ONE_PACKET, RECORD_HEAD, SEAM, at, entry, header, packet,
};
use ivg_wire::codes as wire;
use pmesh_format::codes as mesh;

pub(super) fn refused(accepted: &[Vector]) -> Vec<Vector> {
    let twin = |name: &str| &accepted.iter().find(|vector| vector.name == name).expect("a name").bytes[..];
    let octahedron = twin(OCTAHEDRON);
    let mut list = frame::container(octahedron);
    list.extend(frame::records(twin(EQUAL_PACKETS)));
    list.extend(frame::headers(octahedron));
    list.extend(frame::counts(twin(EMPTY), twin(SEAM)));
    list.extend(directory(octahedron));
    list.extend(names(twin(SEAM)));
    list.extend(points(twin("0022-raw-q12"), twin("0027-raw-q12-plane")));
    list.extend(numbers(octahedron, twin(SEAM), twin(ONE_PACKET)));
    list.extend(topology(octahedron, twin(ONE_PACKET)));
    list.extend(wedges(twin(SEAM)));
    list.extend(switches(octahedron, twin(SEAM)));
    list.extend(super::refused_coded::refused(twin));
    list.into_iter().map(|refused| Vector::refused(Format::Pmesh, refused)).collect()
}

fn directory(file: &[u8]) -> Vec<Refused> {
    let o = OCTAHEDRON;
    let packets = header(file).packets.len();
    let chunk = last_chunk(file, packets * entry::BYTES);
    let edited = |at: usize, bytes: &[u8]| in_envelope(file, chunk.clone(), chunk.start + at, bytes);
    let field =
        |k: usize, field: usize, bytes: [u8; 4]| edited(CHUNK_HEAD + k * entry::BYTES + field, &bytes);
    let number = |k: usize, at: usize, value: u32| field(k, at, value.to_le_bytes());
    let error = |k: usize, value: f32| field(k, entry::ERROR, value.to_le_bytes());
    vec![
        (
            o,
            "directory-kind",
            mesh::DIRECTORY_MISSING,
            edited(0, b"NEWS"),
            "another chunk where the directory belongs",
        ),
        (
            o,
            "directory-short",
            mesh::DIRECTORY_LENGTH,
            number_of_packets(file, packets - 1),
            "an entry more than there are packets",
        ),
        (
            o,
            "entry-order",
            mesh::DIRECTORY_COUNTS,
            number(1, entry::END_VERTEX, 3),
            "a packet without a vertex",
        ),
        (
            o,
            "entry-base",
            mesh::DIRECTORY_COUNTS,
            number(0, entry::END_VERTEX, 2),
            "a first packet without the whole base",
        ),
        (
            o,
            "entry-vertices",
            mesh::DIRECTORY_COUNTS,
            number(packets - 1, entry::END_VERTEX, 9),
            "more vertices than the header says",
        ),
        (
            o,
            "entry-wedges",
            mesh::DIRECTORY_COUNTS,
            number(0, entry::END_WEDGE, 4),
            "more wedges than vertices",
        ),
        (
            o,
            "entry-faces",
            mesh::DIRECTORY_COUNTS,
            number(packets - 1, entry::END_FACE, 0),
            "fewer faces than before",
        ),
        (
            o,
            "entry-missing-face",
            mesh::DIRECTORY_COUNTS,
            number(packets - 1, entry::END_FACE, 7),
            "fewer faces than the header says",
        ),
        (
            o,
            "entry-bytes",
            mesh::DIRECTORY_BYTES,
            number(0, entry::PAYLOAD_BYTES, 8),
            "a packet too short for its positions",
        ),
        (
            o,
            "entry-bytes-huge",
            mesh::DIRECTORY_BYTES,
            number(0, entry::PAYLOAD_BYTES, u32::MAX),
            "a packet longer than a record may be",
        ),
        (
            o,
            "entry-bytes-limit",
            wire::LIMIT_RECORD_BYTES,
            number(0, entry::PAYLOAD_BYTES, 1 << 30),
            "a packet of 1 GiB",
        ),
        (o, "entry-error-nan", mesh::DIRECTORY_ERROR, error(0, f32::NAN), "an error that is no number"),
        (o, "entry-error-negative", mesh::DIRECTORY_ERROR, error(packets - 1, -1.0), "a negative error"),
        (
            o,
            "entry-error-rises",
            mesh::DIRECTORY_ERROR,
            error(1, 1000.0),
            "an error greater than that of the packet before",
        ),
    ]
}

fn number_of_packets(file: &[u8], packets: usize) -> Vec<u8> {
    in_header(file, at::PACKET_COUNT, &(packets as u32).to_le_bytes())
}

fn names(file: &[u8]) -> Vec<Refused> {
    // Two names: lengths of two bytes, and 5 and 6 bytes.
    let chunk = last_chunk(file, 15);
    let edited =
        |at: usize, byte: u8| in_envelope(file, chunk.clone(), chunk.start + CHUNK_HEAD + at, &[byte]);
    let twice = with_chunk(file, b"MTRL", false, b"");
    vec![
        (SEAM, "name-length", mesh::MATERIAL_NAMES, edited(7, 9), "a name that goes beyond the chunk"),
        (SEAM, "name-utf8", mesh::MATERIAL_NAMES, edited(10, 0xFF), "a name that is not UTF-8"),
        (SEAM, "names-repeated", wire::CHUNK_REPEATED, twice, "names of materials twice"),
    ]
}

/// An edit in the payload of a packet.
fn in_packet(file: &[u8], k: u32, at: usize, bytes: &[u8]) -> Vec<u8> {
    let record = packet(file, k);
    in_envelope(file, record.clone(), record.start + RECORD_HEAD + at, bytes)
}

/// Gives packet `k` another payload, of any length, as directory, header and end record say.
pub(super) fn with_payload(file: &[u8], k: u32, payload: &[u8]) -> Vec<u8> {
    let record = packet(file, k);
    let file = in_directory(file, k, entry::PAYLOAD_BYTES, payload.len() as u32);
    replaced(&file, record, k, payload)
}

/// Another number in a field of the directory's entry for packet `k`.
pub(super) fn in_directory(file: &[u8], k: u32, field: usize, value: u32) -> Vec<u8> {
    let length = ivg_wire::chunk_len((header(file).packets.len() * entry::BYTES) as u64).expect("short");
    let chunk = at::END..at::END + length as usize;
    let at = chunk.start + CHUNK_HEAD + k as usize * entry::BYTES + field;
    in_envelope(file, chunk, at, &value.to_le_bytes())
}

/// The payload of packet `k`.
pub(super) fn payload(file: &[u8], k: u32) -> Vec<u8> {
    let start = packet(file, k).start + RECORD_HEAD;
    file[start..start + header(file).packets[k as usize].payload_bytes as usize].to_vec()
}

fn numbers(file: &[u8], seam: &[u8], coloured: &[u8]) -> Vec<Refused> {
    let position = |value: f32| in_packet(file, 0, 12, &value.to_le_bytes());
    // Behind the positions of three vertices.
    let normal = |value: f32| in_packet(seam, 0, 3 * 12, &value.to_le_bytes());
    vec![
        (OCTAHEDRON, "position-nan", mesh::POSITION, position(f32::NAN), "a position that is no number"),
        (OCTAHEDRON, "position-outside", mesh::POSITION, position(1.5), "a position outside the bounds"),
        (SEAM, "normal-nan", mesh::ATTRIBUTE, normal(f32::NAN), "a normal that is no number"),
        // Behind the positions of six vertices.
        (
            ONE_PACKET,
            "uv-infinite",
            mesh::ATTRIBUTE,
            in_packet(coloured, 0, 6 * 12 + 4, &f32::INFINITY.to_le_bytes()),
            "texture coordinates at infinity",
        ),
    ]
}

/// Points of a lattice: four u16 each.
fn points(file: &[u8], plane: &[u8]) -> Vec<Refused> {
    let number = |file: &[u8], point: usize, at: usize, value: u16| {
        in_packet(file, 0, 8 * point + 2 * at, &value.to_le_bytes())
    };
    let longest = {
        let [low, high] = header(file).bounds;
        let extent = |k: usize| f64::from(high[k]) - f64::from(low[k]);
        (0..3).max_by(|&a, &b| extent(a).total_cmp(&extent(b))).expect("three axes")
    };
    vec![
        (
            "0022-raw-q12",
            "point-outside",
            mesh::POSITION,
            number(file, 1, longest, 4096),
            "a number of 13 bits in a lattice of 12",
        ),
        (
            "0027-raw-q12-plane",
            "point-off-plane",
            mesh::POSITION,
            number(plane, 2, 1, 1),
            "a number other than 0 along an axis without extent",
        ),
        (
            "0022-raw-q12",
            "point-fourth",
            mesh::POSITION,
            number(file, 0, 3, 1),
            "a fourth number that is not 0",
        ),
    ]
}

fn topology(file: &[u8], one_packet: &[u8]) -> Vec<Refused> {
    let o = OCTAHEDRON;
    let header = header(file);
    // Of the packet: positions, corners of its faces, parents; the file has no attributes.
    let last = header.packet_count() - 1;
    let counts = |k: u32| (header.packets[k as usize].vertices.len(), header.packets[k as usize].faces.len());
    let corners = |k: u32| counts(k).0 * 12;
    let parents = |k: u32| corners(k) + counts(k).1 * 12;
    let corner = |k: u32, n: usize, wedge: u32| in_packet(file, k, corners(k) + n * 4, &wedge.to_le_bytes());
    let parent = |k: u32, vertex: u32| in_packet(file, k, parents(k), &vertex.to_le_bytes());
    let own = header.packets[last as usize].vertices.start;
    vec![
        (o, "parent-itself", mesh::PARENT, parent(last, own), "a vertex that collapses onto itself"),
        (
            o,
            "parent-later",
            mesh::PARENT,
            parent(1, own),
            "a vertex that collapses onto one that has not arrived",
        ),
        (
            ONE_PACKET,
            "parents-cycle",
            mesh::PARENT,
            // Behind positions, texture coordinates, colours and eight faces: two vertices that collapse onto each other.
            in_packet(one_packet, 0, 6 * (12 + 8 + 4) + 8 * 12, &[4, 0, 0, 0, 3, 0, 0, 0]),
            "two vertices that collapse onto each other",
        ),
        (o, "corner", mesh::CORNER, corner(1, 0, u32::MAX), "a face that names a wedge that does not exist"),
        (o, "corner-later", mesh::CORNER, corner(1, 0, own), "a face that names a wedge of the next packet"),
        (
            o,
            "face-twice",
            mesh::FACE_VERTICES,
            same_corners(file, last, corners(last)),
            "a face with one vertex twice",
        ),
    ]
}

/// The second corner of the first face of a packet is the first one again.
fn same_corners(file: &[u8], k: u32, corners: usize) -> Vec<u8> {
    let start = packet(file, k).start + RECORD_HEAD + corners;
    let first: [u8; 4] = *file[start..].first_chunk().expect("a corner");
    in_packet(file, k, corners + 4, &first)
}

/// Where the numbers of variable length of a packet of the folded strip begin: behind positions, normals, corners, parents and
/// materials.
fn varints(file: &[u8], k: u32) -> usize {
    let header = header(file);
    let entry = &header.packets[k as usize];
    let splits = entry.vertices.end - entry.vertices.start.max(header.base_vertices);
    12 * (entry.vertices.len() + entry.wedges.len()) + (12 + 2) * entry.faces.len() + 4 * splits as usize
}

fn wedges(file: &[u8]) -> Vec<Refused> {
    // The first packet has vertices of one, two and two wedges; the last has one vertex of two, and where these go.
    let count = varints(file, 0);
    let target = varints(file, 2) + 1;
    let first = payload(file, 0);
    let instead = |bytes: &[u8]| with_payload(file, 0, &[&first[..count], bytes].concat());
    vec![
        (
            SEAM,
            "wedges-few",
            mesh::WEDGE_COUNT,
            in_packet(file, 0, count + 2, &[1]),
            "fewer wedges than the packet has",
        ),
        (
            SEAM,
            "varint-33-bits",
            mesh::VARINT,
            instead(&[0x81, 0x80, 0x80, 0x80, 0x10]),
            "a number of 33 bits",
        ),
        (
            SEAM,
            "varint-cut",
            mesh::PACKET_LENGTH,
            instead(&[1, 2]),
            "a payload that ends before the last number of wedges",
        ),
        (
            SEAM,
            "wedges-many",
            mesh::WEDGE_COUNT,
            in_packet(file, 0, count, &[2]),
            "more wedges than the packet has",
        ),
        (SEAM, "wedges-0", mesh::WEDGE_COUNT, in_packet(file, 0, count, &[0]), "a vertex without a wedge"),
        (
            SEAM,
            "varint",
            mesh::VARINT,
            in_packet(file, 2, target, &[0x80, 0x00]),
            "a number longer than it needs to be",
        ),
        (
            SEAM,
            "wedge-target",
            mesh::WEDGE_TARGET,
            in_packet(file, 2, target, &[2]),
            "a wedge that the parent does not have",
        ),
    ]
}

fn switches(file: &[u8], seam: &[u8]) -> Vec<Refused> {
    let header = header(file);
    let last = header.packet_count() - 1;
    let end = header.packets[last as usize].payload_bytes as usize;
    let byte = file[packet(file, last).start + RECORD_HEAD + end - 1];
    let padding = in_packet(file, last, end - 1, &[byte | 0x80]);
    // Two codes of two bits: to wedge 2 on the wall, to wedge 1 on the floor.
    let codes = varints(seam, 2) + 3;
    let code = |bits: u8| in_packet(seam, 2, codes, &[bits]);
    vec![
        (OCTAHEDRON, "switch-padding", mesh::PACKET_PADDING, padding, "a bit behind the last switch code"),
        (SEAM, "switch-high", mesh::SWITCH, code(0b01_11), "a switch code above the number of wedges"),
        (
            SEAM,
            "switch-crossed",
            mesh::SWITCH,
            code(0b10_01),
            "the floor switches to the wall's wedge and the wall to the floor's",
        ),
        (
            OCTAHEDRON,
            "switch-long",
            mesh::PACKET_LENGTH,
            with_payload(file, last, &[&payload(file, last)[..], &[0; 4]].concat()),
            "bytes behind the switch codes",
        ),
        (
            OCTAHEDRON,
            "switch-short",
            mesh::PACKET_LENGTH,
            with_payload(file, last, &payload(file, last)[..end - 1]),
            "a payload that ends before the switch codes",
        ),
    ]
}
