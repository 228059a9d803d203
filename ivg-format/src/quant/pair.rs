//! Directions as three floating-point numbers: the quantisers of the encodings `pair-f16`, `pair-f16x4` and `pair-f32`.

use super::pack::DirectionQuantiser;
use super::{half, normalised};

/// The least component along the axis of a hemisphere (IVG-PAIR-06): about that of the octahedral codes.
const LEAST: f32 = 1.0 / 2048.0;

/// Three numbers of binary16, as their bits.
#[derive(Clone, Copy, Debug, Default)]
pub struct HalfDirection;

/// Three numbers of binary32.
#[derive(Clone, Copy, Debug, Default)]
pub struct SingleDirection;

/// The unit vector in binary32, its component along the axis no less than the least.
fn inside(vector: [f64; 3], axis: usize, positive: bool) -> Option<[f32; 3]> {
    let [x, y, z] = normalised(vector)?;
    let length = libm::sqrt(x * x + y * y + z * z);
    let mut direction = [x, y, z].map(|c| (c / length) as f32);
    let along = direction.get_mut(axis)?;
    *along = if positive { along.max(LEAST) } else { along.min(-LEAST) };
    Some(direction)
}

/// As [`inside`], of `N` vectors `[xyz][n]`, each step for all of them; the axis for a vector that has no direction.
#[inline(always)]
fn all_inside<const N: usize>(vectors: &[[f64; N]; 3], axis: usize, positive: bool) -> [[f32; N]; 3] {
    let [xs, ys, zs] = vectors;
    let side = if positive { 1.0 } else { -1.0 };
    let greater = |one: f64, other: f64| if one > other { one } else { other };
    let mut scaled = [[0.0; N]; 3];
    let mut lengths = [0.0; N];
    let mut lost = [false; N];
    for n in 0..N {
        let largest = greater(greater(xs[n].abs(), ys[n].abs()), zs[n].abs());
        let [x, y, z] = [xs[n] / largest, ys[n] / largest, zs[n] / largest];
        lengths[n] = x * x + y * y + z * z;
        (scaled[0][n], scaled[1][n], scaled[2][n]) = (x, y, z);
        // A coordinate that is not finite, or three that are 0, leave something that is not a number.
        lost[n] = lengths[n].is_nan();
    }
    lengths.iter_mut().for_each(|length| *length = libm::sqrt(*length));
    let mut directions = [[0.0; N]; 3];
    for (i, (directions, scaled)) in directions.iter_mut().zip(&scaled).enumerate() {
        let on_axis = if i == axis { side as f32 } else { 0.0 };
        for n in 0..N {
            let component = (scaled[n] / lengths[n]) as f32;
            let least =
                if i == axis && component * (side as f32) < LEAST { LEAST * side as f32 } else { component };
            directions[n] = if lost[n] { on_axis } else { least };
        }
    }
    directions
}

/// Codes of `N` directions `[xyz][n]`, and the component along `axis` of what a reader makes of them.
#[inline(always)]
fn store_all<Q: DirectionQuantiser, const N: usize>(
    directions: &[[f32; N]; 3],
    code_of: impl Fn([f32; 3]) -> Q::Code,
    axis: usize,
    codes: &mut [Q::Code; N],
    along: &mut [f64; N],
) {
    for (n, (code, along)) in codes.iter_mut().zip(along).enumerate() {
        *code = code_of(directions.each_ref().map(|component| component[n]));
        *along = f64::from(Q::decode(code)[axis]);
    }
}

impl DirectionQuantiser for HalfDirection {
    type Code = [u16; 3];

    fn encode(vector: [f64; 3], axis: usize, positive: bool) -> Option<[u16; 3]> {
        // The least component is a number of binary16, so that rounding cannot bring another below it.
        inside(vector, axis, positive).map(|direction| direction.map(half::from_f32))
    }

    fn decode(code: &[u16; 3]) -> [f32; 3] {
        code.map(|bits| half::to_f32(u32::from(bits)))
    }

    fn encode_all<const N: usize>(
        vectors: &[[f64; N]; 3],
        axis: usize,
        positive: bool,
        codes: &mut [Self::Code; N],
        along: &mut [f64; N],
    ) {
        let directions = all_inside(vectors, axis, positive);
        store_all::<Self, N>(&directions, |direction| direction.map(half::from_f32), axis, codes, along);
    }
}

impl DirectionQuantiser for SingleDirection {
    type Code = [f32; 3];

    fn encode(vector: [f64; 3], axis: usize, positive: bool) -> Option<[f32; 3]> {
        inside(vector, axis, positive)
    }

    fn decode(code: &[f32; 3]) -> [f32; 3] {
        *code
    }

    fn encode_all<const N: usize>(
        vectors: &[[f64; N]; 3],
        axis: usize,
        positive: bool,
        codes: &mut [Self::Code; N],
        along: &mut [f64; N],
    ) {
        let directions = all_inside(vectors, axis, positive);
        store_all::<Self, N>(&directions, |direction| direction, axis, codes, along);
    }
}

#[cfg(test)]
mod tests;
