use ivg_format::{EncodeOptions, GridSource, Lattice};

use super::*;
use crate::manifest::MeshEntry;

fn grid_file(value: f32) -> Vec<u8> {
    let vectors = [[[[value; 3]; 3]; 6]; 8];
    let lattice = Lattice::new([2; 3], [0.0; 3], [1.0; 3]).unwrap();
    ivg_format::encode(&GridSource::new(lattice, &vectors), &EncodeOptions::default()).unwrap()
}

fn mesh_file(height: f32) -> Vec<u8> {
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, height, 0.0]];
    let full = pmesh_format::IndexedMesh::from_positions(positions, vec![[0, 1, 2]]);
    let mesh = pmesh_format::ProgressiveMesh {
        positions: full.positions,
        wedges: full.wedges,
        base_vertices: 3,
        faces: full.triangles,
        ..Default::default()
    };
    pmesh_format::encode(&mesh, &pmesh_format::EncodeOptions::default()).unwrap()
}

fn manifest(meshes: &[(&str, &[u8])], grid: &[u8]) -> Manifest {
    let mesh = |(mesh, &(uri, bytes)): (usize, &(&str, &[u8]))| MeshEntry {
        mesh,
        file: FileEntry::of(uri.into(), bytes),
        origin: [0.0; 3],
        materials: None,
    };
    Manifest {
        scene: Scene::default(),
        meshes: meshes.iter().enumerate().map(mesh).collect(),
        grid: Some(FileEntry::of("light.ivg".into(), grid)),
    }
}

fn feed(assembly: &mut Assembly, files: &[(&str, &[u8])]) {
    for mut reader in assembly.readers() {
        let (_, bytes) = files.iter().find(|(uri, _)| *uri == reader.uri()).unwrap();
        reader.feed(bytes).unwrap();
        reader.finish().unwrap();
    }
}

#[test]
fn meshes_that_name_one_file_share_it() {
    let (mesh, grid) = (mesh_file(1.0), grid_file(1.0));
    let mut assembly = Assembly::new(manifest(&[("a", &mesh), ("a", &mesh)], &grid), SceneLimits::default());
    assert_eq!(assembly.readers().count(), 2);
    feed(&mut assembly, &[("a", &mesh), ("light.ivg", &grid)]);
    assert!(std::ptr::eq(assembly.replay(0).unwrap(), assembly.replay(1).unwrap()));
    assert!(assembly.replay(2).is_none());
    assert_eq!(assembly.geometry_share(), 1.0);
}

#[test]
fn another_description_keeps_what_it_states_as_before() {
    let (a, b, other_b, c, grid) =
        (mesh_file(1.0), mesh_file(2.0), mesh_file(3.0), mesh_file(4.0), grid_file(1.0));
    let mut assembly = Assembly::new(manifest(&[("a", &a), ("b", &b)], &grid), SceneLimits::default());
    assert_eq!(assembly.next_mesh(1.0), Some(0), "the first of equals");
    feed(&mut assembly, &[("a", &a), ("b", &b), ("light.ivg", &grid)]);
    assert_eq!(assembly.next_mesh(1.0), None);

    let restarted = assembly.adopt(manifest(&[("c", &c), ("b", &other_b), ("a", &a)], &grid));
    assert_eq!(restarted, ["b"]);
    assert!(assembly.replay(0).is_none() && assembly.replay(1).is_none());
    assert_eq!(assembly.replay(2).unwrap().positions()[2], [0.0, 1.0, 0.0], "kept in its new place");
    assert!(assembly.grid().is_some());
    assert_eq!(assembly.next_mesh(1.0), Some(0));

    let file = assembly.manifest().meshes[2].file.clone();
    assembly.drop_file(&file);
    assert!(assembly.replay(2).is_none());
    assert_eq!(assembly.adopt(manifest(&[], &grid_file(2.0))), ["light.ivg"]);
    assert!(assembly.grid().is_none() && assembly.replay(0).is_none());
}
