use glam::DVec3;
use pmesh_format::IndexedMesh;

use super::*;

/// Three by three vertices, numbered row by row; diagonals run from the lower right to the upper left of each square.
fn grid() -> IndexedMesh {
    let positions = (0..9u8).map(|v| [f32::from(v % 3), f32::from(v / 3), 0.0]).collect();
    let triangles = [0, 1, 3, 4].iter().flat_map(|&v| [[v, v + 1, v + 3], [v + 1, v + 4, v + 3]]).collect();
    IndexedMesh::from_positions(positions, triangles)
}

fn check(mesh: &IndexedMesh, u: u32, v: u32, rules: Rules) -> bool {
    let positions = mesh.positions.iter().map(|&p| DVec3::from(p.map(f64::from))).collect();
    let surface = Surface::new(mesh, positions);
    let mut ring = Ring::new(mesh.positions.len());
    ring.collect(&surface, u);
    allowed(&surface, u, v, rules, false, &ring)
}

/// The strictest rules under which `u` may move onto `v`.
fn strictest(mesh: &IndexedMesh, u: u32, v: u32) -> Option<Rules> {
    let all = [Rules::Strict, Rules::Topology, Rules::Any];
    let first = all.into_iter().find(|&rules| check(mesh, u, v, rules));
    let from_first_on = all.into_iter().skip_while(|rules| Some(*rules) != first);
    assert!(from_first_on.into_iter().all(|rules| check(mesh, u, v, rules)), "looser rules allow less");
    first
}

#[test]
fn borders_stay_lines() {
    let grid = grid();
    assert_eq!(strictest(&grid, 4, 1), Some(Rules::Strict), "from the inside onto the border");
    assert_eq!(strictest(&grid, 1, 0), Some(Rules::Strict), "along the border");
    assert_eq!(strictest(&grid, 1, 4), Some(Rules::Topology), "off the border");
    assert_eq!(strictest(&grid, 1, 3), Some(Rules::Topology), "from one border across to another");
    assert_eq!(strictest(&grid, 0, 8), None, "there is no edge");
}

#[test]
fn seams_stay_lines() {
    // Materials meet along the middle row.
    let mut grid = grid();
    grid.materials = vec![0, 0, 0, 0, 1, 1, 1, 1];
    assert_eq!(strictest(&grid, 4, 5), Some(Rules::Strict), "along the seam");
    assert_eq!(strictest(&grid, 4, 1), Some(Rules::Topology), "off the seam");
    // Three seams meet in the middle: it is a corner and stays.
    grid.materials = vec![0, 0, 0, 2, 1, 1, 1, 2];
    assert!((0..9).filter(|&v| v != 4).all(|v| strictest(&grid, 4, v) != Some(Rules::Strict)));
}

#[test]
fn faces_keep_their_side_and_are_no_slivers() {
    // The middle is drawn to the lower left, and corner 8 to between the middle and the upper left: moving the middle to
    // vertex 5 turns a face over.
    let mut grid = grid();
    grid.positions[7] = [1.9, 0.9, 0.0];
    assert_eq!(strictest(&grid, 4, 5), Some(Rules::Any));
    grid.positions[7] = [1.0, 2.0, 0.0];
    assert_eq!(strictest(&grid, 4, 5), Some(Rules::Strict));
    // A face that becomes a thousand times longer than wide.
    grid.positions[1] = [1.0, 0.998, 0.0];
    grid.positions[4] = [1.0, 1.2, 0.0];
    assert_eq!(strictest(&grid, 4, 5), Some(Rules::Topology));
}

#[test]
fn topology_stays() {
    // A tube of three sides and three rings. Its sides are no faces: an edge around it closes the tube.
    let mut mesh = IndexedMesh::from_positions(
        (0..9u8)
            .map(|v| {
                let (sin, cos) = (f32::from(v % 3) * std::f32::consts::TAU / 3.0).sin_cos();
                [cos, sin, f32::from(v / 3)]
            })
            .collect(),
        (0..6u32)
            .flat_map(|q| {
                let (i, next) = (q, q / 3 * 3 + (q + 1) % 3);
                [[i, next, i + 3], [next, next + 3, i + 3]]
            })
            .collect(),
    );
    let surface_at = |mesh: &IndexedMesh| {
        let positions = mesh.positions.iter().map(|&p| DVec3::from(p.map(f64::from))).collect();
        let surface = Surface::new(mesh, positions);
        let mut ring = Ring::new(9);
        ring.collect(&surface, 3);
        topology_allowed(&surface, 3, 4, Rules::Strict, true, &ring)
    };
    assert!(!surface_at(&mesh), "the middle ring would become an edge with four faces");
    // With a wall in the middle the third edge belongs to a face, and the ring may close.
    mesh.triangles.push([3, 4, 5]);
    assert!(!surface_at(&mesh), "the wall's edges have three faces, and would have four");
}

#[test]
fn the_last_faces_stay() {
    let triangle =
        IndexedMesh::from_positions(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
    assert_eq!(strictest(&triangle, 0, 1), None);
}
