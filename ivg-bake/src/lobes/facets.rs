//! Rough mirrors: facets with GGX slopes and Smith's masking.
//!
//! Directions are drawn from the facets that are seen (J. Dupuy, A. Benyoub, "Sampling visible GGX normals with spherical
//! caps", HPG 2023); what other facets then shade is not lost but reflected again (C. Kulla, A. Conty, "Revisiting physically
//! based shading at Imageworks", SIGGRAPH 2017 course): with E(w) the share that leaves after one reflection, in proportion
//! to (1 − E(in)) (1 − E(out)) cos. Instead of a table of E, a facet is drawn and it is seen whether the light gets away. So
//! a metal that absorbs nothing loses nothing, and reflection is the same both ways.

use core::f32::consts::PI;

use glam::{Vec2, Vec3};

use crate::sampling::hemisphere;
use crate::sampling::rng::{Purpose, Stream};

/// A rough mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Facets {
    alpha: f32,
    /// Share of even light that the first facet does not send away.
    again: f32,
}

/// Directions drawn to find [`Facets::again`].
const MEAN_DRAWS: u32 = 16_384;

/// Directions drawn for light that is reflected again, at most. The share of it is as small as that of the draws that fit, so
/// that one is needed on average.
const MOST_DRAWS: u32 = 4096;

/// Blocks of random numbers of one reflection.
const BLOCKS: u32 = 4 * MOST_DRAWS;

impl Facets {
    /// Facets of width `alpha` in (0, 1].
    pub(super) fn new(alpha: f32) -> Self {
        let facets = Self { alpha, again: 0.0 };
        let stream = Stream::new(0, 0);
        let lost: f64 = (0..MEAN_DRAWS)
            .map(|n| {
                let [u, v, x, y] = stream.uniforms(n, Purpose::Facets);
                let towards = hemisphere::cosine(Vec3::Z, [u, v]);
                let away = facets.draw(towards, Vec2::new(x, y)).map_or(0.0, |(_, _, away)| away);
                f64::from(1.0 - away)
            })
            .sum();
        Self { alpha, again: (lost / f64::from(MEAN_DRAWS)) as f32 }
    }

    /// Light that leaves towards `towards`, or by symmetry arrives from there, after one reflection at a surface with normal
    /// `side`: the other direction and the cosine on the facet. `None` if another facet is in the way. `u` and `choice` are
    /// uniform in [0, 1).
    pub(super) fn reflect(&self, towards: Vec3, side: Vec3, u: Vec2, choice: f32) -> Option<(Vec3, f32)> {
        let frame = Frame::new(side);
        let (other, cos, away) = self.draw(frame.local(towards), u)?;
        (choice < away).then(|| (frame.world(other).normalize(), cos))
    }

    /// Direction of light that was reflected by more than one facet.
    pub(super) fn reflect_again(&self, side: Vec3, stream: &Stream, step: u32) -> Vec3 {
        let mut direction = side;
        for draw in 0..MOST_DRAWS {
            let block = step.wrapping_mul(BLOCKS).wrapping_add(2 * draw);
            let [u, v, choice, _] = stream.uniforms(block, Purpose::Facets);
            direction = hemisphere::cosine(side, [u, v]);
            let [x, y, ..] = stream.uniforms(block + 1, Purpose::Facets);
            if self.reflect(direction, side, Vec2::new(x, y), choice).is_none() {
                break;
            }
        }
        direction
    }

    /// Density of the directions of [`Facets::reflect_again`] at `from`, as a multiple of cos / π: a sample.
    pub(super) fn share_again(&self, side: Vec3, from: Vec3, stream: &Stream, step: u32) -> f32 {
        let block = step.wrapping_mul(BLOCKS).wrapping_add(2 * MOST_DRAWS);
        let [x, y, choice, _] = stream.uniforms(block, Purpose::Facets);
        let caught = self.reflect(from, side, Vec2::new(x, y), choice).is_none();
        if caught && self.again > 0.0 { 1.0 / self.again } else { 0.0 }
    }

    /// Reflection from `from` towards `towards` by one facet, times the cosine of `from` \[1/sr\], and the cosine on the facet
    /// (B. Walter et al., "Microfacet models for refraction through rough surfaces", EGSR 2007, equation 20).
    pub(super) fn evaluate(&self, side: Vec3, from: Vec3, towards: Vec3) -> (f32, f32) {
        let frame = Frame::new(side);
        let (from, towards) = (frame.local(from), frame.local(towards));
        let half = (from + towards).normalize_or_zero();
        if from.z <= 0.0 || towards.z <= 0.0 || half.z <= 0.0 {
            return (0.0, 1.0);
        }
        let a2 = self.alpha * self.alpha;
        let density = a2 / (PI * (half.z * half.z * (a2 - 1.0) + 1.0).powi(2));
        let seen = 1.0 / (1.0 + self.masking(from) + self.masking(towards));
        (density * seen / (4.0 * towards.z), towards.dot(half))
    }

    /// In the frame of the surface: a direction reflected by one of the facets seen from `towards`, the cosine on it, and the
    /// probability that no other facet is in its way. `None` for a direction into the surface.
    fn draw(&self, towards: Vec3, u: Vec2) -> Option<(Vec3, f32, f32)> {
        let stretched = Vec3::new(self.alpha * towards.x, self.alpha * towards.y, towards.z).normalize();
        let z = (1.0 - u.y) * (1.0 + stretched.z) - stretched.z;
        let radius = (1.0 - z * z).max(0.0).sqrt();
        let (sin, cos) = hemisphere::sin_cos_turn(u.x);
        let half = Vec3::new(radius * cos, radius * sin, z) + stretched;
        let facet = Vec3::new(self.alpha * half.x, self.alpha * half.y, half.z).normalize_or_zero();
        let on_facet = towards.dot(facet);
        let other = facet * (2.0 * on_facet) - towards;
        if other.z <= 0.0 {
            return None;
        }
        let shaded = 1.0 + self.masking(towards);
        Some((other, on_facet, shaded / (shaded + self.masking(other))))
    }

    /// Smith's Lambda of a direction in the frame of the surface.
    fn masking(&self, w: Vec3) -> f32 {
        let cos2 = w.z * w.z;
        let tan2 = (w.x * w.x + w.y * w.y) / cos2.max(f32::MIN_POSITIVE);
        0.5 * ((1.0 + self.alpha * self.alpha * tan2).sqrt() - 1.0)
    }
}

/// A surface's own axes: its normal is z.
struct Frame([Vec3; 3]);

impl Frame {
    fn new(normal: Vec3) -> Self {
        let (x, y) = hemisphere::basis(normal);
        Self([x, y, normal])
    }

    fn local(&self, w: Vec3) -> Vec3 {
        Vec3::from_array(self.0.map(|axis| axis.dot(w)))
    }

    fn world(&self, w: Vec3) -> Vec3 {
        self.0[0] * w.x + self.0[1] * w.y + self.0[2] * w.z
    }
}

#[cfg(test)]
mod tests;
