//! The figure: a seated, meditating person in a robe, as a blend of simple bodies.
//!
//! Its own space: seat at y = 0, top of the head near y = 1, facing +z. The body is symmetric in x; the robe, which
//! leaves one shoulder bare, is not.

use glam::{DVec3, dvec3};

use super::surface::{self, Surface};
use crate::Mesh;

/// Edge of the cells in which the surface is found; decides the number of triangles (about 1.2 / STEP²).
const STEP: f64 = 1.0 / 156.0;
const MIN: DVec3 = dvec3(-0.58, -0.03, -0.30);
const MAX: DVec3 = dvec3(0.58, 1.03, 0.44);

/// The figure as one closed mesh with smooth normals.
pub(super) fn mesh(name: &str, material: u32) -> Mesh {
    let cells = ((MAX - MIN) / STEP).ceil().to_array().map(|n| n as usize);
    let Surface { positions, normals, triangles } = surface::extract(distance, MIN, STEP, cells);
    Mesh {
        name: name.into(),
        triangle_materials: vec![material; triangles.len()],
        positions,
        normals,
        triangles,
        ..Mesh::default()
    }
}

/// Distance from the figure, negative inside; near the surface true to a few per cent.
fn distance(p: DVec3) -> f64 {
    let q = dvec3(p.x.abs(), p.y, p.z);
    let body = blend(torso(q), arms(q), 0.03);
    let body = blend(body, legs(q), 0.05);
    let dressed = robe(p, q, body);
    let whole = blend(dressed, hands(q), 0.018);
    let whole = blend(whole, head(q), 0.03);
    // The seat is flat.
    carve(whole, p.y, 0.012)
}

fn torso(q: DVec3) -> f64 {
    let pelvis = ellipsoid(q, dvec3(0.0, 0.13, -0.03), dvec3(0.235, 0.16, 0.18));
    let belly = ellipsoid(q, dvec3(0.0, 0.275, 0.02), dvec3(0.172, 0.17, 0.135));
    let chest = ellipsoid(q, dvec3(0.0, 0.465, -0.005), dvec3(0.19, 0.16, 0.118));
    let breast = ellipsoid(q, dvec3(0.085, 0.495, 0.065), dvec3(0.085, 0.06, 0.055));
    let shoulder = ellipsoid(q, dvec3(0.2, 0.555, -0.012), dvec3(0.075, 0.068, 0.07));
    let slope = cone(q, dvec3(0.04, 0.635, -0.015), dvec3(0.19, 0.575, -0.015), 0.05, 0.052);
    let neck = cone(q, dvec3(0.0, 0.58, -0.02), dvec3(0.0, 0.72, 0.0), 0.066, 0.058);
    let body = blend(blend(pelvis, belly, 0.07), chest, 0.07);
    let body = blend(body, breast, 0.04);
    blend(body, blend(blend(shoulder, slope, 0.05), neck, 0.035), 0.04)
}

fn arms(q: DVec3) -> f64 {
    let elbow = dvec3(0.315, 0.315, 0.005);
    let upper = cone(q, dvec3(0.235, 0.54, -0.012), elbow, 0.068, 0.056);
    let fore = cone(q, elbow, dvec3(0.125, 0.195, 0.2), 0.056, 0.037);
    blend(upper, fore, 0.02)
}

fn legs(q: DVec3) -> f64 {
    let knee = dvec3(0.425, 0.085, 0.13);
    let thigh = cone(q, dvec3(0.14, 0.12, 0.0), knee, 0.12, 0.085);
    let shin = cone(q, knee, dvec3(0.06, 0.068, 0.27), 0.08, 0.06);
    let foot = ellipsoid(q, dvec3(0.15, 0.132, 0.255), dvec3(0.105, 0.034, 0.05));
    let lap = ellipsoid(q, dvec3(0.0, 0.08, 0.14), dvec3(0.25, 0.075, 0.17));
    blend(blend(blend(thigh, shin, 0.03), lap, 0.05), foot, 0.02)
}

fn hands(q: DVec3) -> f64 {
    // Further away than this the hands cannot matter to the blend.
    let near = q.distance(dvec3(0.05, 0.2, 0.24)) - 0.17;
    if near > 0.1 {
        return near;
    }
    let palm = ellipsoid(q, dvec3(0.062, 0.182, 0.235), dvec3(0.078, 0.03, 0.052));
    let thumb = cone(q, dvec3(0.075, 0.205, 0.225), dvec3(0.006, 0.232, 0.245), 0.017, 0.011);
    let mut fingers = f64::INFINITY;
    for i in 0..4 {
        let z = 0.214 + 0.021 * f64::from(i);
        let finger = cone(
            q,
            dvec3(0.07, 0.178, z),
            dvec3(0.004, 0.178 - 0.003 * f64::from(i), z + 0.004),
            0.0145,
            0.0115,
        );
        fingers = blend(fingers, finger, 0.004);
    }
    blend(blend(palm, fingers, 0.01), thumb, 0.012)
}

/// The robe: a thicker skin with folds, from the left shoulder (x > 0) across the chest and over the legs.
fn robe(p: DVec3, q: DVec3, body: f64) -> f64 {
    if body.abs() > 0.12 {
        return body;
    }
    // Positive where the cloth is, in units of length: below a slanted hem on the torso, everywhere on the legs.
    let hem = 0.62 * p.x - 0.78 * (p.y - 0.44) + 0.10 * (p.z - 0.05);
    let sleeve = p.x - 0.12;
    let cloth = smooth_step((hem.max(sleeve)) / 0.012);
    // Folds hang from the shoulder on the torso and run around the knees on the legs.
    let from_shoulder = p.distance(dvec3(0.25, 0.72, 0.0));
    let from_lap = dvec3(q.x, 1.6 * q.y, q.z).distance(dvec3(0.05, 0.35, 0.05));
    let low = smooth_step((0.24 - p.y) / 0.1);
    let hanging = fold(88.0 * from_shoulder + 14.0 * p.x);
    let lying = fold(80.0 * from_lap + 8.0 * q.z);
    let folds = hanging + low * (lying - hanging);
    let rim = cloth * (1.0 - cloth) * 4.0;
    body - cloth * (0.010 + 0.0065 * folds) - 0.007 * rim
}

/// A wave with broad backs and narrow valleys, in [-1, 1].
fn fold(phase: f64) -> f64 {
    let s = phase.sin();
    let wide = s + 0.25 * (2.0 * phase).cos();
    wide / 1.25
}

fn head(q: DVec3) -> f64 {
    let near = q.distance(dvec3(0.0, 0.82, 0.0)) - 0.22;
    if near > 0.12 {
        return near;
    }
    let skull = ellipsoid(q, dvec3(0.0, 0.825, -0.008), dvec3(0.1, 0.115, 0.112));
    let face = ellipsoid(q, dvec3(0.0, 0.79, 0.03), dvec3(0.082, 0.098, 0.082));
    let cheek = ellipsoid(q, dvec3(0.04, 0.767, 0.07), dvec3(0.033, 0.034, 0.03));
    let chin = ellipsoid(q, dvec3(0.0, 0.712, 0.078), dvec3(0.028, 0.022, 0.024));
    let mut head = blend(blend(skull, face, 0.03), blend(cheek, chin, 0.03), 0.025);
    let socket = ellipsoid(q, dvec3(0.037, 0.812, 0.118), dvec3(0.027, 0.014, 0.016));
    head = carve(head, socket, 0.012);
    let brow = cone(q, dvec3(0.013, 0.828, 0.107), dvec3(0.064, 0.832, 0.083), 0.009, 0.006);
    let nose = cone(q, dvec3(0.0, 0.826, 0.106), dvec3(0.0, 0.777, 0.127), 0.009, 0.014);
    let wing = ellipsoid(q, dvec3(0.012, 0.774, 0.115), dvec3(0.009, 0.008, 0.01));
    let lid = ellipsoid(q, dvec3(0.037, 0.81, 0.094), dvec3(0.022, 0.011, 0.016));
    let upper_lip = ellipsoid(q, dvec3(0.0, 0.749, 0.108), dvec3(0.025, 0.006, 0.011));
    let lower_lip = ellipsoid(q, dvec3(0.0, 0.738, 0.105), dvec3(0.019, 0.007, 0.011));
    for (part, softness) in
        [(brow, 0.01), (nose, 0.01), (wing, 0.006), (lid, 0.003), (upper_lip, 0.009), (lower_lip, 0.011)]
    {
        head = blend(head, part, softness);
    }
    let ear = ellipsoid(q, dvec3(0.102, 0.79, -0.005), dvec3(0.012, 0.036, 0.023));
    let lobe = ellipsoid(q, dvec3(0.1, 0.735, 0.002), dvec3(0.0105, 0.034, 0.014));
    head = blend(head, blend(ear, lobe, 0.01), 0.008);
    blend(head, hair(q), 0.006)
}

/// Hair in small curls, and the knot above it.
fn hair(q: DVec3) -> f64 {
    let cap = ellipsoid(q, dvec3(0.0, 0.836, -0.014), dvec3(0.107, 0.118, 0.117));
    let knot = ellipsoid(q, dvec3(0.0, 0.948, -0.022), dvec3(0.052, 0.042, 0.052));
    let all = blend(cap, knot, 0.025);
    // Cut off the face: the hairline runs from the forehead down to behind the ears.
    let hairline = 0.80 * (q.z - 0.075) - 0.60 * (q.y - 0.868) - 0.05 * q.x;
    let cut = carve(all, -hairline, 0.008);
    let curls = (118.0 * q.x).cos() * (118.0 * q.y).sin() * (118.0 * q.z).cos();
    cut - 0.0045 * curls
}

/// Smooth union of radius `k` (quadratic): where two bodies meet the seam is filled.
fn blend(a: f64, b: f64, k: f64) -> f64 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - 0.25 * h * h * k
}

/// Smooth intersection with the half space or body whose distance is `-b`: keeps `a` where `b` is positive.
fn carve(a: f64, b: f64, k: f64) -> f64 {
    -blend(-a, b, k)
}

/// Distance from an ellipsoid, first order: exact on the surface, true in direction.
fn ellipsoid(p: DVec3, centre: DVec3, radii: DVec3) -> f64 {
    let q = (p - centre) / radii;
    let scaled = q / radii;
    let (length, gradient) = (q.length(), scaled.length());
    if gradient == 0.0 { -radii.min_element() } else { length * (length - 1.0) / gradient }
}

/// Distance from a capsule whose radius runs from `ra` at `a` to `rb` at `b`.
fn cone(p: DVec3, a: DVec3, b: DVec3, ra: f64, rb: f64) -> f64 {
    let axis = b - a;
    let t = ((p - a).dot(axis) / axis.length_squared()).clamp(0.0, 1.0);
    p.distance(a + t * axis) - (ra + t * (rb - ra))
}

/// 0 below -1, 1 above 1, smooth in between.
fn smooth_step(x: f64) -> f64 {
    let t = (0.5 * x + 0.5).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
