//! Prints what leaving effects out saves: bakes of scenes that call for little and for all, each with the effects that its plan
//! needs and with all there are.
//!
//! ```text
//! cargo run --release -p ivg-bake --features cases --example effects -- [SCENE [LIGHTS]] [PHOTONS]
//! ```
//!
//! Without a scene: a box with a lit ceiling, as it is; and with a mirror for a block, a ball of glass on it, and a sky. Times are
//! of one thread, the medians of five bakes of each kind taken in turn; the last column is how far the two results are apart,
//! relative to the second (root mean squares of the components along the axes).

#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use std::path::Path;
use std::time::Instant;

use common::AnyError;
use glam::Vec3;
use ivg_bake::cases::difference;
use ivg_bake::{BakeOptions, BakeResult, Silent, bake, pilot};
use ivg_scene::plan::{PlanOptions, analyse};
use ivg_scene::{EffectPlan, FlatScene, Material, Mesh, Need, Node, Scene};

#[allow(dead_code, reason = "other examples use the rest")]
mod common;

/// Bakes of each kind.
const REPEATS: usize = 5;

fn main() -> Result<(), AnyError> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (numbers, files): (Vec<&String>, Vec<&String>) =
        arguments.iter().partition(|a| a.parse::<u64>().is_ok());
    let photons = numbers.first().map_or(Ok(200_000), |n| n.parse())?;
    let path = |n: usize| files.get(n).map(|file| Path::new(file.as_str()));
    let plain = common::open(path(0), path(1))?;
    let scenes = if files.is_empty() { vec![plain.clone(), with_everything(plain)] } else { vec![plain] };
    println!("{:<16} {:>8} {:>8} {:>8} {:>10}", "scene", "needed s", "all s", "saved", "difference");
    for scene in &scenes {
        measure(scene, photons)?;
    }
    Ok(())
}

fn measure(scene: &Scene, photons: u64) -> Result<(), AnyError> {
    let flat = scene.flatten();
    let options = BakeOptions { photons, threads: Some(1), ..BakeOptions::default() };
    let plans = [false, true].map(|all_effects| {
        let mut plan = analyse(scene, &flat, &PlanOptions { all_effects, ..PlanOptions::default() });
        pilot(scene, &flat, &mut plan, &options).map(|_| plan)
    });
    let [needed, all] = plans;
    let (needed, all) = (needed?, all?);
    let (mut times, mut results) = ([Vec::new(), Vec::new()], Vec::new());
    for _ in 0..REPEATS {
        results.clear();
        for (plan, times) in [&needed, &all].into_iter().zip(&mut times) {
            let (result, seconds) = timed(scene, &flat, plan, &options)?;
            times.push(seconds);
            results.push(result);
        }
    }
    let [needed_time, all_time] = times.map(median);
    println!(
        "{:<16} {needed_time:>8.2} {all_time:>8.2} {:>6.1} % {:>8.3} %",
        scene.name,
        100.0 * (1.0 - needed_time / all_time),
        100.0 * difference(&results[0].grid, &results[1].grid),
    );
    let names = |need: Need| -> Vec<&str> {
        needed.effects.iter().filter(|e| e.need == need).map(|e| e.effect.name()).collect()
    };
    println!("  needed: {}, up to {} reflections", names(Need::Needed).join(", "), needed.max_bounces);
    println!(
        "  left out: {}; with all: up to {} reflections",
        names(Need::NotNeeded).join(", "),
        all.max_bounces
    );
    Ok(())
}

fn timed(
    scene: &Scene,
    flat: &FlatScene,
    plan: &EffectPlan,
    options: &BakeOptions,
) -> Result<(BakeResult, f64), AnyError> {
    let started = Instant::now();
    let result = bake(scene, flat, plan, options, &Silent)?;
    Ok((result, started.elapsed().as_secs_f64()))
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// The box with a rough metal wall, a solid of glass that floats in it, and a sky that shines in through a pane in place of a wall.
fn with_everything(mut scene: Scene) -> Scene {
    scene.name = "all effects".into();
    let first = scene.materials.len() as u32;
    let metal = Vec3::new(0.95, 0.8, 0.5);
    let glass =
        Material { name: "glass".into(), albedo: Vec3::ZERO, transmission: 1.0, ..Material::default() };
    scene.materials.extend([
        Material {
            name: "metal".into(),
            albedo: metal,
            specular: 1.0,
            specular_colour: metal,
            metallic: true,
            roughness: 0.4,
            ..Material::default()
        },
        glass.clone(),
        Material { name: "pane".into(), thin: true, ..glass },
    ]);
    // The first two triangles are the wall at x = 0, the next two the one opposite.
    scene.meshes[0].triangle_materials[..2].fill(first);
    scene.meshes[0].triangle_materials[2..4].fill(first + 2);
    let corners = (0..8).map(|n| Vec3::new((n & 1) as f32, (n >> 1 & 1) as f32, (n >> 2) as f32));
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let solid = Mesh {
        name: "solid".into(),
        positions: corners.map(|p| Vec3::new(1.1, 0.8, 0.9) + p * 0.5).collect(),
        triangles: faces.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).collect(),
        triangle_materials: vec![first + 1; 12],
        ..Mesh::default()
    };
    scene.nodes.push(Node { name: "solid".into(), mesh: 1, transform: glam::DAffine3::IDENTITY });
    scene.meshes.push(solid);
    scene.sky = Some(Vec3::new(0.3, 0.4, 0.6));
    scene
}
