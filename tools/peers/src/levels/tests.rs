use super::faults;

/// The faces name vertices: each vertex has one wedge.
fn faults_at(level: u32, faces: &[[u32; 3]]) -> Vec<&'static str> {
    faults(level, level, faces, |wedge| wedge)
}

#[test]
fn a_valid_level_has_no_faults() {
    assert!(faults_at(4, &[[0, 1, 2], [0, 2, 3]]).is_empty());
    assert!(faults_at(3, &[[0, 1, 2], [0, 2, 1]]).is_empty(), "a closed surface ends like this");
}

#[test]
fn each_fault_is_found() {
    assert_eq!(faults_at(4, &[[0, 1, 2], [0, 2, 4]]), ["an index is too large"]);
    assert_eq!(faults_at(4, &[[0, 1, 2], [0, 2, 2]]), ["two corners of a face are equal"]);
    let removed = faults(3, 4, &[[0, 1, 3]], |wedge| wedge);
    assert_eq!(removed, ["a corner is a removed vertex"]);
}

#[test]
fn coincident_faces_are_allowed_below_a_hundredth_of_the_vertices() {
    let twice = [[0, 1, 2], [2, 1, 0], [3, 4, 5], [4, 3, 5]];
    assert!(faults_at(201, &twice).is_empty());
    assert_eq!(faults_at(200, &twice), ["coincident faces are 1 % of the vertices or more"]);
}
