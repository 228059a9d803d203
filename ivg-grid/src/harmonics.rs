//! Spherical harmonics of the radiance: the basis, and the irradiance of a surface.

use std::f32::consts::PI;

use glam::Vec3;
use ivg_format::RadianceHarmonics;

/// √(1/4π), √(3/4π), √(15/4π), √(5/16π) and √(15/16π): the norms of the basis (IVG-SH-01).
const NORMS: [f32; 5] = [0.282_094_8, 0.488_602_5, 1.092_548_4, 0.315_391_57, 0.546_274_2];

/// The nine functions of the basis in direction `w` of unit length, in the order of [`RadianceHarmonics`] (IVG-SH-01).
#[must_use]
pub fn basis(w: Vec3) -> [f32; 9] {
    let [constant, linear, mixed, zonal, square] = NORMS;
    let Vec3 { x, y, z } = w;
    [
        constant,
        linear * y,
        linear * z,
        linear * x,
        mixed * x * y,
        mixed * y * z,
        zonal * (3.0 * z * z - 1.0),
        mixed * x * z,
        square * (x * x - y * y),
    ]
}

/// The irradiance of a surface with unit normal `n` \[W/m²\], one value a channel, never negative.
#[must_use]
pub fn irradiance(radiance: &RadianceHarmonics, n: Vec3) -> Vec3 {
    irradiance_signed(radiance, n).max(Vec3::ZERO)
}

/// What [`irradiance`] cuts off at zero \[W/m²\]: the sum of coefficient times basis times π, 2π/3 or π/4 for degree 0, 1 or
/// 2 (Ramamoorthi and Hanrahan, An efficient representation for irradiance environment maps, 2001).
#[must_use]
pub fn irradiance_signed(radiance: &RadianceHarmonics, n: Vec3) -> Vec3 {
    let basis = basis(n);
    let degree = |first: usize, last: usize| {
        Vec3::from(radiance.map(|c| (first..=last).map(|k| c[k] * basis[k]).sum::<f32>()))
    };
    PI * degree(0, 0) + (2.0 * PI / 3.0) * degree(1, 3) + (0.25 * PI) * degree(4, 8)
}
