//! Puts a model in the place of the largest object of a scene, as the dragon in that of the bunny in a box:
//!
//! ```text
//! cargo run --release -p ivg-scene --example replace -- SCENE MODEL -o OUT.glb
//! ```
//!
//! SCENE and MODEL are anything that `ivg` reads. The largest object is the one with the most triangles among those that share
//! vertices with each other, in whichever mesh of the scene it is. The model keeps its proportions and its upright (y), gets the
//! material of most of the object's triangles, is as large as it can be without reaching beyond the object's box, and stands
//! in the middle of its bottom.

#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use std::path::{Path, PathBuf};

use glam::{DAffine3, DVec3};
use ivg_scene::export::{GlbOptions, write_glb};
use ivg_scene::import::{self, ImportOptions};
use ivg_scene::{Mesh, Node, Scene};

type AnyError = Box<dyn std::error::Error>;

fn main() -> Result<(), AnyError> {
    let usage = "usage: replace SCENE MODEL -o OUT.glb";
    let mut files: Vec<PathBuf> = Vec::new();
    let mut out = None;
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "-o" => out = Some(PathBuf::from(arguments.next().ok_or(usage)?)),
            _ => files.push(argument.into()),
        }
    }
    let ([scene, model], Some(out)) = (files.as_slice(), out) else { return Err(usage.into()) };
    let load = |path: &Path| import::load(path, &ImportOptions::default());
    let mut scene = load(scene)?;
    let object = Object::largest(&scene).ok_or("the scene has no triangles")?;
    let model = joined(&load(model)?);
    let (removed, added) = (object.triangles.len(), model.triangles.len());
    object.replace(&mut scene, model);
    scene.check()?;
    std::fs::write(&out, write_glb(&scene, &GlbOptions::default())?)?;
    println!("{}: {added} triangles in the place of {removed}", out.display());
    Ok(())
}

/// All triangles of a model as one mesh, in its world space.
fn joined(model: &Scene) -> Mesh {
    let flat = model.flatten();
    let triangle_materials = vec![0; flat.triangles.len()];
    Mesh {
        name: model.name.clone(),
        origin: flat.origin,
        positions: flat.positions,
        triangles: flat.triangles,
        triangle_materials,
        ..Mesh::default()
    }
}

/// Triangles of a mesh that hang together.
struct Object {
    mesh: usize,
    /// Their numbers in the mesh.
    triangles: Vec<usize>,
}

impl Object {
    fn largest(scene: &Scene) -> Option<Self> {
        let objects = scene.meshes.iter().enumerate().filter_map(|(mesh, m)| {
            let mut parts = Parts((0..m.positions.len() as u32).collect());
            m.triangles.iter().for_each(|&[a, b, c]| {
                parts.join(a, b);
                parts.join(b, c);
            });
            let roots: Vec<u32> = m.triangles.iter().map(|triangle| parts.root(triangle[0])).collect();
            let mut counts = vec![0usize; m.positions.len()];
            roots.iter().for_each(|&root| counts[root as usize] += 1);
            let largest = (0..counts.len()).max_by_key(|&root| counts[root])? as u32;
            let triangles: Vec<usize> = (0..roots.len()).filter(|&t| roots[t] == largest).collect();
            (!triangles.is_empty()).then_some(Self { mesh, triangles })
        });
        objects.max_by_key(|object| object.triangles.len())
    }

    /// Puts `model` in its place, wherever a node shows the mesh.
    fn replace(&self, scene: &mut Scene, mut model: Mesh) {
        let mesh = &mut scene.meshes[self.mesh];
        let bounds = |mesh: &Mesh, triangles: &mut dyn Iterator<Item = usize>| {
            let corners =
                triangles.flat_map(|t| mesh.triangles[t]).map(|v| mesh.positions[v as usize].as_dvec3());
            corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)))
        };
        let (low, high) = bounds(mesh, &mut self.triangles.iter().copied());
        let (model_low, model_high) = bounds(&model, &mut (0..model.triangles.len()));
        let scale = ((high - low) / (model_high - model_low)).min_element();
        let foot = |a: DVec3, b: DVec3| DVec3::new(a.x.midpoint(b.x), a.y, a.z.midpoint(b.z));
        let (from, to) = (foot(model_low, model_high), mesh.origin + foot(low, high));
        for position in &mut model.positions {
            *position = ((position.as_dvec3() - from) * scale).as_vec3();
        }
        model.origin = to;
        let material = most(self.triangles.iter().map(|&t| mesh.triangle_materials[t]));
        model.triangle_materials.fill(material);
        let mut gone = vec![false; mesh.triangles.len()];
        self.triangles.iter().for_each(|&t| gone[t] = true);
        let mut kept = gone.iter().map(|gone| !gone);
        mesh.triangles.retain(|_| kept.next().unwrap_or(true));
        let mut kept = gone.iter().map(|gone| !gone);
        mesh.triangle_materials.retain(|_| kept.next().unwrap_or(true));
        let number = scene.meshes.len() as u32;
        let shown: Vec<DAffine3> = scene
            .nodes
            .iter()
            .filter(|node| node.mesh as usize == self.mesh)
            .map(|node| node.transform)
            .collect();
        scene.nodes.extend(shown.into_iter().map(|transform| Node {
            name: model.name.clone(),
            mesh: number,
            transform,
        }));
        scene.meshes.push(model);
    }
}

/// The most frequent number.
fn most(numbers: impl Iterator<Item = u32>) -> u32 {
    let mut counts = std::collections::BTreeMap::new();
    numbers.for_each(|number| *counts.entry(number).or_insert(0) += 1);
    counts.into_iter().max_by_key(|&(_, count)| count).map_or(0, |(number, _)| number)
}

/// Vertices in sets that hang together: of each, another one of its set, or itself.
struct Parts(Vec<u32>);

impl Parts {
    fn root(&mut self, mut vertex: u32) -> u32 {
        while self.0[vertex as usize] != vertex {
            // Halving the way makes the next walk shorter.
            self.0[vertex as usize] = self.0[self.0[vertex as usize] as usize];
            vertex = self.0[vertex as usize];
        }
        vertex
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a as usize] = b;
    }
}
