use std::collections::BTreeSet;
use std::vec;
use std::vec::Vec;

use ivg_wire::Verdict;

use super::*;
use crate::decode::check;
use crate::encode::{EncodeOptions, encode};
use crate::tests::{Kind, Parts, header_of, random_mesh};

fn file() -> Vec<u8> {
    let mesh = random_mesh(21, Kind { vertices: 30, seams: true, materials: true });
    encode(&mesh, &EncodeOptions::fixed(7)).unwrap()
}

#[test]
fn records_lie_where_the_directory_says() {
    let file = file();
    let header = header_of(&file);
    assert_eq!(header.packet_count(), 5);
    let mut next = header.data_offset;
    for k in 0..5 {
        let range = header.packet_range(k);
        assert_eq!(range.start, next);
        assert_eq!(file[range.start as usize..][..4], k.to_le_bytes());
        next = range.end;
    }
    assert_eq!(header.end_range(), next..file.len() as u64);
    assert_eq!(header.packet_range(5), 0..0);
    assert_eq!(header.packet_of_level(7), Some(0));
    assert_eq!(header.packet_of_level(8), Some(1));
    assert_eq!(header.packet_of_level(30), Some(4));
    assert_eq!(header.packet_of_level(31), None);
    assert_eq!(header.packet_of_level(0), None);
}

/// One defect each in a file that is otherwise right: which code, at which byte.
#[test]
fn every_defect_of_header_and_directory_has_its_code_and_its_place() {
    type Spoil = fn(&mut Parts);
    fn put32(bytes: &mut [u8], at: usize, value: u32) {
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
    }
    // Offsets in `specific` are those of the header less 56; the directory's payload begins at byte 168.
    let cases: Vec<(&str, u64, Spoil)> = vec![
        ("COUNTS", 56, |p| put32(&mut p.specific, 0, MAX_COUNT + 1)),
        ("COUNTS", 60, |p| put32(&mut p.specific, 4, 29)),
        ("COUNTS", 60, |p| put32(&mut p.specific, 4, MAX_COUNT + 1)),
        // Several wedges a vertex without an attribute; wedges without seams.
        ("COUNTS", 60, |p| p.specific[22] &= !7),
        ("COUNTS", 60, |p| p.specific[22] &= !16),
        // Wedges without a vertex.
        ("COUNTS", 60, |p| put32(&mut p.specific, 0, 0)),
        ("COUNTS", 64, |p| put32(&mut p.specific, 8, MAX_COUNT + 1)),
        ("COUNTS", 68, |p| put32(&mut p.specific, 12, 0)),
        ("COUNTS", 68, |p| put32(&mut p.specific, 12, 31)),
        ("COUNTS", 72, |p| put32(&mut p.specific, 16, 0)),
        ("COUNTS", 72, |p| put32(&mut p.specific, 16, 32)),
        ("MODE_FORBIDDEN", 76, |p| p.specific[20] = 0),
        ("MODE_UNKNOWN", 76, |p| p.specific[20] = 3),
        // Coded attributes without their parameters.
        ("PARAMETERS", 128, |p| p.specific[20] = 2),
        ("POSITIONS_FORBIDDEN", 77, |p| p.specific[21] = 0),
        ("POSITIONS_UNKNOWN", 77, |p| p.specific[21] = 9),
        ("RESERVED", 78, |p| p.specific[22] |= 32),
        ("RESERVED", 78, |p| p.specific[23] |= 1),
        ("MESH_ORIGIN", 80, |p| p.specific[24..32].copy_from_slice(&f64::NAN.to_le_bytes())),
        ("BOUNDS", 104, |p| p.specific[48..52].copy_from_slice(&f32::NEG_INFINITY.to_le_bytes())),
        ("BOUNDS", 116, |p| p.specific[60..64].copy_from_slice(&f32::NAN.to_le_bytes())),
        ("BOUNDS", 116, |p| p.specific[60..64].copy_from_slice(&(-5.0f32).to_le_bytes())),
        ("RESERVED", 130, |p| p.specific[75] = 1),
        ("RESERVED", 148, |p| p.specific[95] = 1),
        ("PARAMETERS", 128, |p| p.specific[72] = 10),
        ("PARAMETERS", 129, |p| p.specific[73] = 12),
        ("PARAMETERS", 132, |p| p.specific[76..80].copy_from_slice(&(-1.0f32).to_le_bytes())),
        ("PARAMETERS", 140, |p| p.specific[88..92].copy_from_slice(&1.0f32.to_le_bytes())),
        ("DIRECTORY_MISSING", 152, |p| p.chunks.swap(0, 1)),
        ("DIRECTORY_MISSING", 152, |p| p.chunks.clear()),
        ("CHUNK_REPEATED", 272, |p| p.chunks.insert(1, p.chunks[0].clone())),
        ("CHUNK_REPEATED", 312, |p| p.chunks.push(p.chunks[1].clone())),
        ("DIRECTORY_LENGTH", 168, |p| {
            p.directory().pop();
        }),
        ("DIRECTORY_LENGTH", 168, |p| p.directory().truncate(80)),
        ("DIRECTORY_COUNTS", 188, |p| put32(p.directory(), 20, 7)),
        ("DIRECTORY_COUNTS", 188, |p| put32(p.directory(), 20, 31)),
        ("DIRECTORY_COUNTS", 168, |p| put32(p.directory(), 0, 0)),
        ("DIRECTORY_COUNTS", 172, |p| put32(p.directory(), 4, 6)),
        ("DIRECTORY_COUNTS", 172, |p| put32(p.directory(), 4, 1000)),
        ("DIRECTORY_COUNTS", 196, |p| put32(p.directory(), 28, 0)),
        ("DIRECTORY_COUNTS", 196, |p| put32(p.directory(), 28, 1000)),
        // The last packet ends before the last vertex.
        ("DIRECTORY_COUNTS", 248, |p| put32(p.directory(), 80, 29)),
        ("DIRECTORY_BYTES", 180, |p| put32(p.directory(), 12, 100)),
        ("DIRECTORY_BYTES", 180, |p| put32(p.directory(), 12, u32::MAX)),
        ("LIMIT_RECORD_BYTES", 180, |p| put32(p.directory(), 12, 0x7000_0000)),
        ("DIRECTORY_ERROR", 184, |p| p.directory()[16..20].copy_from_slice(&(-1.0f32).to_le_bytes())),
        ("DIRECTORY_ERROR", 184, |p| p.directory()[16..20].copy_from_slice(&f32::INFINITY.to_le_bytes())),
        ("DIRECTORY_ERROR", 204, |p| p.directory()[36..40].copy_from_slice(&2.0f32.to_le_bytes())),
        ("MATERIAL_NAMES", 306, |p| {
            p.chunks[1].2.pop();
        }),
        ("MATERIAL_NAMES", 290, |p| p.chunks[1].2[2] = 0xFF),
        ("CHUNK_CRITICAL", 312, |p| p.chunks.push((ivg_wire::ChunkKind(*b"XYZW"), true, vec![]))),
        ("RESERVED", 316, |p| p.packets[0].1 = 1),
        ("RECORD_ID", 312, |p| p.packets[0].0 = 1),
    ];
    let mut seen = BTreeSet::new();
    for (number, (name, offset, spoil)) in cases.into_iter().enumerate() {
        let mut parts = Parts::of(&file());
        spoil(&mut parts);
        let error = check(&parts.build(), &Limits::default()).expect_err(name);
        assert_eq!((error.rule().name, error.offset().0), (name, offset), "case {number}: {error}");
        seen.insert(error.code());
    }
    let all = codes::ALL.iter().map(|code| code.number()).filter(|number| (351..400).contains(number));
    assert!(all.clone().count() > 10);
    assert!(all.clone().all(|number| seen.contains(&number)), "not met: {:?}", all.collect::<BTreeSet<_>>());
}

#[test]
fn an_ancillary_chunk_of_unknown_type_is_skipped() {
    let mut parts = Parts::of(&file());
    parts.chunks.push((ivg_wire::ChunkKind(*b"NEWS"), false, vec![1, 2, 3]));
    assert_eq!(check(&parts.build(), &Limits::default()), Ok(()));
}

#[test]
fn an_error_of_zero_may_have_either_sign() {
    let mut parts = Parts::of(&file());
    let last = parts.directory().len() - 4;
    parts.directory()[last..].copy_from_slice(&(-0.0f32).to_le_bytes());
    assert_eq!(check(&parts.build(), &Limits::default()), Ok(()));
}

#[test]
fn limits_are_the_callers() {
    let file = file();
    let header = header_of(&file);
    let greatest = header.wedge_count.max(header.face_count);
    let with = |counts| check(&file, &Limits { counts, ..Limits::default() });
    assert_eq!(with(greatest), Ok(()));
    let error = with(greatest - 1).unwrap_err();
    assert_eq!((error.rule().name, error.offset().0, error.verdict()), ("LIMIT_COUNTS", 56, Verdict::Limit));
}
