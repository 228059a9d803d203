//! Writing: a grid's values on their way to bytes. What the encoding keeps of each vertex is found once for all; the largest
//! number of all gives the scale exponent; then records are written from it in any order.

use super::HEMISPHERES;
use super::harmonics::RATIOS;
use crate::encoding::Encoding;
use crate::header::SCALE_EXPONENTS;
use crate::quant::direction::Octahedral24;
use crate::quant::pack::{DirectionQuantiser, PackedHemisphere, pack_all};
use crate::quant::pair::{HalfDirection, SingleDirection};
use crate::quant::xyz::Xyz24;
use crate::quant::{floor_log2, half, power_of_two_f64, ratio, rgb9e5};
use crate::values::{HemisphereVectors, RadianceHarmonics, Values};
use alloc::vec;
use alloc::vec::Vec;

/// Vertices that are packed at once.
const VERTICES: usize = 16;

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
    /// Direction codes of three bytes, RGB9E5 colours.
    Packed(Hemispheres<u32>),
    /// binary16, each three numbers followed by a zero or not.
    Half { hemispheres: Hemispheres<[u16; 3]>, padded: bool },
    /// binary32.
    Single(Hemispheres<[f32; 3]>),
    /// Numbers as they are.
    Vectors(&'a [HemisphereVectors]),
    /// Means, and codes of the ratios to them.
    Harmonics { vertices: Vec<([u8; 4], [u8; RATIOS])>, scale_exponent: i16 },
}

/// Direction and colour of all hemispheres.
pub(crate) struct Hemispheres<Code> {
    vertices: Vec<[PackedHemisphere<Code>; HEMISPHERES]>,
    scale_exponent: i16,
}

impl<'a> Prepared<'a> {
    /// At the scale exponent `fixed`, or at the one that a writer should choose.
    pub(crate) fn new(values: Values<'a>, encoding: Encoding, fixed: Option<i16>) -> Result<Self, Fault> {
        match (encoding, values) {
            (Encoding::PackedOct24, Values::Vectors(vectors)) => {
                Ok(Self::Packed(pack::<Octahedral24>(vectors, rgb9e5::LARGEST, fixed)?))
            }
            (Encoding::PackedXyz24, Values::Vectors(vectors)) => {
                Ok(Self::Packed(pack::<Xyz24>(vectors, rgb9e5::LARGEST, fixed)?))
            }
            (Encoding::PairF16 | Encoding::PairF16x4, Values::Vectors(vectors)) => Ok(Self::Half {
                hemispheres: pack::<HalfDirection>(vectors, half::LARGEST, fixed)?,
                padded: encoding == Encoding::PairF16x4,
            }),
            (Encoding::PairF32, Values::Vectors(vectors)) => {
                Ok(Self::Single(pack::<SingleDirection>(vectors, f32::MAX, fixed)?))
            }
            (Encoding::VectorsF32, Values::Vectors(vectors)) => {
                match vectors.iter().enumerate().find_map(|(n, vertex)| Some((n, not_finite(vertex)?))) {
                    None => match fixed {
                        Some(file) if file != 0 => Err(Fault::ScaleExponent { file, needed: 0 }),
                        _ => Ok(Self::Vectors(vectors)),
                    },
                    Some((vertex, hemisphere)) => Err(Fault::NotFinite(vertex, hemisphere)),
                }
            }
            (Encoding::Sh2, Values::Radiance(radiance)) => relate(radiance, fixed),
            _ => Err(Fault::Quantity),
        }
    }

    pub(crate) fn scale_exponent(&self) -> i16 {
        match self {
            Self::Packed(hemispheres) => hemispheres.scale_exponent,
            Self::Half { hemispheres, .. } => hemispheres.scale_exponent,
            Self::Harmonics { scale_exponent, .. } => *scale_exponent,
            Self::Single(hemispheres) => hemispheres.scale_exponent,
            Self::Vectors(_) => 0,
        }
    }

    /// Appends the payload of some vertices, given by their linear indices.
    pub(crate) fn write(&self, out: &mut Vec<u8>, vertices: impl Iterator<Item = u64>) {
        let vertices: &[u64] = &vertices.collect::<Vec<_>>();
        match self {
            Self::Packed(hemispheres) => {
                hemispheres.colours(vertices, |colour| {
                    out.extend_from_slice(&rgb9e5::encode_f64(colour).to_le_bytes());
                });
                hemispheres.directions(vertices, |code| out.extend_from_slice(&code.to_le_bytes()[..3]));
            }
            Self::Half { hemispheres, padded } => {
                let padding: &[u8] = if *padded { &[0; 2] } else { &[] };
                let mut three = |bits: [u16; 3]| {
                    out.extend(bits.iter().flat_map(|bits| bits.to_le_bytes()));
                    out.extend_from_slice(padding);
                };
                // To binary32 first: no hardware rounds binary64 to binary16.
                hemispheres.colours(vertices, |colour| three(colour.map(|c| half::from_f32(c as f32))));
                hemispheres.directions(vertices, |&code| three(code));
            }
            Self::Single(hemispheres) => {
                let mut three = |numbers: [f32; 3]| out.extend(numbers.iter().flat_map(|c| c.to_le_bytes()));
                hemispheres.colours(vertices, |colour| three(colour.map(|c| c as f32)));
                hemispheres.directions(vertices, |&code| three(code));
            }
            Self::Vectors(vectors) => {
                for &vertex in vertices {
                    let components = vectors[vertex as usize].as_flattened().as_flattened();
                    out.extend(components.iter().flat_map(|c| c.to_le_bytes()));
                }
            }
            Self::Harmonics { vertices: all, .. } => {
                vertices.iter().for_each(|&vertex| out.extend_from_slice(&all[vertex as usize].0));
                vertices.iter().for_each(|&vertex| out.extend_from_slice(&all[vertex as usize].1));
            }
        }
    }
}

impl<Code> Hemispheres<Code> {
    /// Every colour of some vertices, divided by the scale: exact.
    fn colours(&self, vertices: &[u64], mut each: impl FnMut([f64; 3])) {
        let scale = power_of_two_f64(-i32::from(self.scale_exponent));
        for hemisphere in vertices.iter().flat_map(|&vertex| &self.vertices[vertex as usize]) {
            each(hemisphere.colour.map(|c| c * scale));
        }
    }

    /// Every direction of some vertices.
    fn directions(&self, vertices: &[u64], each: impl FnMut(&Code)) {
        let hemispheres = vertices.iter().flat_map(|&vertex| &self.vertices[vertex as usize]);
        hemispheres.map(|hemisphere| &hemisphere.direction).for_each(each);
    }
}

/// The first hemisphere of a vertex with a number that is not finite.
fn not_finite(vertex: &HemisphereVectors) -> Option<usize> {
    // Together first, since nearly every vertex passes.
    let finite = vertex.as_flattened().as_flattened().iter().fold(true, |all, c| all & c.is_finite());
    if finite { None } else { vertex.iter().position(|v| !v.as_flattened().iter().all(|c| c.is_finite())) }
}

/// Directions and colours of all vertices; `storable` is the largest number that stores a colour.
fn pack<Q: DirectionQuantiser>(
    vectors: &[HemisphereVectors],
    storable: f32,
    fixed: Option<i16>,
) -> Result<Hemispheres<Q::Code>, Fault> {
    // Colours of binary32 are not scaled (IVG-HDR-04).
    let highest = if storable == f32::MAX { 0 } else { *SCALE_EXPONENTS.end() };
    let limit = f64::from(storable) * power_of_two_f64(i32::from(highest));
    let mut packed = vec![[PackedHemisphere::default(); HEMISPHERES]; vectors.len()];
    let mut largest = 0.0f64;
    for (chunk, (vectors, packed)) in vectors.chunks(VERTICES).zip(packed.chunks_mut(VERTICES)).enumerate() {
        let most = match (<&[_; VERTICES]>::try_from(vectors), <&mut [_; VERTICES]>::try_from(&mut *packed)) {
            (Ok(vectors), Ok(packed)) => pack_vertices::<Q, VERTICES>(vectors, packed),
            _ => vectors.iter().zip(&mut *packed).fold(0.0, |most: f64, (vector, packed)| {
                let one = core::slice::from_mut(packed).as_chunks_mut::<1>().0;
                most.max(pack_vertices::<Q, 1>(&[*vector], &mut one[0]))
            }),
        };
        let finite = vectors.as_flattened().as_flattened().as_flattened();
        if most > limit || !finite.iter().fold(true, |all, c| all & c.is_finite()) {
            return Err(fault(chunk * VERTICES, vectors, packed, limit));
        }
        largest = largest.max(most);
    }
    Ok(Hemispheres { vertices: packed, scale_exponent: settle(largest, storable, fixed)? })
}

/// Packs every hemisphere of some vertices; the largest component of a colour.
fn pack_vertices<Q: DirectionQuantiser, const N: usize>(
    vectors: &[HemisphereVectors; N],
    packed: &mut [[PackedHemisphere<Q::Code>; HEMISPHERES]; N],
) -> f64 {
    let mut one = [PackedHemisphere::default(); N];
    let mut largest = 0.0f64;
    for hemisphere in 0..HEMISPHERES {
        pack_all::<Q, N>(vectors, hemisphere, &mut one);
        for (vertex, one) in packed.iter_mut().zip(&one) {
            vertex[hemisphere] = *one;
            largest = one.colour.iter().fold(largest, |most, &c| most.max(c));
        }
    }
    largest
}

/// What is wrong with the first vertex and hemisphere of which something is.
fn fault<Code>(
    first: usize,
    vectors: &[HemisphereVectors],
    packed: &[[PackedHemisphere<Code>; HEMISPHERES]],
    limit: f64,
) -> Fault {
    let each = (first..).zip(vectors.iter().zip(packed)).flat_map(|(vertex, (vectors, packed))| {
        vectors.iter().zip(packed).enumerate().map(move |(h, (vectors, packed))| (vertex, h, vectors, packed))
    });
    let mut found = Fault::Quantity;
    for (vertex, hemisphere, vectors, packed) in each {
        if !vectors.as_flattened().iter().all(|c| c.is_finite()) {
            found = Fault::NotFinite(vertex, hemisphere);
            break;
        }
        if packed.colour.iter().any(|&c| c > limit) {
            found = Fault::TooLarge(vertex, hemisphere);
            break;
        }
    }
    found
}

/// Means and codes of the ratios to them (IVG-SH-06).
fn relate<'a>(radiance: &[RadianceHarmonics], fixed: Option<i16>) -> Result<Prepared<'a>, Fault> {
    let limit = f64::from(rgb9e5::LARGEST) * power_of_two_f64(i32::from(*SCALE_EXPONENTS.end()));
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
    // The ratios are taken to the means as they will be decoded, so that their rounding is not passed on.
    let scale_exponent = settle(largest, rgb9e5::LARGEST, fixed)?;
    let scale = power_of_two_f64(-i32::from(scale_exponent));
    let vertices = radiance.iter().map(|channels| {
        let mean = rgb9e5::encode_f64(channels.map(|coefficients| f64::from(coefficients[0]) * scale));
        let decoded = rgb9e5::decode_scaled(mean, scale_exponent);
        let mut codes = [0; RATIOS];
        let (of_channel, _) = codes.as_chunks_mut();
        for ((codes, [_, others @ ..]), mean) in of_channel.iter_mut().zip(channels).zip(decoded) {
            *codes = ratio::encode_all(others, mean);
        }
        (mean.to_le_bytes(), codes)
    });
    Ok(Prepared::Harmonics { vertices: vertices.collect(), scale_exponent })
}

/// The scale exponent of a file that has one already, if it holds `largest`; otherwise the one that a writer should choose.
fn settle(largest: f64, storable: f32, fixed: Option<i16>) -> Result<i16, Fault> {
    let needed = scale_exponent(largest, storable);
    match fixed {
        Some(file) if largest > f64::from(storable) * power_of_two_f64(i32::from(file)) => {
            Err(Fault::ScaleExponent { file, needed })
        }
        Some(file) => Ok(file),
        None => Ok(needed),
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
