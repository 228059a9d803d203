use alloc::vec;
use alloc::vec::Vec;

use crate::encode::{EncodeOptions, encode};
use crate::progressive::ProgressiveMesh;
use crate::replay::Replay;
use crate::storage::Mode;
use crate::tests::{Kind, header_of, random_mesh, replay_all, some_meshes};

#[test]
fn the_level_of_an_error_is_the_coarsest_that_keeps_it() {
    for seed in 0..20 {
        let mesh = random_mesh(seed, Kind { vertices: 30, seams: false, materials: false });
        let file = encode(&mesh, &EncodeOptions::fixed(7)).unwrap();
        let mut replay = replay_all(&file);
        let mut error_of = |level| {
            replay.set_level(level).unwrap();
            replay.error()
        };
        let levels = mesh.base_vertices..=30;
        for wanted in [0.0, 0.1, 0.3, 0.5, 0.9, 2.0, f32::INFINITY] {
            let expected = levels.clone().find(|&level| error_of(level) <= wanted).unwrap();
            assert_eq!(header_of(&file).level_of_error(wanted), expected, "{wanted} of mesh {seed}");
        }
        for nonsense in [-1.0, f32::NAN, f32::NEG_INFINITY] {
            assert_eq!(header_of(&file).level_of_error(nonsense), 30);
        }
    }
}

#[test]
fn the_level_of_a_number_of_faces_is_the_finest_within_it() {
    for mesh in some_meshes().into_iter().filter(|mesh| !mesh.positions.is_empty()) {
        let mut replay = replay_all(&encode(&mesh, &EncodeOptions::fixed(3)).unwrap());
        for faces in 0..=mesh.faces.len() as u32 + 1 {
            let levels = replay.levels().unwrap();
            let within = levels.clone().rev().find(|&level| {
                replay.set_level(level).unwrap();
                replay.face_count() <= faces
            });
            assert_eq!(
                replay.level_of_faces(faces),
                Some(within.unwrap_or(*levels.start())),
                "{faces} faces"
            );
        }
    }
}

#[test]
fn only_levels_that_have_arrived_are_named() {
    let mesh = random_mesh(3, Kind { vertices: 30, seams: true, materials: false });
    let file = encode(&mesh, &EncodeOptions::fixed(10)).unwrap();
    let mut replay = Replay::new(&header_of(&file));
    assert_eq!((replay.level_of_error(0.0), replay.level_of_faces(9)), (None, None));
    let header = header_of(&file);
    let range = header.packet_range(0);
    let packet = &file[range.start as usize..range.end as usize];
    replay.apply(&crate::decode::decode_packet(&header, 0, packet).unwrap()).unwrap();
    assert_eq!((replay.level_of_error(0.0), replay.level_of_faces(u32::MAX)), (Some(10), Some(10)));
}

#[test]
fn every_level_of_a_raw_file_is_whole_and_the_ends_of_coded_packets() {
    let mesh = random_mesh(4, Kind { vertices: 30, seams: false, materials: false });
    let whole = |mode| {
        let file = encode(&mesh, &EncodeOptions { mode, ..EncodeOptions::fixed(10) }).unwrap();
        let header = header_of(&file);
        (0..=40).filter(|&level| header.is_whole_level(level)).collect::<Vec<_>>()
    };
    assert_eq!(whole(Mode::Raw), (mesh.base_vertices..=30).collect::<Vec<_>>());
    let mut ends = vec![mesh.base_vertices, 10, 20, 30];
    ends.dedup();
    assert_eq!(whole(Mode::Coded), ends);

    let empty = encode(&ProgressiveMesh::default(), &EncodeOptions::default()).unwrap();
    assert!(header_of(&empty).is_whole_level(0) && !header_of(&empty).is_whole_level(1));
}
