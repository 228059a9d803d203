//! Hard cases of ordering, each by name, and what must hold of any order.

use pmesh_format::{
    EncodeOptions, IndexedMesh, Limits, ProgressiveMesh, Replay, check_level, decode_all, encode,
};

use crate::{BuildError, BuildOptions, BuildReport, Cost, build};

mod attributes;
mod cases;
mod seams;
mod shapes;

/// Builds, checks everything that must hold of any order, and returns what was built.
fn built(mesh: &IndexedMesh, options: &BuildOptions) -> (ProgressiveMesh, BuildReport) {
    let mut shares = Vec::new();
    let (progressive, report) = build(mesh, options, &mut |share| shares.push(share)).unwrap();
    assert!(shares.is_sorted() && shares.first() == Some(&0.0) && shares.last() == Some(&1.0), "{shares:?}");
    assert_eq!(report.vertices, progressive.positions.len());
    assert_eq!(report.wedges, progressive.wedges.len());
    assert_eq!(report.faces, progressive.faces.len());
    assert_eq!(report.base_vertices, progressive.base_vertices as usize);
    assert_eq!(report.vertices + report.welded_vertices + report.dropped_unreferenced, report.input_vertices);
    let dropped = report.dropped_degenerate + report.dropped_duplicate;
    assert_eq!(report.faces + dropped, report.input_triangles);
    // All n − 2 levels exist, whatever the mesh.
    let (base, base_faces) = if report.faces == 0 { (0, 0) } else { (3, 1) };
    assert_eq!(report.base_vertices, base, "{report:?}");
    assert!(report.base_faces >= base_faces);
    assert!(progressive.errors.is_sorted_by(|a, b| a >= b), "errors rise towards the finest level");
    assert!(progressive.errors.iter().all(|e| e.is_finite() && *e >= 0.0));
    (progressive, report)
}

/// Writes the mesh, reads it back, and checks `count` levels spread over all of them, with both ends.
fn check_levels(progressive: &ProgressiveMesh, count: usize) {
    let file = encode(progressive, &EncodeOptions::default()).unwrap();
    let mut replay = Replay::default();
    decode_all(&file, &Limits::default(), |event| {
        replay.accept(&event).unwrap();
    })
    .unwrap();
    let levels = replay.levels().unwrap();
    let span = (levels.end() - levels.start()) as usize;
    for k in 0..count {
        let level = levels.start() + (span * k / (count - 1).max(1)) as u32;
        replay.set_level(level).unwrap();
        let mesh = replay.mesh();
        assert_eq!(mesh.positions.len(), level as usize);
        check_level(&mesh).unwrap_or_else(|fault| panic!("level {level}: {fault}"));
        assert!(level == 0 || !mesh.triangles.is_empty(), "level {level} has no face");
    }
}

/// How many faces have the same three vertices as an earlier one.
fn coincident_faces(mesh: &IndexedMesh) -> usize {
    let mut sets: Vec<[u32; 3]> = (0..mesh.triangles.len())
        .map(|i| {
            let mut set = mesh.triangle_vertices(i);
            set.sort_unstable();
            set
        })
        .collect();
    sets.sort_unstable();
    let all = sets.len();
    sets.dedup();
    all - sets.len()
}
