//! Prints the stability of bakes: hard cases, what is expected, what was found, and how far off it may be.
//!
//! ```text
//! cargo run --release -p ivg-bake --features cases --example hard_cases -- [FACTOR]
//! ```
//!
//! FACTOR multiplies the photons of every case: bounds are mostly eight standard errors of eight bakes, and shrink with its
//! root. The tests of the crate run the same cases (`docs/hard-cases.md`). Exits with 1 if a case does not hold.

#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use std::process::ExitCode;

use glam::{DVec3, Vec3};
use ivg_bake::cases::{
    Outcome, ball_under_sky, cavity_with_source, cross_coloured_walls, furnace_on_lattice,
    leak_between_rooms, lit_disk, lit_rectangle, parallel_plates, spherical_cavity, white_furnace,
};
use ivg_bake::{BakeError, Estimator};
use ivg_scene::Material;

/// Where the bounds come from.
const NOISE: &str = "8 standard errors";

type Run = Box<dyn Fn(u64) -> Result<Outcome, BakeError>>;

fn cases() -> Vec<(&'static str, Run)> {
    let mut cases: Vec<(&'static str, Run)> = Vec::new();
    for albedo in [0.0, 0.3, 0.7, 0.95] {
        let run = move |n| white_furnace(albedo, 20_000 * n, Estimator::TrackLength);
        cases.push((NOISE, Box::new(run)));
    }
    cases.push((NOISE, Box::new(|n| white_furnace(0.7, 40_000 * n, Estimator::FaceCrossing))));
    for albedo in [0.0, 0.25, 0.5, 0.75, 0.95, 1.0] {
        cases.push((
            "8 standard errors + 1 % of what is missing for a ball of 2048 triangles",
            Box::new(move |n| {
                let material = Material { albedo: Vec3::splat(albedo), ..Material::default() };
                let name = format!("ball of albedo {albedo} under an even sky: share missing");
                ball_under_sky(&name, material, f64::from(albedo), 40_000 * n)
            }),
        ));
    }
    let cavity = "8 standard errors + 0.4 % for 2048 triangles + the source's shadow";
    for albedo in [0.0, 0.5, 0.8, 0.95] {
        cases.push((cavity, Box::new(move |n| spherical_cavity(albedo, 60_000 * n))));
    }
    cases.push((cavity, Box::new(|n| cavity_with_source(0.8, 5e-4, 1e7, 60_000 * n))));
    cases.push((NOISE, Box::new(|n| parallel_plates(true, 20_000 * n))));
    let below = "8 standard errors + 1 % for the mean over cells";
    cases.push((below, Box::new(|n| parallel_plates(false, 20_000 * n))));
    let block = "8 standard errors + 0.5 % for the mean over a block of 0.1 m";
    cases.push((block, Box::new(|n| lit_rectangle(400_000 * n))));
    let block = "8 standard errors + 2 % for the mean over a block of 0.2 m";
    cases.push((block, Box::new(|n| lit_disk(150_000 * n))));
    cases.push((NOISE, Box::new(|n| cross_coloured_walls(20_000 * n))));
    let cube = |low: f64, high: f64| (DVec3::splat(low), DVec3::splat(high));
    for (name, dims, bounds) in [
        ("vertices on the walls", [5; 3], cube(0.0, 1.0)),
        ("walls between cells", [4; 3], cube(0.125, 0.875)),
        ("1 x 3 x 4 vertices", [1, 3, 4], cube(0.25, 0.75)),
        ("2 x 2 x 2 vertices", [2; 3], cube(0.25, 0.75)),
        ("1 vertex", [1; 3], cube(0.25, 0.75)),
    ] {
        cases.push((NOISE, Box::new(move |n| furnace_on_lattice(name, dims, bounds, 10_000 * n))));
    }
    for thickness in [0.0, 0.05, 0.25, 0.5, 1.0, 2.0] {
        let leak = "nothing passes a wall; flights end a rounding late (asked for: 1 % from one step on, 5 % at 0.25)";
        cases.push((leak, Box::new(move |n| leak_between_rooms(thickness, 60_000 * n))));
    }
    cases
}

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let factor = std::env::args().nth(1).map_or(Ok(1), |text| text.parse::<u64>())?.max(1);
    println!("| case | expected | measured | off | may be off | because |\n|---|---|---|---|---|---|");
    let mut failed = 0;
    for (why, run) in cases() {
        let Outcome { name, expected, measured, figure, bound } = &run(factor)?;
        let holds = figure.abs() <= *bound;
        failed += u32::from(!holds);
        println!(
            "| {name} | {expected:.5} | {measured:.5} | {:+.3} % | {:.3} % | {why}{} |",
            100.0 * figure,
            100.0 * bound,
            if holds { "" } else { "; **does not hold**" }
        );
    }
    Ok(if failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
