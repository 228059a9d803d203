//! Prints how far bakes are from the path-traced oracle, for each estimator.
//!
//! ```text
//! cargo run --release -p ivg-bake --example oracle_error -- [SCENE] [--lights FILE] [--grid NXxNYxNZ]
//!     [--bounds x0,y0,z0,x1,y1,z1] [--photons N[,N...]] [--seeds N] [--vertices N] [--paths N] [--estimator NAME]
//!     [--surfaces] [--json FILE]
//! ```
//!
//! SCENE is anything `ivg` reads; without it, a closed box with a lit ceiling and two boxes in it. The vertices compared
//! are chosen evenly at random among those that light reaches and that are half a step or more from every surface; with
//! `--surfaces`, among those that light reaches and that are closer; the oracle is then asked a 32nd of a step nearer to the
//! middle of the grid, since a vertex may lie in a wall. Of all seeds the median is printed of
//!
//! * the root mean square error of all components of the six vectors, without the part that is the oracle's own, relative to
//!   the root mean square of the oracle's values,
//! * the same of the components along the hemispheres' axes (irradiance of axis-aligned surfaces),
//! * the mean of those axis components over the oracle's,
//! * the CPU time of a bake (one thread).
//!
//! `--json` writes the same, where the vertices are, and the oracle's vectors for them.

#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use std::path::PathBuf;

use clock::cpu_seconds;
use common::{AnyError, numbers, plan_of, vertices_at};
use glam::DVec3;
use ivg_bake::reference::{GatheredVectors, Oracle, Sampling};
use ivg_bake::{BakeOptions, Estimator, Silent, bake};

#[allow(dead_code, unused_imports, reason = "shared with other examples")]
mod common;

#[path = "common/clock.rs"]
mod clock;

struct Arguments {
    scene: Option<PathBuf>,
    lights: Option<PathBuf>,
    options: BakeOptions,
    photons: Vec<u64>,
    seeds: u64,
    estimators: Vec<Estimator>,
    vertices: usize,
    paths: u32,
    near_surfaces: bool,
    json: Option<PathBuf>,
}

fn main() -> Result<(), AnyError> {
    let arguments = parse(std::env::args().skip(1))?;
    let scene = common::open(arguments.scene.as_deref(), arguments.lights.as_deref())?;
    let flat = scene.flatten();
    let plan = plan_of(&scene);
    let oracle = Oracle::new(&scene, &flat)?;
    let options = BakeOptions { threads: Some(1), ..arguments.options.clone() };
    let lattice = options.lattice(&flat)?;

    let started = cpu_seconds();
    let few = BakeOptions { photons: 1, ..options.clone() };
    let surroundings = bake(&scene, &flat, &plan, &few, &Silent)?;
    let before_photons = cpu_seconds() - started;
    let vertices = vertices_at(&oracle, &surroundings.grid, arguments.near_surfaces, arguments.vertices);
    let last = DVec3::from(lattice.position(options.dims[0] - 1, options.dims[1] - 1, options.dims[2] - 1));
    let middle = (DVec3::from(lattice.origin) + last) * 0.5;
    let points: Vec<DVec3> = vertices
        .iter()
        .map(|&vertex| {
            let [i, j, k] = lattice.coords(vertex as u64);
            let position = DVec3::from(lattice.position(i, j, k));
            let aside = if arguments.near_surfaces { 1.0 / 32.0 } else { 0.0 };
            position + (middle - position).signum() * DVec3::from(lattice.step) * aside
        })
        .collect();
    let sampling = Sampling { paths: arguments.paths, seed: 99, threads: None };
    let truth = oracle.irradiance_vectors(&points, sampling, &Silent)?;
    println!(
        "{} triangles, {:?} vertices, {} compared, {} seeds; before the first photon {before_photons:.2} CPU-s",
        flat.triangles.len(),
        options.dims,
        points.len(),
        arguments.seeds
    );
    println!("oracle: {} paths a point, own error {:.2} %", arguments.paths, 100.0 * own_error(&truth));
    println!(
        "{:<22} {:>10} {:>10} {:>10} {:>8} {:>8}",
        "estimator", "photons", "all", "I_d.d", "mean", "CPU-s"
    );
    let mut rows = Vec::new();
    for &estimator in &arguments.estimators {
        for &photons in &arguments.photons {
            let mut errors = Vec::new();
            for seed in 1..=arguments.seeds {
                let options = BakeOptions { estimator, seed, photons, ..options.clone() };
                let started = cpu_seconds();
                let result = bake(&scene, &flat, &plan, &options, &Silent)?;
                let seconds = cpu_seconds() - started;
                let baked: Vec<_> = vertices.iter().map(|&v| result.grid.vectors()[v]).collect();
                let [all, axis, mean] = compare(&baked, &truth);
                errors.push([all, axis, mean, seconds]);
            }
            let row: [f64; 4] = core::array::from_fn(|n| median(errors.iter().map(|e| e[n]).collect()));
            let [all, axis, mean, seconds] = row;
            println!(
                "{:<22} {photons:>10} {:>8.2} % {:>8.2} % {mean:>8.4} {seconds:>8.2}",
                estimator.name(),
                100.0 * all,
                100.0 * axis
            );
            rows.push(format!(
                r#"{{"estimator": "{}", "photons": {photons}, "all": {all:?}, "axis": {axis:?}, "mean": {mean:?}, "cpu_seconds": {seconds:?}}}"#,
                estimator.name()
            ));
        }
    }
    if let Some(path) = &arguments.json {
        let places: Vec<[f64; 3]> = points.iter().map(|p| p.to_array()).collect();
        let vectors: Vec<_> = truth.iter().map(|t| t.vectors).collect();
        let errors: Vec<_> = truth.iter().map(|t| t.standard_error).collect();
        let text = format!(
            r#"{{"dims": {:?}, "lit": {}, "before_photons": {before_photons:?}, "own_error": {:?}, "points": {places:?}, "vectors": {vectors:?}, "standard_error": {errors:?}, "rows": [{}]}}"#,
            options.dims,
            surroundings.grid.valid_count(),
            own_error(&truth),
            rows.join(", ")
        );
        std::fs::write(path, text)?;
    }
    Ok(())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    if values.len() % 2 == 1 { values[half] } else { 0.5 * (values[half - 1] + values[half]) }
}

/// Root mean square of the standard errors over that of the values.
fn own_error(truth: &[GatheredVectors]) -> f64 {
    let square = |v: &[[[f64; 3]; 3]; 6]| v.as_flattened().as_flattened().iter().map(|x| x * x).sum::<f64>();
    let errors: f64 = truth.iter().map(|t| square(&t.standard_error)).sum();
    let values: f64 = truth.iter().map(|t| square(&t.vectors)).sum();
    (errors / values).sqrt()
}

/// Relative error of all components, of the axis components, both without the oracle's own, and the ratio of their means.
fn compare(baked: &[ivg_grid::HemisphereVectors], truth: &[GatheredVectors]) -> [f64; 3] {
    let [mut all, mut axis] = [[0.0; 2]; 2];
    let mut means = [0.0; 2];
    for (baked, truth) in baked.iter().zip(truth) {
        let found = baked.as_flattened().as_flattened();
        let expected = truth.vectors.as_flattened().as_flattened();
        let own = truth.standard_error.as_flattened().as_flattened();
        for (n, ((&found, &expected), own)) in found.iter().zip(expected).zip(own).enumerate() {
            let found = f64::from(found);
            let square = (found - expected).powi(2) - own * own;
            all[0] += square;
            all[1] += expected.powi(2);
            // The component n % 3 of the hemisphere n / 9, whose axis is half its number.
            if n % 3 == n / 9 / 2 {
                axis[0] += square;
                axis[1] += expected.powi(2);
                means[0] += found.abs();
                means[1] += expected.abs();
            }
        }
    }
    let relative = |[square, signal]: [f64; 2]| (square.max(0.0) / signal).sqrt();
    [relative(all), relative(axis), means[0] / means[1]]
}

fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Arguments, AnyError> {
    let mut parsed = Arguments {
        scene: None,
        lights: None,
        options: BakeOptions::default(),
        photons: vec![BakeOptions::default().photons],
        seeds: 8,
        estimators: Estimator::ALL.into(),
        vertices: 32,
        paths: 65_536,
        near_surfaces: false,
        json: None,
    };
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--lights" => parsed.lights = Some(value()?.into()),
            "--grid" => parsed.options.dims = numbers(&value()?, 'x')?,
            "--bounds" => {
                let [x0, y0, z0, x1, y1, z1] = numbers(&value()?, ',')?;
                parsed.options.bounds = Some((DVec3::new(x0, y0, z0), DVec3::new(x1, y1, z1)));
            }
            "--photons" => {
                parsed.photons = value()?.split(',').map(str::parse).collect::<Result<_, _>>()?;
            }
            "--estimator" => {
                let name = value()?;
                let estimator = Estimator::from_name(&name).ok_or_else(|| format!("no estimator {name}"))?;
                parsed.estimators = vec![estimator];
            }
            "--seeds" => parsed.seeds = value()?.parse()?,
            "--vertices" => parsed.vertices = value()?.parse()?,
            "--paths" => parsed.paths = value()?.parse()?,
            "--surfaces" => parsed.near_surfaces = true,
            "--json" => parsed.json = Some(value()?.into()),
            option if option.starts_with("--") => return Err(format!("unknown option {option}").into()),
            _ => parsed.scene = Some(argument.into()),
        }
    }
    if parsed.seeds == 0 || parsed.vertices == 0 || parsed.paths < 2 {
        return Err("--seeds and --vertices must be at least 1, --paths at least 2".into());
    }
    Ok(parsed)
}
