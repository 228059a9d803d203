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
use crate::tests::{Kind, Parts, expected, header_of, random_mesh, replay_all};

/// Vertex k collapses onto k − 1, face k is (k, k + 1, k + 2). The payload of one packet: positions 4, corners 64, parents (of 3
/// bits) 100.
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

/// Two vertices with two wedges each, of which the last collapses onto the other; both faces of the base switch, slots 2 and 5. The
/// last vertex in a packet of its own: position 4, texture coordinates 16, corners 32, parent (2 bits) 44, wedge count 45, wedge
/// targets 46, low bits 48, high bits 49.
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

/// Vertices 3 and 4 both collapse onto 2; slot 2 switches to the first, slot 5 to the second. Both in a packet of their own:
/// positions 4, corners 28, parents (of 3 bits) 40, low bits 41, high bits 42, what the slots become (a bit each) 43.
fn fan() -> ProgressiveMesh {
    ProgressiveMesh {
        collapse: vec![2, 2],
        wedge_collapse: vec![2, 2],
        faces: vec![[0, 1, 3], [1, 0, 4], [0, 3, 4]],
        ..strip()
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
    let strip = parts(&strip(), 5);
    assert_eq!(strip.packets[0].2.len(), 101);
    assert_eq!((strip.packets[0].2[..4].to_vec(), strip.packets[0].2[100]), (vec![0; 4], 0b011_010));
    // Slots 2 and 5 of 6: one low bit each, 0 and 1; high bits 1 and 2, in places 1 and 2 + 1 of 4.
    let seam = parts(&seam(), 3);
    assert_eq!(seam.packets[1].2[44..], [2, 2, 0, 1, 0b10, 0b1010]);
    let fan = parts(&fan(), 3);
    assert_eq!(fan.packets[1].2[40..], [0b010_010, 0b10, 0b1010, 0b10]);
}

#[test]
fn every_defect_of_a_packet_has_its_code_and_its_place() {
    type Spoil = fn(&mut Vec<u8>);
    let in_strip: Vec<(&str, u64, Spoil)> = vec![
        ("POSITION", 16, |p| put(p, 16, &f32::NAN.to_le_bytes())),
        ("POSITION", 28, |p| put(p, 36, &f32::INFINITY.to_le_bytes())),
        ("POSITION", 52, |p| put(p, 52, &4.5f32.to_le_bytes())),
        // Onto itself, onto a later one, onto one that is not there: no cycle can be written.
        ("PARENT", 100, |p| p[100] = 0b011_011),
        ("PARENT", 100, |p| p[100] = 0b011_100),
        ("PARENT", 100, |p| p[100] = 0b111_010),
        ("PACKET_PADDING", 100, |p| p[100] |= 0b0100_0000),
        ("PACKET_PADDING", 100, |p| p[100] |= 0b1000_0000),
        ("CORNER", 88, |p| put32(p, 96, &[5])),
        ("CORNER", 64, |p| put32(p, 64, &[u32::MAX])),
        ("FACE_VERTICES", 76, |p| put32(p, 76, &[1, 1, 3])),
        // No faces are earlier, so that no slot can switch.
        ("SWITCH_SLOTS", 0, |p| p[0] = 1),
        ("PACKET_LENGTH", 101, |p| p.push(0)),
    ];
    let in_seam: Vec<(&str, u64, Spoil)> = vec![
        ("ATTRIBUTE", 16, |p| put(p, 20, &f32::NAN.to_le_bytes())),
        ("WEDGE_COUNT", 45, |p| p[45] = 0),
        ("WEDGE_COUNT", 45, |p| p[45] = 3),
        ("WEDGE_COUNT", 46, |p| p[45] = 1),
        ("VARINT", 45, |p| put(p, 45, &[0x82, 0])),
        ("VARINT", 45, |p| put(p, 45, &[0xFF, 0xFF, 0xFF, 0xFF, 0x1F])),
        ("PACKET_LENGTH", 46, |p| p.truncate(46)),
        ("PACKET_LENGTH", 47, |p| p.truncate(47)),
        ("WEDGE_TARGET", 46, |p| p[46] = 2),
        ("SWITCH_SLOTS", 0, |p| p[0] = 7),
        ("PACKET_LENGTH", 48, |p| {
            p.pop();
        }),
        // Three ones, and one; both at the same place; one beyond the last slot.
        ("SWITCH_SLOTS", 48, |p| p[49] = 0b1011),
        ("SWITCH_SLOTS", 48, |p| p[49] = 0b0010),
        ("SWITCH_SLOTS", 48, |p| put(p, 48, &[0b00, 0b0110])),
        ("SWITCH_SLOTS", 48, |p| put(p, 48, &[0b01, 0b0110])),
        ("PACKET_PADDING", 48, |p| p[48] |= 0b100),
        ("PACKET_PADDING", 49, |p| p[49] |= 0x80),
        // One of the ones in the padding is none of the two.
        ("SWITCH_SLOTS", 48, |p| p[49] = 0b1_0010),
        // Nothing descends from wedges 0 and 1.
        ("SWITCH", 50, |p| put(p, 48, &[0b10, 0b1001])),
        // Both slots could have been switched to the wedge that descends from theirs only.
        ("PACKET_LENGTH", 50, |p| p.push(0)),
    ];
    let in_fan: Vec<(&str, u64, Spoil)> = vec![
        ("PACKET_LENGTH", 43, |p| p.truncate(43)),
        ("PACKET_PADDING", 43, |p| p[43] |= 0b100),
        ("PACKET_LENGTH", 44, |p| p.push(1)),
        ("SWITCH", 43, |p| put(p, 41, &[0b10, 0b1001])),
    ];
    // In the fan of three, two bits for a third that there is not.
    let mut fan_of_three = fan();
    fan_of_three.positions.push([5.0, 0.0, 0.0]);
    fan_of_three.wedges.vertices.push(5);
    fan_of_three.collapse.push(2);
    fan_of_three.wedge_collapse.push(2);
    fan_of_three.errors.push(0.0);
    let in_three: Vec<(&str, u64, Spoil)> =
        vec![("SWITCH", 56, |p| p[56] = 0b1101), ("SWITCH", 56, |p| p[56] = 0b0011)];
    assert_eq!(parts(&fan_of_three, 3).packets[1].2[52..], [0b10_010_010, 0, 0b10, 0b1010, 0b0100]);
    let mut seen = BTreeSet::new();
    let files =
        [(strip(), 5, in_strip), (seam(), 3, in_seam), (fan(), 3, in_fan), (fan_of_three, 3, in_three)];
    for (mesh, packet, cases) in files {
        for (number, (name, at, spoil)) in cases.into_iter().enumerate() {
            let mut parts = parts(&mesh, packet);
            let last = parts.packets.len() - 1;
            let mut payload = parts.packets[last].2.clone();
            spoil(&mut payload);
            parts.set_payload(last, payload);
            let error = check(&parts.build(), &Limits::default()).expect_err(name);
            let place = error.offset().0 - parts.payload_offset(last);
            assert_eq!((error.rule().name, place), (name, at), "case {number}: {error}");
            seen.insert(error.code());
        }
    }
    // Packets out of order are tested with Replay, work with switches, what only coded packets can break beside them.
    let elsewhere = [514, 515, 516, 517, 518, 520];
    let all = crate::codes::ALL.iter().map(|code| code.number()).filter(|number| (500..600).contains(number));
    assert_eq!(seen, all.filter(|number| !elsewhere.contains(number)).collect());
}

/// Faces out of order are there later than they might be (PMESH-FACE-05), and nobody is told.
#[test]
fn a_face_out_of_order_is_there_with_the_face_before_it() {
    // As it should be: faces come at levels 3, 4, 5. With the last two exchanged the second waits for the first.
    let mut parts_of_one = parts(&strip(), 5);
    let mut payload = parts_of_one.packets[0].2.clone();
    put32(&mut payload, 76, &[2, 3, 4, 1, 2, 3]);
    parts_of_one.set_payload(0, payload);
    let mut replay = replay_all(&parts_of_one.build());
    let faces = |replay: &mut Replay, level: u32| {
        replay.set_level(level).unwrap();
        replay.indices().to_vec()
    };
    assert_eq!(faces(&mut replay, 5), [[0, 1, 2], [2, 3, 4], [1, 2, 3]]);
    assert_eq!(faces(&mut replay, 4), [[0, 1, 2]]);
    // A face of an earlier packet comes with the first level of its own.
    let mut parts_of_two = parts(&strip(), 4);
    let mut payload = parts_of_two.packets[1].2.clone();
    put32(&mut payload, 16, &[1, 0, 2]);
    parts_of_two.set_payload(1, payload);
    let mut replay = replay_all(&parts_of_two.build());
    assert_eq!(faces(&mut replay, 4), [[0, 1, 2], [1, 2, 3]]);
    assert_eq!(faces(&mut replay, 5), [[0, 1, 2], [1, 2, 3], [1, 0, 2]]);
    assert_eq!(replay.level_of_faces(2), Some(4));
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
    assert_eq!(apply(&wrong, 2), Err("PACKET_LENGTH"));
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
        assert_eq!(replay_all(&file).mesh(), as_read);
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
        put(&mut payload, 4 + 8 * vertex + 2 * component, &value.to_le_bytes());
        parts.set_payload(0, payload);
        let found = check(&parts.build(), &Limits::default())
            .map_err(|error| (error.rule().name, error.offset().0 - parts.payload_offset(0)));
        let expected = if good { Ok(()) } else { Err(("POSITION", 4 + 8 * vertex as u64)) };
        assert_eq!(found, expected, "{value} as component {component} of vertex {vertex}");
    }
    // The box ends, along x and y, at the greatest number that there is, and y has 1022.6 steps: the last point lies beyond.
    let mut parts = right;
    put(&mut parts.specific, 52, &(f32::MAX * 0.0004).to_le_bytes());
    put(&mut parts.specific, 60, &f32::MAX.to_le_bytes());
    put(&mut parts.specific, 64, &f32::MAX.to_le_bytes());
    let mut payload = parts.packets[0].2.clone();
    put(&mut payload, 4 + 8 + 2, &1023u16.to_le_bytes());
    parts.set_payload(0, payload);
    let found = check(&parts.build(), &Limits::default()).map_err(|error| error.rule().name);
    assert_eq!(found, Err("POSITION"), "a coordinate that is not finite");
}
