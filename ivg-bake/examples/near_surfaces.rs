//! Prints how far vertices next to surfaces are off whatever the number of photons: the bias of averaging over cells.
//!
//! ```text
//! cargo run --release -p ivg-bake --example near_surfaces -- [SCENE] [--lights FILE] [--grid NXxNYxNZ]
//!     [--bounds x0,y0,z0,x1,y1,z1] [--photons N] [--paths N]
//! ```
//!
//! SCENE is anything `ivg` reads; without it, a closed box with a lit ceiling and two boxes in it. Every vertex is baked twice, with
//! `--photons` photons each, and gathered twice, with `--paths` paths each. The four are independent, so that the product of the
//! differences of one pair and of the other has the squared bias as its mean, without any noise to subtract. Bias is the root of
//! its sum over a class, of the irradiance along the axes, relative to the root of the sum of its squares; noise likewise, of
//! one bake. Classes, none of which shares a vertex with another but for the sums:
//!
//! * `on bounds`: in the outermost layers of the grid;
//! * `to half a step`: not there, and so near to the nearest surface, in the shortest step;
//! * `to a step`: farther, up to a step;
//! * `farther`: all others.

#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use arguments::SceneArguments;
use common::{AnyError, open, plan_of};
use ivg_bake::reference::Oracle;
use ivg_bake::{BakeOptions, Estimator, Silent, bake};
use ivg_grid::IrradianceGrid;

#[allow(dead_code, reason = "shared with other examples")]
mod common;

#[path = "common/arguments.rs"]
mod arguments;

/// Names of the classes, and of which of them each line is.
const LINES: [(&str, &[usize]); 6] = [
    ("on bounds", &[0]),
    ("to half a step", &[1]),
    ("to a step", &[2]),
    ("farther", &[3]),
    ("on bounds or to a step", &[0, 1, 2]),
    ("all", &[0, 1, 2, 3]),
];

/// Sums over a class.
#[derive(Clone, Copy, Default)]
struct Sums {
    vertices: usize,
    bias: f64,
    noise: f64,
    signal: f64,
}

fn main() -> Result<(), AnyError> {
    let usual = BakeOptions { dims: [32; 3], photons: 4_000_000, paths: 768, ..BakeOptions::default() };
    let mut paths = usual.paths;
    let arguments = SceneArguments::read(usual, |name, value| {
        match name {
            "--paths" => paths = value()?.parse()?,
            _ => return Ok(false),
        }
        Ok(true)
    })?;
    let SceneArguments { scene, lights, options } = arguments;
    let options = BakeOptions { paths, ..options };
    let scene = open(scene.as_deref(), lights.as_deref())?;
    let flat = scene.flatten();
    let plan = plan_of(&scene);
    let grid = |estimator, seed| -> Result<IrradianceGrid, AnyError> {
        let options = BakeOptions { estimator, seed, ..options.clone() };
        Ok(bake(&scene, &flat, &plan, &options, &Silent)?.grid)
    };
    let baked = [grid(Estimator::TrackLength, 1)?, grid(Estimator::TrackLength, 2)?];
    let gathered = [grid(Estimator::Gather, 3)?, grid(Estimator::Gather, 4)?];
    let classes = classes(&Oracle::new(&scene, &flat)?, &baked[0]);
    let mut sums = [Sums::default(); 4];
    for (vertex, class) in classes.into_iter().enumerate().filter_map(|(v, class)| Some((v, class?))) {
        let [a, b, c, d] = [&baked[0], &baked[1], &gathered[0], &gathered[1]].map(|grid| axes(grid, vertex));
        let sum = &mut sums[class];
        sum.vertices += 1;
        for n in 0..18 {
            sum.bias += (a[n] - c[n]) * (b[n] - d[n]);
            sum.noise += 0.5 * (a[n] - b[n]).powi(2);
            sum.signal += c[n] * d[n];
        }
    }
    println!("{:?} vertices, {} photons, {} paths a vertex", options.dims, options.photons, options.paths);
    println!("{:<28} {:>8} {:>8} {:>8}", "class", "vertices", "bias", "noise");
    for (name, of) in LINES {
        let sum = of.iter().map(|&class| sums[class]).fold(Sums::default(), |a, b| Sums {
            vertices: a.vertices + b.vertices,
            bias: a.bias + b.bias,
            noise: a.noise + b.noise,
            signal: a.signal + b.signal,
        });
        let relative = |square: f64| 100.0 * (square.max(0.0) / sum.signal).sqrt();
        println!(
            "{name:<28} {:>8} {:>6.2} % {:>6.2} %",
            sum.vertices,
            relative(sum.bias),
            relative(sum.noise)
        );
    }
    Ok(())
}

/// The irradiance of surfaces that face along the axes.
fn axes(grid: &IrradianceGrid, vertex: usize) -> [f64; 18] {
    let vectors = &grid.vectors()[vertex];
    core::array::from_fn(|n| f64::from(vectors[n / 3][n % 3][n / 6]).abs())
}

/// The class of each vertex; `None` where no light arrives.
fn classes(oracle: &Oracle<'_>, grid: &IrradianceGrid) -> Vec<Option<usize>> {
    let lattice = grid.lattice();
    let step = lattice.step.into_iter().filter(|&s| s > 0.0).fold(f64::INFINITY, f64::min);
    let class = |vertex: usize| {
        let at = lattice.coords(vertex as u64);
        if (0..3).any(|a| at[a] == 0 || at[a] + 1 == lattice.dims[a]) {
            return 0;
        }
        let distance = oracle.clearance(lattice.position(at[0], at[1], at[2]).into()) / step;
        1 + usize::from(distance > 0.5) + usize::from(distance > 1.0)
    };
    (0..grid.vertex_count()).map(|vertex| grid.is_valid(vertex).then(|| class(vertex))).collect()
}
