//! Directions in 24 bits: a signed byte for each coordinate (Web3D 2008, section 3.3).
//!
//! Bits 0–7, 8–15, 16–23 are x, y, z in two's complement; −128 and (0, 0, 0) are forbidden (IVG-XYZ-02). Decoding is
//! pinned as for the octahedral code (IVG-XYZ-03). The direction is off by at most √3/2 of a step of 1/127: 0.39°, on
//! average 0.17°. [`super::direction`] is eight times finer in the same bits.

use super::pack::DirectionQuantiser;
use super::{DirectionCode, normalised, unit};

/// What a coordinate of 1 is stored as.
const SCALE: f64 = 127.0;

/// The quantiser: for [`super::pack::pack_hemisphere`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Xyz24;

/// Encodes the direction of `vector`, which need not have unit length: each coordinate rounded, halves away from zero.
/// `None` if the vector is zero or not finite.
#[must_use]
pub fn encode_xyz24(vector: [f64; 3]) -> Option<u32> {
    rounded(vector).map(join)
}

/// As [`encode_xyz24`], with the coordinate along `axis` (0 to 2) at least 1 on its positive or negative side
/// (IVG-XYZ-04).
#[must_use]
pub fn encode_xyz24_in_hemisphere(vector: [f64; 3], axis: usize, positive: bool) -> Option<u32> {
    let mut point = rounded(vector)?;
    let along = point.get_mut(axis)?;
    *along = if positive { (*along).max(1) } else { (*along).min(-1) };
    Some(join(point))
}

/// Decodes a direction of unit length; `None` if the code is forbidden. Higher bits are ignored.
#[must_use]
pub fn decode_xyz24(code: u32) -> Option<[f32; 3]> {
    let code = code & 0xFF_FFFF;
    (Xyz24::fault(code) == 0).then(|| unit::direction(point(code)))
}

fn rounded(vector: [f64; 3]) -> Option<[i8; 3]> {
    let [x, y, z] = normalised(vector)?;
    let length = libm::sqrt(x * x + y * y + z * z);
    // No magnitude exceeds 1, so that every rounded number fits.
    Some([x, y, z].map(|c| libm::round(c / length * SCALE) as i8))
}

fn join(point: [i8; 3]) -> u32 {
    let [x, y, z] = point.map(i8::cast_unsigned);
    u32::from_le_bytes([x, y, z, 0])
}

fn point(code: u32) -> [f32; 3] {
    // Sign extension: the byte to the top and back.
    [code << 24, code << 16, code << 8].map(|word| (word.cast_signed() >> 24) as f32)
}

impl DirectionCode for Xyz24 {
    /// +x.
    const ALLOWED: u32 = 127;

    #[inline(always)]
    fn fault(code: u32) -> u32 {
        let lowest = [code, code >> 8, code >> 16].map(|byte| u32::from(byte & 0xFF == 0x80));
        u32::from(code == 0) | lowest[0] | lowest[1] | lowest[2]
    }

    #[inline(always)]
    fn directions<const N: usize>(codes: &[u32; N], out: &mut [[f32; N]; 3]) {
        unit::directions(codes, point, out);
    }
}

impl DirectionQuantiser for Xyz24 {
    type Code = u32;

    fn encode(vector: [f64; 3], axis: usize, positive: bool) -> Option<u32> {
        encode_xyz24_in_hemisphere(vector, axis, positive)
    }

    fn decode(code: &u32) -> [f32; 3] {
        unit::direction(point(*code))
    }
}

#[cfg(test)]
mod tests;
