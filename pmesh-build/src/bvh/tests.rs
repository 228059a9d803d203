use pmesh_format::IndexedMesh;
use quickcheck::quickcheck;

use super::*;

fn surface(points: &[[i8; 3]], corners: &[u8]) -> Surface {
    let positions: Vec<[f32; 3]> = points.iter().map(|p| p.map(|x| f32::from(x) / 16.0)).collect();
    let corner = |c: u8| u32::from(c) % index(points.len());
    let triangles = corners.chunks_exact(3).map(|c| [corner(c[0]), corner(c[1]), corner(c[2])]).collect();
    let exact = positions.iter().map(|p| DVec3::from(p.map(f64::from))).collect();
    Surface::new(&IndexedMesh::from_positions(positions, triangles), exact)
}

quickcheck! {
    /// Against all faces one by one, with faces that are edges, points, or there several times among them.
    fn the_nearest_face_is_found(points: Vec<(i8, i8, i8)>, corners: Vec<u8>, asked: Vec<(i8, i8, i8)>) -> bool {
        let points: Vec<[i8; 3]> = points.into_iter().map(|p| p.into()).collect();
        if points.is_empty() || corners.len() < 3 {
            return true;
        }
        let surface = surface(&points, &corners);
        let mut bvh = Bvh::new(&surface);
        asked.into_iter().all(|p| {
            let p = DVec3::from(<[i8; 3]>::from(p).map(f64::from)) / 16.0;
            let all = (0..index(surface.faces.len())).map(|f| squared_distance(p, surface.triangle(f)));
            let nearest = all.fold(f64::INFINITY, f64::min);
            let near_enough = bvh.squared_distance(&surface.positions, p, 2.0);
            bvh.squared_distance(&surface.positions, p, 0.0) == nearest
                && (near_enough == nearest || nearest <= near_enough && near_enough <= 2.0)
        })
    }
}

#[test]
fn bounds_enclose_what_they_round() {
    // Not f32 numbers: the middle of the box is not.
    let mut surface = surface(&[[0, 0, 0], [1, 0, 0], [0, 1, 0]], &[0, 1, 2]);
    for p in &mut surface.positions {
        *p += DVec3::splat(1.0 / 3.0);
    }
    let bvh = Bvh::new(&surface);
    assert!(surface.positions.iter().all(|&p| bvh.nodes[0].squared_distance(p) == 0.0));
}
