//! The octahedral code nearest to a direction.
//!
//! Codes are the points with whole coordinates on the octahedron |x| + |y| + |z| = 2047. On a face, with all signs made
//! positive, they form a triangular lattice whose three steps are (0, 1, −1), (1, −1, 0) and (−1, 0, 1). Seen from the centre in
//! the direction p, a step e has the squared length |e|² − (e·p)² / |p|², and of no two steps is the product so formed positive:
//! −1 − (y − z)(x − y) / |p|² and the other two are at most 0, since y² ≤ |p|². So no triangle of the lattice has an angle
//! above 90°, and the nearest code is a corner of the triangle around the direction; only at the axes, where the angle is 90°,
//! can the corner beyond the longest side be as near. Hence four candidates: with the largest coordinate left out, the
//! corners of the square of whole numbers around the other two. The tests compare with a search of many more.

use super::{SCALE, fold, lowest_code};
use crate::quant::normalised;

/// The corners of a square cell.
const CORNERS: [[i32; 2]; 4] = [[0, 0], [1, 0], [0, 1], [1, 1]];

/// Two codes whose squared distances differ by less than this part of them are equally near: more than rounding in
/// binary64 makes of equal distances, and far less than any direction of a grid is known.
const TIE: f64 = 1.0 / (1u64 << 36) as f64;

/// Differences of squared distances that are less than this part are decided in binary64: what [`encode_all`] has in
/// binary32 may be off by 2^-7.2. Two coordinates a, b of a place are off by at most η = 2^-10 together: by 2047 × 2^-23 × 1.5
/// since the vector is, and by 2047 × 2^-23 × 3.5 × 2/3 since its length, their quotient and the product are, of which the two
/// have two thirds at most. A squared distance is 2 (x² + y² + xy) or less, so that an error of η changes the difference of
/// two corners by no more than 2 × √6 × √2 η; everything else is below 2^-14.
const DOUBT: f32 = 1.0 / (1u32 << 7) as f32;

/// The lowest of the nearest codes; `None` for a vector without direction.
pub(super) fn nearest(vector: [f64; 3]) -> Option<u32> {
    let [x, y, z] = normalised(vector)?.map(f64::abs);
    let scale = f64::from(SCALE) / (x + y + z);
    let largest = largest_coordinate([x, y, z]);
    let mut place = [x * scale, y * scale, z * scale];
    place.swap(largest, 2);
    let [a, b, c] = place;
    let base = [libm::floor(a), libm::floor(b)];
    let squared = a * a + b * b + c * c;
    let distances = CORNERS.map(|[right, up]| {
        let (x, y) = (a - base[0] - f64::from(right), b - base[1] - f64::from(up));
        // The way from the code to the direction is r = (x, y, -x - y); its part across the direction, over the part of the
        // code along it, is the tangent of the angle.
        let along = (a - c) * x + (b - c) * y;
        let across = 2.0 * ((x * x + y * y) + x * y) - along * along / squared;
        let distance = 1.0 - along / squared;
        across / (distance * distance)
    });
    let least = distances.iter().fold(f64::INFINITY, |least: f64, &distance| least.min(distance));
    let near = CORNERS.iter().zip(distances).filter(|&(_, distance)| distance <= least * (1.0 + TIE));
    near.map(|(&[right, up], _)| code([base[0] as i32 + right, base[1] as i32 + up], largest, vector)).min()
}

/// Which of three magnitudes is the largest; of equals, the last, then the middle one.
fn largest_coordinate([x, y, z]: [f64; 3]) -> usize {
    if x.max(y) <= z { 2 } else { usize::from(x <= y) }
}

/// The lowest code of a point, whose two magnitudes are given that are left when the largest, which was exchanged with the
/// third, is left out.
fn code([a, b]: [i32; 2], largest: usize, signs: [f64; 3]) -> u32 {
    let mut point = [a, b, SCALE - a - b];
    point.swap(largest, 2);
    for (coordinate, sign) in point.iter_mut().zip(signs) {
        *coordinate = if sign < 0.0 { -*coordinate } else { *coordinate };
    }
    code_of(point)
}

/// The lowest code of a point of the octahedron.
#[inline(always)]
fn code_of([x, y, z]: [i32; 3]) -> u32 {
    // On the lower half, where a coordinate is 0 the map has two places.
    let below_x = if x > 0 { SCALE - y.abs() } else { y.abs() - SCALE };
    let below_y = if y > 0 { SCALE - x.abs() } else { x.abs() - SCALE };
    let (u, v) = if z < 0 { (below_x, below_y) } else { (x, y) };
    (u + SCALE) as u32 | ((v + SCALE) as u32) << 12
}

/// The lowest of the nearest codes strictly inside a hemisphere, for a direction next to its tangent plane or below it,
/// where the nearest code of all may be outside: a search around the direction, or the place just above it.
pub(super) fn nearest_above(vector: [f64; 3], axis: usize, positive: bool) -> Option<u32> {
    let sign = if positive { 1 } else { -1 };
    let mut lifted = vector;
    let component = lifted.get_mut(axis)?;
    let least = vector.iter().map(|c| c.abs()).sum::<f64>() / f64::from(SCALE);
    *component = f64::from(sign) * (f64::from(sign) * *component).max(least);
    let [x, y, z] = normalised(lifted)?;
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
            if folded[axis] * sign < 1 {
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

/// The places of `N` directions on the octahedron.
struct Places<const N: usize> {
    /// All bits set where the first coordinate, or the second, is the largest, and was exchanged with the third.
    exchanged: [[i32; N]; 2],
    /// The whole numbers below the other two.
    base: [[i32; N]; 2],
    /// What is above them.
    above: [[f32; N]; 2],
    /// The place.
    place: [[f32; N]; 3],
    /// All bits set where the vector's coordinate is negative.
    negative: [[i32; N]; 3],
    /// All bits set where the candidates may not do.
    doubt: [i32; N],
}

/// Codes found together.
pub(super) struct Together<const N: usize> {
    pub(super) codes: [u32; N],
    /// The coordinates along the axis of the codes' points.
    pub(super) along: [f32; N],
    /// The squared lengths of the codes' points.
    pub(super) squared: [f32; N],
    /// All bits set where another code may be nearer, or inside the hemisphere.
    pub(super) doubt: [i32; N],
}

/// Many codes at once, in binary32, of vectors whose coordinates are off by no more than 1.5 × 2^-23 of the sum of their
/// magnitudes together: where there is no doubt, those of [`super::encode_octahedral24_in_hemisphere`].
#[inline(always)]
pub(super) fn encode_all<const N: usize>(
    vectors: &[[f32; N]; 3],
    axis: usize,
    positive: bool,
) -> Together<N> {
    let places = places(vectors, axis, positive);
    let (corner, doubt) = nearest_corners(&places);
    let Places { exchanged: [first, second], base: [base_a, base_b], negative, .. } = &places;
    let [negative_x, negative_y, negative_z] = negative;
    let side = if positive { 1.0 } else { -1.0 };
    let mut found = Together { codes: [0; N], along: [0.0; N], squared: [0.0; N], doubt };
    for n in 0..N {
        let a = base_a[n] + (corner[n] & 1);
        let b = base_b[n] + (corner[n] >> 1);
        let c = SCALE - a - b;
        let choose = |one: i32, other: i32, mask: i32| one ^ ((one ^ other) & mask);
        let x = choose(a, c, first[n]);
        let y = choose(b, c, second[n]);
        let z = choose(choose(c, a, first[n]), b, second[n]);
        // As `code_of`, from magnitudes and signs: below the equator, what is 0 counts as negative.
        let u = choose(x, SCALE - y, negative_z[n]);
        let v = choose(y, SCALE - x, negative_z[n]);
        let (minus_u, minus_v) = (negative_x[n] | mask(x == 0), negative_y[n] | mask(y == 0));
        let (u, v) = ((u ^ minus_u) - minus_u, (v ^ minus_v) - minus_v);
        found.codes[n] = (u + SCALE) as u32 | ((v + SCALE) as u32) << 12;
        let (x, y, z) = (x as f32, y as f32, z as f32);
        found.squared[n] = x * x + y * y + z * z;
        // Where there is no doubt, the point is on the side of the axis.
        found.along[n] = side
            * match axis {
                0 => x,
                1 => y,
                _ => z,
            };
    }
    found
}

/// The code of a coordinate axis.
pub(super) fn axis_code(axis: usize, positive: bool) -> u32 {
    code_of([0, 1, 2].map(|i| {
        if i != axis {
            0
        } else if positive {
            SCALE
        } else {
            -SCALE
        }
    }))
}

/// All bits set or none.
#[inline(always)]
pub(super) fn mask(condition: bool) -> i32 {
    -i32::from(condition)
}

#[inline(always)]
fn places<const N: usize>(vectors: &[[f32; N]; 3], axis: usize, positive: bool) -> Places<N> {
    /// Sums with 1.5 × 2^23 have no digits behind the point; the lowest bits are the whole number.
    const WHOLE: f32 = 12_582_912.0;
    let mut out = Places {
        exchanged: [[0; N]; 2],
        base: [[0; N]; 2],
        above: [[0.0; N]; 2],
        place: [[0.0; N]; 3],
        negative: [[0; N]; 3],
        doubt: [0; N],
    };
    let side = if positive { 1.0 } else { -1.0 };
    let [xs, ys, zs] = vectors;
    let sides = &vectors[axis];
    let Places { exchanged, base: [base_a, base_b], above: [above_a, above_b], place, doubt, .. } = &mut out;
    let [first, second] = exchanged;
    let [place_a, place_b, place_c] = place;
    for n in 0..N {
        let (x, y, z) = (xs[n].abs(), ys[n].abs(), zs[n].abs());
        let scale = SCALE as f32 / (x + y + z);
        let x_over_y = x > y;
        let x_or_y = if x_over_y { x } else { y };
        let exchanged = x_or_y > z;
        let (x_largest, y_largest) = (exchanged & x_over_y, exchanged & !x_over_y);
        let a = if x_largest { z } else { x } * scale;
        let b = if y_largest { z } else { y } * scale;
        let c = if exchanged { x_or_y } else { z } * scale;
        let (down_a, down_b) = ((a - 0.5) + WHOLE, (b - 0.5) + WHOLE);
        base_a[n] = down_a.to_bits() as i32 & 0xFFF;
        base_b[n] = down_b.to_bits() as i32 & 0xFFF;
        above_a[n] = a - (down_a - WHOLE);
        above_b[n] = b - (down_b - WHOLE);
        place_a[n] = a;
        place_b[n] = b;
        place_c[n] = c;
        (first[n], second[n]) = (mask(x_largest), mask(y_largest));
        // Rounding to the whole number below may take one too many off, but the component is then next to 1.
        let inside = sides[n] * side * scale >= 1.5;
        doubt[n] = mask(!inside);
    }
    for (negative, vectors) in out.negative.iter_mut().zip(vectors) {
        for (negative, vector) in negative.iter_mut().zip(vectors) {
            *negative = mask(*vector < 0.0);
        }
    }
    out
}

/// Which corner of its cell is the nearest code: bit 0 to the right, bit 1 up; and where that is in doubt.
#[inline(always)]
fn nearest_corners<const N: usize>(places: &Places<N>) -> ([i32; N], [i32; N]) {
    let mut corner = [0; N];
    let mut doubt = places.doubt;
    let [place_a, place_b, place_c] = &places.place;
    let [above_a, above_b] = &places.above;
    let lesser = |one: f32, other: f32| if one < other { one } else { other };
    let greater = |one: f32, other: f32| if one < other { other } else { one };
    for n in 0..N {
        let (a, b, c) = (place_a[n], place_b[n], place_c[n]);
        let (to_right, to_top) = (a - c, b - c);
        let over_squared = 1.0 / (a * a + b * b + c * c);
        let distance = |square: f32, along: f32| {
            let share = along * over_squared;
            let across = square - along * share;
            // One over (1 - share)², whose share is at most 0.002: the next term is below 2^-15.
            across + across * (share + share)
        };
        // At each corner, 2 (x² + y² + xy) and the part along the direction, from those at the lower left.
        let (x, y) = (above_a[n], above_b[n]);
        let (two_x, two_y) = (x + x, y + y);
        let square = two_x * (x + y) + two_y * y;
        let (less_x, less_y) = (2.0 - two_x - (two_x + two_y), 2.0 - two_y - (two_x + two_y));
        let along = to_right * x + to_top * y;
        let here = distance(square, along);
        let beside = distance(square + less_x, along - to_right);
        let above = distance(square + less_y, along - to_top);
        let beyond = distance(square + (less_x + less_y) + 2.0, along - to_right - to_top);
        let (low, high) = (lesser(here, beside), greater(here, beside));
        let (low_up, high_up) = (lesser(above, beyond), greater(above, beyond));
        let least = lesser(low, low_up);
        let second = lesser(greater(low, low_up), lesser(high, high_up));
        let upper = mask(low_up < low);
        let right = (mask(beside < here) & !upper) | (mask(beyond < above) & upper);
        corner[n] = (right & 1) | (upper & 2);
        doubt[n] |= !mask(second - least > DOUBT);
    }
    (corner, doubt)
}

#[cfg(test)]
mod tests;
