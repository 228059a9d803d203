//! One hemisphere's three irradiance vectors (red, green, blue) as one direction and one colour.
//!
//! Web3D 2008 section 3.3: `d = sum / |sum|`, `c_k = (I_k · axis) / (d · axis)`, so that the component along
//! the hemisphere's axis, which a surface facing that way receives, survives exactly. What is added here
//! (`spec/ivg.md`, "Packing"): d is quantised first and the division uses the quantised d; d stays strictly
//! above the tangent plane; and `c_k ≤ 1.5 |I_k|`, since a shared direction close to the tangent plane would
//! amplify a channel that points elsewhere.

use super::direction::{decode_valid, encode_octahedral24_in_hemisphere};

/// The largest ratio of a colour component to the length of its vector (IVG-PACK-04).
const LARGEST_RATIO: f64 = 1.5;

/// A hemisphere's direction code and colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PackedHemisphere {
    /// The direction, in the 24-bit octahedral code.
    pub direction: u32,
    /// The colour \[W/m²\], not negative, before it is scaled and rounded to RGB9E5.
    pub colour: [f64; 3],
}

/// Packs the vectors `[rgb][xyz]` of hemisphere `hemisphere` (0 to 5 for +x −x +y −y +z −z).
///
/// Vectors that cancel to zero become the hemisphere's axis with colour 0. A component along the axis that is
/// negative, which the definition of an irradiance vector excludes, counts as 0. `None` if a component is not
/// finite.
///
/// # Panics
///
/// If `hemisphere` is greater than 5.
#[must_use]
pub fn pack_hemisphere(vectors: &[[f32; 3]; 3], hemisphere: usize) -> Option<PackedHemisphere> {
    assert!(hemisphere < 6, "there are six hemispheres, not {}", hemisphere + 1);
    let (axis, positive) = (hemisphere / 2, hemisphere.is_multiple_of(2));
    if !vectors.iter().flatten().all(|c| c.is_finite()) {
        return None;
    }
    let vectors = vectors.map(|v| v.map(f64::from));
    let sum: [f64; 3] = core::array::from_fn(|i| vectors[0][i] + vectors[1][i] + vectors[2][i]);
    let Some(direction) = encode_octahedral24_in_hemisphere(sum, axis, positive) else {
        let mut unit = [0.0; 3];
        unit[axis] = if positive { 1.0 } else { -1.0 };
        let direction = encode_octahedral24_in_hemisphere(unit, axis, positive)?;
        return Some(PackedHemisphere { direction, colour: [0.0; 3] });
    };
    let along_axis = f64::from(decode_valid(direction)[axis]);
    let colour = vectors.map(|v| {
        let length = libm::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        (v[axis] / along_axis).min(LARGEST_RATIO * length).max(0.0)
    });
    Some(PackedHemisphere { direction, colour })
}

/// The vectors `[rgb][xyz]` of a direction and a colour: each product rounded once to binary32 (IVG-PACK-05).
#[must_use]
pub fn unpack(direction: [f32; 3], colour: [f32; 3]) -> [[f32; 3]; 3] {
    colour.map(|c| direction.map(|d| c * d))
}

#[cfg(test)]
mod tests;
