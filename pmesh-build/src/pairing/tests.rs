use glam::DVec3;
use pmesh_format::IndexedMesh;

use super::*;

/// Two faces on an edge that is a seam, with texture coordinates that are alike across it: wedges stay on their side all
/// the same. Only a wedge that no face on the edge has goes by likeness.
#[test]
fn the_side_of_the_seam_decides_before_likeness() {
    // Vertex 0: wedges 0, 1, 2; vertex 1: wedges 3, 4; vertices 2, 3: wedges 5, 6.
    let mesh = IndexedMesh {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]],
        wedges: Wedges {
            vertices: vec![0, 0, 0, 1, 1, 2, 3],
            uvs: [0.9, 0.1, 0.2, 0.1, 0.9, 0.0, 0.0].map(|u| [u, 0.0]).to_vec(),
            ..Wedges::default()
        },
        triangles: vec![[0, 3, 5], [1, 6, 4]],
        ..IndexedMesh::default()
    };
    let positions = mesh.positions.iter().map(|&p| DVec3::from(p.map(f64::from))).collect();
    let surface = Surface::new(&mesh, positions);
    let mut targets = Vec::new();
    pair(&surface, &mesh.wedges, (0, 0..3), (1, 3..5), &mut targets);
    assert_eq!(targets, [3, 4, 3]);
}
