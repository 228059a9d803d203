//! Memory bounds, measured with a counting allocator. One test, since the count is that of the whole process.

use std::alloc::System;

use ivg_wire::{CommonHeader, ContentId, FormatId, Step, seal_header};
use pmesh_format::{Decoder, EncodeOptions, Limits, ProgressiveMesh, Replay, Verdict, Wedges, check, encode};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// PMESH-LIM-03 and COM-LIM-03 without the constant: what the directory, the decoder and the replay may hold for each byte
/// received.
const BYTES_PER_BYTE: usize = 64;
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

    // What is held at any time, packet by packet.
    for (seams, packet) in [(false, 5000), (false, 100), (false, 1), (true, 5000), (true, 1)] {
        let file = encode(&strip(20_000, seams), &EncodeOptions::fixed(packet)).unwrap();
        let region = Region::new(ALLOCATOR);
        let mut decoder = Decoder::new(Limits::default());
        let mut replay = Replay::default();
        let mut at = 0;
        while let Step::Consumed(used, event) = decoder.push(&file[at..]).unwrap() {
            at += used;
            replay.accept(&event).unwrap();
            let bound = FIXED + BYTES_PER_BYTE * at;
            assert!(
                held(&region) <= bound,
                "{} bytes held after {at}, seams {seams}, packets {packet}",
                held(&region)
            );
        }
        assert_eq!(at, file.len());
        // Nor does walking about add to it.
        for level in [3, 20_000, 777, 19_999, 3, 10_000] {
            replay.set_level(level).unwrap();
        }
        assert!(held(&region) <= FIXED + BYTES_PER_BYTE * at, "{} bytes held", held(&region));
    }
}
