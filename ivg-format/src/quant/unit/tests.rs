use super::*;

/// Compares x / sqrt(squared) with `value` exactly: whether no other binary32 number is nearer.
pub(in crate::quant) fn is_nearest(x: i32, squared: i32, value: f32) -> bool {
    if x == 0 {
        return value.to_bits() == 0;
    }
    if (x < 0) != (value < 0.0) {
        return false;
    }
    // value = m × 2^e with 2^23 ≤ m < 2^24; its neighbours' midpoints are (2m ± 1) × 2^(e - 1). The quotient lies
    // between them if its square does: x² 2^(2 - 2e) between (2m ± 1)² × squared. At most 10 + 2 × 35 + 22 and
    // 50 + 23 bits: they fit. (At m = 2^23 the lower midpoint is nearer; the bound below is then the laxer one,
    // so that case is compared with (4m - 1) / 2 instead.)
    let bits = value.abs().to_bits();
    let (e, m) = ((bits >> 23) as i32 - 150, u128::from(bits & 0x7F_FFFF | 0x80_0000));
    let quotient = u128::from(x.unsigned_abs()).pow(2) << (4 - 2 * e);
    let squared = squared as u128;
    let above = (4 * m + 2).pow(2) * squared;
    let below = if m == 0x80_0000 { 4 * m - 1 } else { 4 * m - 2 }.pow(2) * squared;
    below < quotient && quotient < above
}

#[test]
fn a_number_that_is_one_unit_off_is_not_the_nearest() {
    let point = [1025, 1, 1021];
    let squared = point.iter().map(|c| c * c).sum();
    let [x, ..] = direction(point.map(|c| c as f32));
    assert!(is_nearest(point[0], squared, x));
    assert!(!is_nearest(point[0], squared, x.next_up()) && !is_nearest(point[0], squared, x.next_down()));
}

#[test]
fn the_inverse_root_is_within_its_bound_for_every_whole_number() {
    for squared in 1..=1u32 << 22 {
        let exact = 1.0 / f64::from(squared).sqrt();
        let error = (inverse_root(squared as f32) - exact).abs() / exact;
        // 5/16 of the cube of 10^-5, and a few roundings; and half a unit each for the root and the quotient above.
        assert!(error <= 2.0_f64.powi(-51), "{squared}: {error:e}");
    }
}
