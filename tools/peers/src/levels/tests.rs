use pmesh_format::{EncodeOptions, Limits, Mode, PacketSize, ProgressiveMesh, Replay, Wedges, encode};

use super::{COINCIDENT, Found, Level, faults};

const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

/// The faces name vertices: each vertex has one wedge.
fn faults_at(vertices: u32, faces: &[[u32; 3]]) -> Vec<&'static str> {
    faults(&Level { vertices, wedges: vertices, faces }, |wedge| wedge)
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
    let removed = Level { vertices: 3, wedges: 4, faces: &TETRAHEDRON };
    assert_eq!(faults(&removed, |wedge| wedge), ["a corner is a removed vertex"]);
}

#[test]
fn faces_may_coincide_inside_coded_packets_only() {
    // A square with a third triangle, which falls onto the second when vertex 4 goes.
    let mesh = ProgressiveMesh {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 1.0]],
        wedges: Wedges { vertices: (0..5).collect(), ..Wedges::default() },
        base_vertices: 3,
        collapse: vec![0, 3],
        wedge_collapse: vec![0, 3],
        errors: vec![0.5, 0.25],
        faces: vec![[0, 1, 2], [0, 2, 3], [0, 2, 4]],
        ..ProgressiveMesh::default()
    };
    let counted = |mode, packets| {
        let options = EncodeOptions { mode, packets: PacketSize::Fixed(packets), ..EncodeOptions::default() };
        let mut replay = Replay::from_file(&encode(&mesh, &options).unwrap(), &Limits::default()).unwrap();
        let mut found = Found::default();
        for level in 3..=5 {
            found.look(&mut replay, level).unwrap();
        }
        (found.faulty.get(COINCIDENT).cloned(), found.inside)
    };
    assert_eq!(counted(Mode::Raw, 5), (Some(vec![4]), 0));
    assert_eq!(counted(Mode::Coded, 5), (None, 1));
    assert_eq!(counted(Mode::Coded, 4), (Some(vec![4]), 0));
}
