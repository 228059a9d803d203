//! `sh2-28`: spherical harmonics of the radiance, the mean as RGB9E5, the others as ratios to it (`spec/ivg.md` 6.5).

use super::Broken;
use crate::code::codes;
use crate::quant::{ratio, rgb9e5};
use crate::values::RadianceHarmonics;

/// Bytes of the mean radiance of the three channels.
pub(super) const MEAN_BYTES: usize = 4;

/// Ratios of a vertex: eight for each of three channels.
pub(super) const RATIOS: usize = 24;

/// Ratios of a channel.
const CHANNEL_RATIOS: usize = 8;

/// Codes that are judged at once.
const CHECKED: usize = 256;

/// Vertices that are read at once.
const VERTICES: usize = 16;

/// Finds a forbidden ratio code (IVG-SH-04) in a payload of `len` vertices.
pub(super) fn check(payload: &[u8], len: usize) -> Result<(), Broken> {
    let forbidden = |code: &u8| code.cast_signed() == i8::MIN;
    for (chunk, stored) in ratios(payload, len).chunks(CHECKED).enumerate() {
        if stored.iter().fold(false, |any, code| any | forbidden(code)) {
            let n = stored.iter().position(forbidden).unwrap_or(0);
            return Err(Broken { code: codes::RATIO_CODE, at: len * MEAN_BYTES + chunk * CHECKED + n });
        }
    }
    Ok(())
}

/// The coefficients of the vertices from `first` on (IVG-SH-05), in a payload of `len` vertices.
pub(super) fn read(
    payload: &[u8],
    len: usize,
    first: usize,
    scale_exponent: i16,
    out: &mut [RadianceHarmonics],
) {
    let (means, _) = payload[first * MEAN_BYTES..].as_chunks::<MEAN_BYTES>();
    let (stored, _) = ratios(payload, len)[first * RATIOS..].as_chunks::<RATIOS>();
    let chunks = out.chunks_mut(VERTICES).zip(means.chunks(VERTICES)).zip(stored.chunks(VERTICES));
    for ((vertices, means), stored) in chunks {
        let mut words = [0; VERTICES];
        for (word, &bytes) in words.iter_mut().zip(means) {
            *word = u32::from_le_bytes(bytes);
        }
        let mut mean = [[0.0; VERTICES]; 3];
        rgb9e5::decode_all(&words, scale_exponent, &mut mean);
        for (n, (vertex, stored)) in vertices.iter_mut().zip(stored).enumerate() {
            let (channels, _) = stored.as_chunks::<CHANNEL_RATIOS>();
            for ((coefficients, channel), mean) in vertex.iter_mut().zip(channels).zip(&mean) {
                let [first, others @ ..] = coefficients;
                *first = mean[n];
                *others = ratio::decode_all(channel).map(|ratio| mean[n] * ratio);
            }
        }
    }
}

/// The ratio codes: behind the means.
fn ratios(payload: &[u8], len: usize) -> &[u8] {
    payload.get(len * MEAN_BYTES..).unwrap_or(&[])
}
