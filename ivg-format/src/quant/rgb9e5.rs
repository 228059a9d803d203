//! RGB9E5: three 9-bit mantissas and one shared 5-bit exponent in 32 bits.
//!
//! Bits 0–8 red, 9–17 green, 18–26 blue, 27–31 the exponent E; a component is `mantissa × 2^(E − 24)`
//! (IVG-RGB-01; the layout of `EXT_texture_shared_exponent` and of the GPU format `RGB9E5`). Decoding is
//! exact in binary32. Encoding is off by at most half a step, `2^(E − 25)`, which is at most 1/511 of the
//! largest component or 2^−25, whichever is more.

use super::{floor_log2, power_of_two, power_of_two_f64};

/// The largest value that can be stored: 511 × 2^7.
pub const LARGEST: f32 = 65408.0;

/// Bias of the exponent, plus the 9 bits of the mantissa.
const EXPONENT_OFFSET: i32 = 15 + 9;

/// Encodes a colour (IVG-RGB-03): components below 0 and NaN count as 0, components above [`LARGEST`] as
/// [`LARGEST`]; halves are rounded up.
#[must_use]
pub fn encode(colour: [f32; 3]) -> u32 {
    encode_f64(colour.map(f64::from))
}

/// As [`encode`], without rounding the components to binary32 first.
#[must_use]
pub(crate) fn encode_f64(colour: [f64; 3]) -> u32 {
    // `f64::max` and `f64::min` take the number of a number and a NaN.
    let [r, g, b] = colour.map(|c| c.max(0.0).min(f64::from(LARGEST)));
    let largest = r.max(g).max(b);
    let mut exponent = (floor_log2(largest) + 16).max(0);
    // Rounding may carry the largest mantissa to 512, which is 256 at the next exponent. It cannot happen at
    // exponent 31, because the components were clamped to 511 steps of that exponent.
    if round(largest, exponent) == 512 {
        exponent += 1;
    }
    let exponent_bits = (exponent as u32) << 27;
    exponent_bits | round(b, exponent) << 18 | round(g, exponent) << 9 | round(r, exponent)
}

/// As [`encode_f64`], for finite colours that are not negative, one array for each component.
#[inline(always)]
pub(crate) fn encode_all<const N: usize>(colours: &[[f64; N]; 3]) -> [u32; N] {
    let lesser = |one: f64, other: f64| if one < other { one } else { other };
    core::array::from_fn(|n| {
        let [r, g, b] = colours.each_ref().map(|c| lesser(c[n], f64::from(LARGEST)));
        let largest = if r > g { r } else { g };
        let largest = if b > largest { b } else { largest };
        // The exponent in the upper half of the bits; numbers below 2^-16 share the lowest.
        let exponent = (((largest.to_bits() >> 52) as i32) - 1023 + 16).max(0);
        let scale = |exponent: i32| f64::from_bits(((EXPONENT_OFFSET - exponent + 1023) as u64) << 52);
        let exponent = exponent + i32::from(nearest(largest * scale(exponent)) == 512);
        let scale = scale(exponent);
        (exponent as u32) << 27 | nearest(b * scale) << 18 | nearest(g * scale) << 9 | nearest(r * scale)
    })
}

/// The whole number nearest to one that is not negative, halves up.
#[inline(always)]
fn nearest(number: f64) -> u32 {
    /// Sums with 2^52 have no digits behind the point; the lowest bits are the whole number.
    const WHOLE: f64 = 4_503_599_627_370_496.0;
    let even = number + WHOLE;
    // Halves went to the even neighbour; where that was the lower one, up.
    even.to_bits() as u32 + u32::from(number - (even - WHOLE) >= 0.5)
}

/// A colour before it is divided by a scale that is not known yet, which changes only the exponent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Unscaled {
    /// As they are stored.
    pub(crate) mantissas: u32,
    /// The exponent of the largest component in binary32, after rounding; 0 for one that binary32 does not have.
    pub(crate) exponent: u8,
}

impl Unscaled {
    /// A finite colour that is not negative.
    #[inline(always)]
    pub(crate) fn new(colour: [f64; 3]) -> Self {
        /// Below it and above the range of binary32, colours are not kept.
        const LEAST: i32 = -127;
        let [r, g, b] = colour;
        let largest = if r > g { r } else { g };
        let largest = if b > largest { b } else { largest };
        let mantissa = |component: f64, exponent: i32| nearest(component * power_of_two_f64(8 - exponent));
        let exponent = floor_log2(largest).max(LEAST);
        let exponent = exponent + i32::from(mantissa(largest, exponent) == 512);
        let mantissas = mantissa(b, exponent) << 18 | mantissa(g, exponent) << 9 | mantissa(r, exponent);
        // Black is black at any exponent.
        let exponent = if largest > 0.0 { exponent - LEAST } else { 1 };
        Self { mantissas, exponent: u8::try_from(exponent).unwrap_or(0) }
    }

    /// The code of the colour over 2^`scale_exponent`, which is at most [`LARGEST`]; `None` where that is so small that
    /// its mantissas have fewer bits, and for what was not kept.
    #[inline(always)]
    pub(crate) fn scaled(self, scale_exponent: i16) -> Option<u32> {
        let exponent = i32::from(self.exponent) - 127 - i32::from(scale_exponent) + 16;
        if self.exponent > 0 && (exponent >= 0 || self.mantissas == 0) {
            Some(if self.mantissas == 0 { 0 } else { (exponent as u32) << 27 | self.mantissas })
        } else {
            None
        }
    }
}

/// The mantissa of `component` at `exponent`, halves rounded up. The component is not negative and the
/// product with a power of two exact, so that truncating after adding one half rounds as it should.
fn round(component: f64, exponent: i32) -> u32 {
    (component * power_of_two_f64(EXPONENT_OFFSET - exponent) + 0.5) as u32
}

/// Decodes a colour; every code is valid and the result exact.
#[must_use]
pub fn decode(code: u32) -> [f32; 3] {
    decode_scaled(code, 0)
}

/// Decodes a colour times 2^`scale_exponent`; exact for −125 ≤ `scale_exponent` ≤ 112 (IVG-RGB-02).
#[must_use]
pub(crate) fn decode_scaled(code: u32, scale_exponent: i16) -> [f32; 3] {
    let step = power_of_two((code >> 27) as i32 - EXPONENT_OFFSET + i32::from(scale_exponent));
    [code, code >> 9, code >> 18].map(|bits| (bits & 0x1FF) as f32 * step)
}

/// Decodes colours times 2^`scale_exponent`, one array for each component; exact (IVG-RGB-02).
#[inline(always)]
pub(crate) fn decode_all<const N: usize>(codes: &[u32; N], scale_exponent: i16, out: &mut [[f32; N]; 3]) {
    let scale = power_of_two(i32::from(scale_exponent));
    let [red, green, blue] = out;
    for n in 0..N {
        let code = codes[n];
        // From 2^-24 to 2^7; times the scale it may be subnormal, and is exact all the same.
        let step = f32::from_bits(((code >> 27) + (127 - EXPONENT_OFFSET as u32)) << 23) * scale;
        let component = |bits: u32| (bits & 0x1FF).cast_signed() as f32 * step;
        (red[n], green[n], blue[n]) = (component(code), component(code >> 9), component(code >> 18));
    }
}

#[cfg(test)]
mod tests;
