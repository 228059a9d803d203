//! Prints how bright surfaces are that are lit from a baked grid, against what paths find there.
//!
//! ```text
//! cargo run --release -p ivg-bake --example brightness -- [SCENE] [--lights FILE] [--grid NXxNYxNZ]
//!     [--bounds x0,y0,z0,x1,y1,z1] [--photons N] [--accuracy PERCENT] [--bounces N] [--estimator NAME]
//!     [--radiance] [--exact] [--baked FILE.ivg] [--places N] [--paths N] [--boxes N] [--worst N]
//! ```
//!
//! SCENE is anything `ivg` reads; without it, a closed box with a lit ceiling and two boxes in it. It is baked with all the
//! effects that it calls for, which the traced paths have too. The grid goes through a file in the default encoding and is looked
//! up as clients do, from three vectors; with `--exact` it is used as it was baked, from six; with `--radiance` it holds spherical
//! harmonics. With `--baked` nothing is baked: the grid is that of a file. Only indirect light is compared.
//!
//! Places are pixels of pictures taken everywhere where the grid has light (see `Oracle::brightness`), so that each counts as much as
//! it is seen. Of all together and of those in each of `--boxes`³ parts of the grid is printed: places compared, the mean
//! traced irradiance, baked over traced, and the standard error of that. How far a part is off is relative to its own light, or to
//! 1.7 % of the mean if that is more: less does not show in a picture of 8 bits. A part is within or beyond 10 % only if it is so by
//! three standard errors; of others these places and paths cannot tell, which is printed too. Parts with less than a thousandth of
//! the places are counted together. `--worst` lists so many places whose irradiance is farthest off.

#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use arguments::SceneArguments;
use common::{AnyError, open, plan_of};
use ivg_bake::reference::{Brightness, DARKEST, LitPlace, Oracle, Sampling, brightness_of};
use ivg_bake::{BakeOptions, Estimator, Silent, bake};
use ivg_format::{EncodeOptions, Limits, encode};
use ivg_grid::{IrradianceGrid, Quantity, Reconstruction};

#[allow(dead_code, reason = "each example uses a part")]
mod common;

#[path = "common/arguments.rs"]
mod arguments;

/// Share of the places below which parts are counted together.
const RARE: f64 = 1e-3;

/// How far a part may be off.
const MOST_OFF: f64 = 0.1;

/// Standard errors by which a part is within or beyond that: by chance one of 740 parts that are neither.
const ERRORS: f64 = 3.0;

/// How clients look up a file in the default encoding.
fn as_clients_do(quantity: Quantity) -> Reconstruction {
    match quantity {
        Quantity::Vectors => Reconstruction::ThreeVector,
        Quantity::Radiance => Reconstruction::Harmonics,
    }
}

fn main() -> Result<(), AnyError> {
    let usual = BakeOptions { dims: [32; 3], photons: 4_000_000, ..BakeOptions::default() };
    let (mut accuracy, mut bounces, mut estimator, mut quantity) =
        (None::<f64>, None, usual.estimator, usual.quantity);
    let (mut places, mut boxes, mut exact, mut worst) = (20_000, 3, false, 0);
    let mut file = None::<std::path::PathBuf>;
    let mut sampling = Sampling { paths: 64, seed: 7, threads: None };
    let SceneArguments { scene, lights, mut options } = SceneArguments::read(usual, |name, value| {
        match name {
            "--accuracy" => accuracy = Some(value()?.trim_end_matches('%').parse()?),
            "--bounces" => bounces = Some(value()?.parse()?),
            "--estimator" => {
                let name = value()?;
                estimator = Estimator::from_name(&name).ok_or_else(|| format!("no estimator {name}"))?;
            }
            "--radiance" => quantity = Quantity::Radiance,
            "--places" => places = value()?.parse()?,
            "--paths" => sampling.paths = value()?.parse()?,
            "--exact" => exact = true,
            "--baked" => file = Some(value()?.into()),
            "--worst" => worst = value()?.parse()?,
            "--boxes" => boxes = value()?.parse()?,
            _ => return Ok(false),
        }
        Ok(true)
    })?;
    (options.estimator, options.quantity) = (estimator, quantity);
    if let Some(percent) = accuracy {
        (options.accuracy, options.photons) = (Some(percent / 100.0), 1 << 33);
    }
    let scene = open(scene.as_deref(), lights.as_deref())?;
    let flat = scene.flatten();
    let oracle = Oracle::new(&scene, &flat)?;
    let (grid, reconstruction, photons) = if let Some(file) = file {
        let (grid, _) = IrradianceGrid::from_file(&std::fs::read(file)?, &Limits::default())?;
        let of_file = as_clients_do(grid.quantity());
        (grid, of_file, None)
    } else {
        let mut plan = plan_of(&scene);
        plan.max_bounces = bounces.unwrap_or(plan.max_bounces);
        let baked = bake(&scene, &flat, &plan, &options, &Silent)?;
        let photons = Some(baked.stats.photons);
        if exact {
            let of_bake = match quantity {
                Quantity::Vectors => Reconstruction::SixVector,
                Quantity::Radiance => Reconstruction::Harmonics,
            };
            (baked.grid, of_bake, photons)
        } else {
            let file = encode(&baked.grid.as_source(), &EncodeOptions::new())?;
            (IrradianceGrid::from_file(&file, &Limits::default())?.0, as_clients_do(quantity), photons)
        }
    };
    let found = oracle.lit_places(&grid, reconstruction, places, sampling, &Silent)?;
    let all = brightness_of(&found, grid.lattice(), boxes);
    let Some((whole, parts)) = all.split_first() else { return Err("no surface has any light".into()) };
    let photons = photons.map_or(String::new(), |photons| format!(", {photons} photons"));
    println!("{} triangles, {:?} vertices{photons}", flat.triangles.len(), grid.lattice().dims);
    println!("{:<44} {:>7} {:>10} {:>8} {:>8}", "part [m]", "places", "W/m²", "ratio", "error");
    let line = |name: String, part: &Brightness| {
        println!(
            "{name:<44} {:>7} {:>10.4} {:>8.4} {:>8.4}",
            part.places, part.traced, part.ratio, part.error
        );
    };
    line("all".into(), whole);
    let (often, rare): (Vec<&Brightness>, Vec<&Brightness>) =
        parts.iter().partition(|part| part.places as f64 >= RARE * whole.places as f64);
    for part in &often {
        let corner = |p: glam::DVec3| format!("{:.2} {:.2} {:.2}", p.x, p.y, p.z);
        line(format!("{} to {}", corner(part.low), corner(part.high)), part);
    }
    let farthest = often.iter().map(|part| part.off(whole.traced)).fold(0.0, f64::max);
    println!(
        "the farthest of {} parts is off by {:.1} % (of {:.4} W/m² at least); {} more have {:.2} % of the places",
        often.len(),
        100.0 * farthest,
        DARKEST * whole.traced,
        rare.len(),
        100.0 * rare.iter().map(|part| part.places as f64).sum::<f64>() / whole.places as f64
    );
    let off_by =
        |part: &&&Brightness, errors: f64| part.off(whole.traced) + errors * part.off_error(whole.traced);
    let within = often.iter().filter(|part| off_by(part, ERRORS) <= MOST_OFF).count();
    let beyond = often.iter().filter(|part| off_by(part, -ERRORS) > MOST_OFF).count();
    println!(
        "by {ERRORS} standard errors {within} parts are within {:.0} %, {beyond} beyond; of {} these places cannot tell",
        100.0 * MOST_OFF,
        often.len() - within - beyond
    );
    let mut seen = found;
    let off = |place: &LitPlace| (place.baked - place.traced).abs();
    seen.sort_by(|a, b| off(b).total_cmp(&off(a)));
    for LitPlace { point: p, normal: n, baked, traced, error, .. } in seen.iter().take(worst) {
        println!(
            "at {:.3} {:.3} {:.3} facing {:+.2} {:+.2} {:+.2}: baked {baked:.4}, traced {traced:.4} ± {error:.4} W/m²",
            p.x, p.y, p.z, n.x, n.y, n.z
        );
    }
    Ok(())
}
