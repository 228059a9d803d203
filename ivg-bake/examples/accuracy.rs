//! Prints how accurate each encoding is on a baked grid, with each reconstruction that it allows.
//!
//! ```text
//! cargo run --release -p ivg-bake --example accuracy -- [SCENE] [--lights FILE] [--grid NXxNYxNZ]
//!     [--bounds x0,y0,z0,x1,y1,z1] [--photons N] [--seed N] [--vertices N] [--normals N] [--paths N]
//! ```
//!
//! SCENE is anything `ivg` reads; without it, a closed box with a lit ceiling and two boxes in it. Compared are vertices that
//! light reaches and that are half a step or more from every surface, chosen evenly at random, each with the same
//! evenly spread normals, against the irradiance that the oracle gathers there. The grid goes through a file: encoded, decoded.
//!
//! Errors are root mean squares over vertices, normals and channels, relative to the root mean square of the irradiance (the
//! first lines also say how much larger that is than the mean); the bias is relative to the mean. What is off comes from three
//! places, which add up about in squares:
//!
//! * `formula`: the reconstruction itself, evaluated on what the oracle gathered. The same paths give the irradiance it is
//!   compared with, so that their noise all but cancels;
//! * `bake`: averaging over dual cells, and noise: the reconstruction of what was baked against that of what was gathered;
//! * `stored`: the encoding: the reconstruction of what comes out of the file against that of what was baked.
//!
//! The oracle's own variance is subtracted from `error` and `bake`, which are independent of it. The rows below the line are
//! other forms made from the same bake, with their bytes in binary16; nothing is rounded.
//!
//! A second table tells what the mode costs that filters directions and colours apart ([`ivg_grid::SeparateTextures`]).

#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use std::path::PathBuf;
use std::time::Instant;

use common::{AnyError, numbers, plan_of, vertices_at};
use glam::{DVec3, Vec3};
use ivg_bake::reference::{GatheredLight, Oracle, Sampling};
use ivg_bake::{BakeOptions, Silent, bake};
use ivg_format::{EncodeOptions, Encoding, Limits, encode};
use ivg_grid::integrate::fibonacci_sphere;
use ivg_grid::{
    FillOptions, IrradianceError, IrradianceGrid, Quantity, Reconstruction, SeparateTextures, SpatialFilter,
    VertexValues, alternatives, fill, harmonics, reconstruct_signed,
};

mod common;

struct Arguments {
    scene: Option<PathBuf>,
    lights: Option<PathBuf>,
    options: BakeOptions,
    vertices: usize,
    normals: usize,
    paths: u32,
}

fn main() -> Result<(), AnyError> {
    let arguments = parse(std::env::args().skip(1))?;
    let scene = common::open(arguments.scene.as_deref(), arguments.lights.as_deref())?;
    let flat = scene.flatten();
    let plan = plan_of(&scene);
    println!(
        "{} triangles, {:?} vertices, {} photons",
        flat.triangles.len(),
        arguments.options.dims,
        arguments.options.photons
    );
    let baked = |quantity: Quantity| -> Result<IrradianceGrid, AnyError> {
        let started = Instant::now();
        let options = BakeOptions { quantity, ..arguments.options.clone() };
        let grid = bake(&scene, &flat, &plan, &options, &Silent)?.grid;
        println!("{} baked in {:.1} s", quantity.name(), started.elapsed().as_secs_f64());
        Ok(grid)
    };
    let grids = [baked(Quantity::Vectors)?, baked(Quantity::Radiance)?];
    let oracle = Oracle::new(&scene, &flat)?;
    let compared = Compared::new(&oracle, &grids[0], &arguments)?;
    compared.print_own_error(arguments.paths);

    println!(
        "\n{:<14} {:<10} {:>5} {:>8} {:>8} {:>9} {:>8} {:>8}",
        "stored as", "evaluated", "bytes", "error", "bias", "formula", "bake", "stored"
    );
    for &encoding in Encoding::ALL {
        let grid = &grids[usize::from(encoding.quantity() == Quantity::Radiance)];
        let file = encode(&grid.as_source(), &EncodeOptions { encoding, ..EncodeOptions::new() })?;
        let (decoded, _) = IrradianceGrid::from_file(&file, &Limits::default())?;
        for method in Reconstruction::ALL.into_iter().filter(|m| m.fits(encoding.quantity())) {
            let form = |values: &VertexValues, n| match values {
                VertexValues::Vectors(vectors) => reconstruct_signed(method, vectors, n),
                VertexValues::Radiance(radiance) => harmonics::irradiance_signed(radiance, n),
            };
            let bytes = encoding.bytes_per_vertex();
            compared.print_row(encoding.name(), method.name(), bytes, grid, &decoded, form);
        }
    }
    println!("{}", "-".repeat(78));
    for (name, numbers, form) in FORMS {
        let grid = &grids[usize::from(name != "ambient cube")];
        compared.print_row(name, "", 2 * numbers, grid, grid, form);
    }
    print_separate(&grids[0])
}

/// An irradiance from the values of a vertex, before the cut at zero.
type Form = fn(&VertexValues, Vec3) -> Vec3;

/// Other forms of the same light and how many numbers they take.
const FORMS: [(&str, u64, Form); 4] = [
    ("ambient cube", 18, |values, n| match values {
        VertexValues::Vectors(vectors) => alternatives::ambient_cube(vectors, n),
        VertexValues::Radiance(radiance) => {
            alternatives::ambient_cube(&harmonics::hemisphere_vectors(radiance), n)
        }
    }),
    ("SH L1", 12, |values, n| alternatives::linear_harmonics(radiance_of(values), n)),
    ("ZH3", 15, |values, n| alternatives::zonal_harmonics(radiance_of(values), n)),
    ("SH L2", 27, |values, n| harmonics::irradiance_signed(radiance_of(values), n)),
];

fn radiance_of(values: &VertexValues) -> &ivg_grid::RadianceHarmonics {
    match values {
        VertexValues::Radiance(radiance) => radiance,
        VertexValues::Vectors(_) => unreachable!("harmonics are evaluated on the grid of radiance"),
    }
}

/// Vertices with their gathered light.
struct Compared {
    vertices: Vec<usize>,
    truth: Vec<GatheredLight>,
    normals: Vec<Vec3>,
    /// Mean squared standard error of the irradiance \[(W/m²)²\].
    noise: f64,
    /// Root mean square and mean of the irradiance \[W/m²\].
    level: [f64; 2],
}

impl Compared {
    fn new(oracle: &Oracle<'_>, grid: &IrradianceGrid, arguments: &Arguments) -> Result<Self, AnyError> {
        let vertices = vertices_at(oracle, grid, false, arguments.vertices);
        if vertices.is_empty() {
            return Err("no vertex is half a step or more from every surface; give a finer --grid".into());
        }
        let points: Vec<DVec3> = vertices
            .iter()
            .map(|&vertex| {
                let [i, j, k] = grid.lattice().coords(vertex as u64);
                grid.lattice().position(i, j, k).into()
            })
            .collect();
        let normals: Vec<Vec3> = fibonacci_sphere(arguments.normals).iter().map(|n| n.as_vec3()).collect();
        let sampling = Sampling { paths: arguments.paths, seed: 99, threads: arguments.options.threads };
        let truth = oracle.light(&points, &normals, sampling, &Silent)?;
        let count = (3 * truth.len() * normals.len()) as f64;
        let mean = |value: &dyn Fn(&GatheredLight) -> f64| truth.iter().map(value).sum::<f64>() / count;
        let noise = mean(&|t| t.irradiance_error.iter().map(|e| e.length_squared()).sum());
        let square = mean(&|t| t.irradiance.iter().map(|e| e.length_squared()).sum());
        let level = [square.sqrt(), mean(&|t| t.irradiance.iter().map(|e| e.element_sum()).sum())];
        Ok(Self { vertices, truth, normals, noise, level })
    }

    fn print_own_error(&self, paths: u32) {
        let [square, mean] = self.level;
        println!(
            "{} vertices, {} normals; irradiance {mean:.4} W/m² in the mean, root mean square {:.3} times that",
            self.vertices.len(),
            self.normals.len(),
            square / mean
        );
        println!("oracle: {paths} paths a vertex, own error {:.2} %", 100.0 * self.noise.sqrt() / square);
    }

    fn print_row(
        &self,
        stored: &str,
        evaluated: &str,
        bytes: u64,
        baked: &IrradianceGrid,
        decoded: &IrradianceGrid,
        form: impl Fn(&VertexValues, Vec3) -> Vec3,
    ) {
        let [mut total, mut of_formula, mut of_bake, mut of_storage] = [IrradianceError::default(); 4];
        for (&vertex, truth) in self.vertices.iter().zip(&self.truth) {
            let [before, after] = [baked, decoded].map(|grid| grid.get(vertex).expect("all are received"));
            let gathered = match baked.quantity() {
                Quantity::Vectors => VertexValues::Vectors(single(&truth.vectors)),
                Quantity::Radiance => VertexValues::Radiance(truth.radiance.map(|c| c.map(|x| x as f32))),
            };
            for (&n, &exact) in self.normals.iter().zip(&truth.irradiance) {
                let [gathered, before, after] = [&gathered, &before, &after].map(|values| form(values, n));
                total.add(after, exact);
                of_formula.add(gathered, exact);
                of_bake.add(before, gathered.max(Vec3::ZERO).as_dvec3());
                of_storage.add(after, before.max(Vec3::ZERO).as_dvec3());
            }
        }
        println!(
            "{stored:<14} {evaluated:<10} {bytes:>5} {:>6.2} % {:>+6.2} % {:>7.2} % {:>6.2} % {:>6.2} %",
            100.0 * total.relative_rmse_less(self.noise),
            100.0 * total.relative_bias(),
            100.0 * of_formula.relative_rmse(),
            100.0 * of_bake.relative_rmse_less(self.noise),
            100.0 * of_storage.relative_rmse()
        );
    }
}

fn single(vectors: &[[[f64; 3]; 3]; 6]) -> ivg_grid::HemisphereVectors {
    vectors.map(|hemisphere| hemisphere.map(|vector| vector.map(|x| x as f32)))
}

/// Points at which the two ways of filtering are compared.
const POINTS: usize = 40_000;

/// What filtering directions and colours apart changes, against filtering their products, of the packed grid.
fn print_separate(grid: &IrradianceGrid) -> Result<(), AnyError> {
    let file = encode(&grid.as_source(), &EncodeOptions::new())?;
    let (decoded, _) = IrradianceGrid::from_file(&file, &Limits::default())?;
    let filled = fill(&decoded, &FillOptions::default());
    let [apart, apart_unfilled] = [&filled, &decoded].map(SeparateTextures::new);
    let lattice = *grid.lattice();
    let normals = fibonacci_sphere(POINTS);
    let mut errors = [[IrradianceError::default(); 2]; 2];
    for (point, n) in normals.iter().enumerate() {
        // Multiples of irrational numbers' fractions are spread evenly over the box (Roberts 2018, "R3").
        let share =
            [0.819_172_513_4, 0.671_043_606_7, 0.549_700_478].map(|a: f64| (a * point as f64).fract());
        let at: [f64; 3] = core::array::from_fn(|axis| share[axis] * f64::from(lattice.dims[axis] - 1));
        let p =
            DVec3::from(core::array::from_fn(|axis| lattice.origin[axis] + at[axis] * lattice.step[axis]));
        let valid = (0..8)
            .filter(|corner| {
                let [i, j, k] = core::array::from_fn(|axis| {
                    (at[axis] as u16 + (corner >> axis & 1)).min(lattice.dims[axis] - 1)
                });
                grid.is_valid(lattice.index(i, j, k) as usize)
            })
            .count();
        if valid == 0 {
            continue;
        }
        // The normals wind from pole to pole; every other one is turned round.
        let n = if point % 2 == 0 { n.as_vec3() } else { -n.as_vec3() };
        let linear = filled.irradiance(p, n, Reconstruction::ThreeVector, SpatialFilter::Trilinear);
        let kind = usize::from(valid < 8);
        errors[kind][0].add(apart.irradiance(p, n), linear.as_dvec3());
        errors[kind][1].add(apart_unfilled.irradiance(p, n), linear.as_dvec3());
    }
    println!(
        "\ndirections and colours filtered apart, against filtering their products (packed-oct24, three):"
    );
    println!("{:<42} {:>8} {:>9} {:>9}", "cells", "points", "error", "bias");
    for (name, error) in [
        ("all corners valid", errors[0][0]),
        ("an invalid corner, directions from the fill", errors[1][0]),
        ("an invalid corner, as stored", errors[1][1]),
    ] {
        println!(
            "{name:<42} {:>8} {:>7.2} % {:>+7.2} %",
            error.count() / 3,
            100.0 * error.relative_rmse(),
            100.0 * error.relative_bias()
        );
    }
    Ok(())
}

fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Arguments, AnyError> {
    let mut parsed = Arguments {
        scene: None,
        lights: None,
        options: BakeOptions::default(),
        vertices: 64,
        normals: 200,
        paths: 65_536,
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
            "--seed" => parsed.options.seed = value()?.parse()?,
            "--vertices" => parsed.vertices = value()?.parse()?,
            "--normals" => parsed.normals = value()?.parse()?,
            "--paths" => parsed.paths = value()?.parse()?,
            option if option.starts_with("--") => return Err(format!("unknown option {option}").into()),
            _ => parsed.scene = Some(argument.into()),
        }
    }
    if parsed.vertices == 0 || parsed.normals == 0 || parsed.paths < 32 {
        return Err("--vertices and --normals must be at least 1, --paths at least 32".into());
    }
    Ok(parsed)
}
