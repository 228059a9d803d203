use pmesh_format::IndexedMesh;

use super::*;

/// An L in a plane, and a triangle of the same area far off: 9 vertices. Moving the corner of the notch along the border
/// spans the notch; the middle of the new edge is half a unit off.
fn notch() -> Surface {
    let corners = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2], [9, 0], [12, 0], [9, 2]];
    let positions: Vec<[f32; 3]> = corners.iter().map(|&[x, y]| [x as f32, y as f32, 0.0]).collect();
    let triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5], [6, 7, 8]];
    let exact = positions.iter().map(|p| DVec3::from(p.map(f64::from))).collect();
    Surface::new(&IndexedMesh::from_positions(positions, triangles), exact)
}

#[test]
fn hausdorff_distances_count_from_an_eighth_of_the_vertices_on() {
    let surface = notch();
    let mut ring = Ring::new(9);
    let mut costs = Costs::new(Cost::Quadric, &surface, None, &mut ring);
    ring.collect(&surface, 3);
    let all = (0.0, f64::INFINITY);
    assert_eq!(costs.squared_distance(&surface, &ring, (3, 2), 2, all), 0.0);
    assert_eq!(costs.squared_distance(&surface, &ring, (3, 2), 1, all), 0.25);
    // Three times 6 square units, for each face counts at three vertices.
    assert_eq!([1, 2].map(|left| costs.average_area(left)), [18.0, 9.0]);
    let mut melax = Costs::new(Cost::Melax, &surface, None, &mut Ring::new(9));
    assert_eq!(melax.squared_distance(&surface, &ring, (3, 2), 1, all), 0.0);
}
