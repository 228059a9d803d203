//! What Hausdorff distances are for, from an input mesh to a level.

use std::collections::HashMap;

use glam::DVec3;
use pmesh_format::IndexedMesh;

use super::*;
use crate::distance::squared_distance;

/// Width of a tooth, and of the gap beside it.
const WIDTH: i32 = 4;

/// A wavy sheet of squares with sides of 1, 28 x 16 of them, that is 0.1 thick and closed all around. From the fifth row on
/// there are gaps: a comb of four teeth.
fn comb() -> IndexedMesh {
    let solid = |x: i32, y: i32| {
        (0..28).contains(&x) && (0..16).contains(&y) && (y < WIDTH || x % (2 * WIDTH) < WIDTH)
    };
    let (mut numbers, mut positions, mut triangles) = (HashMap::new(), Vec::new(), Vec::new());
    let mut quad = |corners: [[i32; 3]; 4]| {
        let [a, b, c, d] = corners.map(|key @ [x, y, side]| {
            *numbers.entry(key).or_insert_with(|| {
                let [x, y] = [x as f32, y as f32];
                positions.push([x, y, 0.4 * (0.9 * x).sin() * (0.8 * y).cos() + 0.1 * side as f32]);
                positions.len() as u32 - 1
            })
        });
        triangles.extend([[a, b, c], [a, c, d]]);
    };
    for (x, y) in (0..28).flat_map(|x| (0..16).map(move |y| (x, y))).filter(|&(x, y)| solid(x, y)) {
        let around = [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]];
        quad(around.map(|[x, y]| [x, y, 1]));
        let [a, b, c, d] = around.map(|[x, y]| [x, y, 0]);
        quad([a, d, c, b]);
        for (k, beside) in [(x, y - 1), (x + 1, y), (x, y + 1), (x - 1, y)].into_iter().enumerate() {
            if !solid(beside.0, beside.1) {
                let (from, to) = (around[k], around[(k + 1) % 4]);
                quad([[from[0], from[1], 0], [to[0], to[1], 0], [to[0], to[1], 1], [from[0], from[1], 1]]);
            }
        }
    }
    IndexedMesh::from_positions(positions, triangles)
}

/// The sides of the teeth have hardly any area, and what is beyond them lies near their planes: quadrics alone give up teeth
/// before the waves are flat.
#[test]
fn a_comb_keeps_its_teeth_longer_than_its_waves() {
    let mesh = comb();
    let (progressive, report) = built(&mesh, &BuildOptions::default());
    assert_eq!((report.vertices, report.boundary_edges, report.nonmanifold_edges), (770, 0, 0));
    let point = |p: [f32; 3]| DVec3::from(p.map(f64::from));
    for vertices in [48, 32] {
        let level = progressive.level(vertices);
        let triangles: Vec<[DVec3; 3]> = (0..level.triangles.len())
            .map(|i| level.triangle_vertices(i).map(|v| point(level.positions[v as usize])))
            .collect();
        let nearest = |p: [f32; 3]| {
            triangles.iter().map(|&t| squared_distance(point(p), t)).fold(f64::INFINITY, f64::min)
        };
        let farthest = mesh.positions.iter().map(|&p| nearest(p)).fold(0.0, f64::max).sqrt();
        // A tooth that is gone is half its width off, or more.
        assert!(farthest < f64::from(WIDTH) / 2.0, "{vertices} vertices: {farthest}");
        assert!(farthest > 0.4, "the waves are flat by now, so something else could have gone: {farthest}");
    }
}
