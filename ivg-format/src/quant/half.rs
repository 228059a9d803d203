//! binary16: eleven significant bits, 2^-24 to 65504.
//!
//! From binary32 only: software and hardware round that the same way everywhere, to nearest and halves to even. Numbers are
//! kept as their bits; the type of half-precision numbers stays in here.

use half::f16;

/// The largest finite number.
pub const LARGEST: f32 = 65504.0;

/// The bits of the nearest number, halves to even; infinity for what rounds to more than [`LARGEST`], as 65520 does.
#[must_use]
pub fn from_f32(value: f32) -> u16 {
    f16::from_f32(value).to_bits()
}

/// The finite number with these bits, exactly.
#[inline(always)]
pub(crate) fn to_f32(bits: u32) -> f32 {
    /// 2^-24, the step of the subnormal numbers.
    const STEP: f32 = f32::from_bits((127 - 24) << 23);
    let magnitude = bits & 0x7FFF;
    // Exponents of binary32 are 127 − 15 higher. Subnormals, which need another one each, are whole multiples of the step.
    let normal = (magnitude << 13) + ((127 - 15) << 23);
    let subnormal = (magnitude as i32 as f32 * STEP).to_bits();
    let number = if magnitude < 0x0400 { subnormal } else { normal };
    f32::from_bits(number | (bits & 0x8000) << 16)
}

#[cfg(test)]
mod tests;
