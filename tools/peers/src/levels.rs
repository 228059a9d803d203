//! Random levels of a file, each looked at by a check of its own: nothing here trusts what the decoder checks.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use pmesh_format::{Mode, Replay};
use serde_json::{Value, json};

use crate::Failure;

#[cfg(test)]
mod tests;

/// Faces of a level whose direction is held against the original surface, at most.
const SAMPLED_FACES: usize = 1000;

/// The fault that coarse levels and those inside coded packets may have.
const COINCIDENT: &str = "two faces have the same corners";

/// Levels of fewer vertices than this share may have coincident faces: a closed surface ends as two opposite triangles.
const COARSE: f64 = 0.01;

/// What levels are asked for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Choice {
    /// How many.
    pub(crate) count: u32,
    /// Of the random numbers.
    pub(crate) seed: u64,
}

/// Goes to random levels in random order, half of them even in their number of vertices, half in its logarithm; of coded files
/// also to the coarsest level and to the end of each packet. Each must have indices below its number of vertices and distinct
/// corners, and the whole ones (PMESH-LVL-06: all of a raw file, those ends of a coded one), from 1 % of all vertices on, no two
/// faces with the same corners; of the others it is only counted. Centre and normal of some faces of the random levels go to
/// `out`, with the number of the level, as rows of seven floats.
pub(crate) fn check(replay: &mut Replay, choice: Choice, out: &Path) -> Result<Value, Failure> {
    let levels = replay.levels().ok_or("the file has no level")?;
    let (low, high) = (f64::from(*levels.start()), f64::from(*levels.end()));
    let mut random = Random(choice.seed);
    let mut rows = Vec::new();
    let mut found = Found::default();
    let mut visited = Vec::new();
    for k in 0..choice.count {
        let u = random.unit();
        let wanted = if k % 2 == 0 { low + u * (high - low) } else { low * (high / low).powf(u) };
        let level = (wanted.round() as u32).clamp(*levels.start(), *levels.end());
        visited.push(level);
        found.look(replay, level)?;
        sample(replay, &mut random, &mut rows);
    }
    let header = replay.header();
    let ends = header.packets.iter().map(|entry| entry.vertices.end).chain([*levels.start()]);
    let ends: Vec<_> = ends.filter(|_| header.mode == Mode::Coded).collect();
    for &level in &ends {
        found.look(replay, level)?;
    }
    let bytes: Vec<u8> = rows.iter().flat_map(|x: &f32| x.to_le_bytes()).collect();
    fs::write(out, bytes)?;
    visited.sort_unstable();
    Ok(json!({
        "levels": choice.count, "lowest": visited.first(), "highest": visited.last(),
        "median": visited.get(visited.len() / 2), "ends": ends.len(), "faults": found.faulty,
        "coincident_inside": found.inside,
    }))
}

/// What the levels looked at have.
#[derive(Default)]
struct Found {
    /// Levels with a fault, by its name.
    faulty: BTreeMap<&'static str, Vec<u32>>,
    /// Levels inside coded packets that have two faces on the same corners, which nobody promises them not to have.
    inside: u32,
}

impl Found {
    /// Goes to a level and looks at it.
    fn look(&mut self, replay: &mut Replay, level: u32) -> Result<(), Failure> {
        replay.set_level(level)?;
        let shown = Level { vertices: level, wedges: replay.wedge_count(), faces: replay.indices() };
        let whole = replay.header().is_whole_level(level);
        let coarse = f64::from(level) < COARSE * f64::from(replay.header().vertex_count);
        for fault in faults(&shown, |wedge| replay.wedge_vertex(wedge)) {
            if fault != COINCIDENT || (whole && !coarse) {
                self.faulty.entry(fault).or_default().push(level);
            } else {
                self.inside += u32::from(!whole && !coarse);
            }
        }
        Ok(())
    }
}

/// A level, as far as its validity is concerned.
struct Level<'a> {
    vertices: u32,
    wedges: u32,
    /// Wedges of the faces.
    faces: &'a [[u32; 3]],
}

/// What is wrong with a level, by name.
fn faults(level: &Level<'_>, vertex_of: impl Fn(u32) -> u32) -> Vec<&'static str> {
    if level.faces.as_flattened().iter().any(|&wedge| wedge >= level.wedges) {
        return vec!["an index is too large"];
    }
    let mut found = Vec::new();
    let mut faces: Vec<[u32; 3]> = level.faces.iter().map(|face| face.map(&vertex_of)).collect();
    if faces.iter().flatten().any(|&vertex| vertex >= level.vertices) {
        found.push("a corner is a removed vertex");
    }
    for face in &mut faces {
        face.sort_unstable();
    }
    if faces.iter().any(|face| face[0] == face[1] || face[1] == face[2]) {
        found.push("two corners of a face are equal");
    }
    faces.sort_unstable();
    if faces.windows(2).any(|pair| pair[0] == pair[1]) {
        found.push(COINCIDENT);
    }
    found
}

/// Level, centre and normal of random faces, or of all if they are few; faces without area have no normal and are left out.
fn sample(replay: &Replay, random: &mut Random, rows: &mut Vec<f32>) {
    let faces = replay.indices();
    let origin = replay.header().origin;
    let all = faces.len() <= SAMPLED_FACES;
    for k in 0..faces.len().min(SAMPLED_FACES) {
        let face = if all { k } else { (random.unit() * faces.len() as f64) as usize };
        let [a, b, c] =
            faces[face].map(|wedge| replay.positions()[replay.wedge_vertex(wedge) as usize].map(f64::from));
        let edge = |p: [f64; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
        let (u, v) = (edge(b), edge(c));
        let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > 0.0 {
            rows.push(replay.level() as f32);
            rows.extend((0..3).map(|k| (origin[k] + (a[k] + b[k] + c[k]) / 3.0) as f32));
            rows.extend(normal.map(|x| (x / length) as f32));
        }
    }
}

/// SplitMix64 (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014).
struct Random(u64);

impl Random {
    /// Even in [0, 1).
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
