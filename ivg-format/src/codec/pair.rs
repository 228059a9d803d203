//! `pair-f16`, `pair-f16x4` and `pair-f32`: colours, then directions, as floating-point numbers (`spec/ivg.md` 6.3).

use super::products::{Chunk, Source};
use super::{Broken, HEMISPHERES};
use crate::code::codes;
use crate::quant::{half, power_of_two};
use core::marker::PhantomData;
use ivg_wire::Code;

/// Hemispheres that are judged at once.
const CHECKED: usize = 16;

/// Three numbers as they are stored, and what each may be.
pub(super) trait Triple {
    /// Bytes of three numbers, with what pads them.
    const BYTES: usize;

    /// Bytes of one number.
    const NUMBER_BYTES: usize = Self::BYTES / Self::NUMBERS;

    /// Numbers stored, with the one that pads them.
    const NUMBERS: usize = 3;

    /// The bits of number `n`, with zeros above.
    fn bits(bytes: &[u8], n: usize) -> u32;

    /// The number with these bits.
    fn number(bits: u32) -> f32;

    /// Whether a colour may have these bits, with this scale (IVG-PAIR-02).
    fn is_colour(bits: u32, scale: f32) -> bool;

    /// Whether a component of a direction may have these bits (IVG-PAIR-03).
    fn is_component(bits: u32) -> bool;
}

/// Three numbers of binary16, stored as `NUMBERS`: of four, the last is +0.
pub(super) struct Half<const NUMBERS: usize>;

/// Three numbers of binary32.
pub(super) struct Single;

/// The bits of infinity, of 1 and of −0 in binary16.
const HALF_INFINITY: u32 = 0x7C00;
const HALF_ONE: u32 = 0x3C00;
const HALF_MINUS_ZERO: u32 = 0x8000;

impl<const NUMBERS: usize> Triple for Half<NUMBERS> {
    const BYTES: usize = 2 * NUMBERS;
    const NUMBERS: usize = NUMBERS;

    fn bits(bytes: &[u8], n: usize) -> u32 {
        u32::from(bytes[2 * n]) | u32::from(bytes[2 * n + 1]) << 8
    }

    fn number(bits: u32) -> f32 {
        half::to_f32(bits)
    }

    fn is_colour(bits: u32, _scale: f32) -> bool {
        // The scaled number is finite with every scale exponent.
        (bits < HALF_INFINITY) | (bits == HALF_MINUS_ZERO)
    }

    fn is_component(bits: u32) -> bool {
        bits & !HALF_MINUS_ZERO <= HALF_ONE
    }
}

impl Triple for Single {
    const BYTES: usize = 12;

    fn bits(bytes: &[u8], n: usize) -> u32 {
        u32::from_le_bytes([bytes[4 * n], bytes[4 * n + 1], bytes[4 * n + 2], bytes[4 * n + 3]])
    }

    fn number(bits: u32) -> f32 {
        f32::from_bits(bits)
    }

    fn is_colour(bits: u32, scale: f32) -> bool {
        // Scaled, a finite number may become infinite.
        let value = f32::from_bits(bits);
        (value >= 0.0) & (value * scale < f32::INFINITY)
    }

    fn is_component(bits: u32) -> bool {
        bits & 0x7FFF_FFFF <= 1.0f32.to_bits()
    }
}

/// A payload of `len` vertices.
pub(super) struct Pair<'a, T> {
    colours: &'a [u8],
    directions: &'a [u8],
    scale: f32,
    triple: PhantomData<T>,
}

impl<'a, T: Triple> Pair<'a, T> {
    pub(super) fn of(payload: &'a [u8], len: usize, scale_exponent: i16) -> Self {
        let (colours, directions) = payload.split_at(payload.len().min(len * HEMISPHERES * T::BYTES));
        Self { colours, directions, scale: power_of_two(i32::from(scale_exponent)), triple: PhantomData }
    }

    /// Finds a number that is no colour, no component of a direction, or no padding, in stored order.
    pub(super) fn check(&self) -> Result<(), Broken> {
        find::<T>(self.colours, 0, codes::PAIR_COLOUR, |bits| T::is_colour(bits, self.scale))?;
        find::<T>(self.directions, self.colours.len(), codes::PAIR_DIRECTION, T::is_component)
    }
}

/// Finds the first number that is not `allowed`, or is padding and not 0, in an array that begins at byte `start`.
fn find<T: Triple>(
    array: &[u8],
    start: usize,
    broken: Code,
    allowed: impl Fn(u32) -> bool,
) -> Result<(), Broken> {
    let judge = |triple: &[u8], n: usize| match n {
        0..3 => allowed(T::bits(triple, n)),
        _ => T::bits(triple, n) == 0,
    };
    for (chunk, triples) in array.chunks(CHECKED * T::BYTES).enumerate() {
        let all = triples
            .chunks_exact(T::BYTES)
            .fold(true, |all, triple| (0..T::NUMBERS).fold(all, |all, n| all & judge(triple, n)));
        if all {
            continue;
        }
        for (place, triple) in triples.chunks_exact(T::BYTES).enumerate() {
            if let Some(n) = (0..T::NUMBERS).find(|&n| !judge(triple, n)) {
                let at = start + (chunk * CHECKED + place) * T::BYTES + n * T::NUMBER_BYTES;
                let code = if n < 3 { broken } else { ivg_wire::codes::RESERVED };
                return Err(Broken { code, at });
            }
        }
    }
    Ok(())
}

impl<T: Triple> Source for Pair<'_, T> {
    fn load<const N: usize>(&self, first: usize, chunk: &mut Chunk<N>) {
        let colours = self.colours[first * T::BYTES..][..N * T::BYTES].chunks_exact(T::BYTES);
        for (n, triple) in colours.enumerate() {
            for (i, component) in chunk.colour.iter_mut().enumerate() {
                // Adding 0 makes +0 of −0 (IVG-PAIR-02) and leaves everything else.
                component[n] = T::number(T::bits(triple, i)) * self.scale + 0.0;
            }
        }
        let directions = self.directions[first * T::BYTES..][..N * T::BYTES].chunks_exact(T::BYTES);
        for (n, triple) in directions.enumerate() {
            for (i, component) in chunk.direction.iter_mut().enumerate() {
                component[n] = T::number(T::bits(triple, i));
            }
        }
    }
}
