//! Prints how far a client's picture of the light is off while a grid arrives, for each order of its vertices.
//!
//! ```text
//! cargo run --release -p ivg-bake --example order_error -- [SCENE [--lights FILE] | GRID.ivg]… [--grid NXxNYxNZ]
//!     [--photons N]
//! ```
//!
//! SCENE is anything `ivg` reads, with the lights of the file named after it; GRID.ivg a grid that is baked already.
//! Without either, the scene of `ivg demo`. All scenes are baked with the same `--grid` and `--photons`.
//!
//! The columns are shares of bytes received: of the bundles of the order `slices`, of 42 bytes a vertex
//! (`packed-oct24`). What all orders have alike comes before and does not count: header, corners, validity. Lists of vertices
//! and the envelopes of records do count; only whole records are received. Of the filled grid are printed
//!
//! * the root mean square error of all components at the valid vertices, relative to the root mean square of the values,
//! * the same at the vertices near surfaces alone, which is what surfaces look up,
//! * the median over the valid vertices of their error (root mean square), relative to the same.

#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use std::path::{Path, PathBuf};

use common::{AnyError, plan_of};
use ivg_bake::{BakeOptions, Silent, bake};
use ivg_format::{
    EncodeOptions, Event, GridSource, HemisphereVectors, Limits, Order, RecordId, decode_all, encode,
};
use ivg_grid::importance::{ImportanceOptions, bundles, near_surfaces};
use ivg_grid::{FillOptions, IrradianceGrid, fill};
use ivg_scene::Scene;
use ivg_scene::import::{self, ImportOptions};

#[allow(dead_code, reason = "each example uses a part")]
mod common;

/// Shares of the bytes at which errors are printed.
const SHARES: [f64; 6] = [0.0025, 0.01, 0.05, 0.25, 0.5, 0.75];

/// Vertices of the bundles in which vertices inside geometry are left out of the order `octree`.
const FIRST_BUNDLE: usize = 32;

/// Vertices per slice that bound a bundle of the order `explicit`. The others take 1, so that the first share is not empty.
const LARGEST_PER_SLICE: u32 = 64;

struct Arguments {
    inputs: Vec<(PathBuf, Option<PathBuf>)>,
    options: BakeOptions,
}

fn main() -> Result<(), AnyError> {
    let arguments = parse(std::env::args().skip(1))?;
    if arguments.inputs.is_empty() {
        print("demo scene", &baked(&ivg_scene::demo::scene(), &arguments.options)?)?;
    }
    for (path, lights) in &arguments.inputs {
        let grid = if path.extension().is_some_and(|extension| extension == "ivg") {
            IrradianceGrid::from_file(&std::fs::read(path)?, &Limits::default())?.0
        } else {
            baked(&import::load(path, &ImportOptions { lights: lights.clone() })?, &arguments.options)?
        };
        print(&name(path), &grid)?;
    }
    Ok(())
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn baked(scene: &Scene, options: &BakeOptions) -> Result<IrradianceGrid, AnyError> {
    let flat = scene.flatten();
    Ok(bake(scene, &flat, &plan_of(scene), options, &Silent)?.grid)
}

/// The bundles of a file: the vertices of each and the bytes of its record.
type Stream = Vec<(Vec<u64>, u64)>;

fn stream(grid: &IrradianceGrid, order: Order, listed: Option<&[Vec<u64>]>) -> Result<Stream, AnyError> {
    let vertices_per_slice = if order == Order::Explicit { LARGEST_PER_SLICE } else { 1 };
    let source = GridSource { bundles: listed, ..grid.as_source() };
    let options = EncodeOptions { order, vertices_per_slice, seed: 1, ..EncodeOptions::default() };
    let file = encode(&source, &options)?;
    let mut stream = Stream::new();
    decode_all(&file, &Limits::default(), |event| {
        if let Event::Bundle(bundle) = event {
            let RecordId::Bundle(_) = bundle.id() else { return };
            let range = bundle.header().record_range(bundle.id());
            stream.push((bundle.vertices().collect(), range.end - range.start));
        }
    })?;
    Ok(stream)
}

fn print(name: &str, grid: &IrradianceGrid) -> Result<(), AnyError> {
    let near = near_surfaces(grid);
    let near_count = (0..grid.vertex_count()).filter(|&v| near[v] && grid.is_valid(v)).count();
    let [nx, ny, nz] = grid.lattice().dims;
    let (count, valid) = (grid.vertex_count(), grid.valid_count());
    println!(
        "{name}: {nx} x {ny} x {nz} = {count} vertices, {valid} valid, {near_count} of them near surfaces"
    );
    print!("{:<44}", "order");
    for what in ["all", "near surfaces", "median"] {
        let heads: Vec<String> = SHARES.iter().map(|share| format!("{:>6}", 100.0 * share)).collect();
        print!(" | {what:<13} {} %", heads.join(" "));
    }
    println!();

    let largest = LARGEST_PER_SLICE as usize * usize::from(nx.max(ny).max(nz));
    let slices = stream(grid, Order::Slices, None)?;
    let octree = stream(grid, Order::Octree, None)?;
    let total: u64 = slices.iter().map(|(_, bytes)| bytes).sum();
    let spread: Vec<u64> = octree.iter().flat_map(|(vertices, _)| vertices).copied().collect();
    let reachable: Vec<u64> = spread.into_iter().filter(|&v| grid.is_valid(v as usize)).collect();
    let reachable: Vec<Vec<u64>> = reachable.chunks(largest.min(FIRST_BUNDLE)).map(<[u64]>::to_vec).collect();
    row("slices", grid, &near, &slices, total);
    row("octree", grid, &near, &octree, total);
    row(
        "octree without vertices inside geometry",
        grid,
        &near,
        &stream(grid, Order::Explicit, Some(&reachable))?,
        total,
    );
    let standard = ImportanceOptions::new(largest);
    for (name, options) in [
        ("largest error first", ImportanceOptions { look_ahead: false, free_weight: 1.0, ..standard }),
        ("importance, surfaces weigh as much as air", ImportanceOptions { free_weight: 1.0, ..standard }),
        ("importance", standard),
        ("importance, air weighs 0.1", ImportanceOptions { free_weight: 0.1, ..standard }),
        ("importance, filled a fourth as often", ImportanceOptions { refill_share: 0.4, ..standard }),
        ("importance, filled four times as often", ImportanceOptions { refill_share: 0.025, ..standard }),
    ] {
        let listed = bundles(grid, &options);
        row(name, grid, &near, &stream(grid, Order::Explicit, Some(&listed))?, total);
    }
    println!();
    Ok(())
}

fn row(name: &str, grid: &IrradianceGrid, near: &[bool], stream: &Stream, total: u64) {
    let errors = SHARES.map(|share| {
        let budget = (share * total as f64) as u64;
        let mut left = budget;
        let received = stream.iter().map_while(|(vertices, bytes)| {
            left = left.checked_sub(*bytes)?;
            Some(vertices)
        });
        error(grid, near, received.flatten().copied())
    });
    print!("{name:<44}");
    for which in 0..3 {
        let figures: Vec<String> = errors.iter().map(|e| format!("{:>6.2}", 100.0 * e[which])).collect();
        print!(" | {:<13} {}  ", "", figures.join(" "));
    }
    println!();
}

/// Error of the filled grid when the corners and these vertices have been received: of all valid vertices, of those near
/// surfaces, and the median.
fn error(grid: &IrradianceGrid, near: &[bool], received: impl Iterator<Item = u64>) -> [f64; 3] {
    let mut client = IrradianceGrid::with_limit(*grid.lattice(), grid.quantity(), u64::MAX)
        .expect("as many vertices as the given grid has");
    for vertex in 0..grid.vertex_count() {
        client.set_validity(vertex, grid.validity()[vertex]);
        client.set_blocked_edges(vertex, grid.blocked_edges()[vertex]);
    }
    for vertex in grid.lattice().corners().chain(received) {
        client.set(vertex as usize, &grid.vectors()[vertex as usize]);
    }
    let filled = fill(&client, &FillOptions::default());
    let square = |v: &HemisphereVectors| -> f64 {
        v.as_flattened().as_flattened().iter().map(|&x| f64::from(x).powi(2)).sum()
    };
    let (mut all, mut close) = ([0.0; 2], [0.0; 2]);
    let mut each = Vec::new();
    for vertex in (0..grid.vertex_count()).filter(|&vertex| grid.is_valid(vertex)) {
        let (shown, exact) = (&filled.vectors()[vertex], &grid.vectors()[vertex]);
        let mut difference = *exact;
        for (d, s) in difference
            .as_flattened_mut()
            .as_flattened_mut()
            .iter_mut()
            .zip(shown.as_flattened().as_flattened())
        {
            *d -= s;
        }
        let squares = [square(&difference), square(exact)];
        for n in 0..2 {
            all[n] += squares[n];
            close[n] += if near[vertex] { squares[n] } else { 0.0 };
        }
        each.push(squares[0]);
    }
    each.sort_by(f64::total_cmp);
    let mean = all[1] / each.len().max(1) as f64;
    let median = each.get(each.len() / 2).copied().unwrap_or(0.0);
    [(all[0] / all[1]).sqrt(), (close[0] / close[1]).sqrt(), (median / mean).sqrt()]
}

fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Arguments, AnyError> {
    let mut parsed = Arguments {
        inputs: Vec::new(),
        options: BakeOptions { dims: [32; 3], photons: 4_000_000, ..BakeOptions::default() },
    };
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--lights" => match parsed.inputs.last_mut() {
                Some((_, lights)) => *lights = Some(value()?.into()),
                None => return Err("--lights belongs behind the scene that it lights".into()),
            },
            "--grid" => {
                let text = value()?;
                let numbers: Vec<u16> = text.split('x').map(str::parse).collect::<Result<_, _>>()?;
                parsed.options.dims = numbers.try_into().map_err(|_| format!("{text}: not NXxNYxNZ"))?;
            }
            "--photons" => parsed.options.photons = value()?.parse()?,
            option if option.starts_with("--") => return Err(format!("unknown option {option}").into()),
            _ => parsed.inputs.push((argument.into(), None)),
        }
    }
    Ok(parsed)
}
