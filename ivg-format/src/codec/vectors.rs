//! `vectors-f32`: 54 binary32 numbers a vertex (`spec/ivg.md` 6.2).

use super::{Broken, number};
use crate::code::codes;
use crate::quant::power_of_two;
use crate::values::HemisphereVectors;

/// Binary32 numbers of a vertex.
const COMPONENTS: usize = 54;

/// Finds a number that is not finite, stored or scaled (IVG-VEC-02).
pub(crate) fn check(payload: &[u8], scale_exponent: i16) -> Result<(), Broken> {
    let scale = power_of_two(i32::from(scale_exponent));
    match payload.chunks_exact(4).position(|bytes| !(component(bytes) * scale).is_finite()) {
        None => Ok(()),
        Some(n) => Err(Broken { code: codes::NOT_FINITE, at: n * 4 }),
    }
}

/// The vectors of vertex `n` (IVG-VEC-01).
pub(crate) fn read(payload: &[u8], n: usize, scale_exponent: i16) -> HemisphereVectors {
    let scale = power_of_two(i32::from(scale_exponent));
    let start = n * COMPONENTS * 4;
    let numbers = &payload[start..start + COMPONENTS * 4];
    core::array::from_fn(|h| {
        core::array::from_fn(|k| {
            core::array::from_fn(|i| {
                let at = (h * 9 + k * 3 + i) * 4;
                component(&numbers[at..at + 4]) * scale
            })
        })
    })
}

fn component(bytes: &[u8]) -> f32 {
    f32::from_bits(number(bytes))
}
