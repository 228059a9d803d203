use glam::Vec3;

use super::Mesh;

/// Two triangles that meet at a right angle along the x axis.
fn folded(shared: bool) -> Mesh {
    let (a, b) = (Vec3::ZERO, Vec3::X);
    let (flat, upright) = (Vec3::Y, Vec3::Z);
    let (positions, triangles) = if shared {
        (vec![a, b, flat, upright], vec![[0, 1, 2], [1, 0, 3]])
    } else {
        (vec![a, b, flat, b, a, upright], vec![[0, 1, 2], [3, 4, 5]])
    };
    Mesh { positions, triangles, triangle_materials: vec![0; 2], ..Mesh::default() }
}

#[test]
fn unshared_vertices_along_an_edge_are_a_crease() {
    assert!(folded(false).has_unstored_creases());
}

#[test]
fn shared_vertices_are_smooth() {
    assert!(!folded(true).has_unstored_creases());
}

#[test]
fn stored_normals_say_all_that_there_is_to_say() {
    let mut mesh = folded(false);
    mesh.normals = mesh.shading_normals();
    assert!(!mesh.has_unstored_creases());
    assert_eq!(mesh.normals[0], Vec3::Z);
}

#[test]
fn coplanar_and_unreferenced_duplicates_are_no_crease() {
    let mut mesh = folded(true);
    mesh.positions.extend([Vec3::ZERO, Vec3::X, -Vec3::Y]);
    mesh.triangles = vec![[0, 1, 2], [5, 4, 6]];
    assert!(!mesh.has_unstored_creases(), "two halves of one plane");
    mesh.positions.push(Vec3::ZERO);
    assert!(!mesh.has_unstored_creases(), "a vertex of no face has no normal");
}
