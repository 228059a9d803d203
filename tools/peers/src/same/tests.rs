use super::compare;
use crate::mesh::Mesh;
use serde_json::json;

fn tetrahedron() -> Mesh {
    Mesh {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.6]],
        indices: vec![0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3],
    }
}

/// The same surface with other numbers and other first corners; positions moved by a third of a step of 4 bits.
fn renumbered() -> Mesh {
    let tetrahedron = tetrahedron();
    let moved = |p: &[f32; 3]| p.map(|x| x + 1.0 / 45.0);
    Mesh {
        positions: tetrahedron.positions.iter().rev().map(moved).collect(),
        indices: vec![3, 1, 2, 0, 3, 2, 1, 0, 2, 1, 3, 0],
    }
}

#[test]
fn order_does_not_matter_and_winding_does() {
    let (original, other) = (tetrahedron(), renumbered());
    assert_eq!(compare(&original, &other, 4), json!({ "triangles": 4, "lost": 0, "foreign": 0 }));
    let mut turned = other;
    turned.indices.swap(0, 1);
    assert_eq!(compare(&original, &turned, 4), json!({ "triangles": 4, "lost": 1, "foreign": 1 }));
}

#[test]
fn a_position_that_is_off_is_found() {
    let original = tetrahedron();
    assert_eq!(compare(&original, &original, 0), json!({ "triangles": 4, "lost": 0, "foreign": 0 }));
    let mut other = tetrahedron();
    other.positions[3][2] = 0.6_f32.next_up();
    assert_eq!(compare(&original, &other, 0), json!({ "triangles": 4, "lost": 3, "foreign": 3 }));
    assert_eq!(compare(&original, &other, 16)["lost"], json!(0));
}

#[test]
fn triangles_without_area_and_repeated_ones_do_not_count() {
    let mut other = tetrahedron();
    other.positions.push([0.0, -0.0, 0.0]);
    other.indices.extend([0, 1, 4, 2, 1, 4]);
    assert_eq!(compare(&tetrahedron(), &other, 0), json!({ "triangles": 4, "lost": 0, "foreign": 0 }));
}
