//! One hemisphere's three irradiance vectors (red, green, blue) as one direction and one colour.
//!
//! Web3D 2008 section 3.3: `d = sum / |sum|`, `c_k = (I_k · axis) / (d · axis)`, so that the component along
//! the hemisphere's axis, which a surface facing that way receives, survives exactly. What is added here
//! (`spec/ivg.md`, "Packing"): d is quantised first and the division uses the quantised d; d stays strictly
//! above the tangent plane; and `c_k ≤ 1.5 |I_k|`, since a shared direction close to the tangent plane would
//! amplify a channel that points elsewhere.
//!
//! The encodings differ in how a direction is quantised and in what stores the colour; the rest is the same and here.

use crate::values::HemisphereVectors;

/// The largest ratio of a colour component to the length of its vector (IVG-PACK-04).
const LARGEST_RATIO: f64 = 1.5;

/// How an encoding stores a direction.
pub trait DirectionQuantiser {
    /// A stored direction.
    type Code: Copy + Default;

    /// The code of a direction strictly inside the hemisphere around coordinate axis `axis` (0 to 2), on its positive or
    /// negative side, near that of `vector`, which need not have unit length. `None` if the vector is zero or not finite.
    fn encode(vector: [f64; 3], axis: usize, positive: bool) -> Option<Self::Code>;

    /// The direction that a reader makes of the code.
    fn decode(code: &Self::Code) -> [f32; 3];

    /// Codes of `N` vectors `[xyz][n]`, and the component along `axis` of what a reader makes of them. A vector that has no
    /// direction becomes the axis.
    fn encode_all<const N: usize>(
        vectors: &[[f64; N]; 3],
        axis: usize,
        positive: bool,
        codes: &mut [Self::Code; N],
        along: &mut [f64; N],
    ) {
        let mut unit = [0.0; 3];
        unit[axis] = if positive { 1.0 } else { -1.0 };
        for (n, (code, along)) in codes.iter_mut().zip(along).enumerate() {
            let vector = vectors.each_ref().map(|c| c[n]);
            let found = Self::encode(vector, axis, positive).or_else(|| Self::encode(unit, axis, positive));
            *code = found.unwrap_or_default();
            *along = f64::from(Self::decode(code)[axis]);
        }
    }
}

/// A hemisphere's direction code and colour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PackedHemisphere<Code> {
    /// The direction.
    pub direction: Code,
    /// The colour \[W/m², or lux\], not negative, before it is scaled and rounded to what stores it.
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
pub fn pack_hemisphere<Q: DirectionQuantiser>(
    vectors: &[[f32; 3]; 3],
    hemisphere: usize,
) -> Option<PackedHemisphere<Q::Code>> {
    assert!(hemisphere < 6, "there are six hemispheres, not {}", hemisphere + 1);
    let mut vertex = HemisphereVectors::default();
    vertex[hemisphere] = *vectors;
    let mut packed = [Default::default()];
    pack_all::<Q, 1>(&[vertex], hemisphere, &mut packed);
    vectors.as_flattened().iter().all(|c| c.is_finite()).then_some(packed[0])
}

/// Packs one hemisphere of `N` vertices, all of whose components are finite; what becomes of others is of no use.
pub(crate) fn pack_all<Q: DirectionQuantiser, const N: usize>(
    vertices: &[HemisphereVectors; N],
    hemisphere: usize,
    packed: &mut [PackedHemisphere<Q::Code>; N],
) {
    let (axis, positive) = (hemisphere / 2, hemisphere.is_multiple_of(2));
    let mut sums = [[0.0; N]; 3];
    let mut components = [[0.0; N]; 3];
    let mut squares = [[0.0; N]; 3];
    for (n, vertex) in vertices.iter().enumerate() {
        let vectors = vertex[hemisphere].map(|v| v.map(f64::from));
        for i in 0..3 {
            sums[i][n] = vectors[0][i] + vectors[1][i] + vectors[2][i];
        }
        for (k, v) in vectors.iter().enumerate() {
            components[k][n] = v[axis];
            squares[k][n] = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
        }
    }
    let mut codes = [Default::default(); N];
    let mut along = [0.0; N];
    Q::encode_all(&sums, axis, positive, &mut codes, &mut along);
    let [x, y, z] = &sums;
    let mut colours = components;
    for (colour, squares) in colours.iter_mut().zip(&squares) {
        let mut capped = false;
        for n in 0..N {
            let quotient =
                if (x[n] == 0.0) & (y[n] == 0.0) & (z[n] == 0.0) { 0.0 } else { colour[n] / along[n] };
            colour[n] = quotient.max(0.0);
            capped |= may_be_capped(colour[n], squares[n]);
        }
        if capped {
            for (colour, &squared) in colour.iter_mut().zip(squares) {
                if may_be_capped(*colour, squared) {
                    *colour = colour.min(LARGEST_RATIO * libm::sqrt(squared));
                }
            }
        }
    }
    for (n, packed) in packed.iter_mut().enumerate() {
        *packed = PackedHemisphere { direction: codes[n], colour: colours.each_ref().map(|c| c[n]) };
    }
}

/// Whether a colour may exceed its cap, by squares; with room for their rounding.
fn may_be_capped(colour: f64, squared: f64) -> bool {
    const ROOM: f64 = 1.0 - f64::EPSILON * 16.0;
    colour * colour > LARGEST_RATIO * LARGEST_RATIO * ROOM * squared
}

#[cfg(test)]
mod tests;
