//! Memory bounds, measured with a counting allocator. One test, since the count is that of the whole process.

use std::alloc::System;

use ivg_wire::{CommonHeader, ContentId, FormatId, Step, seal_header};
use pmesh_format::{
    Decoder, EncodeOptions, IndexedMesh, Limits, Mode, Positions, ProgressiveMesh, Replay, Verdict, Wedges,
    check, encode,
};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// PMESH-LIM-03 and COM-LIM-03 without the constant: what the directory, the decoder and the replay may hold for each byte
/// received.
const BYTES_PER_BYTE: usize = 64;
/// The same of coded packets.
const BYTES_PER_CODED_BYTE: usize = 2_048;
/// What the replay of a whole coded file may hold at most, as a multiple of the mesh: the mesh, and 1.5 times as much beside it.
const OF_THE_MESH: f64 = 2.5;
/// The constant of PMESH-LIM-03.
const FIXED: usize = 65_536;

/// A strip: vertex k collapses onto k − 1.
fn strip(vertices: u32, seams: bool) -> ProgressiveMesh {
    let per_vertex = if seams { 2 } else { 1 };
    let wedges = vertices * per_vertex;
    ProgressiveMesh {
        positions: (0..vertices).map(|v| [v as f32, (v % 2) as f32, 0.0]).collect(),
        wedges: Wedges {
            vertices: (0..wedges).map(|w| w / per_vertex).collect(),
            colours: if seams { vec![[0; 4]; wedges as usize] } else { Vec::new() },
            ..Wedges::default()
        },
        base_vertices: 3,
        collapse: (3..vertices).map(|v| v - 1).collect(),
        wedge_collapse: (3 * per_vertex..wedges).map(|w| w - per_vertex).collect(),
        errors: vec![0.0; vertices as usize - 3],
        faces: (2..vertices).map(|v| [v - 2, v - 1, v].map(|v| v * per_vertex)).collect(),
        ..ProgressiveMesh::default()
    }
}

/// All vertices collapse onto the one three before, and all faces lie on the last three: every corner passes every third vertex,
/// as deep as packets may be.
fn deep(vertices: u32) -> ProgressiveMesh {
    ProgressiveMesh {
        collapse: (3..vertices).map(|v| v - 3).collect(),
        wedge_collapse: (3..vertices).map(|v| v - 3).collect(),
        faces: vec![[vertices - 3, vertices - 2, vertices - 1]; 4 * vertices as usize],
        ..strip(vertices, false)
    }
}

/// A strip whose wedges have all there is.
fn with_attributes(vertices: u32) -> ProgressiveMesh {
    let mut mesh = strip(vertices, true);
    let wedges = mesh.wedges.len();
    mesh.wedges.normals = (0..wedges).map(|w| [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]][w % 2]).collect();
    mesh.wedges.uvs = (0..wedges).map(|w| [w as f32 / wedges as f32, (w % 2) as f32]).collect();
    mesh.materials = (0..mesh.faces.len()).map(|face| (face % 3) as u16).collect();
    mesh
}

/// Bytes of the arrays of a mesh.
fn size(mesh: &IndexedMesh) -> usize {
    let wedges = &mesh.wedges;
    12 * (mesh.positions.len() + wedges.normals.len() + mesh.triangles.len())
        + 8 * wedges.uvs.len()
        + 4 * wedges.colours.len()
        + 2 * mesh.materials.len()
}

/// What is held of coded packets, one by one, and in the end.
fn coded_packets_hold_little(mesh: &ProgressiveMesh, positions: Positions, packet: u32) {
    let mesh = ProgressiveMesh { positions: positions.quantised(&mesh.positions), ..mesh.clone() };
    let options = EncodeOptions { mode: Mode::Coded, positions, ..EncodeOptions::fixed(packet) };
    let file = encode(&mesh, &options).unwrap();
    let region = Region::new(ALLOCATOR);
    let mut decoder = Decoder::new(Limits::default());
    let mut replay = Replay::default();
    let mut at = 0;
    while let Step::Consumed(used, event) = decoder.push(&file[at..]).unwrap() {
        at += used;
        replay.accept(&event).unwrap();
        let (held, bound) = (held(&region), FIXED + BYTES_PER_CODED_BYTE * at);
        assert!(held <= bound, "{held} bytes held after {at}, packets of {packet}");
    }
    assert_eq!(at, file.len());
    let (held, mesh) = (held(&region), size(&replay.mesh()));
    assert!(
        held as f64 <= OF_THE_MESH * mesh as f64,
        "{held} bytes held of a mesh of {mesh}, packets of {packet}"
    );
}

/// A header of 152 bytes that declares the most that the format holds, then a few bytes of a directory.
fn greedy() -> Vec<u8> {
    let format =
        FormatId { magic: *b"\x89PMS\r\n\x1A\n", major: 0, minor: 2, header_bytes: 152, features: 0 };
    let common = CommonHeader {
        minor: 2,
        required_features: 0,
        optional_features: 0,
        header_bytes: 152,
        content_id: ContentId(7),
        data_offset: 1 << 20,
        file_bytes: 1 << 40,
    };
    let mut file = common.to_bytes(&format).to_vec();
    for count in [1u32 << 30, 1 << 30, 1 << 30, 1 << 29, 1 << 29] {
        file.extend(count.to_le_bytes());
    }
    file.extend([1, 1, 0, 0]);
    file.extend([0; 72]);
    seal_header(&mut file);
    file.extend(b"PDIR\x01\0\0\0");
    file.extend(((1u64 << 20) - 300).to_le_bytes());
    file
}

fn held(region: &Region<'_, System>) -> usize {
    let stats = region.change();
    stats.bytes_allocated.saturating_sub(stats.bytes_deallocated)
}

#[test]
fn memory_is_bounded_by_what_has_arrived() {
    // Declared counts allocate nothing.
    let file = greedy();
    assert!(file.len() < 200);
    let everything = Limits { counts: u32::MAX, ..Limits::default() };
    let region = Region::new(ALLOCATOR);
    let result = check(&file, &everything);
    let allocated = region.change().bytes_allocated;
    let error = result.expect_err("most of it is missing");
    assert_eq!(error.verdict(), Verdict::NeedMore, "{error}");
    assert_eq!(allocated, 0, "bytes allocated for {} bytes received", file.len());
    let error = check(&file, &Limits::default()).expect_err("more than the default limit");
    assert_eq!(error.verdict(), Verdict::Limit, "{error}");

    // What is held at any time, packet by packet; nobody has stepped, or somebody steps after each packet.
    let meshes = [
        (strip(20_000, false), 5000),
        (strip(20_000, false), 100),
        (strip(20_000, false), 1),
        (strip(20_000, true), 5000),
        (strip(20_000, true), 1),
        (deep(1_500), 1_500),
        (deep(1_500), 8),
    ];
    for (mesh, packet) in meshes {
        let file = encode(&mesh, &EncodeOptions::fixed(packet)).unwrap();
        for stepping in [false, true] {
            let region = Region::new(ALLOCATOR);
            let mut decoder = Decoder::new(Limits::default());
            let mut replay = Replay::default();
            let mut at = 0;
            let check = |at: usize| {
                let bound = FIXED + BYTES_PER_BYTE * at;
                let held = held(&region);
                assert!(
                    held <= bound,
                    "{held} bytes held after {at}, packets of {packet}, stepping: {stepping}"
                );
                held
            };
            while let Step::Consumed(used, event) = decoder.push(&file[at..]).unwrap() {
                at += used;
                replay.accept(&event).unwrap();
                check(at);
                // Not after each of very many packets: there and back is the way through all of them.
                let steps = stepping && (replay.packets() < 20 || replay.packets() % 500 == 0);
                if let (true, Some(levels)) = (steps, replay.levels()) {
                    replay.set_level(*levels.start()).unwrap();
                    check(at);
                }
            }
            assert_eq!(at, file.len());
            let before = check(at);
            // The first step adds to it, if there was none; walking about does not.
            replay.set_level(777).unwrap();
            let after = check(at);
            assert!(stepping || after > before, "{after} bytes after the first step, {before} before");
            for level in [3, mesh.positions.len() as u32, 777, 999, 3, 1000] {
                replay.set_level(level).unwrap();
                assert!(
                    check(at) <= after + after / 8,
                    "{} bytes after walking about, {after} before",
                    check(at)
                );
            }
        }
        // A whole file at once takes no more.
        let region = Region::new(ALLOCATOR);
        let replay = Replay::from_file(&file, &Limits::default()).unwrap();
        assert!(held(&region) <= FIXED + BYTES_PER_BYTE * file.len(), "{} bytes held", held(&region));
        drop(replay);
        // Nor does one of which only the beginning is there make room for more than that.
        let beginning = &file[..file.len() / 4];
        let region = Region::new(ALLOCATOR);
        assert!(Replay::from_file(beginning, &Limits::default()).is_err());
        let allocated = region.change().bytes_allocated;
        assert!(allocated <= FIXED + 2 * BYTES_PER_BYTE * beginning.len(), "{allocated} bytes allocated");
    }
    for packet in [5_000, 100] {
        for positions in [Positions::F32, Positions::Quantised(12)] {
            coded_packets_hold_little(&strip(20_000, false), positions, packet);
            coded_packets_hold_little(&with_attributes(20_000), positions, packet);
        }
    }
}
