//! How fast files are read and levels are changed, beside what else could be done with the same arrays on the same core in the
//! same minute, and what a replay holds beside the mesh.
//!
//! `cargo bench -p pmesh-format --bench decode [-- FILE.pmesh…]`; without files, a grid. Every figure is the median of rounds in
//! which everything is timed, in processor time where the system tells it. What a file holds is written again: raw in packets
//! that bring 30 % more vertices each, raw in one packet, coded in packets as the first.

use std::alloc::System;
use std::hint::black_box;
use std::time::Instant;

use pmesh_format::{
    EncodeOptions, Event, Header, Limits, Mode, PacketSize, Positions, ProgressiveMesh, Replay, Step, Wedges,
    decode_all, encode,
};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Times everything is done.
const ROUNDS: usize = 11;

/// Faces that are decoded before the time is looked at again, at least.
const LEAST_FACES: u32 = 2_000_000;

/// The level at which zstd compresses the plain arrays.
const ZSTD_LEVEL: i32 = 3;

/// Vertices along a side of the grid: a power of two and one.
const SIDE: u32 = 513;

fn main() {
    let mut subjects: Vec<(String, Vec<u8>)> = vec![];
    for path in std::env::args().skip(1).filter(|word| !word.starts_with("--")) {
        let file = std::fs::read(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
        subjects.push((path.rsplit('/').next().unwrap_or(&path).to_string(), file));
    }
    let meshes = match &subjects[..] {
        [] => vec![("grid".to_string(), grid(SIDE))],
        files => files
            .iter()
            .map(|(name, file)| (name.clone(), load(file).progressive_mesh().expect("a whole file")))
            .collect(),
    };
    subjects.clear();
    for (name, mesh) in meshes {
        for positions in [Positions::F32, Positions::Quantised(14)] {
            let growing = PacketSize::Growing { first: 256, percent: 30, most: u32::MAX };
            let ways = [
                ("raw", Mode::Raw, growing),
                ("raw, one packet", Mode::Raw, PacketSize::Fixed(u32::MAX)),
                ("coded", Mode::Coded, growing),
            ];
            for (how, mode, packets) in ways {
                let options = EncodeOptions { packets, mode, positions, ..EncodeOptions::new() };
                let file = encode(&mesh, &options).expect("a mesh that can be written");
                subjects.push((format!("{name} {how} {}", positions.name()), file));
            }
        }
    }
    println!("{ROUNDS} rounds, medians\n");
    println!(
        "{:32} {:>9} {:>9} {:>8} {:>9} {:>8} {:>8} {:>8} {:>8} {:>10} {:>9} {:>8} {:>8}",
        "file",
        "vertices",
        "faces",
        "bits/v",
        "checksums",
        "Mtris/s",
        "/memcpy",
        "x zstd",
        "streamed",
        "first step",
        "down + up",
        "memory",
        "stepped"
    );
    for (name, file) in &subjects {
        measure(name, file);
    }
    println!(
        "\nMtris/s: triangles of the finest level by the time from the bytes of the file to its index buffer, checksums (own\n\
         column, ns a triangle) and every check included; / memcpy: that time over copying positions and indices; x zstd: the\n\
         time of decompressing them (level {ZSTD_LEVEL}) over it; streamed: Mtris/s packet by packet, with what each changes;\n\
         first step: what it takes to prepare steps, ns a triangle; down + up: from the finest to the coarsest level and back, ns\n\
         a triangle; memory, stepped: what a replay holds beside the mesh, over the bytes of the mesh, before and after that."
    );
}

fn measure(name: &str, file: &[u8]) {
    let Ok(Step::Consumed(_, header)) = Header::read(file, &Limits::default()) else {
        panic!("{name}: no header")
    };
    let mut replay = load(file);
    let plain: Vec<u8> = [
        replay.positions().iter().flatten().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>(),
        replay.indices().iter().flatten().flat_map(|w| w.to_le_bytes()).collect(),
    ]
    .concat();
    let compressed = zstd::bulk::compress(&plain, ZSTD_LEVEL).expect("compression in memory");
    let mut decompressor = zstd::bulk::Decompressor::new().expect("a decompressor");
    let mut copy = vec![0u8; plain.len()];
    let levels = replay.levels().expect("a mesh");
    let fresh = replay.clone();
    // So often that the clock of the processor, which may tick every few milliseconds, sees it.
    let times = LEAST_FACES.div_ceil(header.face_count.max(1)) as usize;
    let mut rounds = [const { vec![] }; 7];
    for _ in 0..ROUNDS {
        let often = |run: &mut dyn FnMut()| time(|| (0..times).for_each(|_| run())) / times as f64;
        let mut unstepped = vec![fresh.clone(); times];
        let mut next = 0;
        let timed = [
            often(&mut || {
                decode_all(file, &Limits::default(), |event| {
                    black_box(event);
                })
                .expect("a valid file");
            }),
            often(&mut || drop(black_box(load(file)))),
            often(&mut || black_box(&mut copy).copy_from_slice(black_box(&plain))),
            often(&mut || {
                let length = decompressor.decompress_to_buffer(&compressed, &mut copy);
                assert_eq!(length.ok(), Some(plain.len()));
            }),
            often(&mut || drop(black_box(streamed(file)))),
            often(&mut || {
                black_box(unstepped[next].set_level(levels.end() - 1)).expect("a level");
                next += 1;
            }),
            often(&mut || {
                black_box(replay.set_level(*levels.start())).expect("the coarsest level");
                black_box(replay.set_level(*levels.end())).expect("the finest level");
            }),
        ];
        rounds.iter_mut().zip(timed).for_each(|(all, one)| all.push(one));
    }
    let faces = f64::from(header.face_count);
    let of = |k: usize| median(rounds[k].clone());
    let region = Region::new(ALLOCATOR);
    let mut held = load(file);
    let mut beside = || {
        let stats = region.change();
        let bytes = stats.bytes_allocated as isize - stats.bytes_deallocated as isize;
        let mesh = plain.len() + attribute_bytes(&held);
        held.set_level(levels.end() - 1).expect("a level");
        (bytes as f64 - mesh as f64) / mesh as f64
    };
    println!(
        "{name:32} {:>9} {:>9} {:>8.1} {:>9.2} {:>8.1} {:>8.1} {:>8.2} {:>8.1} {:>10.1} {:>9.2} {:>8.2} {:>8.2}",
        header.vertex_count,
        header.face_count,
        file.len() as f64 * 8.0 / f64::from(header.vertex_count),
        of(0) / faces,
        faces / of(1) * 1e3,
        of(1) / of(2),
        of(3) / of(1),
        faces / of(4) * 1e3,
        of(5) / faces,
        of(6) / faces,
        beside(),
        beside(),
    );
}

fn load(file: &[u8]) -> Replay {
    Replay::from_file(file, &Limits::default()).expect("a valid file")
}

/// The same packet by packet, as from a network.
fn streamed(file: &[u8]) -> Replay {
    let mut replay = Replay::default();
    decode_all(file, &Limits::default(), |event: Event<'_>| replay.accept(&event).map(drop))
        .expect("a valid file");
    replay
}

/// Bytes of the arrays of a mesh besides positions and indices.
fn attribute_bytes(replay: &Replay) -> usize {
    12 * replay.normals().len()
        + 8 * replay.uvs().len()
        + 4 * replay.colours().len()
        + 2 * replay.face_materials().len()
}

/// Nanoseconds of this thread on a processor, or by the clock where the system does not tell.
fn time(run: impl FnOnce()) -> f64 {
    let processor = || -> Option<f64> {
        let line = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
        line.split_whitespace().next()?.parse().ok()
    };
    let (start, clock) = (processor(), Instant::now());
    run();
    match (start, processor()) {
        (Some(start), Some(end)) if end > start => end - start,
        _ => clock.elapsed().as_secs_f64() * 1e9,
    }
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}

/// A surface over a square whose vertices stand by the coarsest grid that has them, each collapsing towards the origin.
fn grid(side: u32) -> ProgressiveMesh {
    let mut order: Vec<(u32, u32)> = (0..side * side).map(|k| (k % side, k / side)).collect();
    let spacing = |&(x, y): &(u32, u32)| if x | y == 0 { side } else { 1 << (x | y).trailing_zeros() };
    order.sort_by_key(|place| std::cmp::Reverse(spacing(place)));
    let mut numbers = vec![0; (side * side) as usize];
    for (number, &(x, y)) in (0..).zip(&order) {
        numbers[(y * side + x) as usize] = number;
    }
    let at = |x: u32, y: u32| numbers[(y * side + x) as usize];
    let collapse: Vec<u32> = order[4..]
        .iter()
        .map(|place @ &(x, y)| {
            let spacing = spacing(place);
            at(x & !spacing, y & !spacing)
        })
        .collect();
    let squares = (0..side - 1).flat_map(|y| (0..side - 1).map(move |x| (x, y)));
    let faces = squares.flat_map(|(x, y)| {
        let corners = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
        [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]]
    });
    let height = |x: f32, y: f32| 0.1 * (9.0 * x).sin() * (7.0 * y).cos();
    ProgressiveMesh {
        positions: order
            .iter()
            .map(|&(x, y)| [x, y].map(|c| c as f32 / (side - 1) as f32))
            .map(|[x, y]| [x, y, height(x, y)])
            .collect(),
        wedges: Wedges { vertices: (0..side * side).collect(), ..Wedges::default() },
        base_vertices: 4,
        wedge_collapse: collapse.clone(),
        errors: vec![0.0; collapse.len()],
        collapse,
        faces: faces.collect(),
        ..ProgressiveMesh::default()
    }
}
