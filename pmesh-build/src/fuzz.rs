//! The body of the fuzz target `mesh_build`.

use pmesh_format::{IndexedMesh, Wedges, check_level};

use crate::{AttributeWeights, BuildOptions, Cost, build};

/// Builds a progressive mesh from arbitrary bytes and checks that the tables are valid and every level is a valid mesh.
///
/// Byte 0 chooses the options, byte 1 the number of vertices; positions are taken from small grids, so that coincident
/// points and flat regions are common; the rest of the bytes are corners.
///
/// # Panics
/// If the builder breaks one of its promises; that is the finding.
pub fn fuzz_mesh_build(data: &[u8]) {
    let [choices, vertices, rest @ ..] = data else { return };
    let vertices = usize::from(*vertices);
    let (coordinates, corners) = rest.split_at(rest.len().min(vertices));
    let positions: Vec<[f32; 3]> = coordinates
        .iter()
        .map(|&b| if b == 255 { [f32::NAN; 3] } else { [b & 7, b >> 3 & 7, b >> 6].map(f32::from) })
        .collect();
    let triangles: Vec<[u32; 3]> =
        corners.chunks_exact(3).map(|c| [u32::from(c[0]), u32::from(c[1]), u32::from(c[2])]).collect();
    let mut mesh = IndexedMesh::from_positions(positions, triangles);
    if choices & 1 != 0 {
        // Two wedges a vertex: seams.
        let vertices = std::mem::take(&mut mesh.wedges.vertices);
        mesh.wedges = Wedges {
            uvs: vertices.iter().flat_map(|_| [[0.0, 0.0], [1.0, 0.5]]).collect(),
            vertices: vertices.iter().flat_map(|&v| [v, v]).collect(),
            ..Wedges::default()
        };
    }
    if choices & 2 != 0 {
        mesh.materials = (0..mesh.triangles.len()).map(|i| (i % 3) as u16).collect();
    }
    let options = BuildOptions {
        weld: choices & 4 != 0,
        cost: if choices & 8 != 0 { Cost::Melax } else { Cost::Quadric },
        attributes: AttributeWeights {
            uv: if choices & 16 != 0 { 1.0 } else { 0.0 },
            ..AttributeWeights::default()
        },
    };
    let Ok((progressive, report)) = build(&mesh, &options, &mut |_| {}) else { return };
    assert_eq!(report.base_vertices, if report.faces == 0 { 0 } else { 3 });
    let base_wedges = progressive.base_wedges();
    for (v, &parent) in (progressive.base_vertices..).zip(&progressive.collapse) {
        assert!(parent < v, "vertex {v} collapses onto {parent}");
    }
    for (w, &target) in (base_wedges..).zip(&progressive.wedge_collapse) {
        let vertex = progressive.wedges.vertices[w];
        let parent = progressive.collapse[(vertex - progressive.base_vertices) as usize];
        assert_eq!(
            progressive.wedges.vertices[target as usize], parent,
            "wedge {w} leaves its vertex's parent"
        );
    }
    assert!(progressive.errors.is_sorted_by(|a, b| a >= b), "errors rise");
    for level in progressive.base_vertices..=crate::input::index(progressive.positions.len()) {
        let mesh = progressive.level(level);
        check_level(&mesh).unwrap_or_else(|fault| panic!("level {level}: {fault}"));
        assert!(level == 0 || !mesh.triangles.is_empty(), "level {level} has no face");
    }
}
