//! `packed-oct24`: RGB9E5 colours, then octahedral direction codes (`spec/ivg.md` 6.1).

use super::{Broken, number};
use crate::code::codes;
use crate::quant::direction::{decode_valid, is_valid};
use crate::quant::rgb9e5;

/// Directions of a vertex.
pub(crate) const HEMISPHERES: usize = 6;

/// Bytes of a direction code.
const DIRECTION_BYTES: usize = 3;

/// Finds a forbidden direction code (IVG-DIR-02) in a payload of `len` vertices.
pub(crate) fn check(payload: &[u8], len: usize) -> Result<(), Broken> {
    let codes_of = directions(payload, len);
    match codes_of.chunks_exact(DIRECTION_BYTES).position(|code| !is_valid(number(code))) {
        None => Ok(()),
        Some(n) => {
            let at = payload.len() - codes_of.len() + n * DIRECTION_BYTES;
            Err(Broken { code: codes::DIRECTION_CODE, at })
        }
    }
}

/// Direction and scaled colour of hemisphere `h` of vertex `n`.
pub(crate) fn hemisphere(
    payload: &[u8],
    len: usize,
    n: usize,
    h: usize,
    scale_exponent: i16,
) -> ([f32; 3], [f32; 3]) {
    let at = n * HEMISPHERES + h;
    let colour = number(&payload[at * 4..at * 4 + 4]);
    let code = &directions(payload, len)[at * DIRECTION_BYTES..at * DIRECTION_BYTES + DIRECTION_BYTES];
    (decode_valid(number(code)), rgb9e5::decode_scaled(colour, scale_exponent))
}

/// The direction codes: behind the colours.
fn directions(payload: &[u8], len: usize) -> &[u8] {
    payload.get(len * HEMISPHERES * 4..).unwrap_or(&[])
}
