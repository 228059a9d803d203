//! Ratios of spherical harmonics of non-negative radiance to their mean, in signed 8-bit codes.
//!
//! Where radiance is never negative, coefficient (l, m) is at most max Y_lm / Y_00 times coefficient (0, 0), and at least
//! min Y_lm / Y_00 times: √3 both ways for degree 1, √15/2 both ways for degree 2, but √5 and −√5/2 for (2, 0). The code
//! 127 is the upper bound, −127 the lower, 0 is 0; −128 is forbidden (IVG-SH-04).

/// The binary32 numbers nearest to √3 / 127, √15 / 254, √5 / 127 and √5 / 254 (IVG-SH-05).
const LINEAR: f32 = f32::from_bits(0x3C5F_72BD);
const QUADRATIC: f32 = f32::from_bits(0x3C79_D29B);
const ZONAL_ABOVE: f32 = f32::from_bits(0x3C90_3C35);
const ZONAL_BELOW: f32 = f32::from_bits(0x3C10_3C35);

/// Number of coefficient (2, 0) in the order of `RadianceHarmonics`.
const ZONAL: usize = 6;

/// The ratio that `code` stands for in coefficient `which` (1 to 8): one product, rounded once.
#[must_use]
pub fn decode(code: i8, which: usize) -> f32 {
    f32::from(code) * step(which, code < 0)
}

/// The ratios of coefficients 1 to 8 of a channel.
#[inline(always)]
pub(crate) fn decode_all(codes: &[u8; 8]) -> [f32; 8] {
    let above = [1, 2, 3, 4, 5, 6, 7, 8].map(|which| step(which, false));
    let below = [1, 2, 3, 4, 5, 6, 7, 8].map(|which| step(which, true));
    core::array::from_fn(|n| {
        let code = codes[n].cast_signed();
        f32::from(code) * if code < 0 { below[n] } else { above[n] }
    })
}

/// The code nearest to `ratio` for coefficient `which` (1 to 8), halves away from zero; a ratio beyond the bounds
/// becomes the bound, one that is not a number 0.
#[must_use]
pub fn encode(ratio: f64, which: usize) -> i8 {
    nearest(ratio, f64::from(step(which, ratio < 0.0)))
}

/// The codes of coefficients 1 to 8 of each channel, finite numbers, for the coefficients 0 that a reader will have: 0 where
/// that is 0 (IVG-SH-06).
#[inline(always)]
pub(crate) fn encode_all(channels: &[[f32; 9]; 3], means: [f32; 3]) -> [u8; 24] {
    /// Sums with 1.5 × 2^23 have no digits behind the point; the lowest bits are the whole number.
    const WHOLE: f32 = 12_582_912.0;
    /// In binary32 a quotient of up to 127 is off by less than 127 × 2^-21: nearer to the middle between two whole
    /// numbers than this, it is found in binary64.
    const DOUBT: f32 = 0.5 - 1.0 / 8192.0;
    let above = [1, 2, 3, 4, 5, 6, 7, 8].map(|which| 1.0 / step(which, false));
    let below = [1, 2, 3, 4, 5, 6, 7, 8].map(|which| 1.0 / step(which, true));
    let mut sums = [[0; 8]; 3];
    let mut certain = [0; 3];
    for (channel, [_, coefficients @ ..]) in channels.iter().enumerate() {
        let inverse = 1.0 / means[channel];
        let mut all = i32::from(inverse.is_finite());
        for n in 0..8 {
            let negative = coefficients[n] < 0.0;
            let quotient = coefficients[n] * inverse * if negative { below[n] } else { above[n] };
            let quotient = if quotient < 127.0 { quotient } else { 127.0 };
            let quotient = if quotient > -127.0 { quotient } else { -127.0 };
            let whole = quotient + WHOLE;
            sums[channel][n] = whole.to_bits();
            // Not a number is not certain, either: that is what a mean of 0 gives, and one too small for its inverse.
            all &= i32::from((quotient - (whole - WHOLE)).abs() < DOUBT);
        }
        certain[channel] = all;
    }
    let mut codes = [0; 24];
    for (code, sum) in codes.iter_mut().zip(sums.as_flattened()) {
        *code = *sum as u8;
    }
    for (channel, codes) in codes.as_chunks_mut().0.iter_mut().enumerate().filter(|&(n, _)| certain[n] == 0) {
        let [_, coefficients @ ..] = &channels[channel];
        *codes = encode_exactly(coefficients, means[channel]);
    }
    codes
}

#[cold]
fn encode_exactly(coefficients: &[f32; 8], mean: f32) -> [u8; 8] {
    // What is divided by infinity is 0, so that a mean of 0 gives codes of 0.
    let mean = if mean > 0.0 { f64::from(mean) } else { f64::INFINITY };
    core::array::from_fn(|n| {
        // The product has at most 9 + 24 bits and is exact, so that only the quotient is rounded.
        let unit = mean * f64::from(step(n + 1, coefficients[n] < 0.0));
        nearest(f64::from(coefficients[n]), unit).cast_unsigned()
    })
}

/// The whole number nearest to a quotient, halves away from zero, within −127 … 127; 0 for what is not a number.
#[inline(always)]
fn nearest(value: f64, unit: f64) -> i8 {
    /// Sums with 2^52 have no digits behind the point.
    const WHOLE: f64 = 4_503_599_627_370_496.0;
    let quotient = value / unit;
    let magnitude = if quotient.is_nan() { 0.0 } else { quotient.abs().min(127.0) };
    let even = magnitude + WHOLE;
    // Halves went to the even neighbour; where that was the lower one, up.
    let up = i32::from(magnitude - (even - WHOLE) >= 0.5);
    let whole = even.to_bits() as i32 + up;
    (if quotient < 0.0 { -whole } else { whole }) as i8
}

fn step(which: usize, negative: bool) -> f32 {
    match which {
        1..=3 => LINEAR,
        ZONAL if negative => ZONAL_BELOW,
        ZONAL => ZONAL_ABOVE,
        _ => QUADRATIC,
    }
}

#[cfg(test)]
mod tests;
