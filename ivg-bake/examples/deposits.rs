//! Prints what a photon is worth: the noise that it leaves and the time that it takes, for each estimator and several grids.
//!
//! ```text
//! cargo run --release -p ivg-bake --example deposits -- [SCENE] [--lights FILE] [--grids N[,N...]] [--photons N] [--seeds N]
//! ```
//!
//! SCENE is anything `ivg` reads; without it, a closed box with a lit ceiling and two boxes in it. Each grid is baked with several
//! seeds on one thread; noise is the standard deviation between them of the irradiance along the axes at the vertices that
//! light reaches, relative to its root mean square. Noise squared times processor time does not depend on the number of photons: the
//! less, the sooner any noise is reached. Time before the first photon is left out of it.

#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use std::path::PathBuf;

use clock::cpu_seconds;
use common::{AnyError, open, plan_of};
use ivg_bake::{BakeOptions, Estimator, Silent, bake};
use ivg_grid::IrradianceGrid;

#[allow(dead_code, unused_imports, reason = "shared with other examples")]
mod common;

#[path = "common/clock.rs"]
mod clock;

const ESTIMATORS: [Estimator; 2] = [Estimator::TrackLength, Estimator::FaceCrossing];

fn main() -> Result<(), AnyError> {
    let (mut scene, mut lights) = (None, None);
    let (mut grids, mut photons, mut seeds) = (vec![16u16, 32], 500_000u64, 4u64);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--lights" => lights = Some(PathBuf::from(value()?)),
            "--grids" => grids = value()?.split(',').map(str::parse).collect::<Result<_, _>>()?,
            "--photons" => photons = value()?.parse()?,
            "--seeds" => seeds = value()?.parse::<u64>()?.max(2),
            option if option.starts_with("--") => return Err(format!("unknown option {option}").into()),
            _ => scene = Some(PathBuf::from(argument)),
        }
    }
    let scene = open(scene.as_deref(), lights.as_deref())?;
    let flat = scene.flatten();
    let plan = plan_of(&scene);
    println!("{} triangles, {photons} photons, {seeds} seeds", flat.triangles.len());
    println!(
        "{:<16} {:<16} {:>10} {:>18} {:>20}",
        "vertices", "estimator", "noise", "photons [CPU-s]", "noise² x time [s]"
    );
    for n in grids {
        for estimator in ESTIMATORS {
            let baked = |photons, seed| -> Result<(IrradianceGrid, f64), AnyError> {
                let usual = BakeOptions::default();
                let options =
                    BakeOptions { dims: [n; 3], photons, seed, estimator, threads: Some(1), ..usual };
                let started = cpu_seconds();
                let grid = bake(&scene, &flat, &plan, &options, &Silent)?.grid;
                Ok((grid, cpu_seconds() - started))
            };
            let (_, before) = baked(1, 1)?;
            let runs: Vec<_> = (1..=seeds).map(|seed| baked(photons, seed)).collect::<Result<_, _>>()?;
            let mut seconds: Vec<f64> = runs.iter().map(|(_, seconds)| seconds - before).collect();
            seconds.sort_by(f64::total_cmp);
            let time = seconds[seconds.len() / 2];
            let grids: Vec<_> = runs.iter().map(|(grid, _)| grid).collect();
            let noise = noise(&grids);
            println!(
                "{:<16} {:<16} {:>8.2} % {time:>18.2} {:>20.3e}",
                format!("{n}³"),
                estimator.name(),
                100.0 * noise,
                noise * noise * time
            );
        }
    }
    Ok(())
}

/// Standard deviation between grids of the irradiance along the axes, relative to its root mean square.
fn noise(grids: &[&IrradianceGrid]) -> f64 {
    let (mut variance, mut signal) = (0.0, 0.0);
    for vertex in (0..grids[0].vertex_count()).filter(|&vertex| grids[0].is_valid(vertex)) {
        for n in 0..18 {
            let values: Vec<f64> =
                grids.iter().map(|grid| f64::from(grid.vectors()[vertex][n / 3][n % 3][n / 6])).collect();
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let squares = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
            variance += squares / (values.len() - 1) as f64;
            signal += mean * mean;
        }
    }
    (variance / signal).sqrt()
}
