//! Directions in 24 bits: the octahedral map (Meyer et al., "On floating-point normal vectors", 2010), two
//! coordinates of 12 bits.
//!
//! A code is `(u + 2047) | (v + 2047) << 12` with −2047 ≤ u, v ≤ 2047; a half of 4095 is forbidden
//! (IVG-DIR-02). The scale 2047 is odd so that 0 and both ends exist: the six axes are exact. Decoding is
//! pinned bit by bit (IVG-DIR-03): fold in integers, then the binary32 number nearest to the exact quotient.
//! Encoding finds the nearest code; the angle to it is at most √2/2047 rad, 0.0396°.

/// Largest magnitude of a coordinate.
const SCALE: i32 = 2047;

/// The one value a half of a code must not have.
const FORBIDDEN: u32 = 4095;

/// Encodes the direction of `vector`, which need not have unit length: the nearest code, of equally near ones
/// the lowest. `None` if the vector is zero or not finite.
#[must_use]
pub fn encode_octahedral24(vector: [f64; 3]) -> Option<u32> {
    nearest(vector, vector, |_| true)
}

/// As [`encode_octahedral24`], among the codes whose direction lies strictly in the hemisphere around
/// coordinate axis `axis` (0 to 2), on its positive or negative side (IVG-PACK-03).
#[must_use]
pub fn encode_octahedral24_in_hemisphere(vector: [f64; 3], axis: usize, positive: bool) -> Option<u32> {
    let sign = if positive { 1 } else { -1 };
    // Where to look: the vector itself, or, if it lies on or below the tangent plane, the place just above it.
    let mut lifted = vector;
    let component = lifted.get_mut(axis)?;
    let least = vector.iter().map(|c| c.abs()).sum::<f64>() / f64::from(SCALE);
    *component = f64::from(sign) * (f64::from(sign) * *component).max(least);
    nearest(vector, lifted, |folded| folded.get(axis).is_some_and(|&c| c * sign >= 1))
}

/// The code around `place` that comes nearest to `vector` among those that `allowed` accepts.
fn nearest(vector: [f64; 3], place: [f64; 3], allowed: impl Fn(&[i32; 3]) -> bool) -> Option<u32> {
    let [x, y, z] = normalised(place)?;
    let goal = normalised(vector)?;
    let scale = f64::from(SCALE) / (x.abs() + y.abs() + z.abs());
    let (mut u, mut v) = (x * scale, y * scale);
    if z < 0.0 {
        let (a, b) = (f64::from(SCALE) - v.abs(), f64::from(SCALE) - u.abs());
        (u, v) = (if x < 0.0 { -a } else { a }, if y < 0.0 { -b } else { b });
    }
    let (u, v) = (libm::floor(u) as i32, libm::floor(v) as i32);
    let mut best: Option<(f64, u32)> = None;
    for v in (v - 1).max(-SCALE)..=(v + 2).min(SCALE) {
        for u in (u - 1).max(-SCALE)..=(u + 2).min(SCALE) {
            let folded = fold(u, v);
            if !allowed(&folded) {
                continue;
            }
            let [a, b, c] = folded.map(f64::from);
            let cosine = (a * goal[0] + b * goal[1] + c * goal[2]) / libm::sqrt(a * a + b * b + c * c);
            if best.is_none_or(|(most, _)| cosine > most) {
                best = Some((cosine, lowest_code(u, v)));
            }
        }
    }
    best.map(|(_, code)| code)
}

/// The lowest code of the direction at (u, v): on the rim of the map, places mirrored in its middle are one
/// direction, and all four corners are −z.
const fn lowest_code(u: i32, v: i32) -> u32 {
    let low_u = if v.abs() == SCALE { -u.abs() } else { u };
    let low_v = if u.abs() == SCALE { -v.abs() } else { v };
    (low_u + SCALE) as u32 | ((low_v + SCALE) as u32) << 12
}

/// The vector divided by its largest magnitude, so that no square can overflow or vanish.
fn normalised(vector: [f64; 3]) -> Option<[f64; 3]> {
    let largest = vector.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
    (vector.iter().all(|c| c.is_finite()) && largest > 0.0).then(|| vector.map(|c| c / largest))
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
    let half = |bits: u32| (bits & 0xFFF) as i32 - SCALE;
    let point = fold(half(code), half(code >> 12));
    let squared: i32 = point.iter().map(|c| c * c).sum();
    // Root and quotient are each rounded to binary64, the result once more: checked over all codes to be the
    // nearest binary32 number to the exact quotient.
    let length = libm::sqrt(f64::from(squared));
    point.map(|c| (f64::from(c) / length) as f32)
}

#[cfg(test)]
mod tests;
