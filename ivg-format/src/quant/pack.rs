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
pub(crate) const LARGEST_RATIO: f64 = 1.5;

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
        for (n, (code, along)) in codes.iter_mut().zip(along).enumerate() {
            *code = Self::encode_or_axis(vectors.each_ref().map(|c| c[n]), axis, positive);
            *along = f64::from(Self::decode(code)[axis]);
        }
    }

    /// As [`DirectionQuantiser::encode`]; the axis for a vector that has no direction.
    fn encode_or_axis(vector: [f64; 3], axis: usize, positive: bool) -> Self::Code {
        let mut unit = [0.0; 3];
        unit[axis] = if positive { 1.0 } else { -1.0 };
        let found = Self::encode(vector, axis, positive).or_else(|| Self::encode(unit, axis, positive));
        found.unwrap_or_default()
    }
}

/// One hemisphere of `N` vertices, each as a direction and a colour.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PackedAll<Code, const N: usize> {
    /// Directions.
    pub(crate) directions: [Code; N],
    /// Components of colours, `[rgb][n]`, not negative.
    pub(crate) colours: [[f64; N]; 3],
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
    let PackedAll { directions: [direction], colours } = pack_all::<Q, 1>(&[vertex], hemisphere);
    let finite = vectors.as_flattened().iter().all(|c| c.is_finite());
    finite.then_some(PackedHemisphere { direction, colour: colours.map(|[component]| component) })
}

/// Packs one hemisphere of `N` vertices, all of whose components are finite; what becomes of others is of no use.
pub(crate) fn pack_all<Q: DirectionQuantiser, const N: usize>(
    vertices: &[HemisphereVectors; N],
    hemisphere: usize,
) -> PackedAll<Q::Code, N> {
    let (axis, positive) = (hemisphere / 2, hemisphere.is_multiple_of(2));
    let mut sums = [[0.0; N]; 3];
    let mut components = [[0.0; N]; 3];
    let mut squares = [[0.0; N]; 3];
    let [sum_x, sum_y, sum_z] = &mut sums;
    for n in 0..N {
        let [[rx, ry, rz], [gx, gy, gz], [bx, by, bz]] = vertices[n][hemisphere];
        let (rx, ry, rz) = (f64::from(rx), f64::from(ry), f64::from(rz));
        let (gx, gy, gz) = (f64::from(gx), f64::from(gy), f64::from(gz));
        let (bx, by, bz) = (f64::from(bx), f64::from(by), f64::from(bz));
        (sum_x[n], sum_y[n], sum_z[n]) = (rx + gx + bx, ry + gy + by, rz + gz + bz);
        squares[0][n] = rx * rx + ry * ry + rz * rz;
        squares[1][n] = gx * gx + gy * gy + gz * gz;
        squares[2][n] = bx * bx + by * by + bz * bz;
    }
    for (k, components) in components.iter_mut().enumerate() {
        for (component, vertex) in components.iter_mut().zip(vertices) {
            *component = f64::from(vertex[hemisphere][k][axis]);
        }
    }
    let mut codes = [Default::default(); N];
    let mut along = [0.0; N];
    Q::encode_all(&sums, axis, positive, &mut codes, &mut along);
    let [x, y, z] = &sums;
    let mut colours = components;
    for (colour, squares) in colours.iter_mut().zip(&squares) {
        for n in 0..N {
            let quotient = colour[n] / along[n];
            // Vectors that cancel have no direction and no colour.
            let light = (quotient > 0.0) & ((x[n] != 0.0) | (y[n] != 0.0) | (z[n] != 0.0));
            colour[n] = if light { quotient } else { 0.0 };
        }
        let any = |any, (&colour, &squared)| any | u64::from(may_be_capped(colour, squared));
        let capped = colour.iter().zip(squares).fold(0, any) != 0;
        if capped {
            for (colour, &squared) in colour.iter_mut().zip(squares) {
                if may_be_capped(*colour, squared) {
                    *colour = colour.min(LARGEST_RATIO * libm::sqrt(squared));
                }
            }
        }
    }
    PackedAll { directions: codes, colours }
}

/// Whether a colour may exceed its cap, by squares; with room for their rounding.
fn may_be_capped(colour: f64, squared: f64) -> bool {
    const ROOM: f64 = 1.0 - f64::EPSILON * 16.0;
    colour * colour > LARGEST_RATIO * LARGEST_RATIO * ROOM * squared
}

#[cfg(test)]
mod tests;
