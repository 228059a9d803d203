//! What filling costs: `cargo bench -p ivg-grid --bench fill`.
//!
//! Prints a table of ratios, each measured in this run, with the target beside it. What is
//! compared is measured in turns, several times each, and the medians count. The unit of a full fill is one copy of the
//! values of the grid.

use std::hint::black_box;
use std::time::Instant;

use ivg_format::Lattice;
use ivg_grid::{FillOptions, FilledGrid, HemisphereVectors, IrradianceGrid, Smoothing};

const SIDE: usize = 32;
const SLICE: usize = SIDE * SIDE;
const VERTICES: usize = SIDE * SLICE;

fn main() {
    let light: Vec<HemisphereVectors> = (0..VERTICES).map(light).collect();
    println!("32 x 32 x 32 vertices of 54 numbers\n");
    for (name, walls) in [("open", false), ("with walls and invalid vertices", true)] {
        println!("{name}:");
        full(&light, walls);
        for per_slice in [64, 1] {
            stream(&light, walls, per_slice);
        }
        println!();
    }
}

/// Full fills at several shares received: over a copy, and how much of it is smoothing.
fn full(light: &[HemisphereVectors], walls: bool) {
    let start = lattice(walls);
    let mut grid = start.clone();
    grid.set(0, &light[0]);
    let mut to = light.to_vec();
    let mut copy = || to.copy_from_slice(black_box(light));
    let mut once = || {
        black_box(ivg_grid::fill(&grid, &FillOptions::default()));
    };
    let [once, unit] = medians([&mut once, &mut copy]);
    println!(
        "  {:48} {:6.2} copies",
        "fill() of one vertex, pyramid and memory included",
        once.median / unit.median
    );
    let [mut worst, mut worst_share] = [0.0_f64; 2];
    for per_slice in [0, 3, 10, 51, 256, 512, 768] {
        let filled = |options: FillOptions| {
            let mut filled = FilledGrid::new(start.clone(), options);
            filled.set(0, &light[0]);
            order(per_slice.max(1))
                .take(usize::from(per_slice > 0))
                .flatten()
                .for_each(|v| filled.set(v, &light[v]));
            filled.grid();
            move || {
                filled.forget_filled();
                black_box(filled.grid());
            }
        };
        let mut whole = filled(FillOptions::default());
        let mut rough = filled(FillOptions { smoothing: Smoothing::Nowhere, ..FillOptions::default() });
        let mut paper = filled(FillOptions::PAPER);
        let [whole, rough, paper, unit] = medians([&mut whole, &mut rough, &mut paper, &mut copy]);
        let share = (whole.median - rough.median) / whole.median;
        println!(
            "  full fill, {:5.2} % received                        {:6.2} copies ({:.2} to {:.2}), smoothing {:3.0} %; as in the paper {:6.2} copies; a copy {:.3} ms",
            100.0 * per_slice as f64 / SLICE as f64,
            whole.median / unit.median,
            whole.quartiles[0] / unit.median,
            whole.quartiles[1] / unit.median,
            100.0 * share,
            paper.median / unit.median,
            1e3 * unit.median,
        );
        (worst, worst_share) = (worst.max(whole.median / unit.median), worst_share.max(share));
    }
    verdict("largest full fill over a copy", worst, 12.0);
    verdict("largest share of smoothing", worst_share, 0.4);
}

/// Incremental over full fills of the same received vertices, request by request, over a whole stream.
fn stream(light: &[HemisphereVectors], walls: bool, per_slice: usize) {
    let mut times = vec![[const { Vec::new() }; 2]; SLICE / per_slice];
    for _ in 0..5 {
        let mut kept = FilledGrid::new(lattice(walls), FillOptions::default());
        let mut again = kept.clone();
        for (request, [incremental, full]) in order(per_slice).zip(&mut times) {
            request.iter().for_each(|&v| kept.set(v, &light[v]));
            request.iter().for_each(|&v| again.set(v, &light[v]));
            again.forget_filled();
            incremental.push(seconds(|| {
                black_box(kept.grid());
            }));
            full.push(seconds(|| {
                black_box(again.grid());
            }));
        }
        assert!(kept.grid().vectors() == again.grid().vectors());
    }
    let times: Vec<[f64; 2]> =
        times.into_iter().map(|pair| pair.map(|times| Spread::of(times).median)).collect();
    let ratios: Vec<f64> = times.iter().map(|[incremental, full]| incremental / full).collect();
    let [incremental_sum, full_sum] = [0, 1].map(|n| times[1..].iter().map(|pair| pair[n]).sum::<f64>());
    // The first request builds the pyramid in both.
    let mean = ratios[1..].iter().sum::<f64>() / (ratios.len() - 1) as f64;
    let quarters: Vec<String> = ratios
        .chunks(ratios.len().div_ceil(4))
        .map(|q| format!("{:.2}", q.iter().sum::<f64>() / q.len() as f64))
        .collect();
    println!(
        "  requests of {per_slice} a slice, incremental over full: mean {mean:.3}, of the sums {:.3}, by quarters {}",
        incremental_sum / full_sum,
        quarters.join(" ")
    );
    verdict(
        &format!("mean over a stream of {per_slice} a slice"),
        mean,
        if per_slice == 1 { 0.25 } else { 0.9 },
    );
}

fn verdict(name: &str, found: f64, target: f64) {
    println!(
        "  {name:48} {found:6.2}  target {target:5.2}  {}",
        if found <= target { "met" } else { "MISSED" }
    );
}

/// The vertices of each request: so many of each slice, in an order of the slice's own.
fn order(per_slice: usize) -> impl Iterator<Item = Vec<usize>> {
    let slices: Vec<Vec<usize>> = (0..SIDE)
        .map(|z| {
            let mut slice: Vec<usize> = (z * SLICE..(z + 1) * SLICE).collect();
            slice.sort_by_key(|&v| mixed(v as u64));
            slice
        })
        .collect();
    (0..SLICE / per_slice)
        .map(move |k| slices.iter().flat_map(|s| s[k * per_slice..(k + 1) * per_slice].to_vec()).collect())
}

/// A smooth field with a little noise in it.
fn light(vertex: usize) -> HemisphereVectors {
    let at = [vertex % SIDE, vertex / SIDE % SIDE, vertex / SLICE].map(|n| n as f32 / SIDE as f32);
    let noise = (mixed(vertex as u64) >> 40) as f32 / (1 << 24) as f32;
    std::array::from_fn(|h| {
        std::array::from_fn(|c| std::array::from_fn(|i| (h + c) as f32 * (4.0 * at[i]).sin() + 0.1 * noise))
    })
}

fn lattice(walls: bool) -> IrradianceGrid {
    let side = SIDE as u16;
    let lattice = Lattice { dims: [side; 3], origin: [0.0; 3], step: [1.0; 3] };
    let mut grid = IrradianceGrid::new(lattice).expect("a lattice with steps");
    if walls {
        for vertex in 0..VERTICES {
            let at = [vertex % SIDE, vertex / SIDE % SIDE, vertex / SLICE];
            // A shell around a room, a wall with a door in it, and a ball.
            let shell =
                (0..3).map(|axis| u8::from(at[axis] == 0 || at[axis] == SIDE - 2) << axis).sum::<u8>();
            let wall = u8::from(at[0] == 12 && at[1] > 8);
            grid.set_blocked_edges(vertex, shell | wall);
            let from_middle: usize = at.iter().map(|&n| n.abs_diff(20).pow(2)).sum();
            if from_middle < 36 {
                grid.set_validity(vertex, 0);
            }
        }
    }
    grid
}

fn mixed(seed: u64) -> u64 {
    let z = (seed + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB) >> 1
}

fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

/// Several measurements of one thing.
struct Spread {
    median: f64,
    /// A quarter of the measurements is below the first, a quarter above the second.
    quartiles: [f64; 2],
}

impl Spread {
    fn of(mut times: Vec<f64>) -> Self {
        times.sort_by(f64::total_cmp);
        let at = |quarter: usize| times[(times.len() - 1) * quarter / 4];
        Self { median: at(2), quartiles: [at(1), at(3)] }
    }
}

/// How long each takes, measured in turns. The first half of a turn does not count: it finds in the caches what the one
/// before left there, which would make the copy, the unit, seem slow.
fn medians<const N: usize>(mut works: [&mut dyn FnMut(); N]) -> [Spread; N] {
    let mut times = [const { Vec::new() }; N];
    for _ in 0..7 {
        for (work, times) in works.iter_mut().zip(&mut times) {
            (0..5).for_each(|_| work());
            times.extend((0..5).map(|_| seconds(&mut *work)));
        }
    }
    times.map(Spread::of)
}
