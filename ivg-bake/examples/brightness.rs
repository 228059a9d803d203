//! Prints how bright surfaces are that are lit from a baked grid, against what paths find there.
//!
//! ```text
//! cargo run --release -p ivg-bake --example brightness -- [SCENE] [--lights FILE] [--grid NXxNYxNZ]
//!     [--photons N] [--accuracy PERCENT] [--places N] [--paths N] [--boxes N] [--exact]
//! ```
//!
//! SCENE is anything `ivg` reads; without it, a closed box with a lit ceiling and two boxes in it. The grid goes through a file in
//! the default encoding and is looked up as clients do, from three vectors; with `--exact` it is used as it was baked, from
//! six. Only indirect light is compared. Of all surfaces together and of those in each of
//! `--boxes`³ parts of the grid is printed: places compared, the mean traced irradiance, baked over traced, and the
//! standard error of that. Parts in the last line have less than a thousandth of the light.

#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use std::path::PathBuf;

use common::{AnyError, numbers, open, plan_of};
use ivg_bake::reference::{Brightness, Oracle, Sampling};
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
    let (mut places, mut boxes, mut exact) = (20_000, 3, false);
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
    let all = oracle.brightness(&grid, reconstruction, (places, boxes), sampling, &Silent)?;
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
        100.0 * dark.iter().map(|part| light(part)).sum::<f64>() / light(whole)
    );
    Ok(())
}
