//! The hard cases, by name.

use quickcheck::quickcheck;

use super::shapes::{beside, cube, grid, mapped, soup, torus};
use super::*;

fn default() -> BuildOptions {
    BuildOptions::default()
}

fn bumps(x: f32, y: f32) -> f32 {
    0.1 * (9.0 * x).sin() * (7.0 * y).cos()
}

#[test]
fn empty_mesh() {
    let (progressive, report) = built(&IndexedMesh::default(), &default());
    assert_eq!((report.vertices, report.levels()), (0, 1));
    check_levels(&progressive, 1);
    // Vertices without a face are no mesh either.
    let lonely = IndexedMesh::from_positions(vec![[1.0; 3]; 4], vec![]);
    let (progressive, report) = built(&lonely, &default());
    assert_eq!((report.welded_vertices, report.dropped_unreferenced), (3, 1));
    check_levels(&progressive, 1);
}

#[test]
fn one_and_two_triangles() {
    let mut mesh = grid(2, |_, _| 0.0);
    let (progressive, report) = built(&mesh, &default());
    assert_eq!((report.vertices, report.faces, report.levels()), (4, 2, 2));
    check_levels(&progressive, 2);
    mesh.triangles.pop();
    let (progressive, report) = built(&mesh, &default());
    assert_eq!((report.vertices, report.faces, report.dropped_unreferenced), (3, 1, 1));
    check_levels(&progressive, 1);
}

#[test]
fn cube_of_eight_vertices() {
    let (progressive, report) = built(&cube(), &default());
    assert_eq!((report.vertices, report.faces, report.base_faces, report.levels()), (8, 12, 2, 6));
    assert_eq!((report.boundary_edges, report.nonmanifold_edges), (0, 0));
    check_levels(&progressive, 6);
}

#[test]
fn all_vertices_coplanar() {
    // Inner vertices are moved about in the plane: with a regular grid no collapse would turn a triangle over anyway.
    let jitter = |a: f32, b: f32| 0.15 / 39.0 * (7919.0 * a + 104_729.0 * b).sin();
    let inner = |x: f32| x > 0.0 && x < 1.0;
    let mesh = mapped(&grid(40, |_, _| 0.25), |[x, y, z]| {
        if inner(x) && inner(y) { [x + jitter(x, y), y + jitter(y, x), z] } else { [x, y, z] }
    });
    let (progressive, report) = built(&mesh, &default());
    assert_eq!(report.vertices, 1600);
    check_levels(&progressive, 50);
    // A plane needs no more than its four corners: taking away the rest costs nothing but rounding.
    let base = progressive.base_vertices as usize;
    let corners: Vec<_> = progressive.level(4).positions;
    assert!(corners.iter().all(|p| p[..2].iter().all(|&x| x == 0.0 || x == 1.0)), "{corners:?}");
    // Squared distances of about 1 unit cancel: what is left is some 2⁻⁵² of them, its root 2⁻²⁶.
    assert!(progressive.errors[4 - base] < 1e-6, "{}", progressive.errors[4 - base]);
    // And no triangle turns over on the way there.
    for level in [1600, 1500, 800, 200, 50, 10, 5, 4] {
        let mesh = progressive.level(level);
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
            let turn = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            assert!(turn > 0.0, "level {level}: a triangle has turned over");
        }
    }
}

#[test]
fn all_points_equal() {
    let mesh = mapped(&cube(), |_| [1.0, 2.0, 3.0]);
    let (_, report) = built(&mesh, &default());
    assert_eq!((report.welded_vertices, report.dropped_degenerate, report.vertices), (7, 12, 0));
    // Not welded, it is a mesh without area that collapses all the same.
    let (progressive, report) = built(&mesh, &BuildOptions { weld: false, ..default() });
    assert_eq!((report.vertices, report.zero_area), (8, 12));
    check_levels(&progressive, 6);
}

#[test]
fn zero_area_and_duplicate_faces() {
    let mut mesh = grid(4, |_, _| 0.0);
    // Three vertices in a row, twice the same face turned, once turned over, one vertex twice.
    mesh.triangles.push([0, 1, 2]);
    let face = mesh.triangles[4];
    mesh.triangles.push([face[1], face[2], face[0]]);
    mesh.triangles.push([face[0], face[2], face[1]]);
    mesh.triangles.push([5, 5, 6]);
    let (progressive, report) = built(&mesh, &default());
    assert_eq!((report.zero_area, report.dropped_duplicate, report.dropped_degenerate), (1, 1, 1));
    assert_eq!(report.faces, 18 + 2);
    check_levels(&progressive, 14);
}

#[test]
fn duplicates_of_another_material_are_kept() {
    let mut mesh = grid(2, |_, _| 0.0);
    mesh.triangles.push(mesh.triangles[0]);
    mesh.triangles.push(mesh.triangles[0]);
    mesh.materials = vec![0, 0, 1, 1];
    let (progressive, report) = built(&mesh, &default());
    assert_eq!((report.faces, report.dropped_duplicate), (3, 1));
    assert_eq!(progressive.materials, [0, 0, 1]);
    check_levels(&progressive, 2);
}

#[test]
fn three_sheets_on_one_edge() {
    let sheet = |turn: f32| {
        mapped(&grid(12, bumps), |[x, y, z]| {
            let (sin, cos) = turn.sin_cos();
            // x = 0 is the common edge; the bumps end there.
            [x * cos - z * x * sin, y, x * sin + z * x * cos]
        })
    };
    let mesh = beside(&beside(&sheet(0.0), &sheet(2.0)), &sheet(4.0));
    let (progressive, report) = built(&mesh, &default());
    assert_eq!((report.nonmanifold_edges, report.welded_vertices), (11, 24));
    check_levels(&progressive, 50);
    // The sheets stay joined along the edge and the edge stays where it is.
    let coarse = progressive.level(12);
    let on_edge = coarse.positions.iter().filter(|p| p[0] == 0.0 && p[2] == 0.0).count();
    assert!(on_edge >= 2, "{:?}", coarse.positions);
    assert_eq!(report.forced_collapses, 0, "{report:?}");
}

#[test]
fn two_components_touching_in_a_vertex() {
    let mesh = beside(&cube(), &mapped(&cube(), |p| p.map(|x| x + 2.0)));
    let (progressive, report) = built(&mesh, &default());
    assert_eq!((report.vertices, report.welded_vertices), (15, 1));
    check_levels(&progressive, 13);
}

/// A small pyramid stands on some faces without replacing them. Taking its top away would leave two faces on the same
/// vertices, so it has to wait.
#[test]
fn no_face_falls_onto_another() {
    let (progressive, report) = built(&with_pyramids(20), &default());
    assert_eq!((report.vertices, report.nonmanifold_edges), (413, 37));
    check_levels(&progressive, 100);
    // Further down nothing else is left to take away.
    for level in (60..=413).rev() {
        assert_eq!(coincident_faces(&progressive.level(level)), 0, "level {level}");
    }
}

/// A height field with a small pyramid on every 60th face.
fn with_pyramids(side: u32) -> IndexedMesh {
    let mut mesh = grid(side, bumps);
    for face in (0..mesh.triangles.len()).step_by(60) {
        let [a, b, c] = mesh.triangles[face];
        let [p, q, r] = mesh.triangles[face].map(|v| mesh.positions[v as usize]);
        let top = mesh.positions.len() as u32;
        let centre = [0, 1, 2].map(|k| (p[k] + q[k] + r[k]) / 3.0);
        mesh.positions.push([centre[0], centre[1], centre[2] + 0.0005]);
        mesh.wedges.vertices.push(top);
        mesh.triangles.extend([[a, b, top], [b, c, top], [c, a, top]]);
    }
    mesh
}

/// The ends of coded packets are levels of the order; those inside a packet are sorted by parent, and there faces fall onto
/// others (PMESH-LVL-06).
#[test]
fn whole_levels_of_coded_files_have_no_coincident_faces() {
    let noise = grid(60, |x, y| 0.05 * (7919.0 * x + 104_729.0 * y).sin());
    let (progressive, _) = built(&noise, &default());
    let mut replay = replayed(&progressive, &coded(Positions::Quantised(14)));
    let (mut whole, mut inside) = (0, 0);
    for level in 36..=replay.max_level() {
        replay.set_level(level).unwrap();
        let mesh = replay.mesh();
        check_level(&mesh).unwrap();
        let coincident = coincident_faces(&mesh) > 0;
        if replay.header().is_whole_level(level) {
            assert!(!coincident, "level {level}");
            whole += 1;
        }
        inside += usize::from(coincident);
    }
    assert!(whole >= 16 && inside > 0, "{whole} whole levels; {inside} inside packets with coincident faces");
}

#[test]
fn islands_vanish() {
    let mut mesh = torus(24, 12);
    for k in 0..40u8 {
        let island = mapped(&cube(), |p| p.map(|x| x * 0.002 + f32::from(k) * 0.05));
        mesh = beside(&mesh, &island);
    }
    let (progressive, report) = built(&mesh, &default());
    assert_eq!(report.vertices, 288 + 320);
    check_levels(&progressive, 100);
    // Two vertices of an island lose their faces with the last collapse.
    assert!(report.isolated_vertices >= 80, "{report:?}");
    // The torus outlives its crumbs: they are 1/500 of its size.
    let coarse = progressive.level(100);
    let crumbs = coarse.positions.iter().filter(|p| p[2].abs() > 0.4 || p[0].hypot(p[1]) < 0.5).count();
    assert_eq!(crumbs, 0, "{:?}", coarse.positions);
    assert!(coarse.positions.iter().any(|p| p[0] < -1.3));
    // Two faces on the same vertices appear for one level each, while a crumb vanishes.
    let coincident = (100..=608).filter(|&level| coincident_faces(&progressive.level(level)) > 0).count();
    assert!(coincident <= 40, "{coincident} levels");
}

#[test]
fn pinholes_are_closed() {
    let mut mesh = grid(30, bumps);
    let holes = 20;
    let mut next = 0;
    mesh.triangles.retain(|_| {
        next += 1;
        next % (1682 / holes) != 40
    });
    let (progressive, report) = built(&mesh, &default());
    assert!(report.boundary_edges > 4 * 29 + 50, "{report:?}");
    check_levels(&progressive, 50);
    assert_eq!(report.forced_collapses, 0);
}

#[test]
fn unwelded_soup_is_welded() {
    let whole = torus(20, 10);
    let (_, report) = built(&soup(&whole), &default());
    assert_eq!((report.vertices, report.faces, report.boundary_edges), (200, 400, 0));
    assert_eq!(report.welded_vertices, 1000);
    assert_eq!(report.merged_wedges, 1000);
    // Left as it is, it is 400 islands; they vanish one by one.
    let (progressive, report) = built(&soup(&whole), &BuildOptions { weld: false, ..default() });
    assert_eq!((report.vertices, report.boundary_edges), (1200, 1200));
    check_levels(&progressive, 100);
}

#[test]
fn surface_of_genus_two() {
    // Two tori, a face of each removed and the rims joined by a band.
    let other = mapped(&torus(16, 9), |[x, y, z]| [x + 4.0, y, z]);
    let mut mesh = beside(&torus(16, 9), &other);
    let rim = |mesh: &mut IndexedMesh, at: usize| mesh.triangles.remove(at);
    let (a, b) = (rim(&mut mesh, 0), rim(&mut mesh, 287 + 150));
    for k in 0..3 {
        let (a0, a1) = (a[k], a[(k + 1) % 3]);
        let (b0, b1) = (b[(3 - k) % 3], b[2 - k]);
        mesh.triangles.extend([[a0, a1, b1], [a0, b1, b0]]);
    }
    let (progressive, report) = built(&mesh, &default());
    assert_eq!((report.boundary_edges, report.nonmanifold_edges), (0, 0));
    // Euler: V − E + F = 2 − 2 g.
    assert_eq!(report.vertices as i64 - report.faces as i64 * 3 / 2 + report.faces as i64, -2);
    check_levels(&progressive, 60);
}

#[test]
fn far_from_the_origin() {
    let near = grid(20, bumps);
    // Coordinates of 1/64 steps are exact in both places, so the order is the same, bit for bit.
    let exact = mapped(&near, |p| p.map(|x| (x * 64.0).round() / 64.0));
    let far = mapped(&exact, |[x, y, z]| [x + 64.0, y - 64.0, z + 64.0]);
    let (here, _) = built(&exact, &default());
    let (there, report) = built(&far, &default());
    assert_eq!((&here.collapse, &here.errors), (&there.collapse, &there.errors));
    assert!(!report.precision_lost());
    // At 10⁶, f32 has steps of 1/16: that is no shape any more, and the report says so.
    let lost = mapped(&near, |p| p.map(|x| x + 1e6));
    let (progressive, report) = built(&lost, &default());
    assert!(report.precision_lost());
    assert_eq!(report.coordinate_spacing, 0.0625);
    check_levels(&progressive, 20);
}

#[test]
fn scales_of_a_power_of_two_change_nothing() {
    let mesh = torus(24, 12);
    let (here, _) = built(&mesh, &default());
    for exponent in [-60, -20, 20, 60] {
        let scale = 2.0f32.powi(exponent);
        let (there, _) = built(&mapped(&mesh, |p| p.map(|x| x * scale)), &default());
        assert_eq!(here.collapse, there.collapse, "2^{exponent}");
        assert!(here.errors.iter().zip(&there.errors).all(|(a, b)| a * scale == *b));
    }
    // The largest and the smallest coordinates that there are.
    for scale in [1e38, 1e-44] {
        let (progressive, _) = built(&mapped(&mesh, |p| p.map(|x| x * scale)), &default());
        check_levels(&progressive, 20);
    }
}

#[test]
fn bad_input_is_refused_by_name() {
    let good = cube();
    let refused = |expected: BuildError, spoil: fn(&mut IndexedMesh)| {
        let mut mesh = good.clone();
        spoil(&mut mesh);
        assert_eq!(build(&mesh, &default(), &mut |_| {}).unwrap_err(), expected, "{expected}");
    };
    refused(BuildError::NonFinitePosition { vertex: 3, axis: 1 }, |mesh| mesh.positions[3][1] = f32::NAN);
    refused(BuildError::NonFinitePosition { vertex: 0, axis: 2 }, |mesh| {
        mesh.positions[0][2] = f32::INFINITY;
    });
    refused(BuildError::NonFiniteOrigin, |mesh| mesh.origin[0] = f64::NAN);
    refused(BuildError::NonFiniteAttribute { wedge: 2, attribute: "normal" }, |mesh| {
        mesh.wedges.normals = vec![[0.0; 3]; 8];
        mesh.wedges.normals[2][0] = f32::NAN;
    });
    refused(BuildError::NonFiniteAttribute { wedge: 7, attribute: "texture coordinate" }, |mesh| {
        mesh.wedges.uvs = vec![[0.0; 2]; 8];
        mesh.wedges.uvs[7][1] = f32::INFINITY;
    });
    refused(BuildError::CornerOutOfRange { triangle: 5, index: 8, wedges: 8 }, |mesh| {
        mesh.triangles[5][1] = 8;
    });
    refused(BuildError::VertexOutOfRange { wedge: 7, index: 8, vertices: 8 }, |mesh| {
        mesh.wedges.vertices[7] = 8;
    });
    refused(BuildError::ArrayLength { array: "colours", found: 1, expected: 8 }, |mesh| {
        mesh.wedges.colours = vec![[0; 4]];
    });
    refused(BuildError::ArrayLength { array: "materials", found: 3, expected: 12 }, |mesh| {
        mesh.materials = vec![0; 3];
    });
}

#[test]
fn two_runs_give_the_same_order() {
    for cost in Cost::ALL {
        let mesh = torus(40, 20);
        let options = BuildOptions { cost, ..default() };
        let (first, second) = (built(&mesh, &options), built(&mesh, &options));
        assert_eq!(first, second);
    }
}

/// Nothing that threads do at the same time gets into the order, nor does the address of anything.
#[test]
fn threads_give_the_same_order() {
    let mesh = beside(&torus(40, 20), &mapped(&grid(20, bumps), |[x, y, z]| [x, y, z + 3.0]));
    let alone = built(&mesh, &default());
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4).map(|_| scope.spawn(|| built(&mesh.clone(), &default()))).collect();
        for thread in threads {
            assert_eq!(thread.join().unwrap(), alone);
        }
    });
}

#[test]
fn costs_have_names() {
    for cost in Cost::ALL {
        assert_eq!(Cost::from_name(cost.name()), Some(cost));
    }
    assert_eq!(Cost::from_name("cheapest"), None);
}

/// Melax's cost orders the same meshes to the same base, only not as well.
#[test]
fn the_cost_of_melax() {
    let mesh = torus(40, 20);
    let (quadric, _) = built(&mesh, &default());
    let (melax, _) = built(&mesh, &BuildOptions { cost: Cost::Melax, ..default() });
    check_levels(&melax, 50);
    assert_ne!(quadric.collapse, melax.collapse);
    // The ridge of the torus is its shape: both keep its outermost parts to the end.
    for progressive in [quadric, melax] {
        let reach = progressive.level(60).positions.iter().fold(0.0f32, |m, p| m.max(p[0].hypot(p[1])));
        assert!(reach > 1.3, "{reach}");
    }
}

#[test]
fn twenty_thousand_vertices_are_valid_at_fifty_levels() {
    let mesh = beside(&torus(160, 90), &mapped(&grid(75, bumps), |[x, y, z]| [x, y, z + 3.0]));
    let (progressive, report) = built(&mesh, &default());
    assert_eq!(report.vertices, 14_400 + 5_625);
    check_levels(&progressive, 50);
    assert_eq!(report.forced_collapses, 0, "{report:?}");
    // Faces on the same vertices only below 1 % of the vertices (PMESH-LVL-03).
    for level in [20_025, 10_000, 3_000, 1_000, 400, 202] {
        assert_eq!(coincident_faces(&progressive.level(level)), 0, "level {level}");
    }
}

/// A fan of many triangles around one vertex: the time must not grow with the square of their number, which for this one
/// would be minutes.
#[test]
fn a_hub_with_many_spokes() {
    let spokes = 30_000u16;
    let turn = |k: u16| std::f32::consts::TAU * f32::from(k) / f32::from(spokes);
    let mut positions = vec![[0.0, 0.0, 1.0]];
    positions.extend((0..spokes).map(|k| [turn(k).cos(), turn(k).sin(), 0.0]));
    let rim = |k: u16| u32::from(k % spokes) + 1;
    let triangles = (0..spokes).map(|k| [0, rim(k), rim(k + 1)]).collect();
    let (progressive, report) = built(&IndexedMesh::from_positions(positions, triangles), &default());
    assert_eq!(report.faces, 30_000);
    check_levels(&progressive, 5);
}

quickcheck! {
    /// Any triangles over few points: every rule of the tables holds and every level is valid.
    fn arbitrary_triangles(corners: Vec<u8>, points: u8, unwelded: bool) -> bool {
        let points = 3 + u32::from(points) % 30;
        let positions = (0..points).map(|v| [v % 4, v / 4 % 3, v / 12].map(|x| x as f32)).collect();
        let triangles = corners.chunks_exact(3).map(|c| [0, 1, 2].map(|k| u32::from(c[k]) % points)).collect();
        let mesh = IndexedMesh::from_positions(positions, triangles);
        let (progressive, report) = built(&mesh, &BuildOptions { weld: !unwelded, ..default() });
        check_levels(&progressive, report.levels());
        true
    }
}

#[cfg(feature = "fuzz")]
quickcheck! {
    fn the_fuzz_target_finds_nothing(bytes: Vec<u8>, choices: u8, points: u8) -> bool {
        let mut data = vec![choices, points % 40];
        data.extend(bytes.iter().cycle().take(bytes.len() * 4).map(|b| b % 40));
        crate::fuzz_mesh_build(&data);
        true
    }
}

#[test]
fn a_single_triangle() {
    let mesh = IndexedMesh::from_positions(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
    let (progressive, report) = built(&mesh, &default());
    assert_eq!((report.vertices, report.faces, report.levels()), (3, 1, 1));
    assert_eq!(progressive.full().triangles, [[0, 1, 2]]);
    check_levels(&progressive, 1);
}

#[test]
fn unreferenced_vertices_are_dropped_and_counted() {
    let mut mesh = torus(16, 8);
    for k in 0..50u8 {
        mesh.positions.insert(usize::from(k), [f32::from(k) + 5.0; 3]);
    }
    mesh.wedges.vertices = (0..178).collect();
    for corners in &mut mesh.triangles {
        *corners = corners.map(|w| w + 50);
    }
    let (progressive, report) = built(&mesh, &default());
    assert_eq!((report.vertices, report.dropped_unreferenced, report.faces), (128, 50, 256));
    // What is dropped does not count for the size of the mesh either.
    assert!(report.diagonal < 5.0, "{}", report.diagonal);
    check_levels(&progressive, 20);
}

/// A flat square with a flat square hole: both borders keep their corners for as long as there are vertices for them.
#[test]
fn borders_keep_their_corners() {
    let mut mesh = grid(21, |_, _| 0.0);
    let inside = |x: f32| (0.24..0.76).contains(&x);
    let (positions, kept) = (mesh.positions.clone(), std::mem::take(&mut mesh.triangles));
    mesh.triangles = kept
        .into_iter()
        .filter(|t| !t.iter().all(|&v| inside(positions[v as usize][0]) && inside(positions[v as usize][1])))
        .collect();
    let (progressive, report) = built(&mesh, &default());
    assert_eq!(report.boundary_edges, 4 * 20 + 4 * 10);
    check_levels(&progressive, 50);
    let mut corners: Vec<_> = progressive.level(8).positions.iter().map(|p| [p[0], p[1]]).collect();
    corners.sort_by(|a, b| a.partial_cmp(b).unwrap());
    let square = |low: f32, high: f32| [[low, low], [low, high], [high, low], [high, high]];
    let mut expected = [square(0.0, 1.0), square(0.25, 0.75)].concat();
    expected.sort_by(|a, b| a.partial_cmp(b).unwrap());
    assert_eq!(corners, expected);
}

/// Gentle bumps with vertices moved about inside: seen from above no face turns over, down to a tenth.
#[test]
fn flips_and_slivers_are_avoided() {
    let inner = |x: f32| x > 0.0 && x < 1.0;
    let mesh = mapped(&grid(30, |x, y| 0.3 * bumps(x, y)), |[x, y, z]| {
        let by = if inner(x) && inner(y) { 0.008 } else { 0.0 };
        [x + by * (7919.0 * x + 31.0 * y).sin(), y + by * (104_729.0 * y + 17.0 * x).sin(), z]
    });
    let (progressive, _) = built(&mesh, &default());
    check_levels(&progressive, 20);
    for level in [900, 700, 400, 200, 100] {
        let mesh = progressive.level(level);
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
            let turn = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            assert!(turn > 0.0, "level {level}: a triangle has turned over: {a:?} {b:?} {c:?}");
        }
    }
}

#[test]
fn a_scene_at_a_million_metres() {
    // The place is in the origin, in f64; the order does not see it.
    let near = torus(24, 12);
    let far = IndexedMesh { origin: [1e6, -1e6, 1e6], ..near.clone() };
    let ((here, _), (there, report)) = (built(&near, &default()), built(&far, &default()));
    assert_eq!((&here.collapse, &here.errors), (&there.collapse, &there.errors));
    assert_eq!(there.origin, [1e6, -1e6, 1e6]);
    assert!(!report.precision_lost());
    check_levels(&there, 20);
}

/// A plane in a regular grid of exact coordinates: all vertices of a border cost the same. The one that comes first
/// along the curve goes first.
#[test]
fn coplanar_ties_go_to_the_lowest_index() {
    let (progressive, _) = built(&grid(9, |_, _| 0.0), &default());
    check_levels(&progressive, 20);
    // Vertex 0 is a corner; vertex 1 has half of the area around it that one inside has.
    assert_eq!(progressive.positions.last(), Some(&[0.125, 0.0, 0.0]));
}

/// A closed scan with pinholes and tunnels: topology gives way in time, so that the coarsest levels have the shape of the
/// whole and not of the pinholes.
#[test]
fn pinholes_do_not_hold_the_coarsest_levels() {
    let mut mesh = torus(120, 60);
    let mut next = 0;
    mesh.triangles.retain(|_| {
        next += 1;
        next % 97 != 13
    });
    let (progressive, report) = built(&mesh, &default());
    assert_eq!(report.boundary_edges, 3 * (14_400 - report.faces));
    check_levels(&progressive, 100);
    assert_eq!((report.base_vertices, report.forced_collapses), (3, 0));
    // Rims stay rims down to 7200 / 300 = 24 vertices; kept any longer they would go on to 10.
    assert!(report.relaxed_from >= 24, "{report:?}");
}

/// Thin spikes have hardly any area and sides that keep their planes when they get shorter, so quadrics do not miss
/// them. Their height counts all the same.
#[test]
fn thin_spikes_stay_while_lower_bumps_go() {
    let mut mesh = grid(40, bumps);
    let mut tips = Vec::new();
    for face in (0..3042).step_by(500) {
        let corners = mesh.triangles.swap_remove(face);
        let place = corners.map(|v| mesh.positions[v as usize]);
        let centre = [0, 1, 2].map(|k| (place[0][k] + place[1][k] + place[2][k]) / 3.0);
        let mut below = corners;
        for ring in 0..8u8 {
            let (share, height) = (0.08 - 0.01 * f32::from(ring), 0.005 * f32::from(ring));
            let above = place.map(|p| {
                let [x, y, z] = [0, 1, 2].map(|k| centre[k] + share * (p[k] - centre[k]));
                mesh.positions.push([x, y, z + height]);
                mesh.positions.len() as u32 - 1
            });
            for k in 0..3 {
                let next = (k + 1) % 3;
                mesh.triangles.push([below[k], below[next], above[k]]);
                mesh.triangles.push([below[next], above[next], above[k]]);
            }
            below = above;
        }
        tips.push([centre[0], centre[1], centre[2] + 0.04]);
        mesh.positions.push([centre[0], centre[1], centre[2] + 0.04]);
        let tip = mesh.positions.len() as u32 - 1;
        mesh.triangles.extend([0, 1, 2].map(|k| [below[k], below[(k + 1) % 3], tip]));
    }
    mesh.wedges.vertices = (0..mesh.positions.len() as u32).collect();
    let (progressive, report) = built(&mesh, &default());
    assert_eq!((report.vertices, report.boundary_edges, report.nonmanifold_edges), (1600 + 7 * 25, 156, 0));
    check_levels(&progressive, 50);
    let coarse = progressive.level(150);
    let near = |tip: &[f32; 3]| {
        let distance = |p: &[f32; 3]| (0..3).map(|k| (p[k] - tip[k]).powi(2)).sum::<f32>().sqrt();
        coarse.positions.iter().map(distance).fold(f32::INFINITY, f32::min)
    };
    let missing: Vec<f32> = tips.iter().map(near).collect();
    assert!(missing.iter().all(|&d| d < 0.005), "{missing:?}");
}
