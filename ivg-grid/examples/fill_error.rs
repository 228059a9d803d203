//! What filling gets wrong: `cargo run --release -p ivg-grid --example fill_error -- FILE.ivg …`.
//!
//! Takes whole grids, leaves out all but a share of the vertices (so many of each layer in z, in a random order of its
//! own, and the corners), fills the rest and prints the relative root mean square error over all valid vertices, for
//! each of the ways to fill.

use std::process::ExitCode;

use ivg_format::{Limits, Quantity};
use ivg_grid::{FillOptions, IrradianceGrid, Smoothing, Values, fill};

const SHARES: [f64; 6] = [0.0025, 0.01, 0.05, 0.25, 0.5, 0.75];

fn main() -> ExitCode {
    let files: Vec<String> = std::env::args().skip(1).collect();
    if files.is_empty() {
        eprintln!("usage: fill_error FILE.ivg …");
        return ExitCode::FAILURE;
    }
    for file in files {
        let grid = std::fs::read(&file).map_err(|error| error.to_string()).and_then(|bytes| {
            IrradianceGrid::from_file(&bytes, &Limits::default()).map_err(|error| error.to_string())
        });
        match grid {
            Ok((grid, _)) => print_table(&file, &grid),
            Err(error) => {
                eprintln!("{file}: {error}");
                return ExitCode::FAILURE;
            }
        }
    }
    ExitCode::SUCCESS
}

fn print_table(file: &str, grid: &IrradianceGrid) {
    println!("{file}: {:?} vertices, {} valid", grid.lattice().dims, grid.valid_count());
    let heads: Vec<String> = SHARES.iter().map(|share| format!("{:>8.2} %", 100.0 * share)).collect();
    println!("{:40}{}", "error of the valid vertices, received:", heads.join(""));
    for neighbours in [false, true] {
        for smoothing in [Smoothing::Nowhere, Smoothing::EveryLevel, Smoothing::Finest] {
            let options = FillOptions { neighbours, smoothing };
            let errors = SHARES.map(|share| format!("{:10.4}", error(grid, share, &options)));
            let name = format!(
                "{}, smoothed {smoothing:?}{}",
                if neighbours { "neighbours" } else { "coarser values" },
                match options {
                    FillOptions::PAPER => " (paper)",
                    FillOptions::BEST => " (default)",
                    _ => "",
                }
            );
            println!("{name:40}{}", errors.join(""));
        }
    }
}

/// `sqrt(Σ |filled − exact|² / Σ |exact|²)` over the valid vertices.
fn error(grid: &IrradianceGrid, share: f64, options: &FillOptions) -> f64 {
    let lattice = *grid.lattice();
    let layer = usize::from(lattice.dims[0]) * usize::from(lattice.dims[1]);
    let mut partial = IrradianceGrid::of(lattice, grid.quantity()).expect("as large as the whole");
    for index in 0..grid.vertex_count() {
        partial.set_validity(index, grid.validity()[index]);
        partial.set_blocked_edges(index, grid.blocked_edges()[index]);
    }
    for first in (0..grid.vertex_count()).step_by(layer) {
        let mut order: Vec<usize> = (first..first + layer).collect();
        order.sort_by_key(|&index| mixed(index as u64));
        let received = (share * layer as f64).round() as usize;
        let corners = order[received..].iter().filter(|&&index| lattice.is_corner(index as u64));
        for &index in order[..received].iter().chain(corners) {
            partial.set(index, grid.get(index).expect("a whole grid"));
        }
    }
    let filled = fill(&partial, options);
    let width = if grid.quantity() == Quantity::Vectors { 54 } else { 27 };
    let (mut squares, mut norm) = (0.0, 0.0);
    for (n, (&found, &exact)) in numbers(&filled).iter().zip(numbers(grid)).enumerate() {
        if grid.is_valid(n / width) {
            squares += f64::from(found - exact).powi(2);
            norm += f64::from(exact).powi(2);
        }
    }
    (squares / norm).sqrt()
}

fn numbers(grid: &IrradianceGrid) -> &[f32] {
    match grid.values() {
        Values::Vectors(vectors) => vectors.as_flattened().as_flattened().as_flattened(),
        Values::Radiance(radiance) => radiance.as_flattened().as_flattened(),
    }
}

/// The finaliser of SplitMix64: a random order that is the same each time.
fn mixed(seed: u64) -> u64 {
    let z = (seed + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB)
}
