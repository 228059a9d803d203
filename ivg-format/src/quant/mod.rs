//! Quantisers: pure functions between numbers and codes, each with its error bound.

pub mod direction;
pub mod pack;
pub mod ratio;
pub mod rgb9e5;

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
