//! Directions in 24 bits: the octahedral map (Meyer et al., "On floating-point normal vectors", 2010), two
//! coordinates of 12 bits.
//!
//! A code is `(u + 2047) | (v + 2047) << 12` with −2047 ≤ u, v ≤ 2047; a half of 4095 is forbidden
//! (IVG-DIR-02). The scale 2047 is odd so that 0 and both ends exist: the six axes are exact. Decoding is
//! pinned bit by bit (IVG-DIR-03): fold in integers, then the binary32 number nearest to the exact quotient.
//! Encoding finds the nearest code; the angle to it is at most √2/2047 rad, 0.0396°.

use super::pack::DirectionQuantiser;
use super::{DirectionCode, unit};

mod nearest;
pub(crate) mod pack;

/// The quantiser: for [`super::pack::pack_hemisphere`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Octahedral24;

/// Largest magnitude of a coordinate.
const SCALE: i32 = 2047;

/// The one value a half of a code must not have.
const FORBIDDEN: u32 = 4095;

/// Encodes the direction of `vector`, which need not have unit length: the nearest code, of equally near ones
/// the lowest. `None` if the vector is zero or not finite.
#[must_use]
pub fn encode_octahedral24(vector: [f64; 3]) -> Option<u32> {
    nearest::nearest(vector)
}

/// As [`encode_octahedral24`], among the codes whose direction lies strictly in the hemisphere around
/// coordinate axis `axis` (0 to 2), on its positive or negative side (IVG-PACK-03).
#[must_use]
pub fn encode_octahedral24_in_hemisphere(vector: [f64; 3], axis: usize, positive: bool) -> Option<u32> {
    let component = *vector.get(axis)? * if positive { 1.0 } else { -1.0 };
    let whole = vector.iter().map(|c| c.abs() / f64::from(SCALE)).sum();
    // At least 1 on the octahedron: then so is every code around it.
    if component >= whole { nearest::nearest(vector) } else { nearest::nearest_above(vector, axis, positive) }
}

/// The lowest code of the direction at (u, v): on the rim of the map, places mirrored in its middle are one
/// direction, and all four corners are −z.
const fn lowest_code(u: i32, v: i32) -> u32 {
    let low_u = if v.abs() == SCALE { -u.abs() } else { u };
    let low_v = if u.abs() == SCALE { -v.abs() } else { v };
    (low_u + SCALE) as u32 | ((low_v + SCALE) as u32) << 12
}

/// The point of the octahedron |x| + |y| + |z| = 2047 at map coordinates (u, v).
const fn fold(u: i32, v: i32) -> [i32; 3] {
    let z = SCALE - u.abs() - v.abs();
    if z >= 0 {
        [u, v, z]
    } else {
        // Below the equator neither u nor v can be 0, so both signs are defined.
        [(SCALE - v.abs()) * u.signum(), (SCALE - u.abs()) * v.signum(), z]
    }
}

/// Whether both halves of a 24-bit code are allowed. Higher bits are ignored.
#[must_use]
pub const fn is_valid(code: u32) -> bool {
    code & 0xFFF != FORBIDDEN && (code >> 12) & 0xFFF != FORBIDDEN
}

/// Decodes a direction of unit length; `None` if a half has the forbidden value 4095.
#[must_use]
pub fn decode_octahedral24(code: u32) -> Option<[f32; 3]> {
    is_valid(code).then(|| decode_valid(code))
}

/// Decodes a code that [`is_valid`]. For any other, the result is some direction.
pub(crate) fn decode_valid(code: u32) -> [f32; 3] {
    unit::direction(point(code))
}

/// The point of the octahedron that a code names, as [`fold`] finds it, but without branches.
#[inline(always)]
fn point(code: u32) -> [f32; 3] {
    let half = |bits: u32| ((bits & 0xFFF) as i32 - SCALE) as f32;
    let (u, v) = (half(code), half(code >> 12));
    let z = SCALE as f32 - u.abs() - v.abs();
    // Below the equator |u| and |v| both lose what z lacks.
    let lack = (-z).max(0.0);
    [u - lack.copysign(u), v - lack.copysign(v), z]
}

impl DirectionCode for Octahedral24 {
    /// −z.
    const ALLOWED: u32 = 0;

    #[inline(always)]
    fn fault(code: u32) -> u32 {
        // Only 4095 carries into the thirteenth bit.
        (((code & 0xFFF) + 1) | ((code >> 12) + 1)) & 0x1000
    }

    #[inline(always)]
    fn directions<const N: usize>(codes: &[u32; N], out: &mut [[f32; N]; 3]) {
        unit::directions(codes, point, out);
    }
}

impl DirectionQuantiser for Octahedral24 {
    type Code = u32;

    fn encode(vector: [f64; 3], axis: usize, positive: bool) -> Option<u32> {
        encode_octahedral24_in_hemisphere(vector, axis, positive)
    }

    fn decode(code: &u32) -> [f32; 3] {
        decode_valid(*code)
    }
}

#[cfg(test)]
mod tests;
