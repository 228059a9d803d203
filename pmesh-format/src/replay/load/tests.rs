//! One defect each in a packet that is otherwise right: which code, at which byte of the payload.

use std::collections::BTreeSet;
use std::vec;
use std::vec::Vec;

use crate::decode::{check, decode_all, decode_packet};
use crate::encode::{EncodeOptions, encode};
use crate::limits::Limits;
use crate::mesh::Wedges;
use crate::progressive::ProgressiveMesh;
use crate::replay::Replay;
use crate::storage::Positions;
use crate::tests::{Kind, Parts, expected, header_of, random_mesh};

/// Vertex k collapses onto k − 1, face k is (k, k + 1, k + 2). The payload of one packet: positions 0, corners 60, parents
/// 96, switch codes (2 bits) 104.
fn strip() -> ProgressiveMesh {
    ProgressiveMesh {
        positions: (0..5u16).map(|v| [f32::from(v), f32::from(v % 2), 0.0]).collect(),
        wedges: Wedges { vertices: (0..5).collect(), ..Wedges::default() },
        base_vertices: 3,
        collapse: vec![2, 3],
        wedge_collapse: vec![2, 3],
        errors: vec![0.5, 0.25],
        faces: vec![[0, 1, 2], [1, 2, 3], [2, 3, 4]],
        ..ProgressiveMesh::default()
    }
}

/// Two vertices with two wedges each, of which the last collapses onto the other; both faces of the base switch. Positions 0,
/// texture coordinates 48, corners 96, parents 132, wedge counts 136, wedge targets 140, switch codes (2 of 2 bits) 142.
fn seam() -> ProgressiveMesh {
    ProgressiveMesh {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
        wedges: Wedges { vertices: vec![0, 1, 2, 2, 3, 3], uvs: vec![[0.0; 2]; 6], ..Wedges::default() },
        base_vertices: 3,
        collapse: vec![2],
        wedge_collapse: vec![2, 3],
        errors: vec![0.5],
        faces: vec![[0, 1, 4], [1, 0, 5], [0, 2, 4]],
        ..ProgressiveMesh::default()
    }
}

fn parts(mesh: &ProgressiveMesh, packet: u32) -> Parts {
    Parts::of(&encode(mesh, &EncodeOptions::fixed(packet)).unwrap())
}

fn put(payload: &mut [u8], at: usize, bytes: &[u8]) {
    payload[at..at + bytes.len()].copy_from_slice(bytes);
}

fn put32(payload: &mut [u8], at: usize, values: &[u32]) {
    for (k, value) in values.iter().enumerate() {
        put(payload, at + 4 * k, &value.to_le_bytes());
    }
}

#[test]
fn payloads_are_laid_out_as_these_tests_take_them() {
    assert_eq!(parts(&strip(), 5).packets[0].2.len(), 105);
    let seam = parts(&seam(), 4);
    assert_eq!(seam.packets[0].2.len(), 143);
    // Canonical order is descending: slot 5 (face 1) switches to wedge 2 of the new vertex, slot 2 (face 0) to wedge 1.
    assert_eq!(seam.packets[0].2[136..], [1, 1, 2, 2, 0, 1, 0b01_10]);
}

#[test]
fn every_defect_of_a_packet_has_its_code_and_its_place() {
    type Spoil = fn(&mut Vec<u8>);
    let in_strip: Vec<(&str, u64, Spoil)> = vec![
        ("POSITION", 12, |p| put(p, 12, &f32::NAN.to_le_bytes())),
        ("POSITION", 24, |p| put(p, 32, &f32::INFINITY.to_le_bytes())),
        ("POSITION", 48, |p| put(p, 48, &4.5f32.to_le_bytes())),
        // Onto itself, onto a later one, onto one that is not there: no cycle can be written.
        ("PARENT", 96, |p| put32(p, 96, &[3])),
        ("PARENT", 96, |p| put32(p, 96, &[4])),
        ("PARENT", 100, |p| put32(p, 100, &[u32::MAX])),
        ("CORNER", 84, |p| put32(p, 92, &[5])),
        ("CORNER", 60, |p| put32(p, 60, &[u32::MAX])),
        ("FACE_VERTICES", 72, |p| put32(p, 72, &[1, 1, 3])),
        ("FACE_ORDER", 84, |p| put32(p, 72, &[2, 3, 4, 1, 2, 3])),
        ("FACE_LEVEL", 72, |p| put32(p, 72, &[0, 1, 3])),
        ("SWITCH_LENGTH", 105, |p| p.push(0)),
        ("SWITCH_LENGTH", 104, |p| {
            p.pop();
        }),
        ("SWITCH_PADDING", 104, |p| p[104] |= 0x80),
        ("SWITCH_PADDING", 104, |p| p[104] |= 0x04),
    ];
    let in_seam: Vec<(&str, u64, Spoil)> = vec![
        ("ATTRIBUTE", 56, |p| put(p, 60, &f32::NAN.to_le_bytes())),
        ("WEDGE_COUNT", 136, |p| p[136] = 0),
        ("WEDGE_COUNT", 138, |p| p[136] = 4),
        ("WEDGE_COUNT", 140, |p| p[139] = 1),
        ("VARINT", 136, |p| put(p, 136, &[0x81, 0])),
        ("VARINT", 136, |p| put(p, 136, &[0xFF, 0xFF, 0xFF, 0xFF, 0x1F])),
        ("SWITCH_LENGTH", 140, |p| p.truncate(140)),
        ("WEDGE_TARGET", 140, |p| p[140] = 2),
        // Two bits, but there are only two wedges; a wedge that collapses onto the other side of the seam.
        ("SWITCH", 142, |p| p[142] = 0b01_11),
        ("SWITCH", 142, |p| p[142] = 0b01_01),
        ("SWITCH", 142, |p| p[142] = 0b10_10),
    ];
    let mut seen = BTreeSet::new();
    for (mesh, packet, cases) in [(strip(), 5, in_strip), (seam(), 4, in_seam)] {
        for (number, (name, at, spoil)) in cases.into_iter().enumerate() {
            let mut parts = parts(&mesh, packet);
            let mut payload = parts.packets[0].2.clone();
            spoil(&mut payload);
            parts.set_payload(0, payload);
            let error = check(&parts.build(), &Limits::default()).expect_err(name);
            let place = error.offset().0 - parts.payload_offset(0);
            assert_eq!((error.rule().name, place), (name, at), "case {number}: {error}");
            seen.insert(error.code());
        }
    }
    // Packets out of order are tested with Replay, what only coded packets can break (from 515 on) beside them.
    seen.insert(crate::codes::PACKET_ORDER.number());
    let all = crate::codes::ALL.iter().map(|code| code.number()).filter(|number| (500..515).contains(number));
    assert_eq!(seen, all.collect());
}

#[test]
fn a_face_of_an_earlier_packet_is_refused_in_a_later_one() {
    let mut parts = parts(&strip(), 4);
    let mut payload = parts.packets[1].2.clone();
    // Positions 12 bytes, then the face (2, 3, 4).
    put32(&mut payload, 12, &[1, 2, 3]);
    parts.set_payload(1, payload);
    let error = check(&parts.build(), &Limits::default()).unwrap_err();
    assert_eq!((error.rule().name, error.offset().0), ("FACE_ORDER", parts.payload_offset(1) + 12));
}

/// A packet can break a rule in its last byte, when all its vertices have been added already.
#[test]
fn a_refused_packet_leaves_the_levels_before_as_they_were() {
    let mut parts = parts(&strip(), 4);
    let mut payload = parts.packets[1].2.clone();
    *payload.last_mut().unwrap() |= 0x80;
    parts.set_payload(1, payload);
    let mut replay = Replay::default();
    let mut refused = 0;
    decode_all(&parts.build(), &Limits::default(), |event| {
        if replay.packets() == 1 && replay.level() == 4 {
            replay.set_level(3).unwrap();
        }
        refused += usize::from(replay.accept(&event).is_err());
    })
    .unwrap();
    assert_eq!((refused, replay.packets(), replay.level()), (1, 1, 3));
    assert_eq!(replay.indices(), [[0, 1, 2]]);
    replay.set_level(4).unwrap();
    assert_eq!(replay.indices(), [[0, 1, 2], [1, 2, 3]]);
    assert_eq!(replay.levels(), Some(3..=4));
}

/// When the packet comes again as it should be, it is taken as if nothing had been.
#[test]
fn a_refused_packet_leaves_no_trace() {
    let mesh = random_mesh(31, Kind { vertices: 24, seams: true, materials: true });
    let mut parts = parts(&mesh, 6);
    let right = parts.build();
    let mut payload = parts.packets[2].2.clone();
    payload.push(0);
    parts.set_payload(2, payload);
    let wrong = parts.build();
    let mut replay = Replay::new(&header_of(&right));
    let mut apply = |file: &[u8], k: u32| {
        let header = header_of(file);
        let range = header.packet_range(k);
        let packet = decode_packet(&header, k, &file[range.start as usize..range.end as usize]).unwrap();
        replay.apply(&packet).map(drop).map_err(|error| error.rule().name)
    };
    assert_eq!(apply(&right, 0), Ok(()));
    assert_eq!(apply(&right, 1), Ok(()));
    assert_eq!(apply(&wrong, 2), Err("SWITCH_LENGTH"));
    assert_eq!(apply(&right, 2), Ok(()));
    assert_eq!(apply(&right, 3), Ok(()));
    for level in (mesh.base_vertices..=24).rev().chain(mesh.base_vertices..=24) {
        replay.set_level(level).unwrap();
        assert_eq!(replay.mesh().triangles, expected(&mesh, level).triangles, "level {level}");
    }
}

fn quantised(mesh: &ProgressiveMesh, bits: u8, packet: u32) -> Vec<u8> {
    let options = EncodeOptions { positions: Positions::Quantised(bits), ..EncodeOptions::fixed(packet) };
    encode(mesh, &options).unwrap()
}

#[test]
fn quantised_positions_are_read_as_written() {
    for bits in Positions::LEAST_BITS..=Positions::MOST_BITS {
        let mesh = random_mesh(40 + u64::from(bits), Kind { vertices: 30, seams: true, materials: false });
        let file = quantised(&mesh, bits, 7);
        assert_eq!(header_of(&file).positions, Positions::Quantised(bits));
        let mut as_read = expected(&mesh, 30);
        as_read.positions = Positions::Quantised(bits).quantised(&mesh.positions);
        assert_ne!(as_read.positions, mesh.positions);
        assert_eq!(crate::tests::replay_all(&file).mesh(), as_read);
        // Four bytes a vertex fewer.
        let plain = encode(&mesh, &EncodeOptions::fixed(7)).unwrap();
        assert!(
            plain.len() - file.len() >= 4 * 30 - 3 * 5,
            "{bits} bits: padding differs by 3 bytes a packet"
        );
    }
}

#[test]
fn every_defect_of_quantised_positions_has_its_code_and_its_place() {
    // The strip: x from 0 to 4, y from 0 to 1, z 0: the lattice has 1023, 256 (255.75 and a half) and 0 steps.
    let right = Parts::of(&quantised(&strip(), 10, 5));
    for (vertex, component, value, good) in [
        (0, 0, 1023u16, true),
        (3, 0, 1024, false),
        (2, 1, 256, true),
        (2, 1, 257, false),
        (4, 2, 1, false),
        (1, 3, 1, false),
        (4, 3, 0x8000, false),
    ] {
        let mut parts = right.clone();
        let mut payload = parts.packets[0].2.clone();
        put(&mut payload, 8 * vertex + 2 * component, &value.to_le_bytes());
        parts.set_payload(0, payload);
        let found = check(&parts.build(), &Limits::default())
            .map_err(|error| (error.rule().name, error.offset().0 - parts.payload_offset(0)));
        let expected = if good { Ok(()) } else { Err(("POSITION", 8 * vertex as u64)) };
        assert_eq!(found, expected, "{value} as component {component} of vertex {vertex}");
    }
    // The box ends, along x and y, at the greatest number that there is, and y has 1022.6 steps: the last point lies beyond.
    let mut parts = right;
    put(&mut parts.specific, 52, &(f32::MAX * 0.0004).to_le_bytes());
    put(&mut parts.specific, 60, &f32::MAX.to_le_bytes());
    put(&mut parts.specific, 64, &f32::MAX.to_le_bytes());
    let mut payload = parts.packets[0].2.clone();
    put(&mut payload, 8 + 2, &1023u16.to_le_bytes());
    parts.set_payload(0, payload);
    let found = check(&parts.build(), &Limits::default()).map_err(|error| error.rule().name);
    assert_eq!(found, Err("POSITION"), "a coordinate that is not finite");
}
