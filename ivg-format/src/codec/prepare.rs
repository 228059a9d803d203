//! Writing: a grid's values on their way to bytes. What the encoding keeps of each vertex is found once for all; the largest
//! number of all gives the scale exponent; then records are written from it in any order.

use super::HEMISPHERES;
use super::harmonics::RATIOS;
use crate::encoding::Encoding;
use crate::header::SCALE_EXPONENTS;
use crate::quant::direction::Octahedral24;
use crate::quant::pack::{DirectionQuantiser, PackedVertex, pack_all};
use crate::quant::pair::{HalfDirection, SingleDirection};
use crate::quant::xyz::Xyz24;
use crate::quant::{floor_log2, half, power_of_two_f64, ratio, rgb9e5};
use crate::values::{HemisphereVectors, RadianceHarmonics, Values};
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
    vertices: Vec<PackedVertex<Code>>,
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
                hemispheres.write_colours(vertices, out, |colours| {
                    rgb9e5::encode_all(colours).map(u32::to_le_bytes)
                });
                hemispheres.write_directions(vertices, out, |code| {
                    let [low, middle, high, _] = code.to_le_bytes();
                    [low, middle, high]
                });
            }
            // To binary32 first: no hardware rounds binary64 to binary16.
            Self::Half { hemispheres, padded: false } => {
                let bytes = |[x, y, z]: [u16; 3]| little_endian::<2, 6>([x, y, z].map(u16::to_le_bytes));
                hemispheres.write_colours(vertices, out, |colours| {
                    by_hemisphere(colours, |c| half::from_f32(c as f32)).map(bytes)
                });
                hemispheres.write_directions(vertices, out, bytes);
            }
            Self::Half { hemispheres, padded: true } => {
                let bytes = |[x, y, z]: [u16; 3]| little_endian::<2, 8>([x, y, z].map(u16::to_le_bytes));
                hemispheres.write_colours(vertices, out, |colours| {
                    by_hemisphere(colours, |c| half::from_f32(c as f32)).map(bytes)
                });
                hemispheres.write_directions(vertices, out, bytes);
            }
            Self::Single(hemispheres) => {
                let bytes = |numbers: [f32; 3]| little_endian::<4, 12>(numbers.map(f32::to_le_bytes));
                hemispheres
                    .write_colours(vertices, out, |colours| by_hemisphere(colours, |c| c as f32).map(bytes));
                hemispheres.write_directions(vertices, out, bytes);
            }
            Self::Vectors(vectors) => {
                for &vertex in vertices {
                    let components = vectors[vertex as usize].map(|v| v.map(|v| v.map(f32::to_le_bytes)));
                    out.extend_from_slice(components.as_flattened().as_flattened().as_flattened());
                }
            }
            Self::Harmonics { vertices: all, .. } => {
                vertices.iter().for_each(|&vertex| out.extend_from_slice(&all[vertex as usize].0));
                vertices.iter().for_each(|&vertex| out.extend_from_slice(&all[vertex as usize].1));
            }
        }
    }
}

impl<Code: Copy> Hemispheres<Code> {
    /// Appends the colours of some vertices, divided by the scale, which is exact; `bytes` makes those of each hemisphere.
    #[inline(always)]
    fn write_colours<const BYTES: usize>(
        &self,
        vertices: &[u64],
        out: &mut Vec<u8>,
        bytes: impl Fn(&[[f64; HEMISPHERES]; 3]) -> [[u8; BYTES]; HEMISPHERES],
    ) {
        let scale = power_of_two_f64(-i32::from(self.scale_exponent));
        out.reserve(vertices.len() * HEMISPHERES * BYTES);
        for &vertex in vertices {
            let colours =
                self.vertices[vertex as usize].colours.map(|component| component.map(|c| c * scale));
            out.extend_from_slice(bytes(&colours).as_flattened());
        }
    }

    /// Appends the directions of some vertices.
    #[inline(always)]
    fn write_directions<const BYTES: usize>(
        &self,
        vertices: &[u64],
        out: &mut Vec<u8>,
        bytes: impl Fn(Code) -> [u8; BYTES] + Copy,
    ) {
        out.reserve(vertices.len() * HEMISPHERES * BYTES);
        for &vertex in vertices {
            out.extend_from_slice(self.vertices[vertex as usize].directions.map(bytes).as_flattened());
        }
    }
}

/// The colour of each hemisphere, its components as `number` makes them.
fn by_hemisphere<T>(colours: &[[f64; HEMISPHERES]; 3], number: impl Fn(f64) -> T) -> [[T; 3]; HEMISPHERES] {
    core::array::from_fn(|h| colours.each_ref().map(|component| number(component[h])))
}

/// The bytes of three numbers, and zeros behind them.
fn little_endian<const NUMBER: usize, const ALL: usize>(numbers: [[u8; NUMBER]; 3]) -> [u8; ALL] {
    let mut bytes = [0; ALL];
    bytes.iter_mut().zip(numbers.as_flattened()).for_each(|(to, from)| *to = *from);
    bytes
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
    let mut packed = Vec::with_capacity(vectors.len());
    let mut largest = 0.0f64;
    let (chunks, rest) = vectors.as_chunks::<VERTICES>();
    let (ones, _) = rest.as_chunks::<1>();
    for chunk in chunks {
        largest = append::<Q, VERTICES>(&mut packed, chunk, largest, limit)?;
    }
    for one in ones {
        largest = append::<Q, 1>(&mut packed, one, largest, limit)?;
    }
    Ok(Hemispheres { vertices: packed, scale_exponent: settle(largest, storable, fixed)? })
}

/// Packs every hemisphere of some vertices, which must be finite and their colours no more than the limit; the largest
/// component of a colour so far.
fn append<Q: DirectionQuantiser, const N: usize>(
    packed: &mut Vec<PackedVertex<Q::Code>>,
    vectors: &[HemisphereVectors; N],
    largest: f64,
    limit: f64,
) -> Result<f64, Fault> {
    let mut vertices = [PackedVertex::default(); N];
    for hemisphere in 0..HEMISPHERES {
        pack_all::<Q, N>(vectors, hemisphere, &mut vertices);
    }
    let components = vectors.as_flattened().as_flattened().as_flattened();
    let finite = components.iter().fold(true, |all, c| all & c.is_finite());
    let mut most = [largest; HEMISPHERES];
    for colours in vertices.iter().flat_map(|vertex| &vertex.colours) {
        for (most, &c) in most.iter_mut().zip(colours) {
            *most = if c > *most { c } else { *most };
        }
    }
    let most = most.iter().fold(largest, |most, &c| most.max(c));
    if !finite || most > limit {
        return Err(fault(packed.len(), vectors, &vertices, limit));
    }
    packed.extend_from_slice(&vertices);
    Ok(most)
}

/// What is wrong with the first vertex and hemisphere of which something is.
fn fault<Code>(
    first: usize,
    vectors: &[HemisphereVectors],
    packed: &[PackedVertex<Code>],
    limit: f64,
) -> Fault {
    for (vertex, (vectors, packed)) in (first..).zip(vectors.iter().zip(packed)) {
        for (hemisphere, vectors) in vectors.iter().enumerate() {
            if !vectors.as_flattened().iter().all(|c| c.is_finite()) {
                return Fault::NotFinite(vertex, hemisphere);
            }
            if packed.colours.iter().any(|component| component[hemisphere] > limit) {
                return Fault::TooLarge(vertex, hemisphere);
            }
        }
    }
    unreachable!("some hemisphere was at fault")
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
