use std::vec::Vec;

use crate::bits::Packer;
use crate::decode::check;
use crate::encode::{EncodeOptions, encode};
use crate::limits::Limits;
use crate::mesh::Wedges;
use crate::progressive::ProgressiveMesh;
use crate::tests::{Numbers, Parts, replay_all};

/// Vertices from 3 on all descend from vertex 2, each from the one before; `faces` faces switch from it to vertex 3, and as many
/// have only corners of the base.
fn chain(vertices: u32, faces: usize) -> ProgressiveMesh {
    ProgressiveMesh {
        positions: (0..vertices).map(|v| [v as f32, 0.0, 0.0]).collect(),
        wedges: Wedges { vertices: (0..vertices).collect(), ..Wedges::default() },
        base_vertices: 3,
        collapse: (2..vertices - 1).collect(),
        wedge_collapse: (2..vertices - 1).collect(),
        errors: std::vec![0.0; vertices as usize - 3],
        faces: [std::vec![[0, 1, 3]; faces], std::vec![[0, 1, 2]; faces]].concat(),
        ..ProgressiveMesh::default()
    }
}

fn verdict(parts: &Parts, k: usize) -> Result<(), (&'static str, u64)> {
    let checked = check(&parts.build(), &Limits::default());
    checked.map_err(|error| (error.rule().name, error.offset().0 - parts.payload_offset(k)))
}

/// Numbers from 0 to `most`, `count` of them, whose sum is `sum`.
fn adding_up(count: usize, most: u64, sum: u64) -> Vec<u32> {
    let mut left = sum;
    let numbers: Vec<u32> = (0..count)
        .map(|_| {
            let number = left.min(most);
            left -= number;
            number as u32
        })
        .collect();
    assert_eq!(left, 0);
    numbers
}

/// PMESH-SWI-07, for what slots switch to: as much as is allowed, and one more.
#[test]
fn corners_may_pass_as_many_wedges_as_the_payload_allows() {
    let (vertices, faces) = (600, 300);
    let right = Parts::of(&encode(&chain(vertices, faces), &EncodeOptions::fixed(3)).unwrap());
    assert_eq!(right.packets[0].2.len(), 4 + 3 * 12 + 2 * faces * 12);
    // All other vertices in one packet, which no writer makes of deeper switches.
    let file = encode(&chain(vertices, faces), &EncodeOptions::fixed(vertices)).unwrap();
    assert!(header_packets(&file) == 1, "shallow corners fit in one packet");
    let options = EncodeOptions {
        packets: crate::PacketSize::Growing { first: 3, percent: 1_000_000, most: vertices },
        ..EncodeOptions::new()
    };
    let parts = Parts::of(&encode(&chain(vertices, faces), &options).unwrap());
    assert_eq!(parts.packets.len(), 2);
    let payload = parts.packets[1].2.clone();
    // Each slot has a code of 10 bits, for its place among 597 wedges: its depth less one.
    let bits = 10;
    let codes_bytes = (faces * bits).div_ceil(8);
    let most = 8 * payload.len() as u64;
    for (sum, expected) in [(most, Ok(())), (most + 1, Err(("SWITCH_WORK", 0)))] {
        let mut packer = Packer::default();
        for code in adding_up(faces, 596, sum - faces as u64) {
            packer.push(code, bits as u32);
        }
        let mut deep = parts.clone();
        let arrays = &payload[..payload.len() - codes_bytes];
        deep.set_payload(1, [arrays, &packer.finish()].concat());
        assert_eq!(verdict(&deep, 1), expected, "{sum} of {most}");
    }
}

fn header_packets(file: &[u8]) -> usize {
    crate::tests::header_of(file).packets.len()
}

/// The same for the corners of new faces, which need not differ in more than two vertices.
#[test]
fn corners_of_new_faces_count_too() {
    let (vertices, faces) = (600u32, 100);
    let mut mesh = chain(vertices, faces);
    mesh.faces.iter_mut().for_each(|face| *face = [0, 1, 2]);
    let parts = Parts::of(&encode(&mesh, &EncodeOptions::fixed(vertices)).unwrap());
    assert_eq!(parts.packets.len(), 1);
    let payload = parts.packets[0].2.clone();
    let most = 8 * payload.len() as u64;
    let corners = 4 + 12 * vertices as usize;
    for (sum, expected) in [(most, Ok(())), (most + 1, Err(("SWITCH_WORK", 0)))] {
        let mut deep = parts.clone();
        let mut payload = payload.clone();
        for (face, depth) in adding_up(2 * faces, 597, sum).into_iter().enumerate() {
            payload[corners + 12 * face + 8..][..4].copy_from_slice(&(2 + depth).to_le_bytes());
        }
        deep.set_payload(0, payload);
        assert_eq!(verdict(&deep, 0), expected, "{sum} of {most}");
    }
}

/// The fast way and the plain one say the same of any bytes: a packet is refused if and only if there is a rule that it breaks, and
/// the levels before it are what they were.
#[test]
fn any_bytes_of_switches_are_judged_alike() {
    let mut numbers = Numbers::new(11);
    let mesh =
        crate::tests::random_mesh(8, crate::tests::Kind { vertices: 60, seams: true, materials: false });
    let parts = Parts::of(&encode(&mesh, &EncodeOptions::fixed(20)).unwrap());
    let mut refused = std::collections::BTreeSet::new();
    let mut accepted = 0;
    for _ in 0..4000 {
        let mut changed = parts.clone();
        let mut payload = parts.packets[1].2.clone();
        let end = payload.len();
        for _ in 0..1 + numbers.below(3) {
            let at = end - 1 - numbers.below(60);
            payload[at] ^= 1 << numbers.below(8);
        }
        match numbers.below(8) {
            0 => payload.truncate(end - 1 - numbers.below(20)),
            1 => payload.push(numbers.below(2) as u8),
            2 => payload[0] = payload[0].wrapping_add(numbers.below(5) as u8),
            _ => {}
        }
        changed.set_payload(1, payload);
        let before = crate::tests::header_of(&parts.build());
        let file = changed.build();
        let header = crate::tests::header_of(&file);
        let mut replay = crate::replay::Replay::new(&header);
        replay.apply(&packet(&header, &file, 0)).unwrap();
        let shown = replay.mesh();
        match replay.apply(&packet(&header, &file, 1)) {
            Ok(_) => accepted += 1,
            Err(error) => {
                assert_eq!(
                    (replay.mesh(), replay.level()),
                    (shown, before.packets[0].vertices.end),
                    "{error}"
                );
                refused.insert(error.rule().name);
            }
        }
    }
    assert!(accepted > 50, "{accepted} accepted");
    for name in ["SWITCH_SLOTS", "SWITCH", "PACKET_LENGTH", "PACKET_PADDING"] {
        assert!(refused.contains(name), "{name} in {refused:?}");
    }
}

/// A mesh whose packets have more slots than a block, so that some are switched before one is refused.
#[test]
fn a_fault_in_a_later_block_switches_nothing() {
    let faces = 2000;
    let options = EncodeOptions::fixed(3);
    let parts = Parts::of(&encode(&chain(4, faces), &options).unwrap());
    assert_eq!(parts.packets[1].2[..4], (faces as u32).to_le_bytes());
    let mut wrong = parts.clone();
    let mut payload = parts.packets[1].2.clone();
    payload.push(0);
    wrong.set_payload(1, payload);
    let file = wrong.build();
    let header = crate::tests::header_of(&file);
    let mut replay = crate::replay::Replay::new(&header);
    replay.apply(&packet(&header, &file, 0)).unwrap();
    let before = replay.mesh();
    assert_eq!(replay.apply(&packet(&header, &file, 1)).unwrap_err().rule().name, "PACKET_LENGTH");
    assert_eq!(replay.mesh(), before);
    assert_eq!(replay_all(&parts.build()).indices()[..faces], std::vec![[0, 1, 3]; faces]);
}

/// A packet of a file that has this header.
fn packet<'a>(header: &'a crate::header::Header, file: &'a [u8], index: u32) -> crate::packet::Packet<'a> {
    let range = header.packet_range(index);
    crate::decode::decode_packet(header, index, &file[range.start as usize..range.end as usize]).unwrap()
}
