//! Packing many hemispheres at once with octahedral directions: all in binary32, which is twice as fast as binary64, with
//! a bound on every error. Where rounding could make another code of it, the caller packs the hemisphere alone
//! ([`crate::quant::pack`]), so that the codes are those of binary64 always.

use super::nearest::{self, Together, axis_code, mask};
use crate::quant::pack::LARGEST_RATIO;
use crate::quant::rgb9e5::Unscaled;
use crate::quant::unit;
use crate::values::HemisphereVectors;

/// One hemisphere of `N` vertices.
pub(crate) struct PackedTogether<const N: usize> {
    /// Direction codes.
    pub(crate) directions: [u32; N],
    /// The mantissas of colours, as in [`Unscaled`].
    pub(crate) mantissas: [u32; N],
    /// Their exponents.
    pub(crate) exponents: [u32; N],
    /// The largest components of colours, off by [`ERROR`] of them at most.
    pub(crate) largest: [f32; N],
    /// Not 0 where none of this may be right.
    pub(crate) doubt: [i32; N],
}

/// Components of colours are off by less than this part of them: the inverse root by 2^-22; its product with the square, the
/// quotient, the product with the component and the direction as readers know it by 2^-24 each. The cap, of another inverse root,
/// is no worse, and the lesser of two numbers is not either.
pub(crate) const ERROR: f64 = 1.0 / (1u32 << 21) as f64;

/// Mantissas, less than 512, are off by 2^-12 at most: this near to the middle between two, they are in doubt.
const MIDDLE: f32 = 0.5 - 1.0 / 2048.0;

/// The sums of magnitudes of a vector's coordinates that are packed together, [2^-30, 2^60] about: no square of a number that
/// matters beside the largest is subnormal, and none overflows.
const LEAST: f32 = 1.0 / (1u32 << 30) as f32;
const LARGEST_SQUARE: f32 = (1u128 << 120) as f32;

/// Packs hemisphere `hemisphere` of some vertices.
pub(crate) fn pack_together<const N: usize>(
    vertices: &[HemisphereVectors; N],
    hemisphere: usize,
) -> PackedTogether<N> {
    let (axis, positive) = (hemisphere / 2, hemisphere.is_multiple_of(2));
    // A loop of its own, so that those that follow have numbers side by side.
    let mut columns = [[[0.0; N]; 3]; 3];
    for (n, vertex) in vertices.iter().enumerate() {
        for (columns, vector) in columns.iter_mut().zip(&vertex[hemisphere]) {
            columns.iter_mut().zip(vector).for_each(|(column, &component)| column[n] = component);
        }
    }
    let [red, green, blue] = &columns;
    let mut sums = [[0.0; N]; 3];
    let mut partial = [0.0; N];
    let mut whole = [0.0; N];
    for (i, sums) in sums.iter_mut().enumerate() {
        for n in 0..N {
            let both = red[i][n] + green[i][n];
            sums[n] = both + blue[i][n];
            partial[n] += both.abs();
            whole[n] += sums[n].abs();
        }
    }
    let Together { codes, along, squared, mut doubt } = nearest::encode_all(&sums, axis, positive);
    let mut ratio = [0.0; N];
    for n in 0..N {
        // Each addition is off by 2^-24 of its result, so that this bounds the sums' error as `encode_all` wants it.
        doubt[n] |= !(mask(partial[n] <= 2.0 * whole[n]) & mask(whole[n] >= LEAST));
        ratio[n] = squared[n] * unit::inverse_root_single(squared[n]) / along[n];
    }
    let mut colours = [[0.0; N]; 3];
    for ((colours, vectors), components) in
        colours.iter_mut().zip(&columns).zip(columns.each_ref().map(|c| &c[axis]))
    {
        let [x, y, z] = vectors;
        let mut squares = [0.0; N];
        let mut capped = 0;
        for n in 0..N {
            let colour = components[n] * ratio[n];
            squares[n] = x[n] * x[n] + y[n] * y[n] + z[n] * z[n];
            // What is not finite has no square that is less than the largest.
            doubt[n] |= !mask(squares[n] <= LARGEST_SQUARE);
            capped |= mask(colour * colour > (LARGEST_RATIO * LARGEST_RATIO) as f32 * squares[n]);
            colours[n] = colour;
        }
        if capped != 0 {
            for n in 0..N {
                let most = LARGEST_RATIO as f32 * (squares[n] * unit::inverse_root_single(squares[n]));
                colours[n] = if most < colours[n] { most } else { colours[n] };
            }
        }
        for colour in colours {
            *colour = if *colour > 0.0 { *colour } else { 0.0 };
        }
    }
    let mut packed =
        PackedTogether { directions: codes, mantissas: [0; N], exponents: [0; N], largest: [0.0; N], doubt };
    mantissas(&colours, &mut packed);
    packed
}

/// The mantissas and exponents of colours.
#[inline(always)]
fn mantissas<const N: usize>([red, green, blue]: &[[f32; N]; 3], packed: &mut PackedTogether<N>) {
    /// Sums with 1.5 × 2^23 have no digits behind the point; the lowest bits are the whole number.
    const WHOLE: f32 = 12_582_912.0;
    let PackedTogether { mantissas, exponents, largest, doubt, .. } = packed;
    let greater = |one: f32, other: f32| if one > other { one } else { other };
    for n in 0..N {
        largest[n] = greater(greater(red[n], green[n]), blue[n]);
        let exponent = largest[n].to_bits() >> 23;
        // 2^(8 - exponent): 256 to 511 of them make the largest.
        let scale = f32::from_bits((8 + 2 * 127 - exponent) << 23);
        let certain = |scaled: f32, rounded: f32| mask((scaled - (rounded - WHOLE)).abs() < MIDDLE);
        let scaled = largest[n] * scale;
        let rounded = scaled + WHOLE;
        let mut all = certain(scaled, rounded);
        let carry = mask(rounded.to_bits() & 0x3FF == 512);
        let scale = f32::from_bits(scale.to_bits().wrapping_sub((carry & (1 << 23)).cast_unsigned()));
        exponents[n] = exponent + (carry & 1).cast_unsigned();
        let mut bits = |colour: f32| {
            let scaled = colour * scale;
            let rounded = scaled + WHOLE;
            all &= certain(scaled, rounded);
            rounded.to_bits() & 0x1FF
        };
        mantissas[n] = bits(blue[n]) << 18 | bits(green[n]) << 9 | bits(red[n]);
        doubt[n] |= !all;
    }
}

/// A hemisphere without light.
pub(crate) fn black(hemisphere: usize) -> (u32, Unscaled) {
    let direction = axis_code(hemisphere / 2, hemisphere.is_multiple_of(2));
    (direction, Unscaled::new([0.0; 3]))
}

#[cfg(test)]
mod tests;
