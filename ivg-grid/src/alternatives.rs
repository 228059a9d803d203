//! Other forms of the same light, for comparison: what engines store in a probe today.
//!
//! None of them is an encoding of the format. They are made from the two quantities that a grid holds, so that tables can
//! put them beside the reconstructions: see the examples `reconstruction_error` of this crate and `accuracy` of the baker.

use std::f32::consts::PI;

use glam::{DVec3, Vec3};
use ivg_format::{HemisphereVectors, RadianceHarmonics};

use crate::harmonics::{basis, irradiance_weights};

/// Rec. 709 luminance of linear RGB.
const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// √(5/4π), the zonal harmonic of degree 2 at its pole.
const POLE: f32 = 0.630_783_13;

/// The ambient cube (G. McTaggart, "Half-Life 2 / Valve Source shading", 2004): irradiance of the six axis-aligned
/// surfaces blended with squared normal components \[W/m²\]. 18 numbers.
#[must_use]
pub fn ambient_cube(vectors: &HemisphereVectors, n: Vec3) -> Vec3 {
    (0..3)
        .map(|axis| {
            let negative = n[axis] < 0.0;
            let side = vectors[2 * axis + usize::from(negative)];
            let along = Vec3::from(side.map(|vector| vector[axis]));
            n[axis] * n[axis] * if negative { -along } else { along }
        })
        .sum()
}

/// Spherical harmonics to degree 1, before the cut at zero \[W/m²\]. 12 numbers.
#[must_use]
pub fn linear_harmonics(radiance: &RadianceHarmonics, n: Vec3) -> Vec3 {
    let weights = irradiance_weights(n);
    Vec3::from(radiance.map(|channel| (0..4).map(|k| channel[k] * weights[k]).sum()))
}

/// Zonal harmonics of degree 2 upon the linear ones, about the direction that the luminance mostly comes from, before the
/// cut at zero \[W/m²\] (T. Roughton, P.-P. Sloan, A. Silvennoinen, M. Iwanicki, P. Shirley, "ZH3: quadratic zonal
/// harmonics", 2024). 15 numbers.
#[must_use]
pub fn zonal_harmonics(radiance: &RadianceHarmonics, n: Vec3) -> Vec3 {
    let linear = linear_harmonics(radiance, n);
    let towards = |k: usize| (0..3).map(|channel| LUMINANCE[channel] * radiance[channel][k]).sum::<f32>();
    let Some(axis) = Vec3::new(towards(3), towards(1), towards(2)).try_normalize() else { return linear };
    let at_axis = basis(DVec3::from(axis)).map(|y| y as f32);
    let cos = axis.dot(n);
    let zonal = 0.25 * PI * POLE * (1.5 * cos * cos - 0.5);
    let projected = radiance.map(|channel| (4..9).map(|k| channel[k] * at_axis[k]).sum::<f32>() / POLE);
    linear + Vec3::from(projected) * zonal
}

#[cfg(test)]
mod tests;
