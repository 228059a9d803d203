use super::*;
use quickcheck::quickcheck;

/// Any number of binary16 by its definition.
fn by_definition(bits: u16) -> f64 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 0x3FF));
    let magnitude = match exponent {
        0 => fraction * 2.0_f64.powi(-24),
        _ => (1024.0 + fraction) * 2.0_f64.powi(exponent - 25),
    };
    if bits >> 15 == 1 { -magnitude } else { magnitude }
}

#[test]
fn every_finite_number_is_read_exactly_and_written_back() {
    for bits in (0..=u16::MAX).filter(|bits| bits & 0x7FFF < 0x7C00) {
        let number = to_f32(bits.into());
        assert_eq!(f64::from(number).to_bits(), by_definition(bits).to_bits(), "{bits:#06x}");
        assert_eq!(from_f32(number), bits);
    }
}

#[test]
fn the_largest_number_and_what_is_above_it() {
    assert_eq!(from_f32(LARGEST), 0x7BFF);
    assert_eq!(from_f32(65519.996), 0x7BFF, "nearer to 65504 than to 65536");
    assert_eq!(from_f32(65520.0), 0x7C00, "halfway, and the even neighbour is 65536: infinity");
}

#[test]
fn the_smallest_number_and_what_is_below_it() {
    let step = 2.0_f32.powi(-24);
    assert_eq!([step, step * 0.5, (step * 0.5).next_up(), step * 1.5].map(from_f32), [1, 0, 1, 2]);
    assert_eq!([0.0, -0.0, f32::from_bits(1)].map(from_f32), [0, 0x8000, 0]);
}

quickcheck! {
    fn rounding_is_to_nearest_with_halves_to_even(bits: u32) -> bool {
        // Numbers from 2^-30 to 2^16.
        let value = f32::from_bits((97 + (bits >> 23) % 46) << 23 | bits & 0x7F_FFFF);
        let found = from_f32(value);
        let error = |bits: u16| if bits >= 0x7C00 { 65536.0 } else { by_definition(bits) } - f64::from(value);
        let (here, above, below) = (error(found), error(found + 1), error(found.saturating_sub(1)));
        let nearer = |other: f64| here.abs() < other.abs() || here.abs() == other.abs() && found.is_multiple_of(2);
        (found == 0x7C00 || nearer(above)) && (found == 0 || nearer(below))
    }
}
