//! Attributes: wedges stay on their side of a seam, and materials on their faces.

use super::shapes::grid;
use super::*;

/// A grid whose left and right half have texture coordinates of their own (u < 1 and u > 2), and, if asked, materials.
pub(super) fn two_charts(side: u32, with_materials: bool) -> IndexedMesh {
    let mut mesh = grid(side, |x, y| 0.05 * (6.0 * x).sin() * (5.0 * y).cos());
    let middle = (side - 1) / 2;
    let (mut vertices, mut uvs) = (Vec::new(), Vec::new());
    for (v, p) in (0..).zip(&mesh.positions) {
        vertices.extend([v, v]);
        uvs.extend([[p[0] * 0.9, p[1]], [p[0] * 0.9 + 2.0, p[1]]]);
    }
    let is_right = |triangle: usize| (triangle as u32 / 2) % (side - 1) >= middle;
    for (i, triangle) in mesh.triangles.iter_mut().enumerate() {
        *triangle = triangle.map(|v| 2 * v + u32::from(is_right(i)));
    }
    if with_materials {
        mesh.materials = (0..mesh.triangles.len()).map(|i| u16::from(is_right(i))).collect();
        mesh.material_names = vec!["left".into(), "right".into()];
    }
    mesh.wedges.vertices = vertices;
    mesh.wedges.uvs = uvs;
    mesh
}

#[test]
fn wedges_stay_on_their_side_of_a_seam() {
    for with_materials in [false, true] {
        let side = 21;
        let (progressive, report) = built(&two_charts(side, with_materials), &BuildOptions::default());
        assert_eq!(report.seam_edges, side as usize - 1);
        // Only the vertices on the seam have two wedges.
        assert_eq!((report.vertices, report.wedges), (441, 441 + 21));
        check_levels(&progressive, 50);
        for level in [400, 200, 100, 50, 20, 10] {
            let mesh = progressive.level(level);
            for (i, corners) in mesh.triangles.iter().enumerate() {
                let u = corners.map(|w| mesh.wedges.uvs[w as usize][0]);
                let is_left = u.iter().all(|&u| u < 1.0);
                assert!(
                    is_left || u.iter().all(|&u| u > 1.5),
                    "level {level}: a face across the seam: {u:?}"
                );
                if with_materials {
                    assert_eq!(mesh.material(i), u16::from(!is_left), "level {level}");
                }
                // Texture coordinates are a function of the place here, so they still have to fit.
                for (&w, u) in corners.iter().zip(u) {
                    let x = mesh.positions[mesh.wedges.vertices[w as usize] as usize][0];
                    assert!((u - x * 0.9 - if is_left { 0.0 } else { 2.0 }).abs() < 1e-6);
                }
            }
        }
    }
}

/// The seam is a straight line of x = 1/2: as long as it is there it stays one.
#[test]
fn a_border_between_materials_stays_where_it_is() {
    let mut mesh = grid(21, |_, _| 0.0);
    mesh.materials = (0..mesh.triangles.len()).map(|i| u16::from((i / 2) % 20 >= 10)).collect();
    let (progressive, report) = built(&mesh, &BuildOptions::default());
    assert_eq!((report.seam_edges, report.vertices, report.wedges), (20, 441, 441));
    check_levels(&progressive, 20);
    for level in [300, 100, 30, 6] {
        let mesh = progressive.level(level);
        for i in 0..mesh.triangles.len() {
            let x = mesh.triangle_vertices(i).map(|v| mesh.positions[v as usize][0]);
            let fits =
                if mesh.material(i) == 0 { x.iter().all(|&x| x <= 0.5) } else { x.iter().all(|&x| x >= 0.5) };
            assert!(fits, "level {level}: a face of material {} at {x:?}", mesh.material(i));
        }
    }
}

/// A disc of another material in a plane, where nothing but its border has a shape.
#[test]
fn a_curved_border_between_materials_keeps_its_shape() {
    let mut mesh = grid(41, |_, _| 0.0);
    let distance = |p: [f32; 3]| (p[0] - 0.5).hypot(p[1] - 0.5);
    let inside = |mesh: &IndexedMesh, i: usize| {
        let corners = mesh.triangle_vertices(i).map(|v| mesh.positions[v as usize]);
        distance([0, 1, 2].map(|k| corners.iter().map(|p| p[k]).sum::<f32>() / 3.0)) < 0.3
    };
    mesh.materials = (0..mesh.triangles.len()).map(|i| u16::from(inside(&mesh, i))).collect();
    let area = |mesh: &IndexedMesh| -> f32 {
        let faces = (0..mesh.triangles.len()).filter(|&i| mesh.material(i) == 1);
        faces
            .map(|i| {
                let [a, b, c] = mesh.triangle_vertices(i).map(|v| mesh.positions[v as usize]);
                ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0
            })
            .sum()
    };
    let (progressive, _) = built(&mesh, &BuildOptions::default());
    let full = area(&progressive.full());
    // Four vertices are those of the square, twelve stand on the border, two of them beside another one: nothing but their
    // own edges tells them apart. A polygon of 10 corners in a circle lacks 6.5 % of its area; corners within half the
    // diagonal of a cell of 1/40 off the circle of 0.3, on average half of that, make up to 6 % more.
    let coarse = area(&progressive.level(16));
    assert!((coarse - full).abs() < 0.125 * full, "{coarse} of {full}");
}

#[test]
fn equal_wedges_are_merged_and_different_ones_kept() {
    // A cube as exporters write it: 24 vertices, one normal for each side.
    let cube = shapes::cube();
    let mut mesh = shapes::soup(&cube);
    mesh.wedges.normals = (0..36)
        .map(|corner| {
            let side = corner / 6;
            let mut normal = [0.0; 3];
            normal[[2, 1, 0][side / 2]] = if side % 2 == 0 { -1.0 } else { 1.0 };
            normal
        })
        .collect();
    let (progressive, report) = built(&mesh, &BuildOptions::default());
    assert_eq!((report.vertices, report.wedges, report.faces), (8, 24, 12));
    assert_eq!((report.merged_wedges, report.seam_edges), (12, 12));
    check_levels(&progressive, 6);
    // The full level is the input: each corner has its position and its normal.
    let full = progressive.full();
    for (face, corners) in full.triangles.iter().enumerate() {
        for (k, &w) in corners.iter().enumerate() {
            let corner = 3 * face + k;
            assert_eq!(full.wedges.normals[w as usize], mesh.wedges.normals[corner]);
            let vertex = full.wedges.vertices[w as usize] as usize;
            assert_eq!(full.positions[vertex], mesh.positions[corner]);
        }
    }
}

#[test]
fn colours_and_normals_come_through() {
    let mut mesh = grid(9, |x, y| x * y);
    mesh.wedges.normals = vec![[0.0, 0.0, 1.0]; 81];
    mesh.wedges.colours = (0..81u8).map(|v| [v, 255 - v, 7, 255]).collect();
    let (progressive, report) = built(&mesh, &BuildOptions::default());
    assert_eq!(report.wedges, 81);
    for (p, colour) in progressive.positions.iter().zip(&progressive.wedges.colours) {
        let v = (p[0] * 8.0).round() as u8 + 9 * (p[1] * 8.0).round() as u8;
        assert_eq!(*colour, [v, 255 - v, 7, 255]);
    }
    check_levels(&progressive, 79);
}
