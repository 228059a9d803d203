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

/// The code nearest to `ratio` for coefficient `which` (1 to 8), halves away from zero; a ratio beyond the bounds
/// becomes the bound, one that is not a number 0.
#[must_use]
pub fn encode(ratio: f64, which: usize) -> i8 {
    let steps = libm::round(ratio / f64::from(step(which, ratio < 0.0)));
    // `as` takes NaN to 0 and everything beyond to the ends.
    steps.clamp(-127.0, 127.0) as i8
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
