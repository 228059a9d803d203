//! Quantisers: pure functions between numbers and codes, each with its error bound.

pub mod direction;
pub mod half;
pub mod pack;
pub mod pair;
pub mod ratio;
pub mod rgb9e5;
mod unit;
pub mod xyz;

/// A direction code of 24 bits.
pub(crate) trait DirectionCode {
    /// Some code that is allowed.
    const ALLOWED: u32;

    /// Not 0 exactly if the code, whose bits 24 to 31 are 0, is forbidden. Without branches, for many codes at once.
    fn fault(code: u32) -> u32;

    /// The directions of allowed codes.
    fn directions<const N: usize>(codes: &[u32; N], out: &mut [[f32; N]; 3]);
}

/// 2 to the power of `exponent`, for −149 ≤ `exponent` ≤ 127; exact, also where the result is subnormal.
pub(crate) const fn power_of_two(exponent: i32) -> f32 {
    debug_assert!(-149 <= exponent && exponent <= 127);
    if exponent >= -126 {
        f32::from_bits(((exponent + 127) as u32) << 23)
    } else {
        f32::from_bits(1 << (exponent + 149))
    }
}

/// 2 to the power of `exponent`, for −1022 ≤ `exponent` ≤ 1023; exact.
pub(crate) const fn power_of_two_f64(exponent: i32) -> f64 {
    debug_assert!(-1022 <= exponent && exponent <= 1023);
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

/// The largest `e` with 2^e ≤ `value`, for normal positive numbers; −1023 for 0 and subnormals.
pub(crate) const fn floor_log2(value: f64) -> i32 {
    ((value.to_bits() >> 52) & 0x7FF) as i32 - 1023
}

/// The vector divided by its largest magnitude, so that no square can overflow or vanish; `None` if it is zero or not finite.
pub(crate) fn normalised(vector: [f64; 3]) -> Option<[f64; 3]> {
    let largest = vector.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
    (vector.iter().all(|c| c.is_finite()) && largest > 0.0).then(|| vector.map(|c| c / largest))
}
