use std::vec;
use std::vec::Vec;

use quickcheck::quickcheck;

use super::*;
use crate::decode::{decode_all, decode_packet};
use crate::encode::{EncodeOptions, PacketSize, encode};
use crate::limits::Limits;
use crate::tests::{Kind, Numbers, expected, header_of, random_mesh, replay_all, some_meshes};

#[test]
fn every_level_equals_the_direct_mapping_up_and_down() {
    for mesh in some_meshes() {
        let mut replay = replay_all(&encode(&mesh, &EncodeOptions::fixed(3)).unwrap());
        let levels = replay.levels().unwrap();
        assert_eq!(levels, mesh.base_vertices..=mesh.positions.len() as u32);
        for level in levels.clone().rev().chain(levels) {
            replay.set_level(level).unwrap();
            assert_eq!(replay.mesh(), expected(&mesh, level), "level {level}");
        }
    }
}

quickcheck! {
    /// Any walk over the levels, while packets come in; a copy of the index buffer that is only given what is reported as
    /// changed stays equal.
    fn any_walk_gives_the_direct_mapping(seed: u64, size: u8, packet: u8, steps: Vec<u16>) -> bool {
        let kind = Kind { vertices: 1 + usize::from(size) % 60, seams: seed.is_multiple_of(2), materials: seed.is_multiple_of(3) };
        let mesh = random_mesh(seed, kind);
        let file = encode(&mesh, &EncodeOptions::fixed(1 + u32::from(packet) % 30)).unwrap();
        let mut steps = steps.into_iter();
        let mut replay = Replay::default();
        let mut copy: Vec<[u32; 3]> = vec![];
        let mut good = true;
        decode_all(&file, &Limits::default(), |event| {
            let Some(change) = replay.accept(&event).unwrap() else { return };
            let levels = replay.levels().unwrap();
            good &= change.to == *levels.end() && update(&mut copy, &change, &replay);
            for step in steps.by_ref().take(3) {
                let count = levels.end() - levels.start() + 1;
                let level = levels.start() + u32::from(step) % count;
                let change = replay.set_level(level).unwrap();
                good &= change.to == level && update(&mut copy, &change, &replay);
                good &= replay.mesh().triangles == expected(&mesh, level).triangles;
            }
        })
        .unwrap();
        replay.set_level(mesh.positions.len() as u32).unwrap();
        good && replay.mesh() == expected(&mesh, mesh.positions.len() as u32)
    }

    /// The same mesh in packets of other sizes is the same at every level.
    fn levels_do_not_depend_on_the_size_of_packets(seed: u64) -> bool {
        let mesh = random_mesh(seed, Kind { vertices: 40, seams: seed.is_multiple_of(2), materials: false });
        let sizes = [
            PacketSize::Fixed(1),
            PacketSize::Fixed(7),
            PacketSize::Fixed(1000),
            PacketSize::Growing { first: 2, percent: 30, most: 9 },
        ];
        let mut replays = sizes.map(|packets| replay_all(&encode(&mesh, &EncodeOptions { packets, ..EncodeOptions::new() }).unwrap()));
        (mesh.base_vertices..=40).all(|level| {
            let meshes = replays.each_mut().map(|replay| {
                replay.set_level(level).unwrap();
                replay.mesh()
            });
            meshes.windows(2).all(|pair| pair[0] == pair[1])
        })
    }
}

/// Gives the copy of an index buffer what has changed; whether it is equal then, and nothing equal was reported.
fn update(copy: &mut Vec<[u32; 3]>, change: &LevelChange, replay: &Replay) -> bool {
    let indices = replay.indices();
    copy.resize(indices.len(), [u32::MAX; 3]);
    let ranges_ascend = change.changed.windows(2).all(|pair| pair[0].end < pair[1].start);
    for range in &change.changed {
        let range = range.start as usize..range.end as usize;
        copy[range.clone()].copy_from_slice(&indices[range]);
    }
    ranges_ascend && copy == indices
}

#[test]
fn a_change_names_only_the_faces_that_switch() {
    // A strip: vertex k collapses onto k − 1, so that one step down touches the one or two faces beside it.
    let vertices = 100u32;
    let mesh = crate::ProgressiveMesh {
        positions: (0..vertices).map(|v| [v as f32, (v % 2) as f32, 0.0]).collect(),
        wedges: Wedges { vertices: (0..vertices).collect(), ..Wedges::default() },
        base_vertices: 3,
        collapse: (3..vertices).map(|v| v - 1).collect(),
        wedge_collapse: (3..vertices).map(|v| v - 1).collect(),
        errors: vec![0.0; 97],
        faces: (2..vertices).map(|v| [v - 2, v - 1, v]).collect(),
        ..crate::ProgressiveMesh::default()
    };
    let mut replay = replay_all(&encode(&mesh, &EncodeOptions::default()).unwrap());
    let change = replay.set_level(50).unwrap();
    assert_eq!(change, LevelChange { from: 100, to: 50, changed: vec![] }, "faces only go");
    assert_eq!(replay.indices().len(), 48);
    let change = replay.set_level(52).unwrap();
    assert_eq!((change.from, change.to), (50, 52));
    assert!(change.changed.iter().eq([&(48..50)]), "two faces come: {:?}", change.changed);
    // Nothing changes when the level stays.
    assert_eq!(replay.set_level(52).unwrap().changed, vec![]);
}

#[test]
fn levels_that_are_not_there_are_refused_by_name() {
    let mesh = random_mesh(3, Kind { vertices: 30, seams: false, materials: false });
    let file = encode(&mesh, &EncodeOptions::fixed(10)).unwrap();
    let header = header_of(&file);
    let mut replay = Replay::new(&header);
    assert_eq!(replay.set_level(5).unwrap_err(), LevelError { asked: 5, levels: None });
    let range = header.packet_range(0);
    let packet = decode_packet(&header, 0, &file[range.start as usize..range.end as usize]).unwrap();
    replay.apply(&packet).unwrap();
    let base = mesh.base_vertices;
    for asked in [0, base - 1, 11, u32::MAX] {
        let error = replay.set_level(asked).unwrap_err();
        assert_eq!(error, LevelError { asked, levels: Some(base..=10) });
        assert_eq!(replay.level(), 10, "nothing changes");
    }
}

#[test]
fn packets_out_of_order_twice_or_missing_are_refused() {
    let mesh = random_mesh(5, Kind { vertices: 30, seams: true, materials: true });
    let file = encode(&mesh, &EncodeOptions::fixed(10)).unwrap();
    let header = header_of(&file);
    let packet = |k: u32| {
        let range = header.packet_range(k);
        decode_packet(&header, k, &file[range.start as usize..range.end as usize]).unwrap()
    };
    let mut replay = Replay::new(&header);
    let refused = |replay: &mut Replay, k: u32| {
        let before = (replay.level(), replay.mesh());
        let error = replay.apply(&packet(k)).unwrap_err();
        assert_eq!(error.rule().name, "PACKET_ORDER");
        assert_eq!(error.offset().0, header.packet_range(k).start + 8);
        assert_eq!((replay.level(), replay.mesh()), before);
    };
    refused(&mut replay, 1);
    replay.apply(&packet(0)).unwrap();
    refused(&mut replay, 0);
    refused(&mut replay, 2);
    replay.apply(&packet(1)).unwrap();
    replay.apply(&packet(2)).unwrap();
    refused(&mut replay, 2);
    assert_eq!(replay.mesh().triangles, expected(&mesh, 30).triangles);

    // A packet of another file with the same layout.
    let mut other = mesh.clone();
    other.positions[0] = [0.25; 3];
    let other = encode(&other, &EncodeOptions::fixed(10)).unwrap();
    let other_header = header_of(&other);
    let range = other_header.packet_range(0);
    let foreign = decode_packet(&other_header, 0, &other[range.start as usize..range.end as usize]).unwrap();
    assert_eq!(Replay::new(&header).apply(&foreign).unwrap_err().rule().name, "PACKET_ORDER");
}

#[test]
fn the_error_of_a_level_is_that_of_its_packet() {
    let mesh = random_mesh(8, Kind { vertices: 30, seams: false, materials: false });
    let mut replay = Replay::default();
    assert_eq!(replay.error(), 0.0, "no file: a mesh without vertices, complete");
    replay = replay_all(&encode(&mesh, &EncodeOptions::fixed(10)).unwrap());
    let mut numbers = Numbers::new(1);
    for _ in 0..20 {
        let level = mesh.base_vertices + numbers.below(30 - mesh.base_vertices as usize) as u32;
        replay.set_level(level).unwrap();
        let own = mesh.errors[(level - mesh.base_vertices) as usize];
        assert!(replay.error() >= own, "level {level}");
        let packet = level.div_ceil(10).max(1);
        let coarsest = ((packet - 1) * 10 + 1).max(mesh.base_vertices);
        assert_eq!(replay.error(), mesh.errors[(coarsest - mesh.base_vertices) as usize], "level {level}");
    }
    replay.set_level(30).unwrap();
    assert_eq!(replay.error(), 0.0);
}
