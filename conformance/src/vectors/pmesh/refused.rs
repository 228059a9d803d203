//! Files of `.pmesh` to refuse.

use super::super::edit::{in_envelope, in_header, last_chunk, replaced, with_chunk};
use super::super::parts::Parts;
use super::super::{Format, Refused, Vector};
use super::refused_frame as frame;
use super::refused_packets as packets;
use super::{
    CHUNK_HEAD, CODED_ATTRIBUTES, EMPTY, EQUAL_PACKETS, OCTAHEDRON, ONE_PACKET, RECORD_HEAD, SEAM, at, entry,
    header, packet,
};
use ivg_wire::codes as wire;
use pmesh_format::codes as mesh;

/// Where the arrays of a packet begin: behind the number of slots that switch.
const ARRAYS: usize = 4;

pub(super) fn refused(accepted: &[Vector]) -> Vec<Vector> {
    let twin = |name: &str| &accepted.iter().find(|vector| vector.name == name).expect("a name").bytes[..];
    let octahedron = twin(OCTAHEDRON);
    let mut list = frame::container(octahedron);
    list.extend(frame::records(twin(EQUAL_PACKETS)));
    list.extend(frame::headers(octahedron));
    list.extend(super::forward::refused(octahedron));
    list.extend(frame::counts(twin(EMPTY), twin(SEAM)));
    list.extend(frame::parameters(octahedron, twin(CODED_ATTRIBUTES)));
    list.extend(directory(octahedron));
    list.extend(entries(twin(SEAM)));
    list.extend(names(twin(SEAM)));
    list.extend(points(twin("0022-raw-q12"), twin("0027-raw-q12-plane"), twin("0073-raw-greatest")));
    list.extend(numbers(octahedron, twin(SEAM), twin(ONE_PACKET)));
    list.extend(packets::collapses(octahedron, twin(ONE_PACKET)));
    list.extend(packets::faces(octahedron, twin(SEAM)));
    list.extend(packets::wedges(twin(SEAM)));
    list.extend(super::refused_switches::refused(&twin));
    list.extend(least_bytes(twin));
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
            "entry-faces-fall",
            mesh::DIRECTORY_COUNTS,
            number(1, entry::END_FACE, 1),
            "fewer faces than before, and more again behind",
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

/// With seams, wedges need not grow with the vertices, so that they do not tell what is wrong with these.
fn entries(seam: &[u8]) -> Vec<Refused> {
    let vertices = |mistake, k, end: u32, why| {
        (SEAM, mistake, mesh::DIRECTORY_COUNTS, in_directory(seam, k, entry::END_VERTEX, end), why)
    };
    let wedges = |mistake, end: u32, why| {
        (SEAM, mistake, mesh::DIRECTORY_COUNTS, in_directory(seam, 1, entry::END_WEDGE, end), why)
    };
    vec![
        vertices("entry-order-seams", 1, 3, "a packet without a vertex, with a wedge"),
        vertices("entry-base-seams", 0, 2, "a first packet without the whole base, with its wedges"),
        wedges("entry-wedges-seams", 5, "a packet with a vertex, without a wedge"),
        wedges("entry-wedges-fall", 4, "fewer wedges than before, and more again behind"),
        (
            SEAM,
            "entry-missing-vertex",
            mesh::DIRECTORY_COUNTS,
            in_header(seam, at::VERTEX_COUNT, &[6]),
            "fewer vertices than the header says",
        ),
        (
            SEAM,
            "entry-missing-wedge",
            mesh::DIRECTORY_COUNTS,
            in_header(seam, at::WEDGE_COUNT, &[9]),
            "fewer wedges than the header says",
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
    // The first byte of padding becomes the last of the list.
    let longer = in_envelope(file, chunk.clone(), chunk.start + 8, &[16]);
    vec![
        (SEAM, "name-length", mesh::MATERIAL_NAMES, edited(7, 9), "a name that goes beyond the chunk"),
        (SEAM, "name-utf8", mesh::MATERIAL_NAMES, edited(10, 0xFF), "a name that is not UTF-8"),
        (SEAM, "name-left-over", mesh::MATERIAL_NAMES, longer, "a byte behind the last name"),
        (SEAM, "names-repeated", wire::CHUNK_REPEATED, twice, "names of materials twice"),
    ]
}

/// An edit in the payload of a packet.
pub(super) fn in_packet(file: &[u8], k: u32, at: usize, bytes: &[u8]) -> Vec<u8> {
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
    let position = |value: f32| in_packet(file, 0, ARRAYS + 12, &value.to_le_bytes());
    // Behind the positions of three vertices.
    let normal = |value: f32| in_packet(seam, 0, ARRAYS + 3 * 12, &value.to_le_bytes());
    vec![
        (OCTAHEDRON, "position-nan", mesh::POSITION, position(f32::NAN), "a position that is no number"),
        (OCTAHEDRON, "position-outside", mesh::POSITION, position(1.5), "a position outside the bounds"),
        (SEAM, "normal-nan", mesh::ATTRIBUTE, normal(f32::NAN), "a normal that is no number"),
        // Behind the positions of six vertices.
        (
            ONE_PACKET,
            "uv-infinite",
            mesh::ATTRIBUTE,
            in_packet(coloured, 0, ARRAYS + 6 * 12 + 4, &f32::INFINITY.to_le_bytes()),
            "texture coordinates at infinity",
        ),
    ]
}

/// Points of a lattice: four u16 each.
fn points(file: &[u8], plane: &[u8], greatest: &[u8]) -> Vec<Refused> {
    let number = |file: &[u8], point: usize, at: usize, value: u16| {
        in_packet(file, 0, ARRAYS + 8 * point + 2 * at, &value.to_le_bytes())
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
        (
            "0073-raw-greatest",
            "point-infinite",
            mesh::POSITION,
            number(greatest, 2, 1, 2),
            "a point of the lattice whose coordinate is too great for binary32",
        ),
    ]
}

/// The least that a packet must have (PMESH-DIR-04), by hand: the number of slots that switch, arrays, parents.
fn least_bytes<'a>(twin: impl Fn(&str) -> &'a [u8]) -> Vec<Refused> {
    // Of packet 1 of each file. The octahedron: two vertices, four faces, parents of three bits.
    let octahedron = 4 + 2 * 12 + 4 * 12 + 1;
    // A vertex of one wedge with a normal, a face with a material, a parent of two bits.
    let seam = 4 + (12 + 12) + (12 + 2) + 1;
    let few = |name: &'static str, mistake, least: u32, why| {
        let file = in_directory(twin(name), 1, entry::PAYLOAD_BYTES, least - 1);
        (name, mistake, mesh::DIRECTORY_BYTES, file, why)
    };
    let enough = |name: &'static str, mistake, least: u32, why| {
        let whole = payload(twin(name), 1);
        let file = with_payload(twin(name), 1, &whole[..least as usize]);
        (name, mistake, mesh::PACKET_LENGTH, file, why)
    };
    let (quantised, all) = ("0022-raw-q12", "0029-raw-q14-attributes");
    vec![
        few(OCTAHEDRON, "entry-bytes-floats", octahedron, "a byte too few for parents behind floats"),
        enough(OCTAHEDRON, "packet-least", octahedron, "as long as the directory must say, and no longer"),
        few(SEAM, "entry-bytes-seams", seam, "a byte too few for parents behind materials"),
        enough(SEAM, "packet-least-seams", seam, "no number of wedges, which the directory allows"),
        few(quantised, "entry-bytes-points", least(twin(quantised), 1), "a byte too few behind points"),
        few(all, "entry-bytes-all", least(twin(all), 1), "a byte too few behind arrays of every kind"),
        enough(
            all,
            "packet-least-all",
            least(twin(all), 1),
            "arrays of every kind, and nothing behind parents",
        ),
    ]
}

/// Where `wedge_counts` begins.
fn least(file: &[u8], k: u32) -> u32 {
    let parts = Parts::read(&header(file), k, &payload(file, k));
    let parts = Parts { wedge_counts: Vec::new(), wedge_targets: Vec::new(), ..parts };
    parts.before_slots().len() as u32
}
