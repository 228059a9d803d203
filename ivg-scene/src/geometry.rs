//! Small geometry shared by import, flattening and framing.

use glam::{DVec3, Vec3};

use crate::Mesh;

/// A local origin near the middle of a box, such that f32 positions relative to it lose nothing to distance.
///
/// The centre is rounded to a multiple of the smallest power of two that is not below the largest extent. So a scene
/// that lies within its own extent of the world origin keeps origin 0 (its coordinates stay as they are), and moving a
/// scene by whole steps or scaling it by a power of two changes no bit of the relative positions. Zero if the box is
/// empty or not finite.
pub(crate) fn snapped_origin(min: DVec3, max: DVec3) -> DVec3 {
    let extent = (max - min).max_element();
    if !(min.is_finite() && max.is_finite() && extent.is_finite()) || extent < 0.0 {
        return DVec3::ZERO;
    }
    if extent == 0.0 {
        return min;
    }
    let step = 2f64.powi(extent.log2().ceil().clamp(-1000.0, 1000.0) as i32);
    let centre = 0.5 * min + 0.5 * max;
    // Halves go down for either sign, so that moving by whole steps moves the origin too; [0, 1] keeps origin 0.
    let origin = (centre / step - 0.5).ceil() * step;
    // Adding zero turns -0 into 0.
    if origin.is_finite() { origin + DVec3::ZERO } else { DVec3::ZERO }
}

/// Twice the area of a triangle times its unit normal, in f64: the front is where the corners run
/// counter-clockwise.
pub(crate) fn area_vector(corners: [Vec3; 3]) -> DVec3 {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    (b - a).cross(c - a)
}

/// Normals of vertices as the area-weighted mean of the faces around them; +z where that mean is zero (no face, or
/// faces that cancel).
pub(crate) fn area_weighted_normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; positions.len()];
    for t in triangles {
        let normal = area_vector(t.map(|i| positions[i as usize]));
        for &i in t {
            sums[i as usize] += normal;
        }
    }
    sums.into_iter().map(|n| unit_or(n, Vec3::Z)).collect()
}

/// `n` scaled to unit length, or `fallback` where it is zero; safe for lengths whose square under- or overflows.
pub(crate) fn unit_or(n: DVec3, fallback: Vec3) -> Vec3 {
    let largest = n.abs().max_element();
    if largest > 0.0 && largest.is_finite() { (n / largest).normalize().as_vec3() } else { fallback }
}

/// Replaces normals of length zero by area-weighted ones.
pub(crate) fn repair_normals(mesh: &mut Mesh) {
    if mesh.normals.contains(&Vec3::ZERO) {
        let computed = area_weighted_normals(&mesh.positions, &mesh.triangles);
        for (normal, computed) in mesh.normals.iter_mut().zip(computed) {
            if *normal == Vec3::ZERO {
                *normal = computed;
            }
        }
    }
}

#[cfg(test)]
mod tests;
