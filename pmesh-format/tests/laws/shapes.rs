//! Shapes that are hard to collapse and to split, by name: each goes into a raw and into coded files and comes back at every
//! level. `docs/hard-cases.md` lists them.

use crate::files::{header, levels, packet, replayed};
use pmesh_format::{
    EncodeOptions, IndexedMesh, Limits, Mode, PacketSize, Positions, ProgressiveMesh, Replay, Wedges,
    check_level, codes, encode,
};

/// The faces of the finest level, and what each vertex from `base` on collapses onto.
fn progressive(
    positions: Vec<[f32; 3]>,
    faces: Vec<[u32; 3]>,
    base: u32,
    collapse: Vec<u32>,
) -> ProgressiveMesh {
    ProgressiveMesh {
        wedges: Wedges { vertices: (0..positions.len() as u32).collect(), ..Wedges::default() },
        positions,
        base_vertices: base,
        wedge_collapse: collapse.clone(),
        errors: vec![0.5; collapse.len()],
        collapse,
        faces,
        ..ProgressiveMesh::default()
    }
}

/// A point on a circle of that radius.
fn around(k: u32, of: u32, radius: f32, z: f32) -> [f32; 3] {
    let (sin, cos) = (k as f32 / of as f32 * std::f32::consts::TAU).sin_cos();
    [radius * cos, radius * sin, z]
}

/// Material and places of the corners of each face, the least corner first, sorted: only winding and places count.
fn places(mesh: &IndexedMesh) -> Vec<[[u32; 3]; 3]> {
    let corner = |w: &u32| mesh.positions[mesh.wedges.vertices[*w as usize] as usize].map(f32::to_bits);
    let mut faces: Vec<[[u32; 3]; 3]> = mesh
        .triangles
        .iter()
        .map(|face| {
            let mut corners = [corner(&face[0]), corner(&face[1]), corner(&face[2])];
            let least = (0..3).min_by_key(|&c| corners[c]).unwrap_or_default();
            corners.rotate_left(least);
            corners
        })
        .collect();
    faces.sort_unstable();
    faces
}

/// Raw files have exactly the levels of the tables; coded ones valid levels, and at the ends of packets the faces of the tables.
fn comes_back(mesh: &ProgressiveMesh) {
    for size in [1, 3, 1000] {
        for (mode, positions) in [
            (Mode::Raw, Positions::F32),
            (Mode::Coded, Positions::F32),
            (Mode::Coded, Positions::Quantised(12)),
        ] {
            let packets = PacketSize::Fixed(size);
            let options = EncodeOptions { mode, positions, packets, ..EncodeOptions::default() };
            let mut replay = Replay::from_file(&encode(mesh, &options).unwrap(), &Limits::default()).unwrap();
            for level in mesh.base_vertices..=mesh.positions.len() as u32 {
                replay.set_level(level).unwrap();
                let (shown, expected) = (replay.mesh(), mesh.level(level));
                check_level(&shown).unwrap();
                if mode == Mode::Raw {
                    assert_eq!(shown, expected, "packets of {size}, level {level}");
                } else if replay.header().is_whole_level(level) {
                    assert_eq!(shown.triangles.len(), expected.triangles.len());
                    if positions == Positions::F32 {
                        assert_eq!(places(&shown), places(&expected), "packets of {size}, level {level}");
                    }
                }
            }
        }
    }
}

/// Two fans that meet in one vertex; the new vertex takes a face of each.
#[test]
fn a_pinched_fan_is_split_across_both_fans() {
    let positions =
        (0..7).map(|k| if k == 0 { [0.0; 3] } else { around(k, 7, 1.0, 0.2 * k as f32) }).collect();
    let faces = vec![[7, 1, 2], [0, 2, 3], [7, 4, 5], [0, 5, 6], [0, 7, 2], [0, 7, 5]];
    let mut mesh = progressive(positions, faces, 7, vec![0]);
    mesh.positions.push([0.1, 0.2, 0.5]);
    mesh.wedges.vertices.push(7);
    assert_eq!((mesh.level(7).triangles.len(), mesh.level(8).triangles.len()), (4, 6));
    comes_back(&mesh);
}

/// A tube: each of its two borders loses and regains its vertices.
#[test]
fn a_tube_has_two_borders() {
    let (n, rings) = (8, 5);
    let positions = (0..n * rings).map(|v| around(v % n, n, 1.0, (v / n) as f32)).collect();
    let quads =
        (0..n * (rings - 1)).map(|q| [q, q / n * n + (q + 1) % n, q / n * n + (q + 1) % n + n, q + n]);
    let faces = quads.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    // Along each ring, the last vertex first; then the rings onto the first.
    let parents = (3..n * rings).map(|v| if v % n == 0 { v - n } else { v - 1 }).collect();
    comes_back(&progressive(positions, faces, 3, parents));
}

/// A file whose coarsest level is its finest: one packet that is all base.
#[test]
fn a_mesh_that_is_all_base() {
    let positions = (0..6).map(|k| around(k, 6, 1.0, (k % 2) as f32)).collect();
    let mesh = progressive(positions, vec![[0, 1, 2], [2, 1, 3], [4, 5, 0]], 6, Vec::new());
    assert_eq!(mesh.base_vertices as usize, mesh.positions.len());
    comes_back(&mesh);
}

/// Vertices that come without a face: one on its own, and a component that is torn off another.
#[test]
fn a_split_without_new_faces() {
    let mut positions: Vec<[f32; 3]> = (0..3).map(|k| around(k, 3, 1.0, 0.0)).collect();
    positions.extend((0..3).map(|k| around(k, 3, 1.0, 2.0)));
    positions.push([9.0; 3]);
    // Vertex 5 goes onto vertex 0, which lies in the other triangle, and takes both its faces along.
    let mesh = progressive(positions, vec![[0, 1, 2], [3, 4, 5], [5, 4, 3]], 5, vec![0, 2]);
    let faces: Vec<_> = (5..=7).map(|level| mesh.level(level).triangles.len()).collect();
    assert_eq!(faces, [3, 3, 3]);
    comes_back(&mesh);
}

/// Three, five and forty sheets on the edge between a vertex and its parent all come at once.
#[test]
fn a_split_with_many_new_faces() {
    for sheets in [3, 5, 40] {
        let mut positions: Vec<[f32; 3]> = vec![[0.0; 3]];
        positions.extend((0..sheets).map(|k| around(k, sheets, 1.0, 0.5)));
        positions.push([0.0, 0.0, 1.0]);
        let top = sheets + 1;
        let mut faces: Vec<_> =
            (1..top).map(|k| if k % 2 == 0 { [0, k, top] } else { [0, top, k] }).collect();
        faces.extend((1..top - 1).map(|k| [top, k, k + 1]));
        let mesh = progressive(positions, faces, top, vec![0]);
        assert_eq!(mesh.faces.len() - mesh.level(top).triangles.len(), sheets as usize);
        comes_back(&mesh);
    }
}

/// A vertex of so many faces is split in two halves, then each half once more: faces that go round and faces that do not.
#[test]
fn vertices_of_many_faces() {
    for rim in [8, 9, 12, 31, 32, 33, 64, 65, 100, 300] {
        for closed in [true, false] {
            let mut positions: Vec<[f32; 3]> = vec![[0.0, 0.0, 1.0]];
            positions.extend((0..rim).map(|k| around(k, rim, 1.0, 0.1 * (k % 3) as f32)));
            positions.extend([[0.5, 0.25, 1.5], [0.25, -0.5, 1.25], [-0.5, 0.125, 1.0]]);
            // Which of four hubs a face of the rim has: hub 0, and those that come from it.
            let (half, quarter) = (rim / 2, rim / 4);
            let hub = |k: u32| match k {
                k if k < quarter => rim + 2,
                k if k < half => rim + 1,
                k if k < half + quarter => rim + 3,
                _ => 0,
            };
            let spokes = if closed { rim } else { rim - 1 };
            let mut faces: Vec<_> = (0..spokes).map(|k| [hub(k), k + 1, (k + 1) % rim + 1]).collect();
            let between = (0..rim).filter(|&k| (closed || k > 0) && hub(k) != hub((k + rim - 1) % rim));
            faces.extend(between.map(|k| [hub((k + rim - 1) % rim), k + 1, hub(k)]));
            let mesh = progressive(positions, faces, rim + 1, vec![0, rim + 1, 0]);
            assert_eq!(mesh.level(rim + 1).triangles.len(), spokes as usize);
            comes_back(&mesh);
        }
    }
}

/// Faces that are twice there, the same way round or the other, on the vertices that split.
#[test]
fn faces_that_lie_on_each_other() {
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.5, 0.5, 1.0]];
    let faces = vec![[0, 1, 2], [0, 1, 2], [2, 1, 0], [2, 1, 3], [0, 1, 4], [0, 1, 4], [1, 0, 4], [4, 3, 2]];
    comes_back(&progressive(positions, faces, 3, vec![1, 0]));
}

/// What a client that fetches by ranges may do wrong, with coded packets.
#[test]
fn coded_packets_out_of_order_twice_or_missing_leave_all_levels_as_they_were() {
    let (n, rings) = (6, 4);
    let positions = (0..n * rings).map(|v| around(v % n, n, 1.0, (v / n) as f32)).collect();
    let quads =
        (0..n * (rings - 1)).map(|q| [q, q / n * n + (q + 1) % n, q / n * n + (q + 1) % n + n, q + n]);
    let faces = quads.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let parents = (3..n * rings).map(|v| if v % n == 0 { v - n } else { v - 1 }).collect();
    let mesh = progressive(positions, faces, 3, parents);
    let packets = PacketSize::Fixed(6);
    let options = EncodeOptions { mode: Mode::Coded, packets, ..EncodeOptions::default() };
    let file = encode(&mesh, &options).unwrap();
    let header = header(&file);
    assert_eq!(header.packet_count(), 4);
    for applied in 0..=header.packet_count() {
        for next in (0..header.packet_count()).filter(|&next| next != applied) {
            let mut replay = replayed(&file, applied);
            let expected = levels(&mut replay);
            let error = replay.apply(&packet(&file, &header, next)).unwrap_err();
            let place = header.packet_range(next).start + 8;
            assert_eq!((error.code(), error.offset().0), (codes::PACKET_ORDER.number(), place));
            assert_eq!((replay.packets(), levels(&mut replay)), (applied, expected));
            // And those that are next go on where the last one ended.
            (applied..header.packet_count())
                .for_each(|k| drop(replay.apply(&packet(&file, &header, k)).unwrap()));
            assert_eq!(levels(&mut replay), levels(&mut replayed(&file, header.packet_count())));
        }
    }
}
