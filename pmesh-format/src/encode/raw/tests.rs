use std::vec;
use std::vec::Vec;

use crate::encode::{EncodeOptions, encode};
use crate::mesh::Wedges;
use crate::progressive::ProgressiveMesh;
use crate::tests::{expected, header_of, replay_all};

/// Each vertex collapses onto the one before, and all faces have three of the last ones.
fn deep(vertices: u32, faces: usize) -> ProgressiveMesh {
    let corners = |k: usize| [1, 2, 3].map(|n| vertices - n - (k % 5) as u32);
    ProgressiveMesh {
        positions: (0..vertices).map(|v| [v as f32, 1.0, 0.0]).collect(),
        wedges: Wedges { vertices: (0..vertices).collect(), ..Wedges::default() },
        base_vertices: 1,
        collapse: (0..vertices - 1).collect(),
        wedge_collapse: (0..vertices - 1).collect(),
        errors: vec![0.0; vertices as usize - 1],
        faces: (0..faces).map(corners).collect(),
        ..ProgressiveMesh::default()
    }
}

/// One face for every three vertices, which pass all of them before they meet.
fn wide(vertices: u32) -> ProgressiveMesh {
    let parent = |v: u32| v.saturating_sub(3);
    ProgressiveMesh {
        base_vertices: 3,
        collapse: (3..vertices).map(parent).collect(),
        wedge_collapse: (3..vertices).map(parent).collect(),
        errors: vec![0.0; vertices as usize - 3],
        faces: vec![[vertices - 3, vertices - 2, vertices - 1]; 2 * vertices as usize],
        ..deep(vertices, 0)
    }
}

/// Writing never fails for want of bytes: packets are cut in half as often as it takes, and only then.
#[test]
fn packets_whose_corners_pass_too_many_wedges_are_cut() {
    let mesh = wide(600);
    let file = encode(&mesh, &EncodeOptions::fixed(600)).unwrap();
    let ends: Vec<u32> = header_of(&file).packets.iter().map(|entry| entry.vertices.end).collect();
    assert!(ends.len() > 1 && ends.len() < 100, "{ends:?}");
    let mut replay = replay_all(&file);
    for level in [3, 4, 57, 300, 599, 600] {
        replay.set_level(level).unwrap();
        assert_eq!(replay.mesh(), expected(&mesh, level), "level {level}");
    }
    // Faces that are gone at once pass few.
    assert_eq!(header_of(&encode(&deep(600, 20), &EncodeOptions::fixed(600)).unwrap()).packets.len(), 1);
}
