//! Radiance as real spherical harmonics to degree 2, and what follows from it in closed form.
//!
//! L(w) = Σ c_lm Y_lm(w), with w pointing to where the light comes from. The nine functions are orthonormal over the
//! sphere, without the Condon-Shortley sign, and stored in the order (0,0) (1,−1) (1,0) (1,1) (2,−2) (2,−1) (2,0)
//! (2,1) (2,2):
//!
//! | | | |
//! |---|---|---|
//! | Y₀₀ = 1 / (2√π) | | |
//! | Y₁₋₁ = √(3/4π) y | Y₁₀ = √(3/4π) z | Y₁₁ = √(3/4π) x |
//! | Y₂₋₂ = √(15/4π) xy | Y₂₋₁ = √(15/4π) yz | Y₂₀ = √(5/16π) (3z² − 1) |
//! | Y₂₁ = √(15/4π) xz | Y₂₂ = √(15/16π) (x² − y²) | |
//!
//! The irradiance of a surface is the radiance seen through the clamped cosine, whose harmonics fall off so fast that
//! degree 2 carries nearly all of it (R. Ramamoorthi, P. Hanrahan, "An efficient representation for irradiance
//! environment maps", 2001): E(n) = Σ A_l c_lm Y_lm(n), A_0 = π, A_1 = 2π/3, A_2 = π/4.
//!
//! Everything here is linear in the coefficients, so coefficients are what is interpolated.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use ivg_format::{HemisphereVectors, RadianceHarmonics};

/// Coefficients of a channel.
pub const COEFFICIENTS: usize = 9;

/// What the clamped cosine makes of each degree, 0 to 2 (Ramamoorthi and Hanrahan 2001, equations 7 and 8).
pub const COSINE_FACTORS: [f64; 3] = [PI, 2.0 * PI / 3.0, PI / 4.0];

/// The degree of each coefficient.
const DEGREES: [usize; COEFFICIENTS] = [0, 1, 1, 1, 2, 2, 2, 2, 2];

/// Factors of the polynomials: 1 / (2√π), √(3/4π), √(15/4π), √(5/16π), √(15/16π).
const Y0: f64 = 0.282_094_791_773_878_14;
const Y1: f64 = 0.488_602_511_902_919_9;
const Y2: f64 = 1.092_548_430_592_079_2;
const Y20: f64 = 0.315_391_565_252_520_05;
const Y22: f64 = 0.546_274_215_296_039_6;

/// The largest value that any of the nine functions takes: √(5/4π), of Y₂₀ at the poles.
pub const LARGEST_BASIS_VALUE: f64 = 0.630_783_130_505_040_1;

/// The nine functions at the unit direction `w`.
#[must_use]
#[inline]
pub fn basis(w: DVec3) -> [f64; COEFFICIENTS] {
    let DVec3 { x, y, z } = w;
    [
        Y0,
        Y1 * y,
        Y1 * z,
        Y1 * x,
        Y2 * x * y,
        Y2 * y * z,
        Y20 * (3.0 * z * z - 1.0),
        Y2 * x * z,
        Y22 * (x * x - y * y),
    ]
}

/// What each coefficient adds to the irradiance of a surface with unit normal `n` \[sr\]: A_l Y_lm(n).
#[must_use]
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "factors of at most π")]
pub fn irradiance_weights(n: Vec3) -> [f32; COEFFICIENTS] {
    const WEIGHTS: [f32; 5] = [
        (COSINE_FACTORS[0] * Y0) as f32,
        (COSINE_FACTORS[1] * Y1) as f32,
        (COSINE_FACTORS[2] * Y2) as f32,
        (COSINE_FACTORS[2] * Y20) as f32,
        (COSINE_FACTORS[2] * Y22) as f32,
    ];
    let Vec3 { x, y, z } = n;
    let [constant, linear, mixed, polar, square] = WEIGHTS;
    [
        constant,
        linear * y,
        linear * z,
        linear * x,
        mixed * x * y,
        mixed * y * z,
        polar * (3.0 * z * z - 1.0),
        mixed * x * z,
        square * (x * x - y * y),
    ]
}

/// The irradiance of a surface with unit normal `n` \[W/m²\], one value a channel, never negative.
#[must_use]
pub fn irradiance(radiance: &RadianceHarmonics, n: Vec3) -> Vec3 {
    irradiance_signed(radiance, n).max(Vec3::ZERO)
}

/// What [`irradiance`] cuts off at zero \[W/m²\]: narrow light can make it negative behind the surface.
#[must_use]
#[inline]
pub fn irradiance_signed(radiance: &RadianceHarmonics, n: Vec3) -> Vec3 {
    let weights = irradiance_weights(n);
    Vec3::from(radiance.map(|channel| channel.iter().zip(weights).map(|(c, weight)| c * weight).sum()))
}

/// The six irradiance vectors of radiance that is what its harmonics say \[W/m²\]: exact for radiance band-limited to
/// degree 2.
///
/// A channel is the polynomial L(w) = p + q·w + w·Qw. Over the hemisphere around `s e_a`, s = ±1, the integrals of
/// `w_a`, `w_k²`, `w_a³` and `w_a w_b²` are sπ, 2π/3, sπ/2 and sπ/4 (b ≠ a), and those of all other monomials of degree 1 to
/// 3 that are needed vanish. So the vector I of that hemisphere has
///
/// * `I[a] = sπ p + (2π/3) q_a + sπ/4 (Q_aa + tr Q)`,
/// * `I[b] = (2π/3) q_b + sπ/2 Q_ab`.
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "the result is in single precision")]
pub fn hemisphere_vectors(radiance: &RadianceHarmonics) -> HemisphereVectors {
    let polynomials = radiance.map(|channel| Polynomial::new(&channel));
    std::array::from_fn(|hemisphere| {
        let axis = hemisphere / 2;
        let sign = if hemisphere % 2 == 0 { 1.0 } else { -1.0 };
        polynomials.each_ref().map(|p| {
            std::array::from_fn(|component| {
                let odd = if component == axis {
                    p.constant + 0.25 * (p.quadratic[axis][axis] + p.trace())
                } else {
                    0.5 * p.quadratic[axis][component]
                };
                (PI * (2.0 / 3.0 * p.linear[component] + sign * odd)) as f32
            })
        })
    })
}

/// Radiance of one channel as a polynomial of the direction: constant + linear·w + w·quadratic w.
struct Polynomial {
    constant: f64,
    linear: [f64; 3],
    quadratic: [[f64; 3]; 3],
}

impl Polynomial {
    fn new(coefficients: &[f32; COEFFICIENTS]) -> Self {
        let c = coefficients.map(f64::from);
        let [xy, yz, xz] = [4, 5, 7].map(|n| 0.5 * Y2 * c[n]);
        let (square, polar) = (Y22 * c[8], Y20 * c[6]);
        Self {
            constant: Y0 * c[0] - polar,
            linear: [Y1 * c[3], Y1 * c[1], Y1 * c[2]],
            quadratic: [[square, xy, xz], [xy, -square, yz], [xz, yz, 3.0 * polar]],
        }
    }

    fn trace(&self) -> f64 {
        (0..3).map(|axis| self.quadratic[axis][axis]).sum()
    }
}

/// The largest size that the ratio of coefficient `n` to coefficient 0 can have for radiance that is nowhere negative:
/// (most negative, most positive).
///
/// Both are reached, by light from a single direction (for (2,0): from the equator and from a pole): the ratio is a mean of
/// Y_lm / Y₀₀ with the radiance as weight.
///
/// # Panics
///
/// If `n` is not 1 to 8.
#[must_use]
pub fn ratio_bounds(n: usize) -> (f64, f64) {
    match (n, DEGREES[n]) {
        (6, _) => (-0.5 * 5.0_f64.sqrt(), 5.0_f64.sqrt()),
        (_, 1) => (-(3.0_f64.sqrt()), 3.0_f64.sqrt()),
        (_, 2) => (-0.5 * 15.0_f64.sqrt(), 0.5 * 15.0_f64.sqrt()),
        _ => panic!("coefficient 0 is what the others are compared with"),
    }
}

#[cfg(test)]
mod tests;
