use super::{Level, faults};

const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

/// The faces name vertices: each vertex has one wedge.
fn faults_at(vertices: u32, faces: &[[u32; 3]]) -> Vec<&'static str> {
    faults(&Level { vertices, wedges: vertices, coarse: false, faces }, |wedge| wedge)
}

#[test]
fn a_valid_level_has_no_faults() {
    assert!(faults_at(4, &TETRAHEDRON).is_empty());
}

#[test]
fn each_fault_is_found() {
    assert_eq!(faults_at(3, &TETRAHEDRON), ["an index is too large"]);
    assert_eq!(faults_at(4, &[[0, 1, 2], [0, 2, 2]]), ["two corners of a face are equal"]);
    assert_eq!(faults_at(4, &[[0, 1, 2], [0, 1, 3], [2, 1, 0]]), ["two faces have the same corners"]);
    let removed = Level { vertices: 3, wedges: 4, coarse: false, faces: &TETRAHEDRON };
    assert_eq!(faults(&removed, |wedge| wedge), ["a corner is a removed vertex"]);
}

#[test]
fn a_coarse_level_may_have_coincident_faces() {
    let ends = Level { vertices: 3, wedges: 3, coarse: true, faces: &[[0, 1, 2], [0, 2, 1]] };
    assert!(faults(&ends, |wedge| wedge).is_empty());
    assert_eq!(faults(&Level { coarse: false, ..ends }, |wedge| wedge).len(), 1);
}
