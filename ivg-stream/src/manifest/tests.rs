use pmesh_format::{EncodeOptions, Mode, PacketSize, ProgressiveMesh};

use super::*;
use crate::client::{SceneLimits, read_mesh};

/// Four vertices and two triangles of materials 0 and 2; the last vertex collapses onto the second.
fn replay() -> Replay {
    replay_of(&EncodeOptions::default())
}

fn replay_of(options: &EncodeOptions) -> Replay {
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.5]];
    let full = IndexedMesh::from_positions(positions, vec![[0, 1, 2], [1, 3, 2]]);
    let mesh = ProgressiveMesh {
        origin: [1e6, 0.25, -3.0],
        positions: full.positions,
        wedges: full.wedges,
        base_vertices: 3,
        collapse: vec![1],
        wedge_collapse: vec![1],
        errors: vec![0.5],
        faces: full.triangles,
        materials: vec![0, 2],
        ..ProgressiveMesh::default()
    };
    read_mesh(&pmesh_format::encode(&mesh, options).unwrap(), &SceneLimits::default()).unwrap()
}

fn scene() -> Scene {
    let material = |name: &str| Material { name: name.into(), ..Material::default() };
    Scene {
        meshes: vec![Mesh { name: "coarse".into(), ..Mesh::default() }],
        materials: ["a", "b", "c"].map(material).into(),
        ..Scene::default()
    }
}

fn entry(materials: Option<Vec<u32>>, origin: [f64; 3]) -> MeshEntry {
    MeshEntry { mesh: 0, file: FileEntry::of("a.pmesh".into(), b""), origin, materials }
}

#[test]
fn a_share_is_a_level_and_the_name_stays() {
    for (share, vertices) in [(0.0, 3), (0.5, 3), (0.75, 3), (0.76, 4), (1.0, 4), (7.0, 4)] {
        let mut scene = scene();
        let mut replay = replay();
        replay.set_level(level_of_share(&replay, share).unwrap()).unwrap();
        entry(None, [0.0; 3]).put(&replay, &mut scene);
        let mesh = &scene.meshes[0];
        assert_eq!((mesh.positions.len(), mesh.name.as_str()), (vertices, "coarse"), "{share}");
        assert_eq!(mesh.triangles.len(), vertices - 2);
    }
}

#[test]
fn a_share_of_a_coded_mesh_is_the_end_of_a_packet() {
    let coded = EncodeOptions { mode: Mode::Coded, ..EncodeOptions::default() };
    for (size, at_three_quarters) in [(4, 4), (3, 3)] {
        let replay = replay_of(&EncodeOptions { packets: PacketSize::Fixed(size), ..coded });
        assert_eq!(level_of_share(&replay, 0.75), Some(at_three_quarters), "{size} vertices a packet");
        // No share at all is the coarsest level, whatever the packet.
        assert_eq!(level_of_share(&replay, 0.0), Some(3));
        assert_eq!(level_of_share(&replay, 1.0), Some(4));
    }
}

#[test]
fn materials_are_mapped_and_missing_ones_are_the_default() {
    for (map, expected, count) in [
        (None, [0, 2], 3),
        (Some(vec![2, 0, 1]), [2, 1], 3),
        (Some(vec![1]), [1, 3], 4),
        (Some(vec![9, 9, 0]), [3, 0], 4),
    ] {
        let mut scene = scene();
        entry(map.clone(), [0.0; 3]).put(&replay(), &mut scene);
        assert_eq!(scene.meshes[0].triangle_materials, expected, "{map:?}");
        assert_eq!(scene.materials.len(), count, "{map:?}");
        assert!(scene.check().is_ok());
    }
}

#[test]
fn the_two_origins_are_subtracted() {
    let mut scene = scene();
    entry(None, [1e6, 0.0, 0.5]).put(&replay(), &mut scene);
    assert_eq!(scene.meshes[0].origin, DVec3::new(0.0, 0.25, -3.5));
    assert_eq!(scene.meshes[0].positions[3], Vec3::new(1.0, 1.0, 0.5));
}
