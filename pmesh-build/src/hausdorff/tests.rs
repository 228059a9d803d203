use pmesh_format::IndexedMesh;

use super::*;

/// A strip of `columns` quads along x with the given heights, two rows of vertices: vertex 2 i at y = 0, 2 i + 1 at y = 1.
fn strip(heights: &[f64]) -> Surface {
    let positions: Vec<DVec3> = (0u8..)
        .zip(heights)
        .flat_map(|(x, &z)| [DVec3::new(f64::from(x), 0.0, z), DVec3::new(f64::from(x), 1.0, z)])
        .collect();
    let quads = (0..index(heights.len()) - 1).map(|i| 2 * i);
    let triangles = quads.flat_map(|v| [[v, v + 2, v + 1], [v + 1, v + 2, v + 3]]).collect();
    let mesh = IndexedMesh::from_positions(positions.iter().map(|p| p.as_vec3().into()).collect(), triangles);
    Surface::new(&mesh, positions)
}

fn moving(hausdorff: &mut Hausdorff, surface: &Surface, u: u32, v: u32, range: (f64, f64)) -> f64 {
    let mut ring = Ring::new(surface.positions.len());
    ring.collect(surface, u);
    hausdorff.squared_distance(surface, &ring, (u, v), range)
}

const ALL: (f64, f64) = (0.0, f64::INFINITY);

/// 64 bits of rounding over a few operations on numbers below 10.
fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-13
}

#[test]
fn what_is_flat_moves_nowhere() {
    let surface = strip(&[0.0; 5]);
    let mut hausdorff = Hausdorff::new(&surface);
    assert_eq!(moving(&mut hausdorff, &surface, 4, 6, ALL), 0.0);
}

#[test]
fn vertices_that_came_before_count() {
    // Moving vertex 4, then 6, on to 8 takes away their edge of the ridge, which was at z = 1.
    let mut surface = strip(&[0.0, 0.0, 1.0, 0.0, 0.0]);
    let mut hausdorff = Hausdorff::new(&surface);
    let first = moving(&mut hausdorff, &surface, 4, 6, ALL);
    assert!(first > 0.1, "{first}");
    surface.collapse(4, 6, |w| w);
    hausdorff.collapsed(4, 6);
    let with_it = moving(&mut hausdorff, &surface, 6, 8, ALL);
    let mut forgetful = Hausdorff::new(&surface);
    let without = moving(&mut forgetful, &surface, 6, 8, ALL);
    assert!(with_it > 2.0 * without, "{with_it} {without}");
    // One after the other: the vertices that came to 8 are 4, 6 and itself.
    surface.collapse(6, 8, |w| w);
    hausdorff.collapsed(6, 8);
    let mut there = vec![8];
    while hausdorff.next[*there.last().unwrap() as usize] != 8 {
        there.push(hausdorff.next[*there.last().unwrap() as usize]);
    }
    there.sort_unstable();
    assert_eq!(there, [4, 6, 8]);
}

fn surface(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Surface {
    let exact = positions.iter().map(|p| DVec3::from(p.map(f64::from))).collect();
    Surface::new(&IndexedMesh::from_positions(positions.to_vec(), triangles.to_vec()), exact)
}

/// An L in a plane. Moving the corner of its notch along the border spans the notch: the middle of the new edge is half a
/// unit off either side.
#[test]
fn new_edges_off_the_surface_count() {
    let corners = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]
        .map(|[x, y]| [f32::from(x as u8), f32::from(y as u8), 0.0]);
    let surface = surface(&corners, &[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]);
    let mut hausdorff = Hausdorff::new(&surface);
    assert_eq!(moving(&mut hausdorff, &surface, 3, 2, ALL), 0.25);
}

/// A tent over three corners, whose tip touches another face at vertex 2. Moving the tip there leaves its floor: no new edge,
/// and the tip lies on the other face, but the middle of the floor is off the sides of the tent. The nearest one lies in
/// the plane 2 x + y + z = 8 (mirrored, -2 x + y + z = 0), to which (2, 4/3, 0) has the distance 8/3 / √6.
#[test]
fn new_faces_off_the_surface_count() {
    let corners = [
        [0.0, 0.0, 0.0],
        [4.0, 0.0, 0.0],
        [2.0, 4.0, 0.0],
        [2.0, 1.0, 3.0],
        [1.0, 1.0, 3.0],
        [3.0, 1.0, 3.0],
    ];
    let surface = surface(&corners, &[[3, 0, 1], [3, 1, 2], [3, 2, 0], [2, 4, 5]]);
    let mut hausdorff = Hausdorff::new(&surface);
    let found = moving(&mut hausdorff, &surface, 3, 2, ALL);
    assert!(close(found, 64.0 / 54.0), "{found}");
}

#[test]
fn only_the_range_asked_for_is_exact() {
    let surface = strip(&[0.0, 0.0, 1.0, 0.0, 0.0]);
    let mut hausdorff = Hausdorff::new(&surface);
    let exact = moving(&mut hausdorff, &surface, 4, 6, ALL);
    assert_eq!(moving(&mut hausdorff, &surface, 4, 6, (2.0 * exact, 2.0 * exact)), 2.0 * exact);
    let some = moving(&mut hausdorff, &surface, 4, 6, (0.0, 0.5 * exact));
    assert!(some > 0.5 * exact && some <= exact);
}
