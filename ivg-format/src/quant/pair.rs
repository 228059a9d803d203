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

impl DirectionQuantiser for HalfDirection {
    type Code = [u16; 3];

    fn encode(vector: [f64; 3], axis: usize, positive: bool) -> Option<[u16; 3]> {
        // The least component is a number of binary16, so that rounding cannot bring another below it.
        inside(vector, axis, positive).map(|direction| direction.map(half::from_f32))
    }

    fn decode(code: &[u16; 3]) -> [f32; 3] {
        code.map(|bits| half::to_f32(u32::from(bits)))
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
}

#[cfg(test)]
mod tests;
