//! Writing: a grid's values on their way to bytes. What the encoding keeps of each vertex is found once for all; the largest
//! number of all gives the scale exponent; then records are written from it in any order.

mod hemispheres;
mod keep;

use super::harmonics::{MEAN_BYTES, RATIOS};
use crate::encoding::Encoding;
use crate::header::{SCALE_EXPONENTS, scale_exponents};
use crate::quant::direction::Octahedral24;
use crate::quant::pair::{HalfDirection, SingleDirection};
use crate::quant::xyz::Xyz24;
use crate::quant::{floor_log2, power_of_two_f64, ratio, rgb9e5};
use crate::values::{HemisphereVectors, RadianceHarmonics, Values};
use alloc::vec::Vec;
use hemispheres::Hemispheres;

/// Vertices that are gathered at once: they lie far from each other, and memory answers many requests in the time of one.
const GATHERED: usize = 32;

/// Vertices whose radiance is related to its mean at once.
const RELATED: usize = 8;

/// The mean radiance of a vertex, and codes of the ratios to it.
type Related = ([u8; MEAN_BYTES], [u8; RATIOS]);

/// Why values cannot be stored, and where: the vertex' linear index, the hemisphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fault {
    /// The encoding stores the other quantity.
    Quantity,
    NotFinite(usize, usize),
    TooLarge(usize, usize),
    RadianceNotFinite(usize),
    RadianceTooLarge(usize),
    /// The exponent that is given is too small, or not what the encoding has.
    ScaleExponent {
        file: i16,
        needed: i16,
    },
}

/// The values of all vertices.
pub(crate) enum Prepared<'a> {
    /// `packed-oct24`.
    Octahedral(Hemispheres<'a, Octahedral24>),
    /// `packed-xyz24`.
    Bytes(Hemispheres<'a, Xyz24>),
    /// `pair-f16`, and `pair-f16x4` with each three numbers followed by a zero.
    Half { hemispheres: Hemispheres<'a, HalfDirection>, padded: bool },
    /// `pair-f32`.
    Single(Hemispheres<'a, SingleDirection>),
    /// Numbers as they are.
    Vectors(&'a [HemisphereVectors]),
    /// Means, and codes of the ratios to them.
    Harmonics { vertices: Vec<Related>, scale_exponent: i16 },
}

impl<'a> Prepared<'a> {
    /// At a scale exponent as `scale` asks for.
    pub(crate) fn new(values: Values<'a>, encoding: Encoding, scale: Scale) -> Result<Self, Fault> {
        match (encoding, values) {
            (Encoding::PackedOct24, Values::Vectors(vectors)) => {
                Ok(Self::Octahedral(Hemispheres::new(vectors, scale)?))
            }
            (Encoding::PackedXyz24, Values::Vectors(vectors)) => {
                Ok(Self::Bytes(Hemispheres::new(vectors, scale)?))
            }
            (Encoding::PairF16 | Encoding::PairF16x4, Values::Vectors(vectors)) => Ok(Self::Half {
                hemispheres: Hemispheres::new(vectors, scale)?,
                padded: encoding == Encoding::PairF16x4,
            }),
            (Encoding::PairF32, Values::Vectors(vectors)) => {
                Ok(Self::Single(Hemispheres::new(vectors, scale)?))
            }
            (Encoding::VectorsF32, Values::Vectors(vectors)) => {
                match vectors.iter().enumerate().find_map(|(n, vertex)| Some((n, not_finite(vertex)?))) {
                    None => match scale {
                        Scale::Fixed(file) if file != 0 => Err(Fault::ScaleExponent { file, needed: 0 }),
                        _ => Ok(Self::Vectors(vectors)),
                    },
                    Some((vertex, hemisphere)) => Err(Fault::NotFinite(vertex, hemisphere)),
                }
            }
            (Encoding::Sh2, Values::Radiance(radiance)) => {
                let scale_exponent = scale_radiance(radiance, scale)?;
                Ok(Self::Harmonics { vertices: relate(radiance, scale_exponent), scale_exponent })
            }
            _ => Err(Fault::Quantity),
        }
    }

    pub(crate) fn scale_exponent(&self) -> i16 {
        match self {
            Self::Octahedral(hemispheres) => hemispheres.scale_exponent(),
            Self::Bytes(hemispheres) => hemispheres.scale_exponent(),
            Self::Half { hemispheres, .. } => hemispheres.scale_exponent(),
            Self::Single(hemispheres) => hemispheres.scale_exponent(),
            Self::Vectors(_) => 0,
            Self::Harmonics { scale_exponent, .. } => *scale_exponent,
        }
    }

    /// Fills a payload with the values of some vertices, given by their linear indices: as many as it has room for.
    pub(crate) fn fill(&self, payload: &mut [u8], vertices: impl Iterator<Item = u64>) {
        let vertices: &[u64] = &vertices.collect::<Vec<_>>();
        match self {
            Self::Octahedral(hemispheres) => hemispheres.fill_packed(payload, vertices),
            Self::Bytes(hemispheres) => hemispheres.fill_packed(payload, vertices),
            Self::Half { hemispheres, padded: false } => hemispheres.fill_half::<6>(payload, vertices),
            Self::Half { hemispheres, padded: true } => hemispheres.fill_half::<8>(payload, vertices),
            Self::Single(hemispheres) => hemispheres.fill_single(payload, vertices),
            Self::Vectors(vectors) => {
                let (payload, _) = payload.as_chunks_mut::<{ size_of::<HemisphereVectors>() }>();
                for (bytes, &vertex) in payload.iter_mut().zip(vertices) {
                    let components = vectors[vertex as usize].as_flattened().as_flattened();
                    for (bytes, number) in bytes.as_chunks_mut().0.iter_mut().zip(components) {
                        *bytes = number.to_le_bytes();
                    }
                }
            }
            Self::Harmonics { vertices: all, .. } => fill_radiance(all, payload, vertices),
        }
    }
}

/// The first hemisphere of a vertex with a number that is not finite.
fn not_finite(vertex: &HemisphereVectors) -> Option<usize> {
    // Together first, since nearly every vertex passes.
    let finite = vertex.as_flattened().as_flattened().iter().fold(true, |all, c| all & c.is_finite());
    if finite { None } else { vertex.iter().position(|v| !v.as_flattened().iter().all(|c| c.is_finite())) }
}

/// The scale exponent of the radiance of a grid, which must be finite and no more than can be stored.
fn scale_radiance(radiance: &[RadianceHarmonics], scale: Scale) -> Result<i16, Fault> {
    let highest = *scale_exponents(Encoding::Sh2).end();
    let limit = f64::from(rgb9e5::LARGEST) * power_of_two_f64(i32::from(highest));
    let mut largest = 0.0f64;
    for (vertex, channels) in radiance.iter().enumerate() {
        if !channels.as_flattened().iter().fold(true, |all, c| all & c.is_finite()) {
            return Err(Fault::RadianceNotFinite(vertex));
        }
        largest = channels.iter().fold(largest, |most, coefficients| most.max(f64::from(coefficients[0])));
        if largest > limit {
            return Err(Fault::RadianceTooLarge(vertex));
        }
    }
    Ok(settle(largest, rgb9e5::LARGEST, scale)?.min(highest))
}

/// Means, and codes of the ratios to them (IVG-SH-06).
fn relate(radiance: &[RadianceHarmonics], scale_exponent: i16) -> Vec<Related> {
    let mut vertices = Vec::with_capacity(radiance.len());
    let (chunks, rest) = radiance.as_chunks::<RELATED>();
    let (ones, _) = rest.as_chunks::<1>();
    chunks.iter().for_each(|chunk| vertices.extend_from_slice(&relate_all(chunk, scale_exponent)));
    ones.iter().for_each(|one| vertices.extend_from_slice(&relate_all(one, scale_exponent)));
    vertices
}

#[inline(always)]
fn relate_all<const N: usize>(radiance: &[RadianceHarmonics; N], scale_exponent: i16) -> [Related; N] {
    let scale = power_of_two_f64(-i32::from(scale_exponent));
    let mut means = [[0.0; N]; 3];
    for (channel, means) in means.iter_mut().enumerate() {
        for (to, channels) in means.iter_mut().zip(radiance) {
            let [mean, ..] = channels[channel];
            *to = f64::from(if mean > 0.0 { mean } else { 0.0 }) * scale;
        }
    }
    let means = rgb9e5::encode_all(&means);
    let mut related = [Related::default(); N];
    for (n, (mean, ratios)) in related.iter_mut().enumerate() {
        *mean = means[n].to_le_bytes();
        // The ratios are taken to the means as they will be decoded, so that their rounding is not passed on.
        *ratios = ratio::encode_all(&radiance[n], rgb9e5::decode_scaled(means[n], scale_exponent));
    }
    related
}

/// Fills a payload with means, then with the codes of ratios.
fn fill_radiance(all: &[Related], payload: &mut [u8], vertices: &[u64]) {
    let count = payload.len() / (MEAN_BYTES + RATIOS);
    let (means, ratios) = payload.split_at_mut(count * MEAN_BYTES);
    let (means, _) = means.as_chunks_mut();
    let (ratios, _) = ratios.as_chunks_mut();
    for ((mean, ratios), &vertex) in means.iter_mut().zip(ratios).zip(vertices) {
        (*mean, *ratios) = all[vertex as usize];
    }
}

/// Which scale exponent to store with.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Scale {
    /// The smallest that holds the grid, and this many more.
    Smallest {
        /// Powers of two by which light may get brighter later.
        headroom: u8,
    },
    /// That of a file that is there already.
    Fixed(i16),
}

/// The scale exponent of a file that has one already, if it holds `largest`; otherwise the one that a writer should choose.
fn settle(largest: f64, storable: f32, scale: Scale) -> Result<i16, Fault> {
    let needed = scale_exponent(largest, storable);
    match scale {
        Scale::Fixed(file) if largest > f64::from(storable) * power_of_two_f64(i32::from(file)) => {
            Err(Fault::ScaleExponent { file, needed })
        }
        Scale::Fixed(file) => Ok(file),
        // Nothing is scaled in binary32, and darkness has no size.
        Scale::Smallest { .. } if largest <= 0.0 || storable == f32::MAX => Ok(needed),
        Scale::Smallest { headroom } => Ok((needed + i16::from(headroom)).min(*SCALE_EXPONENTS.end())),
    }
}

/// The smallest exponent e in range with `largest / 2^e` ≤ `storable`, which is a little below 2^16; 0 for a grid without
/// light, and for binary32 (IVG-PACK-06, IVG-PAIR-07).
fn scale_exponent(largest: f64, storable: f32) -> i16 {
    if largest <= 0.0 || storable == f32::MAX {
        return 0;
    }
    let (low, high) = (i32::from(*SCALE_EXPONENTS.start()), i32::from(*SCALE_EXPONENTS.end()));
    let mut exponent = (floor_log2(largest) - 15).clamp(low, high);
    if largest > f64::from(storable) * power_of_two_f64(exponent) {
        exponent += 1;
    }
    exponent.min(high) as i16
}
