use super::*;
use crate::quant::power_of_two;

#[test]
fn the_steps_are_the_numbers_nearest_to_the_bounds_over_127() {
    let bounds = [
        (1, 127, 3.0_f64.sqrt()),
        (4, 127, 15.0_f64.sqrt() / 2.0),
        (6, 127, 5.0_f64.sqrt()),
        (6, -127, -(5.0_f64.sqrt()) / 2.0),
    ];
    for (which, code, bound) in bounds {
        // The step is rounded once, the product once: 2^-24 of the value each.
        let error = (f64::from(decode(code, which)) - bound).abs();
        assert!(error <= 2.0_f64.powi(-23) * bound.abs(), "{which} {code}: {error}");
        let step = f64::from(step(which, code < 0));
        let nearest = (bound / f64::from(code)) as f32;
        assert_eq!(step, f64::from(nearest), "{which} {code}");
    }
}

#[test]
fn every_code_survives_and_ratios_between_go_to_the_nearer() {
    for which in 1..9 {
        for code in -127..=127i8 {
            let ratio = f64::from(decode(code, which));
            assert_eq!(encode(ratio, which), code, "coefficient {which}");
            let step = f64::from(step(which, code < 0));
            let inside = ratio + 0.49 * step * f64::from(code.signum());
            if code.abs() < 127 {
                assert_eq!(encode(inside, which), code);
            }
        }
        assert_eq!([encode(1e9, which), encode(-1e9, which), encode(f64::NAN, which)], [127, -127, 0]);
    }
}

/// The rule, with one division in binary64 of an exact product: correct up to that division.
fn by_the_rule(coefficient: f32, mean: f32, which: usize) -> i8 {
    if mean == 0.0 {
        return 0;
    }
    let unit = f64::from(mean) * f64::from(step(which, coefficient < 0.0));
    libm::round(f64::from(coefficient) / unit).clamp(-127.0, 127.0) as i8
}

#[test]
fn a_channel_at_once_gives_what_the_rule_gives() {
    let mut random = 1u64;
    let mut next = || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) as u32
    };
    for round in 0..200_000u32 {
        // Means as RGB9E5 gives them, scaled by anything, and 0.
        let exponent = next() % 220;
        let mean = f32::from_bits((20 + exponent) << 23) * (next() % 512) as f32;
        let coefficients: [f32; 8] = core::array::from_fn(|n| {
            let sign = if next() % 2 == 0 { 1.0 } else { -1.0 };
            let unit = f64::from(mean) * f64::from(step(n + 1, sign < 0.0));
            let steps = match round % 3 {
                // Anything up to the bounds and beyond; the middle between two codes, as nearly as binary32 can hold it.
                0 => f64::from(next()) / f64::from(1u32 << 31) * 150.0,
                1 => f64::from(next() % 128) + 0.5,
                _ => f64::from(next() % 256) / 2.0,
            };
            (unit * steps * sign) as f32
        });
        let codes = channel(&coefficients, mean);
        for (n, code) in codes.into_iter().enumerate() {
            let expected = by_the_rule(coefficients[n], mean, n + 1);
            assert_eq!(
                code.cast_signed(),
                expected,
                "{:e} of {mean:e}, coefficient {}",
                coefficients[n],
                n + 1
            );
        }
    }
}

/// The codes of one channel, whichever of the three it is; the others cannot be found without doubt.
fn channel(coefficients: &[f32; 8], mean: f32) -> [u8; 8] {
    let [first, others @ ..] = [0, 1, 2].map(|at| {
        let mut channels = [[1.0; 9]; 3];
        channels[at][1..].copy_from_slice(coefficients);
        let mut means = [0.0; 3];
        means[at] = mean;
        let codes = encode_all(&channels, means);
        let (codes, _) = codes.as_chunks::<8>();
        assert!(codes.iter().enumerate().all(|(n, codes)| n == at || *codes == [0; 8]));
        codes[at]
    });
    assert_eq!(others, [first; 2]);
    first
}

#[test]
fn halves_go_away_from_zero() {
    // K / 2 is exact, and so is the ratio to a mean of a power of two.
    for mean in [1.0, 0.25, 1e-30f32, 64.0] {
        let mean = power_of_two(mean.log2().floor() as i32);
        for which in 1..9 {
            for sign in [1.0, -1.0] {
                let half = mean * step(which, sign < 0.0) * 0.5 * sign;
                let mut coefficients = [0.0; 8];
                coefficients[which - 1] = half;
                assert_eq!(channel(&coefficients, mean)[which - 1].cast_signed(), sign as i8);
                assert_eq!(encode(f64::from(half) / f64::from(mean), which), sign as i8);
            }
        }
    }
}
