use super::*;

#[test]
fn glass_reflects_four_per_cent_head_on_and_everything_at_grazing_angles() {
    let (straight, behind) = interface(1.0, 1.0 / 1.5);
    assert!((straight - 0.04).abs() < 1e-6 && behind == Some(1.0), "{straight} {behind:?}");
    assert!(interface(1e-4, 1.0 / 1.5).0 > 0.999);
    // Nothing is reflected where nothing changes, to within a rounding of the cosine.
    let (none, same) = interface(0.3, 1.0);
    assert!(none < 1e-12 && (same.expect("goes on") - 0.3).abs() < 1e-6);
    // Two faces of 4 %: 0.08 / 1.04.
    assert!((pane(1.0, 1.5, true) - 0.076_923).abs() < 1e-5);
    assert!((pane(1.0, 1.5, false) - 0.04).abs() < 1e-6);
}

#[test]
fn both_ways_through_a_border_reflect_the_same_share() {
    for cos in [0.1f32, 0.4, 0.7, 0.99] {
        let (into, behind) = interface(cos, 1.0 / 1.5);
        let (out, before) = interface(behind.expect("no total reflection into glass"), 1.5);
        // Snell's law there and back, a few roundings.
        assert!((into - out).abs() < 1e-5 && (before.unwrap() - cos).abs() < 1e-5, "{cos}: {into} {out}");
    }
}

#[test]
fn beyond_the_critical_angle_all_is_reflected() {
    // sin = 1 / 1.5 is cos = 0.745.
    assert_eq!(interface(0.744, 1.5), (1.0, None));
    assert!(interface(0.747, 1.5).0 < 1.0);
}

/// Brewster's angle, tan = 1.5: light polarised in the plane is not reflected at all, half of the other is all there is.
#[test]
fn brewsters_angle_reflects_one_polarisation() {
    let cos = 1.0 / 1.5f32.hypot(1.0);
    let s = ((1.0 - 1.5f32 * 1.5) / (1.0 + 1.5 * 1.5)).powi(2);
    assert!((interface(cos, 1.0 / 1.5).0 - 0.5 * s).abs() < 1e-6);
}
