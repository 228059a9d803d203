//! `packed-oct24` and `packed-xyz24`: RGB9E5 colours, then direction codes of three bytes (`spec/ivg.md` 6.1, 6.2).

use super::products::{Chunk, Source};
use super::{Broken, HEMISPHERES};
use crate::code::codes;
use crate::quant::{DirectionCode, rgb9e5};
use core::marker::PhantomData;

/// Bytes of a direction code.
pub(super) const DIRECTION_BYTES: usize = 3;

/// Bytes of a colour.
pub(super) const COLOUR_BYTES: usize = 4;

/// Direction codes that are judged at once.
const CHECKED: usize = 64;

/// A payload of `len` vertices.
pub(super) struct Packed<'a, D> {
    colours: &'a [u8],
    directions: &'a [u8],
    scale_exponent: i16,
    code: PhantomData<D>,
}

impl<'a, D: DirectionCode> Packed<'a, D> {
    pub(super) fn of(payload: &'a [u8], len: usize, scale_exponent: i16) -> Self {
        let (colours, directions) = payload.split_at(payload.len().min(len * HEMISPHERES * COLOUR_BYTES));
        Self { colours, directions, scale_exponent, code: PhantomData }
    }

    /// Finds a forbidden direction code (IVG-DIR-02, IVG-XYZ-02).
    pub(super) fn check(&self) -> Result<(), Broken> {
        let mut place = 0;
        for bytes in self.directions.chunks(CHECKED * DIRECTION_BYTES) {
            let mut codes_here = [D::ALLOWED; CHECKED];
            join(bytes, &mut codes_here);
            let faults = codes_here.iter().fold(0, |faults, &code| faults | D::fault(code));
            if faults != 0 {
                let n = codes_here.iter().position(|&code| D::fault(code) != 0).unwrap_or(0);
                let at = self.colours.len() + (place + n) * DIRECTION_BYTES;
                return Err(Broken { code: codes::DIRECTION_CODE, at });
            }
            place += CHECKED;
        }
        Ok(())
    }
}

impl<D: DirectionCode> Source for Packed<'_, D> {
    fn load<const N: usize>(&self, first: usize, chunk: &mut Chunk<N>) {
        let mut stored = [0; N];
        join(&self.directions[first * DIRECTION_BYTES..][..N * DIRECTION_BYTES], &mut stored);
        D::directions(&stored, &mut chunk.direction);
        let (bytes, _) = self.colours[first * COLOUR_BYTES..][..N * COLOUR_BYTES].as_chunks::<COLOUR_BYTES>();
        for (stored, &bytes) in stored.iter_mut().zip(bytes) {
            *stored = u32::from_le_bytes(bytes);
        }
        rgb9e5::decode_all(&stored, self.scale_exponent, &mut chunk.colour);
    }
}

/// Codes of three bytes each, four at a time from three words.
fn join(bytes: &[u8], codes: &mut [u32]) {
    let (quads, rest) = bytes.as_chunks::<{ 4 * DIRECTION_BYTES }>();
    let (four, one) = codes.as_chunks_mut::<4>();
    for (codes, quad) in four.iter_mut().zip(quads) {
        let word = |n: usize| u32::from_le_bytes([quad[n], quad[n + 1], quad[n + 2], quad[n + 3]]);
        let (low, middle, high) = (word(0), word(4), word(8));
        *codes = [
            low & 0xFF_FFFF,
            low >> 24 | (middle & 0xFFFF) << 8,
            middle >> 16 | (high & 0xFF) << 16,
            high >> 8,
        ];
    }
    let behind = four.as_flattened_mut().iter_mut().skip(quads.len() * 4).chain(one);
    for (code, &[low, middle, high]) in behind.zip(rest.as_chunks::<DIRECTION_BYTES>().0) {
        *code = u32::from_le_bytes([low, middle, high, 0]);
    }
}
