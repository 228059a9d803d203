//! `sh2-28`: spherical harmonics of the radiance, the mean as RGB9E5, the others as ratios to it (`spec/ivg.md` 6.3).

use super::{Broken, number};
use crate::code::codes;
use crate::quant::{ratio, rgb9e5};
use crate::values::RadianceHarmonics;

/// Bytes of the mean radiance of the three channels.
const MEAN_BYTES: usize = 4;

/// Ratios of a vertex: eight for each of three channels.
pub(crate) const RATIOS: usize = 24;

/// Ratios of a channel.
const CHANNEL_RATIOS: usize = 8;

/// Finds a forbidden ratio code (IVG-SH-04) in a payload of `len` vertices.
pub(crate) fn check(payload: &[u8], len: usize) -> Result<(), Broken> {
    match ratios(payload, len).iter().position(|&code| code.cast_signed() == i8::MIN) {
        None => Ok(()),
        Some(n) => Err(Broken { code: codes::RATIO_CODE, at: len * MEAN_BYTES + n }),
    }
}

/// The coefficients of vertex `n` (IVG-SH-05).
pub(crate) fn read(payload: &[u8], len: usize, n: usize, scale_exponent: i16) -> RadianceHarmonics {
    let mean = rgb9e5::decode_scaled(number(&payload[n * MEAN_BYTES..][..MEAN_BYTES]), scale_exponent);
    let stored = &ratios(payload, len)[n * RATIOS..][..RATIOS];
    core::array::from_fn(|channel| {
        let mut coefficients = [mean[channel]; 9];
        let codes = &stored[channel * CHANNEL_RATIOS..][..CHANNEL_RATIOS];
        for (which, (coefficient, &code)) in coefficients[1..].iter_mut().zip(codes).enumerate() {
            *coefficient *= ratio::decode(code.cast_signed(), which + 1);
        }
        coefficients
    })
}

/// The ratio codes: behind the means.
fn ratios(payload: &[u8], len: usize) -> &[u8] {
    payload.get(len * MEAN_BYTES..).unwrap_or(&[])
}
