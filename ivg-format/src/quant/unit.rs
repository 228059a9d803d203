//! Points with whole coordinates as directions of unit length, without a square root.
//!
//! A direction code names a point (x, y, z) of whole numbers; its direction is the point divided by √(x² + y² + z²), each
//! component the binary32 number nearest to the exact quotient (IVG-DIR-03, IVG-XYZ-03). What is here takes only sums and
//! products, so that a compiler can do several directions at once on any processor, and libraries without a square root
//! need none. That the results are the pinned ones is tested over all codes.

/// One over the root of `squared`, in binary64, off by less than 2^-51 of it; for whole numbers from 1 to 2^22.
///
/// A first guess from the bits of the number (off by 3.5 %) and two of Newton's steps in binary32 (5 × 10^-6), then one step of
/// order three in binary64: with e = 1 − squared × y², 1/√squared = y (1 − e)^(-1/2) = y (1 + e/2 + 3e²/8 + …).
#[inline(always)]
pub(crate) fn inverse_root(squared: f32) -> f64 {
    refined(squared, guess(squared))
}

#[inline(always)]
fn refined(squared: f32, guess: f32) -> f64 {
    let y = f64::from(guess);
    let e = 1.0 - f64::from(squared) * (y * y);
    y + y * (e * (0.5 + e * 0.375))
}

/// One over the root of `squared`, off by 5 × 10^-6 of it.
#[inline(always)]
fn guess(squared: f32) -> f32 {
    /// Halves the exponent and makes the worst error of both halves equal (C. Lomont, "Fast inverse square root", 2003).
    const GUESS: u32 = 0x5F37_5A86;
    let half = 0.5 * squared;
    let y = f32::from_bits(GUESS - (squared.to_bits() >> 1));
    let y = y * (1.5 - half * (y * y));
    y * (1.5 - half * (y * y))
}

/// As [`inverse_root`], in binary32 alone and off by less than 2^-22 of it: one more of Newton's steps.
#[inline(always)]
pub(crate) fn inverse_root_single(squared: f32) -> f32 {
    let y = guess(squared);
    y * (1.5 - 0.5 * squared * y * y)
}

/// The directions of the points that `point` finds for some codes, none of them the origin.
#[inline(always)]
pub(crate) fn directions<const N: usize>(
    codes: &[u32; N],
    point: impl Fn(u32) -> [f32; 3],
    out: &mut [[f32; N]; 3],
) {
    let [xs, ys, zs] = out;
    let mut scales = [0.0; N];
    let mut squares = [0.0; N];
    let mut guesses = [0.0; N];
    // Loops of one kind of number each, so that as many as possible are done at once.
    for n in 0..N {
        let [x, y, z] = point(codes[n]);
        squares[n] = x * x + y * y + z * z;
        guesses[n] = guess(squares[n]);
        (xs[n], ys[n], zs[n]) = (x, y, z);
    }
    for n in 0..N {
        scales[n] = refined(squares[n], guesses[n]);
    }
    for coordinates in [xs, ys, zs] {
        for n in 0..N {
            coordinates[n] = (f64::from(coordinates[n]) * scales[n]) as f32;
        }
    }
}

/// The direction of a point that is not the origin; whole numbers of magnitude up to 2047.
#[inline(always)]
pub(crate) fn direction(point: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = point;
    let scale = inverse_root(x * x + y * y + z * z);
    point.map(|c| (f64::from(c) * scale) as f32)
}

#[cfg(test)]
pub(super) mod tests;
