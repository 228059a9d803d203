use std::vec;
use std::vec::Vec;

use super::*;
use crate::encode::{EncodeOptions, encode};
use crate::progressive::ProgressiveMesh;
use crate::tests::{Kind, Parts, header_of, random_mesh, replay_all, some_meshes};

/// PMESH-FACE-05 word by word, for faces in any order: for each face the level from which on it is there.
fn introduced(mesh: &ProgressiveMesh, packets: &[(Range<u32>, Range<u32>)], faces: &[[u32; 3]]) -> Vec<u32> {
    let apart = |face: &[u32; 3], level: u32| {
        let [a, b, c] = face.map(|w| mesh.wedges.vertices[mesh.map_wedge(w, level) as usize]);
        a != b && b != c && c != a
    };
    let mut levels = vec![];
    for (vertices, range) in packets {
        let mut least = if vertices.start == 0 { mesh.base_vertices } else { vertices.start + 1 };
        for face in &faces[range.start as usize..range.end as usize] {
            least = (mesh.base_vertices..).find(|&level| apart(face, level)).unwrap().max(least);
            levels.push(least);
        }
    }
    levels
}

#[test]
fn faces_are_introduced_as_the_specification_says() {
    for seed in 0..30 {
        let seams = seed % 2 == 0;
        let mesh = random_mesh(seed, Kind { vertices: 20, seams, materials: false });
        let mut parts = Parts::of(&encode(&mesh, &EncodeOptions::fixed(5 + 8 * (seed as u32 % 3))).unwrap());
        let header = header_of(&parts.build());
        // The faces of the last packet, which no later one switches, in another order: reversed.
        let last = header.packets.len() - 1;
        let layout = header.layout(&header.packets[last]).unwrap();
        let mut payload = parts.packets[last].2.clone();
        let corners = payload[layout.corners.clone()].to_vec();
        let reversed: Vec<u8> = corners.rchunks(12).flatten().copied().collect();
        payload[layout.corners].copy_from_slice(&reversed);
        parts.set_payload(last, payload);
        let file = parts.build();
        let mut replay = replay_all(&file);
        let packets: Vec<_> =
            header.packets.iter().map(|entry| (entry.vertices.clone(), entry.faces.clone())).collect();
        let expected = introduced(&mesh, &packets, &replay.corners);
        for faces in 0..=mesh.faces.len() as u32 {
            // Before anybody has stepped.
            let found = replay_all(&file).level_of_faces(faces);
            let within = |level: &u32| expected.iter().filter(|&&e| e <= *level).count() as u32 <= faces;
            let levels = mesh.base_vertices..=20;
            assert_eq!(found, levels.rev().find(within).or(Some(mesh.base_vertices)), "{faces} faces");
        }
        for level in (mesh.base_vertices..=20).rev() {
            replay.set_level(level).unwrap();
            let there = expected.iter().filter(|&&e| e <= level).count();
            assert_eq!(replay.face_count() as usize, there, "level {level} of mesh {seed}");
        }
    }
}

/// What is prepared at once is what is prepared packet by packet.
#[test]
fn steps_do_not_depend_on_when_somebody_steps() {
    for mesh in some_meshes().into_iter().filter(|mesh| !mesh.positions.is_empty()) {
        let file = encode(&mesh, &EncodeOptions::fixed(2)).unwrap();
        let header = header_of(&file);
        let whole = replay_all(&file);
        for stepped in 0..header.packet_count() {
            let mut replay = Replay::new(&header);
            for k in 0..header.packet_count() {
                let range = header.packet_range(k);
                let bytes = &file[range.start as usize..range.end as usize];
                replay.apply(&crate::decode::decode_packet(&header, k, bytes).unwrap()).unwrap();
                if k == stepped {
                    replay.set_level(mesh.base_vertices).unwrap();
                }
            }
            let mut whole = whole.clone();
            for level in (mesh.base_vertices..=mesh.positions.len() as u32).rev() {
                replay.set_level(level).unwrap();
                whole.set_level(level).unwrap();
                assert_eq!(replay.indices(), whole.indices(), "level {level}, stepped at packet {stepped}");
            }
        }
    }
}

#[test]
fn nothing_is_prepared_before_somebody_steps() {
    let mesh = random_mesh(5, Kind { vertices: 30, seams: true, materials: true });
    let mut replay = replay_all(&encode(&mesh, &EncodeOptions::fixed(7)).unwrap());
    replay.set_level(30).unwrap();
    assert!(replay.steps.is_none());
    replay.set_level(29).unwrap();
    assert!(replay.steps.is_some());
}
