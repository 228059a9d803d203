use std::vec;

use super::*;

fn square() -> IndexedMesh {
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    IndexedMesh::from_positions(positions, vec![[0, 1, 2], [0, 2, 3]])
}

#[test]
fn each_fault_of_a_level_is_found() {
    let check = |expected: LevelFault, spoil: fn(&mut IndexedMesh)| {
        let mut mesh = square();
        assert_eq!(check_level(&mesh), Ok(()));
        spoil(&mut mesh);
        assert_eq!(check_level(&mesh), Err(expected), "{expected}");
    };
    check(LevelFault::NonFinitePosition { vertex: 2 }, |mesh| mesh.positions[2][1] = f32::NAN);
    check(LevelFault::ArrayLength { array: "normals", found: 1, expected: 4 }, |mesh| {
        mesh.wedges.normals = vec![[0.0; 3]];
    });
    check(LevelFault::ArrayLength { array: "materials", found: 1, expected: 2 }, |mesh| {
        mesh.materials = vec![0];
    });
    check(LevelFault::WedgeVertex { wedge: 3 }, |mesh| {
        mesh.positions.pop();
    });
    check(LevelFault::WedgeOrder { wedge: 1 }, |mesh| mesh.wedges.vertices.swap(0, 1));
    check(LevelFault::Corner { triangle: 1 }, |mesh| mesh.triangles[1][0] = 4);
    check(LevelFault::RepeatedVertex { triangle: 0 }, |mesh| mesh.triangles[0] = [1, 2, 1]);
    // Two wedges of one vertex.
    check(LevelFault::RepeatedVertex { triangle: 1 }, |mesh| mesh.wedges.vertices[3] = 2);
}
