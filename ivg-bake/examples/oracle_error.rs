//! Prints how far bakes are from the path-traced oracle, for each estimator.
//!
//! ```text
//! cargo run --release -p ivg-bake --example oracle_error -- [SCENE] [--lights FILE] [--grid NXxNYxNZ]
//!     [--bounds x0,y0,z0,x1,y1,z1] [--photons N] [--seeds N] [--vertices N] [--paths N] [--estimator NAME]
//!     [--surfaces]
//! ```
//!
//! SCENE is anything `ivg` reads; without it, a closed box with a lit ceiling and two boxes in it. The vertices compared
//! are chosen evenly at random among those that light reaches and that are half a step or more from every surface; with
//! `--surfaces`, among those that light reaches and that are closer; the oracle is then asked a 32nd of a step nearer to the
//! middle of the grid, since a vertex may lie in a wall. Of all seeds the median is printed of
//!
//! * the root mean square error of all components of the six vectors, relative to the root mean square of the oracle's,
//! * the same of the components along the hemispheres' axes (irradiance of axis-aligned surfaces),
//! * the mean of those axis components over the oracle's,
//! * the CPU time of a bake (one thread).

#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use std::path::PathBuf;
use std::time::Instant;

use glam::{DVec3, Vec3};
use ivg_bake::reference::{GatheredVectors, Oracle, Sampling};
use ivg_bake::{BakeOptions, Estimator, Silent, bake};
use ivg_scene::import::{self, ImportOptions};
use ivg_scene::{Effect, EffectPlan, Material, Mesh, Need, Node, PlannedEffect, Scene};

type AnyError = Box<dyn std::error::Error>;

struct Arguments {
    scene: Option<PathBuf>,
    lights: Option<PathBuf>,
    options: BakeOptions,
    seeds: u64,
    estimators: Vec<Estimator>,
    vertices: usize,
    paths: u32,
    near_surfaces: bool,
}

fn main() -> Result<(), AnyError> {
    let arguments = parse(std::env::args().skip(1))?;
    let scene = match &arguments.scene {
        Some(path) => import::load(path, &ImportOptions { lights: arguments.lights.clone() })?,
        None => lit_box(),
    };
    let flat = scene.flatten();
    let plan = plan_of(&scene);
    let oracle = Oracle::new(&scene, &flat)?;
    let options = BakeOptions { threads: Some(1), ..arguments.options.clone() };
    let lattice = options.lattice(&flat)?;

    let started = cpu_seconds();
    let few = BakeOptions { photons: 1, ..options.clone() };
    let surroundings = bake(&scene, &flat, &plan, &few, &Silent)?;
    let before_photons = cpu_seconds() - started;
    let vertices = choose(&arguments, &oracle, &surroundings.grid);
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
        "{} triangles, {:?} vertices, {} compared, {} photons, {} seeds; before the first photon {before_photons:.2} CPU-s",
        flat.triangles.len(),
        options.dims,
        points.len(),
        options.photons,
        arguments.seeds
    );
    println!("oracle: {} paths a point, own error {:.2} %", arguments.paths, 100.0 * own_error(&truth));
    println!("{:<22} {:>10} {:>10} {:>8} {:>8}", "estimator", "all", "I_d.d", "mean", "CPU-s");
    for &estimator in &arguments.estimators {
        let mut errors = Vec::new();
        for seed in 1..=arguments.seeds {
            let options = BakeOptions { estimator, seed, ..options.clone() };
            let started = cpu_seconds();
            let result = bake(&scene, &flat, &plan, &options, &Silent)?;
            let seconds = cpu_seconds() - started;
            let baked: Vec<_> = vertices.iter().map(|&v| result.grid.vectors()[v]).collect();
            let [all, axis, mean] = compare(&baked, &truth);
            errors.push([all, axis, mean, seconds]);
        }
        let median = |n: usize| {
            let mut values: Vec<f64> = errors.iter().map(|e| e[n]).collect();
            values.sort_by(f64::total_cmp);
            let half = values.len() / 2;
            if values.len() % 2 == 1 { values[half] } else { 0.5 * (values[half - 1] + values[half]) }
        };
        println!(
            "{:<22} {:>8.2} % {:>8.2} % {:>8.4} {:>8.2}",
            estimator.name(),
            100.0 * median(0),
            100.0 * median(1),
            median(2),
            median(3)
        );
    }
    Ok(())
}

/// Root mean square of the standard errors over that of the values.
fn own_error(truth: &[GatheredVectors]) -> f64 {
    let square = |v: &[[[f64; 3]; 3]; 6]| v.as_flattened().as_flattened().iter().map(|x| x * x).sum::<f64>();
    let errors: f64 = truth.iter().map(|t| square(&t.standard_error)).sum();
    let values: f64 = truth.iter().map(|t| square(&t.vectors)).sum();
    (errors / values).sqrt()
}

/// Relative error of all components, of the axis components, and the ratio of their means.
fn compare(baked: &[ivg_grid::HemisphereVectors], truth: &[GatheredVectors]) -> [f64; 3] {
    let [mut all, mut axis] = [[0.0; 2]; 2];
    let mut means = [0.0; 2];
    for (baked, truth) in baked.iter().zip(truth) {
        let found = baked.as_flattened().as_flattened();
        let expected = truth.vectors.as_flattened().as_flattened();
        for (n, (&found, &expected)) in found.iter().zip(expected).enumerate() {
            let found = f64::from(found);
            all[0] += (found - expected).powi(2);
            all[1] += expected.powi(2);
            // The component n % 3 of the hemisphere n / 9, whose axis is half its number.
            if n % 3 == n / 9 / 2 {
                axis[0] += (found - expected).powi(2);
                axis[1] += expected.powi(2);
                means[0] += found.abs();
                means[1] += expected.abs();
            }
        }
    }
    [(all[0] / all[1]).sqrt(), (axis[0] / axis[1]).sqrt(), means[0] / means[1]]
}

/// Vertices to compare, in an order scattered over the lattice.
fn choose(arguments: &Arguments, oracle: &Oracle<'_>, grid: &ivg_grid::IrradianceGrid) -> Vec<usize> {
    let lattice = grid.lattice();
    let half_step = 0.5 * lattice.step.into_iter().filter(|&s| s > 0.0).fold(f64::INFINITY, f64::min);
    let count = grid.vertex_count();
    // Multiples of the golden ratio's fraction scatter evenly; a stride coprime to the count visits every vertex once.
    let mut stride = (count as f64 * 0.618_033_988_749_895) as usize | 1;
    while gcd(stride, count) != 1 {
        stride += 2;
    }
    (0..count)
        .map(|n| n * stride % count)
        .filter(|&vertex| {
            let [i, j, k] = lattice.coords(vertex as u64);
            let near = || oracle.clearance(lattice.position(i, j, k).into()) < half_step;
            grid.is_valid(vertex) && near() == arguments.near_surfaces
        })
        .take(arguments.vertices)
        .collect()
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// CPU time of this thread \[s\] where Linux tells it, else the time since the first call.
fn cpu_seconds() -> f64 {
    static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    let wall = || START.get_or_init(Instant::now).elapsed().as_secs_f64();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = text.and_then(|t| t.split_whitespace().next().and_then(|n| n.parse::<f64>().ok()));
    nanoseconds.map_or_else(wall, |n| n * 1e-9)
}

/// Diffuse indirect light, and textures and sky where the scene has them.
fn plan_of(scene: &Scene) -> EffectPlan {
    let planned = |effect, needed| PlannedEffect {
        effect,
        need: if needed { Need::Needed } else { Need::NotNeeded },
        reason: String::new(),
        cost: None,
    };
    EffectPlan {
        effects: vec![
            planned(Effect::DiffuseIndirect, true),
            planned(Effect::Textures, !scene.textures.is_empty()),
            planned(Effect::Sky, scene.sky.is_some()),
        ],
        max_bounces: 64,
        energy_cutoff: 1e-3,
    }
}

/// A closed room of 2 m with two coloured walls, two boxes on its floor and a lit square under its ceiling.
fn lit_box() -> Scene {
    let mut mesh = Mesh { name: "room".into(), ..Mesh::default() };
    let mut add = |corner: [f32; 3], u: [f32; 3], v: [f32; 3], material: u32| {
        let [corner, u, v] = [corner, u, v].map(Vec3::from);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([corner, corner + u, corner + u + v, corner + v]);
        mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        mesh.triangle_materials.extend([material; 2]);
    };
    let mut add_box = |[x, y, z]: [f32; 3], [sx, sy, sz]: [f32; 3], materials: [u32; 6]| {
        add([x, y, z], [0.0, 0.0, sz], [0.0, sy, 0.0], materials[0]);
        add([x + sx, y, z], [0.0, sy, 0.0], [0.0, 0.0, sz], materials[1]);
        add([x, y, z], [sx, 0.0, 0.0], [0.0, 0.0, sz], materials[2]);
        add([x, y + sy, z], [0.0, 0.0, sz], [sx, 0.0, 0.0], materials[3]);
        add([x, y, z], [0.0, sy, 0.0], [sx, 0.0, 0.0], materials[4]);
        add([x, y, z + sz], [sx, 0.0, 0.0], [0.0, sy, 0.0], materials[5]);
    };
    add_box([0.0; 3], [2.0; 3], [1, 2, 0, 0, 0, 0]);
    add_box([0.3, 0.0, 0.4], [0.6, 1.2, 0.6], [0; 6]);
    add_box([1.1, 0.0, 0.9], [0.6, 0.6, 0.6], [0; 6]);
    // Counter-clockwise from below: the square shines down.
    add([0.7, 1.95, 0.7], [0.6, 0.0, 0.0], [0.0, 0.0, 0.6], 3);
    let colour = |name: &str, albedo: [f32; 3]| Material {
        name: name.into(),
        albedo: albedo.into(),
        ..Material::default()
    };
    let light =
        Material { emission: Vec3::new(18.0, 14.0, 7.0), two_sided: false, ..colour("light", [0.0; 3]) };
    Scene {
        name: "lit box".into(),
        meshes: vec![mesh],
        nodes: vec![Node { name: "box".into(), mesh: 0, transform: glam::DAffine3::IDENTITY }],
        materials: vec![
            colour("white", [0.75; 3]),
            colour("red", [0.6, 0.05, 0.05]),
            colour("green", [0.1, 0.4, 0.1]),
            light,
        ],
        ..Scene::default()
    }
}

fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Arguments, AnyError> {
    let mut parsed = Arguments {
        scene: None,
        lights: None,
        options: BakeOptions::default(),
        seeds: 8,
        estimators: Estimator::ALL.into(),
        vertices: 32,
        paths: 65_536,
        near_surfaces: false,
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
            "--photons" => parsed.options.photons = value()?.parse()?,
            "--estimator" => {
                let name = value()?;
                let estimator = Estimator::from_name(&name).ok_or_else(|| format!("no estimator {name}"))?;
                parsed.estimators = vec![estimator];
            }
            "--seeds" => parsed.seeds = value()?.parse()?,
            "--vertices" => parsed.vertices = value()?.parse()?,
            "--paths" => parsed.paths = value()?.parse()?,
            "--surfaces" => parsed.near_surfaces = true,
            option if option.starts_with("--") => return Err(format!("unknown option {option}").into()),
            _ => parsed.scene = Some(argument.into()),
        }
    }
    if parsed.seeds == 0 || parsed.vertices == 0 || parsed.paths < 2 {
        return Err("--seeds and --vertices must be at least 1, --paths at least 2".into());
    }
    Ok(parsed)
}

/// `N` numbers between separators.
fn numbers<T: std::str::FromStr, const N: usize>(text: &str, separator: char) -> Result<[T; N], AnyError>
where
    T::Err: std::error::Error + 'static,
{
    let numbers: Vec<T> = text.split(separator).map(str::parse).collect::<Result<_, _>>()?;
    numbers.try_into().map_err(|_| format!("{text}: {N} numbers separated by {separator} are needed").into())
}
