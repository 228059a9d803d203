use super::*;

/// Error of the Fibonacci rule with 20,000 directions on the integrals below: the curve along which a hemisphere is
/// cut passes through the solid angles (6e-4 sr) of about 250 directions; each is off by at most half its solid
/// angle times |w·n|, which vanishes there for the axis component and is at most 1 for the tangential ones. The
/// signs alternate, so the sum stays near sqrt(250) × 3e-4 = 5e-3.
const TOLERANCE: f32 = 5e-3;

#[test]
fn uniform_light_gives_pi_along_each_axis() {
    let directions = fibonacci_sphere(20_000);
    let vectors = hemisphere_vectors(&directions, |_| DVec3::new(1.0, 0.5, 2.0));
    for hemisphere in 0..6 {
        for (channel, radiance) in [1.0, 0.5, 2.0].into_iter().enumerate() {
            let mut expected = [0.0; 3];
            let sign = if hemisphere % 2 == 0 { 1.0 } else { -1.0 };
            expected[hemisphere / 2] = sign * std::f32::consts::PI * radiance;
            for axis in 0..3 {
                let found = vectors[hemisphere][channel][axis];
                assert!(
                    (found - expected[axis]).abs() < TOLERANCE * radiance,
                    "{hemisphere} {channel} {axis}: {found}"
                );
            }
        }
    }
}

#[test]
fn a_bright_plane_below_gives_its_closed_form() {
    // An endless Lambertian plane below with radiance 1: E(n) = π (1 + cos t) / 2, t the angle between n and -z;
    // I_-z = -π z, I_+z = 0, I_±x = (±π/2, 0, -π/2).
    let directions = fibonacci_sphere(20_000);
    let plane = |w: DVec3| if w.z < 0.0 { DVec3::ONE } else { DVec3::ZERO };
    let vectors = hemisphere_vectors(&directions, plane);
    let pi = std::f32::consts::PI;
    let expected = [
        [pi / 2.0, 0.0, -pi / 2.0],
        [-pi / 2.0, 0.0, -pi / 2.0],
        [0.0, pi / 2.0, -pi / 2.0],
        [0.0, -pi / 2.0, -pi / 2.0],
        [0.0; 3],
        [0.0, 0.0, -pi],
    ];
    for (found, expected) in vectors.iter().zip(expected) {
        assert!((Vec3::from(found[0]) - Vec3::from(expected)).abs().max_element() < TOLERANCE, "{found:?}");
    }
    for n in [Vec3::NEG_Z, Vec3::X, Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.8, -0.6)] {
        let exact = f64::from(pi) * (1.0 - f64::from(n.z)) / 2.0;
        assert!((irradiance(&directions, plane, n).x - exact).abs() < f64::from(TOLERANCE), "{n}");
    }
}

#[test]
fn the_directions_are_unit_and_balanced() {
    let directions = fibonacci_sphere(999);
    assert!(directions.iter().all(|w| (w.length() - 1.0).abs() < 1e-12));
    // 999 unit vectors: a lopsided set would have a mean of the order of one.
    assert!((directions.iter().sum::<DVec3>() / 999.0).length() < 1e-3);
}
