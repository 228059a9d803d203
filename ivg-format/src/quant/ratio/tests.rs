use super::*;

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
