//! Meshes to order.

use pmesh_format::IndexedMesh;

/// A height field over a grid of `side` × `side` vertices in the unit square.
pub(super) fn grid(side: u32, height: impl Fn(f32, f32) -> f32) -> IndexedMesh {
    let at = |i: u32| i as f32 / (side - 1) as f32;
    let positions = (0..side * side)
        .map(|v| {
            let (x, y) = (at(v % side), at(v / side));
            [x, y, height(x, y)]
        })
        .collect();
    let quads = (0..(side - 1) * (side - 1)).map(|q| q % (side - 1) + side * (q / (side - 1)));
    let triangles = quads.flat_map(|v| [[v, v + 1, v + side], [v + 1, v + side + 1, v + side]]).collect();
    IndexedMesh::from_positions(positions, triangles)
}

/// A closed torus: no border, genus 1.
pub(super) fn torus(around: u32, across: u32) -> IndexedMesh {
    let turn = |k: u32, n: u32| std::f32::consts::TAU * (k % n) as f32 / n as f32;
    let vertex = |i: u32, j: u32| (i % around) * across + j % across;
    let positions = (0..around * across)
        .map(|v| {
            let (a, b) = (turn(v / across, around), turn(v % across, across));
            let radius = 1.0 + 0.35 * b.cos() + 0.05 * (5.0 * a).sin();
            [radius * a.cos(), radius * a.sin(), 0.35 * b.sin()]
        })
        .collect();
    let triangles = (0..around * across)
        .flat_map(|q| {
            let (i, j) = (q / across, q % across);
            let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    IndexedMesh::from_positions(positions, triangles)
}

/// The cube from −1 to 1: 8 vertices, 12 triangles.
pub(super) fn cube() -> IndexedMesh {
    let positions = (0..8u8).map(|v| [v & 1, v >> 1 & 1, v >> 2].map(|b| f32::from(b) * 2.0 - 1.0)).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    IndexedMesh::from_positions(positions, triangles)
}

/// Both meshes in one, without shared vertices.
pub(super) fn beside(a: &IndexedMesh, b: &IndexedMesh) -> IndexedMesh {
    let first = a.positions.len() as u32;
    let positions = [&a.positions[..], &b.positions].concat();
    let mut triangles = a.triangles.clone();
    triangles.extend(b.triangles.iter().map(|t| t.map(|v| v + first)));
    IndexedMesh::from_positions(positions, triangles)
}

/// Every triangle with vertices of its own.
pub(super) fn soup(mesh: &IndexedMesh) -> IndexedMesh {
    let positions = mesh.triangles.iter().flatten().map(|&v| mesh.positions[v as usize]).collect();
    let triangles = (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    IndexedMesh::from_positions(positions, triangles)
}

/// The mesh with every position mapped.
pub(super) fn mapped(mesh: &IndexedMesh, map: impl Fn([f32; 3]) -> [f32; 3]) -> IndexedMesh {
    IndexedMesh { positions: mesh.positions.iter().map(|&p| map(p)).collect(), ..mesh.clone() }
}
