//! What is judged first when several things are wrong at once.
//!
//! Every list below holds mistakes in the order in which the specification judges them. The n-th case has mistake n and all that
//! come after it, and mistake n must be the one reported.

use crate::files::{ENTRY, Parts, file, put, put32, random, seam, strip};
use ivg_wire::{ChunkKind, Code, codes as common};
use pmesh_format::{Limits, check, codes};

/// A file with the limits under which it is read.
struct Judged {
    parts: Parts,
    limits: Limits,
    /// What stands in the header instead of the right length of the file.
    file_bytes: Option<u64>,
}

impl Judged {
    fn put(&mut self, at: usize, bytes: &[u8]) {
        put(&mut self.parts.header, at, bytes);
    }

    fn entry(&mut self, k: usize, at: usize, bytes: &[u8]) {
        put(&mut self.parts.chunks[0].2, ENTRY * k + at, bytes);
    }

    fn build(&self) -> Vec<u8> {
        let mut file = self.parts.build();
        if let Some(length) = self.file_bytes {
            put(&mut file, 48, &length.to_le_bytes());
            ivg_wire::seal_header(&mut file[..self.parts.header.len()]);
        }
        file
    }
}

/// Where a mistake is reported: at a byte of the file, or at a byte of the directory's payload.
#[derive(Clone, Copy)]
enum At {
    File(u64),
    FirstChunk,
    Directory(u64),
}

type Mistake = (Code, At, fn(&mut Judged));

const HEADER: &[Mistake] = &[
    (common::RESERVED, At::File(78), |h| h.put(79, &[0x80])),
    (codes::COUNTS, At::File(56), |h| h.put(56, &((1u32 << 30) + 1).to_le_bytes())),
    (codes::COUNTS, At::File(60), |h| h.put(60, &[0; 4])),
    (codes::COUNTS, At::File(64), |h| h.put(64, &[0xFF; 4])),
    (codes::COUNTS, At::File(68), |h| h.put(68, &[0; 4])),
    (codes::COUNTS, At::File(72), |h| h.put(72, &[0; 4])),
    (codes::MODE_FORBIDDEN, At::File(76), |h| h.put(76, &[0])),
    (codes::POSITIONS_FORBIDDEN, At::File(77), |h| h.put(77, &[0])),
    (codes::MESH_ORIGIN, At::File(80), |h| h.put(96, &f64::NAN.to_le_bytes())),
    (codes::BOUNDS, At::File(104), |h| h.put(104, &f32::NAN.to_le_bytes())),
    (codes::BOUNDS, At::File(116), |h| h.put(116, &f32::INFINITY.to_le_bytes())),
    (common::RESERVED, At::File(130), |h| h.put(130, &[1])),
    (common::RESERVED, At::File(148), |h| h.put(151, &[1])),
    (codes::PARAMETERS, At::File(128), |h| h.put(128, &[10])),
    (codes::PARAMETERS, At::File(129), |h| h.put(129, &[12])),
    (codes::PARAMETERS, At::File(132), |h| h.put(136, &f32::NAN.to_le_bytes())),
    (codes::PARAMETERS, At::File(140), |h| h.put(140, &1.0f32.to_le_bytes())),
    (codes::LIMIT_COUNTS, At::File(56), |h| h.limits.counts = 1),
    (codes::DIRECTORY_MISSING, At::FirstChunk, |h| h.parts.chunks[0].0 = ChunkKind(*b"NEWS")),
    (codes::DIRECTORY_COUNTS, At::Directory(0), |h| h.entry(0, 0, &[0; 4])),
    (codes::DIRECTORY_COUNTS, At::Directory(4), |h| h.entry(0, 4, &[0; 4])),
    (codes::DIRECTORY_COUNTS, At::Directory(8), |h| h.entry(0, 8, &[0xFF; 4])),
    (codes::DIRECTORY_BYTES, At::Directory(12), |h| h.entry(0, 12, &[0; 4])),
    (codes::DIRECTORY_ERROR, At::Directory(16), |h| h.entry(0, 16, &(-1.0f32).to_le_bytes())),
    (codes::DIRECTORY_ERROR, At::Directory(36), |h| h.entry(1, 16, &f32::NAN.to_le_bytes())),
    (common::FILE_BYTES, At::File(48), |h| h.file_bytes = Some(1 << 30)),
];

#[test]
fn header_and_directory_are_judged_in_the_order_of_the_specification() {
    let right = || {
        let parts = Parts::of(&file(&random(3, 14, true), 4));
        Judged { parts, limits: Limits::default(), file_bytes: None }
    };
    assert_eq!(check(&right().build(), &Limits::default()), Ok(()));
    for (first, (code, at, _)) in HEADER.iter().enumerate() {
        let mut judged = right();
        for (_, _, make) in HEADER[first..].iter().rev() {
            make(&mut judged);
        }
        let length = judged.parts.header.len() as u64;
        let at = match *at {
            At::File(at) => at,
            At::FirstChunk => length,
            At::Directory(at) => length + 16 + at,
        };
        let error = check(&judged.build(), &judged.limits).unwrap_err();
        assert_eq!((error.code(), error.offset().0), (code.number(), at), "mistake {first}: {error}");
    }
}

/// Numbers of the arrays of a packet in the table of PMESH-PKT-02.
const POSITIONS: usize = 0;
const NORMALS: usize = 1;
const UVS: usize = 2;
const CORNERS: usize = 4;
const PARENTS: usize = 6;
/// Where the numbers of variable length begin.
const REST: usize = 7;
/// Stands for the beginning of the payload.
const COUNT: usize = 8;

/// A mistake in the payload of a packet with the arrays `arrays`, reported at this byte behind the beginning of that array.
type PacketMistake = (Code, usize, usize, fn(&mut [u8], &[usize; 8]));

/// In the last packet of the seam: vertex 3 with wedges 4 and 5 and a face; wedge count 2, targets 0 1, low bits 10, high bits 1010.
const PACKET: &[PacketMistake] = &[
    (codes::POSITION, POSITIONS, 0, |p, a| put(p, a[POSITIONS] + 4, &f32::NAN.to_le_bytes())),
    (codes::ATTRIBUTE, NORMALS, 12, |p, a| put(p, a[NORMALS] + 12, &f32::INFINITY.to_le_bytes())),
    (codes::ATTRIBUTE, UVS, 0, |p, a| put(p, a[UVS] + 4, &f32::NAN.to_le_bytes())),
    (codes::PARENT, PARENTS, 0, |p, a| p[a[PARENTS]] |= 3),
    (codes::PACKET_PADDING, PARENTS, 0, |p, a| p[a[PARENTS]] |= 4),
    (codes::WEDGE_COUNT, REST, 0, |p, a| p[a[REST]] = 0),
    (codes::VARINT, REST, 1, |p, a| put(p, a[REST] + 1, &[0x80, 0])),
    (codes::WEDGE_TARGET, REST, 2, |p, a| p[a[REST] + 2] = 2),
    (codes::CORNER, CORNERS, 0, |p, a| put32(p, a[CORNERS] + 8, &[6])),
    (codes::FACE_VERTICES, CORNERS, 0, |p, a| put32(p, a[CORNERS], &[1, 2, 3])),
    (codes::SWITCH_SLOTS, COUNT, 0, |p, a| put32(p, a[POSITIONS] - 4, &[7])),
    (codes::SWITCH_SLOTS, REST, 3, |p, a| p[a[REST] + 4] = 0b1110),
    (codes::PACKET_PADDING, REST, 3, |p, a| p[a[REST] + 3] |= 0x80),
    (codes::PACKET_PADDING, REST, 4, |p, a| p[a[REST] + 4] |= 0x80),
    (codes::SWITCH, REST, 5, |p, a| p[a[REST] + 4] = p[a[REST] + 4] & 0xF0 | 0b1001),
];

#[test]
fn a_packet_is_judged_in_the_order_of_the_specification() {
    for (first, (code, array, at, _)) in PACKET.iter().enumerate() {
        let mut parts = Parts::of(&file(&seam(), 3));
        let arrays = parts.arrays(1);
        for (_, _, _, make) in PACKET[first..].iter().rev() {
            make(&mut parts.packets[1].1, &arrays);
        }
        let error = check(&parts.build(), &Limits::default()).unwrap_err();
        let start = arrays.get(*array).copied().unwrap_or(0);
        let expected = (code.number(), parts.payload_offset(1) + (start + at) as u64);
        assert_eq!((error.code(), error.offset().0), expected, "mistake {first}: {error}");
    }
}

/// PMESH-FACE-01: of both rules that one face breaks; and the first face that breaks one is reported.
#[test]
fn a_face_is_judged_in_the_order_of_the_specification() {
    // In place of the faces (1, 2, 3) and (2, 3, 4) of the strip: codes and the face that is reported.
    let cases: [(Code, usize, [u32; 6]); 4] = [
        (codes::CORNER, 1, [9, 9, 9, 2, 3, 4]),
        (codes::CORNER, 2, [1, 2, 3, 1, 1, 5]),
        (codes::FACE_VERTICES, 1, [2, 2, 3, 1, 1, 9]),
        (codes::FACE_VERTICES, 2, [2, 3, 4, 1, 1, 2]),
    ];
    for (number, (code, face, corners)) in cases.into_iter().enumerate() {
        let mut parts = Parts::of(&file(&strip(), 5));
        let arrays = parts.arrays(0);
        put32(&mut parts.packets[0].1, arrays[CORNERS] + 12, &corners);
        let error = check(&parts.build(), &Limits::default()).unwrap_err();
        let expected = (code.number(), parts.payload_offset(0) + (arrays[CORNERS] + 12 * face) as u64);
        assert_eq!((error.code(), error.offset().0), expected, "case {number}: {error}");
    }
}

/// The sum of the wedges of a packet (PMESH-WDG-01) is judged number by number, and too few only after the last.
#[test]
fn wedge_counts_are_judged_number_by_number() {
    let cases: [(Code, usize, [u8; 4]); 5] = [
        (codes::WEDGE_COUNT, 0, [7, 0, 0, 0]),
        (codes::WEDGE_COUNT, 2, [1, 1, 5, 2]),
        (codes::WEDGE_COUNT, 3, [1, 1, 2, 3]),
        (codes::WEDGE_COUNT, 4, [1, 1, 2, 1]),
        // A number that is too long is known before its value.
        (codes::VARINT, 2, [1, 1, 0x82, 0]),
    ];
    for (code, at, counts) in cases {
        let mut parts = Parts::of(&file(&seam(), 4));
        let rest = parts.arrays(0)[REST];
        put(&mut parts.packets[0].1, rest, &counts);
        let error = check(&parts.build(), &Limits::default()).unwrap_err();
        let expected = (code.number(), parts.payload_offset(0) + (rest + at) as u64);
        assert_eq!((error.code(), error.offset().0), expected, "{counts:?}: {error}");
    }
}

/// PMESH-PKT-04: the shortest form, below 2³², at most five bytes, not beyond the payload; always at the number's first byte.
#[test]
fn numbers_of_variable_length_are_judged_byte_by_byte() {
    // What stands instead of the six numbers of the seam, and where the number at fault begins.
    let cases: [(Code, usize, &[u8]); 9] = [
        (codes::VARINT, 0, &[0x80, 0x00]),
        (codes::VARINT, 0, &[0xFF, 0xFF, 0xFF, 0xFF, 0x10]),
        (codes::VARINT, 0, &[0xFF, 0xFF, 0xFF, 0xFF, 0x8F, 0x01]),
        (codes::VARINT, 1, &[1, 0x81, 0x80, 0x00]),
        // 2³² − 1 is a number, but too many wedges.
        (codes::WEDGE_COUNT, 0, &[0xFF, 0xFF, 0xFF, 0xFF, 0x0F]),
        (codes::PACKET_LENGTH, 0, &[]),
        (codes::PACKET_LENGTH, 1, &[1, 0x81]),
        (codes::PACKET_LENGTH, 4, &[1, 1, 2, 2]),
        (codes::PACKET_LENGTH, 5, &[1, 1, 2, 2, 0, 0x80]),
    ];
    for (code, at, bytes) in cases {
        let mut parts = Parts::of(&file(&seam(), 4));
        let rest = parts.arrays(0)[REST];
        let payload = [&parts.packets[0].1[..rest], bytes].concat();
        parts.set_payload(0, payload);
        let error = check(&parts.build(), &Limits::default()).unwrap_err();
        let expected = (code.number(), parts.payload_offset(0) + (rest + at) as u64);
        assert_eq!((error.code(), error.offset().0), expected, "{bytes:02X?}: {error}");
    }
}
