use super::*;
use alloc::vec::Vec;
use quickcheck::quickcheck;

#[track_caller]
fn check(colour: [f32; 3], code: u32, decoded: [f32; 3]) {
    assert_eq!(encode(colour), code, "{colour:?} became {:#010x}, expected {code:#010x}", encode(colour));
    assert_eq!(decode(code), decoded, "{code:#010x}");
}

const fn code(exponent: u32, r: u32, g: u32, b: u32) -> u32 {
    exponent << 27 | b << 18 | g << 9 | r
}

#[test]
fn simple_colours() {
    check([0.0; 3], 0, [0.0; 3]);
    check([1.0, 0.5, 0.25], code(16, 256, 128, 64), [1.0, 0.5, 0.25]);
    check([3.0, 0.0, 1.0], code(17, 384, 0, 128), [3.0, 0.0, 1.0]);
}

#[test]
fn rounding_to_512_steps_up_to_the_next_exponent() {
    // 511.5 lies halfway between 511 and 512 at the exponent whose step is 1: rounded up, it needs step 2.
    check([511.5, 0.0, 0.0], code(25, 256, 0, 0), [512.0, 0.0, 0.0]);
    check([511.499_97, 0.0, 0.0], code(24, 511, 0, 0), [511.0, 0.0, 0.0]);
    // The others are rounded with the new step: 3 halves of it are rounded up.
    check([511.5, 3.0, 2.999_999_8], code(25, 256, 2, 1), [512.0, 4.0, 2.0]);
}

#[test]
fn the_largest_number_and_what_is_above_it() {
    check([65408.0; 3], code(31, 511, 511, 511), [65408.0; 3]);
    check([f32::MAX, 65408.5, f32::INFINITY], code(31, 511, 511, 511), [65408.0; 3]);
    check([65344.0, 0.0, 0.0], code(31, 511, 0, 0), [65408.0, 0.0, 0.0]);
    check([65343.996, 0.0, 0.0], code(31, 510, 0, 0), [65280.0, 0.0, 0.0]);
}

#[test]
fn the_smallest_number_and_what_is_below_it() {
    let least = power_of_two(-24);
    check([least, 0.0, 0.0], code(0, 1, 0, 0), [least, 0.0, 0.0]);
    check([least / 2.0, 0.0, 0.0], code(0, 1, 0, 0), [least, 0.0, 0.0]);
    check([least * 0.499_999_97, f32::MIN_POSITIVE, f32::from_bits(1)], 0, [0.0; 3]);
    // 511 steps fit at exponent 0, 512 do not.
    check([least * 511.0, 0.0, 0.0], code(0, 511, 0, 0), [least * 511.0, 0.0, 0.0]);
    check([least * 511.5, 0.0, 0.0], code(1, 256, 0, 0), [least * 512.0, 0.0, 0.0]);
}

#[test]
fn what_is_no_colour_counts_as_zero() {
    check([f32::NAN, -1.0, -0.0], 0, [0.0; 3]);
    check([f32::NEG_INFINITY, f32::NAN, 1.0], code(16, 0, 0, 256), [0.0, 0.0, 1.0]);
    assert!(decode(encode([-0.0; 3])).iter().all(|c| c.is_sign_positive()));
}

#[test]
fn every_exponent_edge_decodes_to_itself() {
    for exponent in 0..32 {
        for mantissa in [0, 1, 255, 256, 511] {
            let colour = decode(code(exponent, mantissa, mantissa / 2, 0));
            assert_eq!(decode(encode(colour)), colour, "exponent {exponent}, mantissa {mantissa}");
        }
    }
}

#[test]
fn scaling_is_exact_over_the_whole_range_of_exponents() {
    for scale_exponent in -125..=112i16 {
        for (e, m) in [(0, 1), (0, 511), (15, 257), (31, 1), (31, 511)] {
            let exact = f64::from(m) * power_of_two_f64(e as i32 - 24 + i32::from(scale_exponent));
            let [decoded, ..] = decode_scaled(code(e, m, 0, 0), scale_exponent);
            assert_eq!(f64::from(decoded), exact, "E {e}, mantissa {m}, scale {scale_exponent}");
        }
    }
}

/// The textbook form of the extension: logarithms and divisions, no bit tricks.
fn naive(colour: [f32; 3]) -> [u32; 4] {
    extern crate std;
    let clamped = colour.map(|c| if c > 0.0 { f64::from(c.min(65408.0)) } else { 0.0 });
    let most = clamped.iter().fold(0.0f64, |a, &b| a.max(b));
    let preliminary = if most == 0.0 { -16 } else { (most.log2().floor() as i32).max(-16) } + 16;
    let step = |e: i32| (f64::from(e) - 24.0).exp2();
    let exponent =
        if (most / step(preliminary) + 0.5).floor() == 512.0 { preliminary + 1 } else { preliminary };
    let [r, g, b] = clamped.map(|c| (c / step(exponent) + 0.5).floor() as u32);
    [r, g, b, exponent as u32]
}

quickcheck! {
    fn agrees_with_the_textbook_form(bits: (u32, u32, u32)) -> bool {
        // Bit patterns, so that all magnitudes, NaN and infinities appear.
        let colour = [bits.0, bits.1, bits.2].map(f32::from_bits);
        let [r, g, b, e] = naive(colour);
        encode(colour) == code(e, r, g, b)
    }

    fn is_within_half_a_step(bits: (u32, u32, u32)) -> bool {
        // Positive numbers between 2^-32 and 2^15: exponents 95 to 141 of binary32.
        let colour = [bits.0, bits.1, bits.2]
            .map(|b| f32::from_bits((95 + (b >> 23) % 47) << 23 | (b & 0x7F_FFFF)));
        let most = colour.iter().fold(0.0f32, |a, &b| a.max(b));
        // The largest component is at least 255.5 steps, since 256 are where its rounding begins: half a step is at most
        // 1/511 of it; or 2^-25 at the lowest exponent.
        let bound = (most / 511.0).max(power_of_two(-25));
        colour.iter().zip(decode(encode(colour))).all(|(&a, b)| (a - b).abs() <= bound)
    }

    fn many_at_once_give_what_each_gives_alone(colours: Vec<(u32, u32, u32)>, scale_exponent: i16) -> bool {
        // Positive finite numbers of every size; sums of few digits, so that halves appear; and zeros.
        let positive = |bits: u32| match bits % 4 {
            0 => f64::from(bits >> 20) / 8.0,
            _ => f64::from(f32::from_bits((bits & 0x7FFF_FFFF).min(0x7F7F_FFFF))),
        };
        let colour = |n: usize| colours.get(n).map_or([0.0; 3], |&(r, g, b)| [r, g, b].map(positive));
        let columns: [[f64; 16]; 3] = core::array::from_fn(|k| core::array::from_fn(|n| colour(n)[k]));
        let codes = encode_all(&columns);
        let scale_exponent = scale_exponent.rem_euclid(238) - 125;
        let mut decoded = [[0.0; 16]; 3];
        decode_all(&codes, scale_exponent, &mut decoded);
        (0..16).all(|n| {
            codes[n] == encode_f64(colour(n)) && decoded.map(|c| c[n]) == decode_scaled(codes[n], scale_exponent)
        })
    }

    fn decoded_codes_are_stable(code: u32) -> bool {
        let colour = decode(code);
        decode(encode(colour)) == colour
    }
}

#[test]
fn a_colour_that_is_scaled_later_is_the_same() {
    let mut state = 7u64;
    let mut next = || {
        state = ivg_wire::splitmix64(state, 0);
        state
    };
    let mut not_kept = 0;
    for round in 0..100_000u32 {
        // Up to 2^-24 apart, some on or next to the middle of two mantissas; the largest from 2^-140 to 2^128.
        let size = power_of_two_f64((next() % 268) as i32 - 140);
        let colour = [0, 1, 2].map(|_| match round % 4 {
            0 => 0.0,
            1 => (next() % 1024) as f64 / 1024.0 * size,
            2 => ((next() % 1024) as f64 / 1024.0).next_down() * size,
            _ => (next() as u32 as f64) * power_of_two_f64(-32 - (next() % 24) as i32) * size,
        });
        let largest = colour[0].max(colour[1]).max(colour[2]);
        // Scales that leave the largest no more than the largest number, and from there down to where nothing is left.
        let lowest = (floor_log2(largest.max(1e-60)) - 14).max(-125);
        let scale_exponent = (lowest + (next() % 60) as i32).min(112);
        let scaled = colour.map(|c| c * power_of_two_f64(-scale_exponent));
        let found = Unscaled::new(colour).scaled(scale_exponent as i16);
        not_kept += u32::from(found.is_none());
        let [expected] = encode_all(&scaled.map(|c| [c]));
        assert_eq!(found.unwrap_or(expected), expected, "{colour:?} at {scale_exponent}");
    }
    assert!((10_000..80_000).contains(&not_kept), "{not_kept}");
}
