//! Hard cases of ordering, each by name, and what must hold of any order.

use pmesh_format::{
    EncodeOptions, IndexedMesh, Limits, Mode, PacketSize, Positions, ProgressiveMesh, Replay, check_level,
    encode,
};

use crate::{BuildError, BuildOptions, BuildReport, Cost, build};

mod attributes;
mod cases;
mod comb;
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

/// Writes the mesh raw and coded, reads it back, and checks `count` levels spread over all of them, with both ends: the raw ones
/// are those of the tables, all are valid, and the whole ones of coded files have the faces of the tables where they were.
fn check_levels(progressive: &ProgressiveMesh, count: usize) {
    let mut replay = replayed(progressive, &EncodeOptions::default());
    for level in spread(&replay, count) {
        replay.set_level(level).unwrap();
        assert_eq!(replay.mesh(), progressive.level(level), "level {level}");
        assert!(level == 0 || replay.face_count() > 0, "level {level} has no face");
    }
    for positions in [Positions::F32, Positions::Quantised(12)] {
        let mut replay = replayed(progressive, &coded(positions));
        let ends = replay.header().packets.iter().map(|entry| entry.vertices.end);
        let ends: Vec<_> = ends.chain([progressive.base_vertices]).collect();
        for level in spread(&replay, count).chain(ends) {
            replay.set_level(level).unwrap();
            let mesh = replay.mesh();
            assert_eq!(mesh.positions.len(), level as usize);
            check_level(&mesh).unwrap_or_else(|fault| panic!("level {level}: {fault}"));
            if replay.header().is_whole_level(level) {
                let expected = progressive.level(level);
                assert_eq!(mesh.triangles.len(), expected.triangles.len(), "level {level}");
                if positions == Positions::F32 {
                    assert!(places(&mesh) == places(&expected), "level {level} has other faces");
                }
            }
        }
    }
}

/// Coded in small packets.
fn coded(positions: Positions) -> EncodeOptions {
    let packets = PacketSize::Growing { first: 8, percent: 30, most: 4096 };
    EncodeOptions { mode: Mode::Coded, positions, packets, ..EncodeOptions::default() }
}

/// The mesh, written and read back.
fn replayed(progressive: &ProgressiveMesh, options: &EncodeOptions) -> Replay {
    let file = encode(progressive, options).unwrap();
    Replay::from_file(&file, &Limits::default()).unwrap()
}

/// So many levels of the file, with both ends.
fn spread(replay: &Replay, count: usize) -> impl Iterator<Item = u32> + use<> {
    let levels = replay.levels().unwrap();
    let span = (levels.end() - levels.start()) as usize;
    (0..count).map(move |k| levels.start() + (span * k / (count - 1).max(1)) as u32)
}

/// Material and places of the corners of each face, sorted; the least corner first, so that only winding and places count.
fn places(mesh: &IndexedMesh) -> Vec<(u16, [[u32; 3]; 3])> {
    let mut faces: Vec<_> = (0..mesh.triangles.len())
        .map(|i| {
            let mut corners = mesh.triangle_vertices(i).map(|v| mesh.positions[v as usize].map(f32::to_bits));
            let least = (0..3).min_by_key(|&c| corners[c]).unwrap_or_default();
            corners.rotate_left(least);
            (mesh.material(i), corners)
        })
        .collect();
    faces.sort_unstable();
    faces
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
