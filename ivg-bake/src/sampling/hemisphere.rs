//! Directions: cosine-distributed about a normal, uniform on the sphere, points in a disk.
//!
//! Sine and cosine are polynomials of our own, so that results do not depend on a platform's mathematics library.

use glam::Vec3;

/// A unit direction about the unit `normal` with density cos/π \[1/sr\].
#[inline]
pub(crate) fn cosine(normal: Vec3, u: [f32; 2]) -> Vec3 {
    let [x, y] = disk(u);
    let z = (1.0 - x * x - y * y).max(0.0).sqrt();
    let (tangent, bitangent) = basis(normal);
    (tangent * x + bitangent * y + normal * z).normalize()
}

/// A unit direction with density 1/(4π) \[1/sr\].
#[inline]
pub(crate) fn sphere(u: [f32; 2]) -> Vec3 {
    let z = 1.0 - 2.0 * u[0];
    let (sin, cos) = sin_cos_turn(u[1]);
    let radius = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(radius * cos, radius * sin, z).normalize()
}

/// A unit direction at cosine `cos` from the unit `axis`, turned by `turn` of a full circle.
#[inline]
pub(crate) fn about(axis: Vec3, cos: f32, turn: f32) -> Vec3 {
    let (tangent, bitangent) = basis(axis);
    let (s, c) = sin_cos_turn(turn);
    let radius = (1.0 - cos * cos).max(0.0).sqrt();
    (tangent * (radius * c) + bitangent * (radius * s) + axis * cos).normalize()
}

/// A point of the unit disk with density 1/π.
#[inline]
pub(crate) fn disk(u: [f32; 2]) -> [f32; 2] {
    let radius = u[0].sqrt();
    let (sin, cos) = sin_cos_turn(u[1]);
    [radius * cos, radius * sin]
}

/// Two unit vectors that with the unit `normal` make a right-handed frame (Duff et al., "Building an orthonormal
/// basis, revisited", JCGT 6(1), 2017).
#[inline]
pub(crate) fn basis(normal: Vec3) -> (Vec3, Vec3) {
    let sign = 1f32.copysign(normal.z);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    (
        Vec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x),
        Vec3::new(b, sign + normal.y * normal.y * a, -normal.y),
    )
}

/// Sine and cosine of `turn` full circles, `turn` in [0, 1).
///
/// The circle is folded to an eighth, |angle| <= π/4, where Taylor polynomials of degree 9 and 8 leave less than
/// 2e-9 and 3e-8 (next terms: (π/4)^11/11! and (π/4)^10/10!).
#[inline]
pub(crate) fn sin_cos_turn(turn: f32) -> (f32, f32) {
    let quarter = (turn * 4.0 + 0.5).floor();
    let angle = (turn * 4.0 - quarter) * core::f32::consts::FRAC_PI_2;
    let x2 = angle * angle;
    let sin = angle
        * (1.0 + x2 * (-1.0 / 6.0 + x2 * (1.0 / 120.0 + x2 * (-1.0 / 5040.0 + x2 * (1.0 / 362_880.0)))));
    let cos = 1.0 + x2 * (-0.5 + x2 * (1.0 / 24.0 + x2 * (-1.0 / 720.0 + x2 * (1.0 / 40_320.0))));
    match quarter as i32 & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

#[cfg(test)]
mod tests;
