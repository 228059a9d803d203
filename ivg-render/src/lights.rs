//! Lights as the shaders read them, and the points that stand for emissive surfaces.
//!
//! An emissive surface of radiance L and area A is represented by n points. Each stands for a disk of area A / n that
//! faces the surface's way, so a point at distance d sees from it
//!
//! ```text
//! E = L (A / n) cos cos' / (d² + A / (n pi))      [W/m²]
//! ```
//!
//! which is exact for a disk seen along its axis (E = pi L r² / (d² + r²)), tends to the inverse square law far away,
//! and stays below pi L however close the receiver comes: no bright spots around the points.
//!
//! The points are shared out by power among the connected emissive surfaces, one at least for each, by largest
//! remainders; so the power of each surface is exact. On a surface they follow the area of its triangles, the k-th
//! point at the area share (k + 1/2) / n, with the radical inverse of k as second coordinate: all points differ in
//! both coordinates, which keeps the steps between their shadows small. Nothing is random. With 16 points on a lamp of
//! 1 x 0.5 m the irradiance on its axis is off by 0.7 % at 1 m, by 3 % at 0.5 m; with 64 points by 0.2 and 0.8 %.

use std::collections::HashMap;

use glam::{DVec3, Vec3};
use ivg_scene::{Light, LightKind, Material};

use crate::geometry::Geometry;
use crate::layout::{DIRECTIONAL_TILES, LIGHT_AREA, LIGHT_DIRECTIONAL, LIGHT_POINT, LIGHT_SPOT, LightRecord};
use crate::tonemap::LUMINANCE;

/// Shadow maps begin at this share of the scene's extent in front of a light.
const NEAR_SHARE: f32 = 1e-4;

/// Largest half angle of a spot light \[rad\] for which one face of 90° holds the whole cone.
const ONE_FACE_ANGLE: f32 = std::f32::consts::FRAC_PI_4;

/// A connected emissive surface, one side of it.
struct Emitter {
    /// Index of the triangle, its unit normal on this side, and its area \[m²\].
    triangles: Vec<(u32, Vec3, f32)>,
    radiance: Vec3,
    area: f32,
}

impl Emitter {
    fn power(&self) -> f32 {
        self.radiance.dot(LUMINANCE) * self.area
    }
}

/// All lights of a scene: first the points of emissive surfaces, then the others in the scene's order.
///
/// `origin` is the world position of the origin of scene space \[m\].
pub(crate) fn light_records(
    geometry: &Geometry,
    materials: &[Material],
    lights: &[Light],
    origin: DVec3,
    area_samples: u32,
    shadows: bool,
) -> Vec<LightRecord> {
    let mut records = area_records(geometry, materials, area_samples);
    records.extend(lights.iter().map(|light| punctual_record(&light.kind, geometry, origin)));
    records.retain(|record| record.strength != [0.0; 3]);
    let mut layer = 0;
    for record in &mut records {
        record.layers = if shadows { layers_of(record) } else { 0 };
        record.first_layer = layer;
        layer += record.layers;
        if record.kind != LIGHT_DIRECTIONAL {
            record.reach = (geometry.extent() * NEAR_SHARE).max(f32::MIN_POSITIVE);
        }
    }
    records
}

fn layers_of(record: &LightRecord) -> u32 {
    match record.kind {
        LIGHT_POINT => 6,
        LIGHT_DIRECTIONAL => DIRECTIONAL_TILES * DIRECTIONAL_TILES,
        // -offset / scale is the cosine of the outer angle.
        LIGHT_SPOT if -record.cone_offset >= ONE_FACE_ANGLE.cos() * record.cone_scale => 1,
        _ => 5,
    }
}

fn area_records(geometry: &Geometry, materials: &[Material], area_samples: u32) -> Vec<LightRecord> {
    let emitters = emitters(geometry, materials);
    let powers: Vec<f32> = emitters.iter().map(Emitter::power).collect();
    let mut records = Vec::new();
    for (emitter, count) in emitters.iter().zip(share_out(area_samples, &powers)) {
        let area = emitter.area / count as f32;
        for k in 0..count {
            let (position, normal) = emitter.point(geometry, k, count);
            let mut record = framed(position, normal);
            record.kind = LIGHT_AREA;
            record.disk = area / std::f32::consts::PI;
            record.strength = (emitter.radiance * area).to_array();
            records.push(record);
        }
    }
    records
}

/// Connected emissive surfaces that some part of the scene may see, in the order of their first triangle; the front
/// side before the back side.
fn emitters(geometry: &Geometry, materials: &[Material]) -> Vec<Emitter> {
    let mut emissive = Vec::new();
    for draw in &geometry.draws {
        let material = &materials[draw.material as usize];
        if material.emission.max_element() > 0.0 {
            emissive.extend(draw.triangles.clone().map(|triangle| (triangle, draw.material)));
        }
    }
    let groups = connected(geometry, &emissive);
    let mut emitters = Vec::new();
    for group in groups {
        let material = &materials[group[0].1 as usize];
        for side in [1.0, -1.0] {
            if side < 0.0 && !material.two_sided {
                continue;
            }
            let mut triangles = Vec::new();
            for (triangle, _) in &group {
                let [a, b, c] = geometry.corners(*triangle);
                let cross = (b - a).cross(c - a) * side;
                let area = 0.5 * cross.length();
                if area > 0.0 && something_in_front(geometry, a, cross.normalize_or_zero()) {
                    triangles.push((*triangle, cross.normalize_or_zero(), area));
                }
            }
            let area = triangles.iter().map(|t| t.2).sum();
            if area > 0.0 {
                emitters.push(Emitter { triangles, radiance: material.emission, area });
            }
        }
    }
    emitters
}

/// Emissive triangles of one material that share vertex positions, directly or through others.
fn connected(geometry: &Geometry, emissive: &[(u32, u32)]) -> Vec<Vec<(u32, u32)>> {
    let mut parent: Vec<usize> = (0..emissive.len()).collect();
    let mut owner: HashMap<(u32, [u32; 3]), usize> = HashMap::new();
    for (index, (triangle, material)) in emissive.iter().enumerate() {
        for corner in geometry.corners(*triangle) {
            // Adding zero makes -0 and 0 the same bits.
            let key = (*material, (corner + Vec3::ZERO).to_array().map(f32::to_bits));
            let other = *owner.entry(key).or_insert(index);
            let (a, b) = (root(&mut parent, index), root(&mut parent, other));
            // The smaller index becomes the root, so a group is named by its first triangle.
            parent[a.max(b)] = a.min(b);
        }
    }
    let mut groups: Vec<Vec<(u32, u32)>> = Vec::new();
    let mut group_of_root = HashMap::new();
    for (index, entry) in emissive.iter().enumerate() {
        let group = *group_of_root.entry(root(&mut parent, index)).or_insert_with(|| {
            groups.push(Vec::new());
            groups.len() - 1
        });
        groups[group].push(*entry);
    }
    groups
}

fn root(parent: &mut [usize], mut index: usize) -> usize {
    while parent[index] != index {
        parent[index] = parent[parent[index]];
        index = parent[index];
    }
    index
}

/// Whether the bounds of the scene reach in front of the plane through `point`. What lies on the plane sees nothing
/// of it, so rounding is allowed for generously.
fn something_in_front(geometry: &Geometry, point: Vec3, normal: Vec3) -> bool {
    let (low, high) = geometry.bounds;
    let furthest = Vec3::select(normal.cmpgt(Vec3::ZERO), high, low);
    normal.dot(furthest - point) > 1e-5 * geometry.extent()
}

/// Shares out `count` points by largest remainders, one at least for each power.
fn share_out(count: u32, powers: &[f32]) -> Vec<u32> {
    let total: f64 = powers.iter().map(|power| f64::from(*power)).sum();
    let ideal: Vec<f64> = powers.iter().map(|power| f64::from(count) * f64::from(*power) / total).collect();
    let mut shares: Vec<u32> = ideal.iter().map(|share| (*share as u32).max(1)).collect();
    let mut order: Vec<usize> = (0..powers.len()).collect();
    order.sort_by(|a, b| ideal[*b].fract().total_cmp(&ideal[*a].fract()).then(a.cmp(b)));
    let mut left = count.saturating_sub(shares.iter().sum());
    for index in order {
        if left > 0 && ideal[index] >= 1.0 {
            shares[index] += 1;
            left -= 1;
        }
    }
    shares
}

impl Emitter {
    /// The k-th of n points and the normal there.
    fn point(&self, geometry: &Geometry, k: u32, n: u32) -> (Vec3, Vec3) {
        let mut rest = (k as f32 + 0.5) / n as f32 * self.area;
        let mut chosen = self.triangles.len() - 1;
        for (index, (_, _, area)) in self.triangles.iter().enumerate() {
            if rest < *area {
                chosen = index;
                break;
            }
            rest -= area;
        }
        let (triangle, normal, area) = self.triangles[chosen];
        let u = (rest / area).clamp(0.0, 1.0);
        let v = radical_inverse(k) + 0.5 / (n.next_power_of_two() as f32);
        // Uniform in area (Turk 1990): the square root undoes the narrowing towards the first corner.
        let [a, b, c] = geometry.corners(triangle);
        let root = u.sqrt();
        (a + (b - a) * (root * (1.0 - v)) + (c - a) * (root * v), normal)
    }
}

/// The bits of `k` mirrored at the binary point: 0, 1/2, 1/4, 3/4, 1/8 ...
fn radical_inverse(k: u32) -> f32 {
    k.reverse_bits() as f32 / 4_294_967_296.0
}

fn punctual_record(kind: &LightKind, geometry: &Geometry, origin: DVec3) -> LightRecord {
    match *kind {
        LightKind::Point { position, intensity } => {
            let mut record = framed((position - origin).as_vec3(), Vec3::Z);
            record.kind = LIGHT_POINT;
            record.strength = intensity.to_array();
            record
        }
        LightKind::Spot { position, direction, intensity, inner_angle, outer_angle } => {
            let mut record = framed((position - origin).as_vec3(), direction);
            record.kind = LIGHT_SPOT;
            record.strength = intensity.to_array();
            // KHR_lights_punctual, "Inner and Outer Cone Angles".
            record.cone_scale = 1.0 / (inner_angle.cos() - outer_angle.cos()).max(0.001);
            record.cone_offset = -outer_angle.cos() * record.cone_scale;
            record
        }
        LightKind::Directional { direction, irradiance } => {
            let (low, high) = geometry.bounds;
            let mut record = framed(0.5 * (low + high), direction);
            record.kind = LIGHT_DIRECTIONAL;
            record.strength = irradiance.to_array();
            // A little larger than the scene, so that nothing lies on the border.
            record.reach = (0.501 * geometry.extent()).max(f32::MIN_POSITIVE);
            record
        }
    }
}

/// A record with a position and a frame around `axis`.
fn framed(position: Vec3, axis: Vec3) -> LightRecord {
    let axis = axis.normalize_or(Vec3::Z);
    let tangent = axis.any_orthonormal_vector();
    LightRecord {
        position: position.to_array(),
        axis: axis.to_array(),
        tangent: tangent.to_array(),
        bitangent: axis.cross(tangent).to_array(),
        cone_offset: 1.0,
        ..LightRecord::default()
    }
}

#[cfg(test)]
mod tests;
