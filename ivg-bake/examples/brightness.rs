//! Prints how bright surfaces are that are lit from a baked grid, against what paths find there.
//!
//! ```text
//! cargo run --release -p ivg-bake --example brightness -- [SCENE] [--lights FILE] [--grid NXxNYxNZ]
//!     [--photons N] [--accuracy PERCENT] [--places N] [--paths N] [--boxes N] [--exact] [--worst N]
//! ```
//!
//! SCENE is anything `ivg` reads; without it, a closed box with a lit ceiling and two boxes in it. The grid goes through a file in
//! the default encoding and is looked up as clients do, from three vectors; with `--exact` it is used as it was baked, from
//! six. Only indirect light is compared. Places count that a valid vertex sees which is one of the 4 × 4 × 4 around them: not the insides of
//! scanned models nor the floor under them, where no camera comes; how many are left out, and how much light they have, is said. Of all surfaces together and of those in each of
//! `--boxes`³ parts of the grid is printed: places compared, the mean traced irradiance, baked over traced, and the
//! standard error of that. Parts in the last line have less than a thousandth of the light. `--worst` lists so many places
//! whose irradiance is farthest off, and as many of those left out that have the most light.

#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use std::path::PathBuf;

use common::{AnyError, numbers, open, plan_of};
use ivg_bake::reference::{Brightness, LitPlace, Oracle, Sampling, brightness_of};
use ivg_bake::{BakeOptions, Silent, bake};
use ivg_format::{EncodeOptions, Limits, encode};
use ivg_grid::{IrradianceGrid, Reconstruction};

#[allow(dead_code, reason = "each example uses a part")]
mod common;

/// Share of the light below which parts are counted together.
const DARK: f64 = 1e-3;

fn main() -> Result<(), AnyError> {
    let (mut scene, mut lights) = (None::<PathBuf>, None::<PathBuf>);
    let mut options = BakeOptions { dims: [32; 3], photons: 4_000_000, ..BakeOptions::default() };
    let (mut places, mut boxes, mut exact, mut worst) = (20_000, 3, false, 0);
    let mut sampling = Sampling { paths: 64, seed: 7, threads: None };
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--lights" => lights = Some(value()?.into()),
            "--grid" => options.dims = numbers(&value()?, 'x')?,
            "--photons" => options.photons = value()?.parse()?,
            "--accuracy" => {
                let percent: f64 = value()?.trim_end_matches('%').parse()?;
                (options.accuracy, options.photons) = (Some(percent / 100.0), 1 << 33);
            }
            "--places" => places = value()?.parse()?,
            "--paths" => sampling.paths = value()?.parse()?,
            "--exact" => exact = true,
            "--worst" => worst = value()?.parse()?,
            "--boxes" => boxes = value()?.parse()?,
            option if option.starts_with("--") => return Err(format!("unknown option {option}").into()),
            _ => scene = Some(argument.into()),
        }
    }
    let scene = open(scene.as_deref(), lights.as_deref())?;
    let flat = scene.flatten();
    let baked = bake(&scene, &flat, &plan_of(&scene), &options, &Silent)?;
    let oracle = Oracle::new(&scene, &flat)?;
    let (grid, reconstruction) = if exact {
        (baked.grid, Reconstruction::SixVector)
    } else {
        let file = encode(&baked.grid.as_source(), &EncodeOptions::new())?;
        (IrradianceGrid::from_file(&file, &Limits::default())?.0, Reconstruction::ThreeVector)
    };
    let found = oracle.lit_places(&grid, reconstruction, places, sampling, &Silent)?;
    let all = brightness_of(&found, grid.lattice(), boxes);
    let Some((whole, parts)) = all.split_first() else { return Err("no surface has any light".into()) };
    println!(
        "{} triangles, {:?} vertices, {} photons",
        flat.triangles.len(),
        options.dims,
        baked.stats.photons
    );
    println!("{:<44} {:>7} {:>10} {:>8} {:>8}", "part [m]", "places", "W/m²", "ratio", "error");
    let light = |part: &Brightness| part.traced * part.places as f64;
    let line = |name: String, part: &Brightness| {
        println!(
            "{name:<44} {:>7} {:>10.4} {:>8.4} {:>8.4}",
            part.places, part.traced, part.ratio, part.error
        );
    };
    line("all".into(), whole);
    let (bright, dark): (Vec<&Brightness>, Vec<&Brightness>) =
        parts.iter().partition(|part| light(part) >= DARK * light(whole));
    for part in &bright {
        let corner = |p: glam::DVec3| format!("{:.2} {:.2} {:.2}", p.x, p.y, p.z);
        line(format!("{} to {}", corner(part.low), corner(part.high)), part);
    }
    let farthest = bright.iter().map(|part| (part.ratio - 1.0).abs()).fold(0.0, f64::max);
    println!(
        "the farthest of {} parts is off by {:.1} %; {} more have together {:.2} % of the light",
        bright.len(),
        100.0 * farthest,
        dark.len(),
        100.0 * dark.iter().fold(0.0, |sum, part| sum + light(part)) / light(whole)
    );
    let (mut seen, mut hidden): (Vec<LitPlace>, Vec<LitPlace>) = found.iter().partition(|place| place.seen);
    let total = |places: &[LitPlace]| places.iter().fold(0.0, |sum, place| sum + place.traced);
    println!(
        "{} places that no vertex sees, with {:.3} % of the light, are left out",
        hidden.len(),
        100.0 * total(&hidden) / total(&found)
    );
    let off = |place: &LitPlace| (place.baked - place.traced).abs();
    seen.sort_by(|a, b| off(b).total_cmp(&off(a)));
    hidden.sort_by(|a, b| b.traced.total_cmp(&a.traced));
    for (name, places) in [("at", seen), ("left out, at", hidden)] {
        for LitPlace { point: p, normal: n, baked, traced, error, .. } in places.iter().take(worst) {
            println!(
                "{name} {:.3} {:.3} {:.3} facing {:+.2} {:+.2} {:+.2}: baked {baked:.4}, traced {traced:.4} ± {error:.4} W/m²",
                p.x, p.y, p.z, n.x, n.y, n.z
            );
        }
    }
    Ok(())
}
