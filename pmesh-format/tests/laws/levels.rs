//! What the words of the specification mean: levels, introductions, complete packets, by hand and by brute force.

use crate::files::{file, header, packet, random, replayed, seam, strip};
use pmesh_format::{IndexedMesh, ProgressiveMesh, check_level};

/// The wedge that stands for `wedge` when all vertices from `level` on have been taken away, one after the other.
fn mapped(mesh: &ProgressiveMesh, wedge: u32, level: u32) -> u32 {
    let first = mesh.wedges.vertices.iter().position(|&v| v >= mesh.base_vertices).unwrap_or(0);
    let mut wedge = wedge;
    for vertex in (level..mesh.positions.len() as u32).rev() {
        if mesh.wedges.vertices[wedge as usize] == vertex {
            wedge = mesh.wedge_collapse[wedge as usize - first];
        }
    }
    wedge
}

/// Whether three wedges lie on three different vertices.
fn is_face(mesh: &ProgressiveMesh, corners: [u32; 3]) -> bool {
    let [a, b, c] = corners.map(|w| mesh.wedges.vertices[w as usize]);
    a != b && b != c && c != a
}

/// The faces of a level, each with its number in the mesh, by trying all.
fn faces(mesh: &ProgressiveMesh, level: u32) -> Vec<(usize, [u32; 3])> {
    let all = mesh.faces.iter().map(|face| face.map(|wedge| mapped(mesh, wedge, level)));
    all.enumerate().filter(|&(_, corners)| is_face(mesh, corners)).collect()
}

#[test]
fn a_vertex_of_the_seam_goes_and_its_corners_move() {
    let mut replay = replayed(&file(&seam(), 3), 2);
    assert_eq!(replay.indices(), [[0, 1, 4], [1, 0, 5], [0, 2, 4]]);
    assert_eq!((0..6).map(|w| replay.wedge_vertex(w)).collect::<Vec<_>>(), [0, 1, 2, 2, 3, 3]);
    // Wedges 4 and 5 of vertex 3 become 2 and 3; the last face has two corners on vertex 2 then.
    replay.set_level(3).unwrap();
    assert_eq!(replay.indices(), [[0, 1, 2], [1, 0, 3]]);
    assert_eq!((replay.positions().len(), replay.wedge_count()), (3, 4));
}

#[test]
fn a_level_has_the_faces_whose_corners_still_differ() {
    for (seed, rich) in [(1, false), (2, true), (3, true)] {
        let mesh = random(seed, 25, rich);
        let mut replay = replayed(&file(&mesh, 9), 3);
        for level in 3..=25 {
            replay.set_level(level).unwrap();
            let found = replay.mesh();
            check_level(&found).unwrap();
            let mut expected: Vec<[u32; 3]> =
                faces(&mesh, level).into_iter().map(|(_, corners)| corners).collect();
            let mut triangles = found.triangles;
            expected.sort_unstable();
            triangles.sort_unstable();
            assert_eq!(triangles, expected, "level {level}");
            assert_eq!(found.positions, mesh.positions[..level as usize]);
        }
    }
}

/// PMESH-DEF-04: once two corners meet they never part; so the faces of a level are among those of any finer one.
#[test]
fn corners_that_have_met_never_part_again() {
    let mesh = random(4, 30, true);
    for level in 4..=30 {
        let finer: Vec<usize> = faces(&mesh, level).into_iter().map(|(face, _)| face).collect();
        assert!(faces(&mesh, level - 1).iter().all(|(face, _)| finer.contains(face)), "level {level}");
    }
}

/// PMESH-FACE-01, PMESH-FACE-06: faces are stored by the smallest level that has them, with their corners as mapped where the packet
/// ends that completes it.
#[test]
fn faces_are_stored_as_they_are_at_the_end_of_their_packet() {
    for packet_size in [1, 4, 100] {
        let mesh = random(5, 30, true);
        let file = file(&mesh, packet_size);
        let header = header(&file);
        let mut end = 2;
        for k in 0..header.packet_count() {
            let entry = &header.packets[k as usize];
            let mut expected = vec![];
            while end < entry.vertices.end {
                let before: Vec<usize> = if end < 3 {
                    vec![]
                } else {
                    faces(&mesh, end).into_iter().map(|(face, _)| face).collect()
                };
                end += 1;
                let new =
                    faces(&mesh, end).into_iter().map(|(face, _)| face).filter(|face| !before.contains(face));
                expected
                    .extend(new.map(|face| mesh.faces[face].map(|w| mapped(&mesh, w, entry.vertices.end))));
            }
            let packet = packet(&file, &header, k);
            let numbers: Vec<u32> = packet
                .corner_bytes()
                .chunks_exact(4)
                .map(|b| u32::from_le_bytes(*b.first_chunk().unwrap()))
                .collect();
            assert_eq!(numbers, expected.concat(), "packet {k}");
        }
    }
}

/// PMESH-SWI-04 to -06, read from the bytes: a packet names the corners of earlier faces that it changes, and what they become.
#[test]
fn a_packet_switches_the_corners_that_change() {
    // Slots 2 and 5 lie on wedges 2 and 3 of vertex 2, and switch to those that become these.
    let mut mesh = seam();
    let payload = |mesh: &ProgressiveMesh| crate::files::Parts::of(&file(mesh, 3)).packets[1].1.clone();
    let whole = payload(&mesh);
    assert_eq!((whole[0], &whole[whole.len() - 2..]), (2, &[0b10, 0b1010][..]));
    mesh.faces[1] = [1, 0, 3];
    // Slot 2 alone: a low bit, 0, then a one in place 1 of three.
    let whole = payload(&mesh);
    assert_eq!((whole[0], &whole[whole.len() - 2..]), (1, &[0, 0b010][..]));
}

/// PMESH-DIR-06, and the error of each level in between.
#[test]
fn a_level_is_complete_with_the_first_packet_that_reaches_it() {
    let mesh = random(6, 14, false);
    let file = file(&mesh, 4);
    let header = header(&file);
    for level in 3..=14 {
        let first = header.packets.iter().position(|packet| packet.vertices.end >= level).unwrap() as u32;
        assert_eq!(header.packet_of_level(level), Some(first));
        assert!(replayed(&file, first + 1).set_level(level).is_ok());
        assert!(replayed(&file, first).set_level(level).is_err());
    }
    // Who wants an error of at most e fetches up to the first packet with at most e; level 14 has none.
    for e in [1.0, 0.2, 0.1, 0.0] {
        let wanted = header.packets.iter().position(|packet| packet.error <= e).map_or(4, |k| k as u32 + 1);
        let mut replay = replayed(&file, wanted);
        replay.set_level(replay.max_level()).unwrap();
        assert!(replay.error() <= e || wanted == 4, "{e}");
    }
    assert_eq!(replayed(&file, 4).error(), 0.0);
}

/// PMESH-LVL-01: bytes for bytes the same, whichever level was shown before, in packets of whatever size.
#[test]
fn a_level_does_not_depend_on_the_way_there() {
    let mesh = random(7, 24, true);
    let whole = |packet: u32| {
        let file = file(&mesh, packet);
        replayed(&file, header(&file).packet_count())
    };
    let show = |replay: &mut pmesh_format::Replay, level: u32| {
        replay.set_level(level).unwrap();
        IndexedMesh { material_names: vec![], ..replay.mesh() }
    };
    let expected: Vec<IndexedMesh> = (3..=24).map(|level| show(&mut whole(24), level)).collect();
    for packet in [1, 2, 5, 11] {
        let mut replay = whole(packet);
        for step in [1, 5, 7, 13, 21] {
            let mut level = 3;
            for _ in 0..22 {
                assert_eq!(
                    show(&mut replay, level),
                    expected[level as usize - 3],
                    "level {level}, packets of {packet}"
                );
                level = 3 + (level - 3 + step) % 22;
            }
        }
    }
}

/// PMESH-LVL-05: from level to level only corners of the vertices in between switch.
#[test]
fn a_step_changes_no_more_corners_than_switch() {
    let mesh = random(8, 40, false);
    let file = file(&mesh, 40);
    let mut replay = replayed(&file, 1);
    for level in (3..40).rev() {
        let before = replay.indices().to_vec();
        let change = replay.set_level(level).unwrap();
        let differ = |face: &u32| replay.indices()[*face as usize] != before[*face as usize];
        let changed: Vec<u32> = (0..replay.face_count()).filter(differ).collect();
        assert_eq!(change.changed.into_iter().flatten().collect::<Vec<u32>>(), changed, "level {level}");
    }
}

/// PMESH-HDR-06: the sum in binary64, so that a scene far away keeps the precision that its positions have.
#[test]
fn the_origin_is_carried_beside_the_positions() {
    let mut mesh = strip();
    mesh.origin = [1e6 + 1.0 / 1024.0, -0.0, 5e-324];
    let replay = replayed(&file(&mesh, 5), 1);
    assert_eq!(replay.header().origin.map(f64::to_bits), mesh.origin.map(f64::to_bits));
    assert_eq!(replay.mesh().origin.map(f64::to_bits), mesh.origin.map(f64::to_bits));
    assert_eq!(replay.positions(), mesh.positions);
}
