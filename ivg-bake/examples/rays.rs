//! Prints how many closest hits a second of processor time finds, in each kind of tree, for the flights of a scene's photons.
//!
//! ```text
//! cargo run --release -p ivg-bake --features rays --example rays -- [SCENE] [--lights FILE] [--rays N] [--runs N]
//!     [--dump FILE] [--json]
//! ```
//!
//! SCENE is anything `ivg` reads; without it, a closed box with a lit ceiling and two boxes in it. Rays are flights after the
//! first (`--rays`, 262144 unless said otherwise), on one thread; trees take turns, and of `--runs` the median is printed.
//! `--dump` writes triangles, rays and hits for other programs, all numbers little-endian: the number of triangles and of rays
//! (u32), the corners of each triangle (9 f32), origin and direction of each ray (6 f32), and the triangle (u32, 2³² − 1 for
//! none) and distance (f32) of each hit in the tree that bakes use.

#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use std::path::PathBuf;

use clock::cpu_seconds;
use common::{AnyError, open, plan_of};
use glam::Vec3;
use ivg_bake::BakeOptions;
use ivg_bake::rays::{Flights, Found, Kind, Preset, Tree, flights};

#[allow(dead_code, unused_imports, reason = "shared with other examples")]
mod common;

#[path = "common/clock.rs"]
mod clock;

/// Trees compared; the first is that of bakes.
const TREES: [(&str, Kind, Preset); 6] = [
    ("eight-wide, medium", Kind::Wide, Preset::Medium),
    ("eight-wide, fast", Kind::Wide, Preset::Fast),
    ("eight-wide, very slow", Kind::Wide, Preset::VerySlow),
    ("binary, medium", Kind::Binary, Preset::Medium),
    ("binary, fast", Kind::Binary, Preset::Fast),
    ("binary, very slow", Kind::Binary, Preset::VerySlow),
];

/// Distances that differ by less are of the same hit: relative to the distance, and to the largest coordinate, whose rounding
/// is all that the distance of a near hit consists of.
const SAME: [f32; 2] = [1e-4, 1e-5];

fn main() -> Result<(), AnyError> {
    let (mut scene, mut lights, mut dump) = (None, None, None::<PathBuf>);
    let (mut most, mut runs, mut json) = (262_144usize, 5usize, false);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--lights" => lights = Some(PathBuf::from(value()?)),
            "--rays" => most = value()?.parse()?,
            "--runs" => runs = value()?.parse::<usize>()?.max(1),
            "--dump" => dump = Some(value()?.into()),
            "--json" => json = true,
            option if option.starts_with("--") => return Err(format!("unknown option {option}").into()),
            _ => scene = Some(PathBuf::from(argument)),
        }
    }
    let scene = open(scene.as_deref(), lights.as_deref())?;
    let flat = scene.flatten();
    let options = BakeOptions { photons: u64::MAX, dims: [4; 3], ..BakeOptions::default() };
    let options = BakeOptions { photons: (most as u64).max(1), ..options };
    let flights = flights(&scene, &flat, &plan_of(&scene), &options, most)?;
    let corners = flights.triangles.iter().flatten();
    let reach = corners.fold(0f32, |reach, corner| reach.max(corner.abs().max_element()));
    let mut rows = Vec::new();
    let mut trees = Vec::new();
    for (name, kind, preset) in TREES {
        let started = cpu_seconds();
        let tree = Tree::new(&flights.triangles, kind, preset)?;
        rows.push(Row { name, build: cpu_seconds() - started, seconds: Vec::new(), differ: 0 });
        trees.push(tree);
    }
    let hits = trees[0].closest_hits(&flights.rays);
    for _ in 0..runs {
        for (tree, row) in trees.iter().zip(&mut rows) {
            let started = cpu_seconds();
            let found = tree.closest_hits(&flights.rays);
            row.seconds.push(cpu_seconds() - started);
            row.differ = hits.iter().zip(&found).filter(|(a, b)| differ(**a, **b, reach)).count();
        }
    }
    if let Some(path) = dump {
        std::fs::write(path, bytes(&flights, &hits))?;
    }
    let rate = |row: &Row| flights.rays.len() as f64 / row.median() / 1e6;
    if json {
        let rows: Vec<String> = rows
            .iter()
            .map(|row| {
                format!(
                    r#"{{"tree": "{}", "build_seconds": {:?}, "mrays": {:?}, "differ": {}}}"#,
                    row.name,
                    row.build,
                    rate(row),
                    row.differ
                )
            })
            .collect();
        println!(
            r#"{{"triangles": {}, "rays": {}, "trees": [{}]}}"#,
            flights.triangles.len(),
            flights.rays.len(),
            rows.join(", ")
        );
        return Ok(());
    }
    println!("{} triangles, {} rays, median of {runs}", flights.triangles.len(), flights.rays.len());
    println!("{:<24} {:>14} {:>14} {:>12}", "tree", "build [CPU-s]", "Mray/CPU-s", "other hits");
    for row in &rows {
        println!("{:<24} {:>14.3} {:>14.2} {:>12}", row.name, row.build, rate(row), row.differ);
    }
    Ok(())
}

struct Row {
    name: &'static str,
    build: f64,
    seconds: Vec<f64>,
    /// Rays that hit something else than in the first tree.
    differ: usize,
}

impl Row {
    fn median(&self) -> f64 {
        let mut seconds = self.seconds.clone();
        seconds.sort_by(f64::total_cmp);
        seconds[seconds.len() / 2]
    }
}

fn differ(a: Option<Found>, b: Option<Found>, reach: f32) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => (a.distance - b.distance).abs() > SAME[0] * a.distance + SAME[1] * reach,
        (None, None) => false,
        _ => true,
    }
}

fn bytes(flights: &Flights, hits: &[Option<Found>]) -> Vec<u8> {
    let counts = [flights.triangles.len(), flights.rays.len()].map(|count| count as u32);
    let mut bytes: Vec<u8> = counts.into_iter().flat_map(u32::to_le_bytes).collect();
    let mut points = |points: &[Vec3]| {
        bytes.extend(points.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes));
    };
    flights.triangles.iter().for_each(|triangle| points(triangle));
    flights.rays.iter().for_each(|ray| points(&[ray.origin, ray.direction]));
    for hit in hits {
        let (triangle, distance) = hit.map_or((u32::MAX, 0.0), |hit| (hit.triangle, hit.distance));
        bytes.extend(triangle.to_le_bytes());
        bytes.extend(distance.to_le_bytes());
    }
    bytes
}
