//! From the six irradiance vectors of a point to the irradiance of a surface with a given normal.

use glam::Vec3;
use ivg_format::{Encoding, Quantity};

use crate::HemisphereVectors;

/// How much of a tangential component [`Reconstruction::ThreeVector`] leaves out where it points along the normal.
///
/// Uniform light and the axes are exact for any; the weight 1 of small components makes the formula exact to first order
/// around the axes in light of degree 1. A half is the best of round numbers in light of several lobes.
pub const TANGENTIAL_LOSS: f32 = 0.5;

/// A formula for the irradiance of a surface from the six irradiance vectors at its point.
///
/// They give the irradiance E(n) \[W/m²\] of one colour channel; `s_i` is the sign of `n_i`, `I_i` the vector
/// of the hemisphere around `s_i e_i`, `I_±i` both hemispheres of axis i, and `[j]` a component:
///
/// | | formula, before max(0, ·) | vectors read |
/// |---|---|---|
/// | [`NSquared`](Self::NSquared) | `Σ_i n_i² (I_i · n)` | 3 |
/// | [`ThreeVector`](Self::ThreeVector) | `Σ_i n_i² (s_i I_i[i] + Σ_{j≠i} n_j (1 − ½\|n_j\|) I_i[j])` | 3 |
/// | [`SixVector`](Self::SixVector) | `½ [Σ_j n_j V_j + Σ_j n_j² A_j[j] + ½ Σ_{j≠k} n_j n_k A_j[k]]`, `V_j = (I_+j + I_-j)[j]`, `A_j = I_+j − I_-j` | 6 |
///
/// All three are exact for normals along the axes and continuous in the normal. The first is what both papers print
/// (Web3D 2008, section 3.2); it loses light between the axes: under uniform radiance L it gives
/// `π L (|n_x|³ + |n_y|³ + |n_z|³)` instead of `π L`, a quarter too little on average and 42 % on the diagonal. The
/// other two are exact in uniform light. The third is exact for all radiance band-limited to spherical harmonics of
/// degree 2, and the most accurate of the three (but under one or two point-like lights) also where the channels of a vector
/// share one direction: it takes the net flux and the squares from components along the hemispheres' axes, which packing
/// keeps. The second reads half as many vectors, of which packing bends the tangential components: on a baked room it is
/// off by 4.4 % where the third is by 2.5 % (in floating-point vectors 2.2 and 1.8 %; example `accuracy` of the baker).
/// `cargo run -p ivg-grid --release --example reconstruction_error` prints how far each is off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Reconstruction {
    /// The papers' blend with squared normal components: the baseline, 25 % too dark in uniform light.
    NSquared,
    /// The same three vectors with the component along each axis taken whole.
    ThreeVector,
    /// All six vectors, in a quadratic form of the normal: the most accurate.
    SixVector,
    /// The convolution of the radiance harmonics with the cosine: see [`harmonics`](crate::harmonics).
    Harmonics,
}

impl Reconstruction {
    /// All formulas.
    pub const ALL: [Self; 4] = [Self::NSquared, Self::ThreeVector, Self::SixVector, Self::Harmonics];

    /// The formulas that start from irradiance vectors, the papers' baseline first.
    pub const OF_VECTORS: [Self; 3] = [Self::NSquared, Self::ThreeVector, Self::SixVector];

    /// The name that commands and reports use: `n2`, `three`, `six` or `sh2`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::NSquared => "n2",
            Self::ThreeVector => "three",
            Self::SixVector => "six",
            Self::Harmonics => "sh2",
        }
    }

    /// The formula with that [`name`](Self::name).
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }

    /// The formula of an encoding unless its user asks for another (IVG-IRR-06): six vectors where every channel has its
    /// own, three, for half the reading, where the channels share a direction.
    #[must_use]
    pub fn for_encoding(encoding: Encoding) -> Self {
        match encoding {
            Encoding::VectorsF32 => Self::SixVector,
            Encoding::Sh2 => Self::Harmonics,
            _ => Self::ThreeVector,
        }
    }

    /// Whether the formula can be evaluated from a quantity.
    #[must_use]
    pub fn fits(self, quantity: Quantity) -> bool {
        (self == Self::Harmonics) == (quantity == Quantity::Radiance)
    }

    /// Whether the formula reads a hemisphere's vectors for a surface with normal `n`.
    #[must_use]
    pub(crate) fn reads(self, hemisphere: usize, n: Vec3) -> bool {
        match self {
            Self::NSquared | Self::ThreeVector => hemisphere == facing(hemisphere / 2, n),
            Self::SixVector => true,
            Self::Harmonics => false,
        }
    }
}

/// The irradiance of a surface with unit normal `n` \[W/m²\], one value a channel, never negative.
///
/// # Panics
///
/// With [`Reconstruction::Harmonics`], which has no vectors to start from.
#[must_use]
pub fn reconstruct(method: Reconstruction, vectors: &HemisphereVectors, n: Vec3) -> Vec3 {
    reconstruct_signed(method, vectors, n).max(Vec3::ZERO)
}

/// What [`reconstruct`] cuts off at zero \[W/m²\]: narrow light can make it negative behind the surface.
///
/// Linear in the vectors, so it commutes with their interpolation.
///
/// # Panics
///
/// With [`Reconstruction::Harmonics`], which has no vectors to start from.
#[must_use]
pub fn reconstruct_signed(method: Reconstruction, vectors: &HemisphereVectors, n: Vec3) -> Vec3 {
    match method {
        Reconstruction::NSquared => n_squared(vectors, n),
        Reconstruction::ThreeVector => three_vector(vectors, n, tangential_weights(n)),
        Reconstruction::SixVector => six_vector(vectors, n),
        Reconstruction::Harmonics => panic!("irradiance vectors cannot be reconstructed by sh2"),
    }
}

/// What the tangential components count in [`Reconstruction::ThreeVector`]: `n_j (1 − |n_j| / 2)`.
#[must_use]
#[inline]
pub fn tangential_weights(n: Vec3) -> Vec3 {
    n * (Vec3::ONE - TANGENTIAL_LOSS * n.abs())
}

/// [`Reconstruction::ThreeVector`] with other weights of the tangential components, before the cut at zero \[W/m²\].
#[must_use]
pub fn three_vector(vectors: &HemisphereVectors, n: Vec3, tangential: Vec3) -> Vec3 {
    per_channel(|channel| {
        let mut sum = 0.0;
        for axis in 0..3 {
            let vector = vectors[facing(axis, n)][channel];
            let own = if n[axis] < 0.0 { -vector[axis] } else { vector[axis] };
            let [a, b] = others(axis).map(|other| tangential[other] * vector[other]);
            sum += n[axis] * n[axis] * (own + (a + b));
        }
        sum
    })
}

fn n_squared(vectors: &HemisphereVectors, n: Vec3) -> Vec3 {
    per_channel(|channel| {
        (0..3).map(|axis| n[axis] * n[axis] * n.dot(Vec3::from(vectors[facing(axis, n)][channel]))).sum()
    })
}

fn six_vector(vectors: &HemisphereVectors, n: Vec3) -> Vec3 {
    per_channel(|channel| {
        let mut sum = 0.0;
        for axis in 0..3 {
            let plus = vectors[2 * axis][channel];
            let minus = vectors[2 * axis + 1][channel];
            // The sum of a pair is the same net flux for all three axes. Its component j is taken from the pair of
            // axis j, because packing keeps the component along the axis and bends the others.
            sum += n[axis] * (plus[axis] + minus[axis]);
            sum += n[axis] * n[axis] * (plus[axis] - minus[axis]);
            for other in others(axis) {
                sum += 0.5 * n[axis] * n[other] * (plus[other] - minus[other]);
            }
        }
        0.5 * sum
    })
}

/// The hemisphere of an axis that a surface with normal `n` faces.
fn facing(axis: usize, n: Vec3) -> usize {
    2 * axis + usize::from(n[axis] < 0.0)
}

fn others(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

fn per_channel(channel: impl Fn(usize) -> f32) -> Vec3 {
    Vec3::new(channel(0), channel(1), channel(2))
}

#[cfg(test)]
mod tests;
