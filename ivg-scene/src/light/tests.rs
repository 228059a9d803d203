use super::*;

fn spot(inner: f32, outer: f32) -> Light {
    Light {
        name: "spot".into(),
        kind: LightKind::Spot {
            position: DVec3::ZERO,
            direction: Vec3::NEG_Y,
            intensity: Vec3::new(3.0, 1.0, 0.0),
            inner_angle: inner,
            outer_angle: outer,
        },
    }
}

#[test]
fn power_of_a_spot_is_the_integral_of_its_intensity() {
    for (inner, outer) in [(0.0, 0.5), (0.3, 0.9), (0.0, std::f32::consts::FRAC_PI_2), (1.0, 1.2)] {
        // Midpoint rule over the cosine; a squared ramp with a kink errs by less than steps^-2 of the range.
        let steps = 100_000;
        let sum: f64 = (0..steps)
            .map(|i| f64::from(spot_factor(((f64::from(i) + 0.5) / f64::from(steps)) as f32, inner, outer)))
            .sum();
        let expected = 2.0 * PI * 3.0 * sum / f64::from(steps);
        let power = spot(inner, outer).power().map(|p| p.x).unwrap_or_default();
        // f32 cosines in the summand: 1e-7 relative each, against a cone that may take 1 - cos 0.5 = 0.12 of the range.
        assert!((power - expected).abs() < 1e-4 * expected, "{inner} {outer}: {power} instead of {expected}");
    }
}

#[test]
fn a_spot_is_full_inside_dark_outside_and_never_leaves_zero_to_one() {
    assert_eq!(spot_factor(1.0, 0.2, 0.6), 1.0);
    assert_eq!(spot_factor(0.7f32.cos(), 0.2, 0.6), 0.0);
    assert_eq!(spot_factor(-1.0, 0.2, 0.6), 0.0);
    let middle = 0.5 * (0.2f32.cos() + 0.6f32.cos());
    assert!((spot_factor(middle, 0.2, 0.6) - 0.25).abs() < 1e-6);
}

#[test]
fn a_point_radiates_over_the_whole_sphere() {
    let kind = LightKind::Point { position: DVec3::ZERO, intensity: Vec3::ONE };
    assert_eq!(Light { name: String::new(), kind }.power(), Some(DVec3::splat(4.0 * PI)));
}
