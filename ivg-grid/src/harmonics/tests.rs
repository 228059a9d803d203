use quickcheck::{Arbitrary, Gen};

use super::*;
use crate::integrate::{fibonacci_sphere, hemisphere_vectors as integrated_vectors, radiance_harmonics};

/// Light from a few directions: w and radiance times solid angle.
#[derive(Clone, Debug)]
struct Light(Vec<(DVec3, f64)>);

impl Arbitrary for Light {
    fn arbitrary(g: &mut Gen) -> Self {
        let number = |g: &mut Gen| f64::from(i16::arbitrary(g)) / 32_768.0;
        let count = 1 + usize::arbitrary(g) % 5;
        let lamps = (0..count).map(|_| {
            let w = DVec3::new(number(g), number(g), number(g)).try_normalize().unwrap_or(DVec3::X);
            (w, number(g).abs() + 1e-3)
        });
        Self(lamps.collect())
    }
}

impl Light {
    fn harmonics(&self) -> [f64; COEFFICIENTS] {
        let mut sums = [0.0; COEFFICIENTS];
        for (w, light) in &self.0 {
            sums.iter_mut().zip(basis(*w)).for_each(|(sum, y)| *sum += light * y);
        }
        sums
    }
}

/// Positive radiance made of all nine functions.
fn smooth(w: DVec3) -> DVec3 {
    let grey = 2.0 + 0.5 * w.x - 0.3 * w.y + 0.2 * w.z;
    let quadratic = 0.3 * w.x * w.y - 0.2 * w.y * w.z + 0.25 * w.x * w.z + 0.2 * w.x * w.x - 0.3 * w.z * w.z;
    DVec3::new(grey + quadratic, grey, 2.0 + quadratic)
}

/// The integration rule of 20,000 directions; smooth integrands have an error far below 1e-4.
fn sphere() -> Vec<DVec3> {
    fibonacci_sphere(20_000)
}

#[test]
fn the_basis_is_orthonormal_and_in_the_stated_order() {
    let directions = sphere();
    let solid_angle = 4.0 * PI / directions.len() as f64;
    for a in 0..COEFFICIENTS {
        for b in 0..COEFFICIENTS {
            let sum: f64 = directions.iter().map(|&w| basis(w)[a] * basis(w)[b]).sum();
            let expected = if a == b { 1.0 } else { 0.0 };
            assert!((sum * solid_angle - expected).abs() < 1e-4, "{a} {b}: {}", sum * solid_angle);
        }
    }
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(basis);
    assert!(x[3] > 0.48 && y[1] > 0.48 && z[2] > 0.48, "degree 1: y, z, x");
    assert!(z[6] > 0.63 && x[8] > 0.54 && y[8] < -0.54);
    let mixed = |w: DVec3| basis(w.normalize());
    assert!(mixed(DVec3::new(1.0, 1.0, 0.0))[4] > 0.54);
    assert!(mixed(DVec3::new(0.0, 1.0, 1.0))[5] > 0.54);
    assert!(mixed(DVec3::new(1.0, 0.0, 1.0))[7] > 0.54);
}

#[test]
fn no_function_exceeds_the_largest_value() {
    let largest = sphere().iter().flat_map(|&w| basis(w)).fold(0.0, |a: f64, y| a.max(y.abs()));
    assert!(largest <= LARGEST_BASIS_VALUE, "{largest}");
    assert!((basis(DVec3::Z)[6] - LARGEST_BASIS_VALUE).abs() < 1e-15);
}

#[test]
fn a_furnace_has_one_coefficient_and_the_same_irradiance_all_around() {
    let radiance = radiance_harmonics(&sphere(), |_| DVec3::new(1.0, 2.0, 0.0));
    for (channel, light) in radiance.iter().zip([1.0_f64, 2.0, 0.0]) {
        assert!((f64::from(channel[0]) - light * 2.0 * PI.sqrt()).abs() < 1e-5);
        assert!(channel[1..].iter().all(|c| c.abs() < 1e-4), "{channel:?}");
    }
    let even = [[2.0 * (PI as f32).sqrt(), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]; 3];
    for n in fibonacci_sphere(50) {
        let off = (irradiance(&even, n.as_vec3()) - Vec3::splat(PI as f32)).abs().max_element();
        assert!(off < 1e-6, "{off}");
    }
}

#[test]
fn irradiance_of_light_of_degree_two_is_exact() {
    let directions = sphere();
    let radiance = radiance_harmonics(&directions, smooth);
    for n in fibonacci_sphere(60) {
        let n = n.as_vec3();
        let expected = crate::integrate::irradiance(&directions, smooth, n).as_vec3();
        // The integral over the hemisphere of n is good to 5e-3 / π of radiance 2 (integrate/tests.rs).
        let off = (irradiance(&radiance, n) - expected).abs().max_element();
        assert!(off < 2.0 * 5e-3 / PI as f32 * 3.0, "{n}: {off}");
    }
}

#[test]
fn vectors_of_light_of_degree_two_are_exact() {
    let directions = sphere();
    let found = hemisphere_vectors(&radiance_harmonics(&directions, smooth));
    let expected = integrated_vectors(&directions, smooth);
    for (found, expected) in
        found.as_flattened().as_flattened().iter().zip(expected.as_flattened().as_flattened())
    {
        assert!((found - expected).abs() < 0.01, "{found} {expected}");
    }
}

#[test]
fn vectors_of_each_function_are_exact() {
    // One function at a time, about twice as strong as the constant one: signs and factors cannot make up for each other.
    let directions = sphere();
    for n in 0..COEFFICIENTS {
        let mut radiance = RadianceHarmonics::default();
        radiance[1][n] = 1.0;
        let found = hemisphere_vectors(&radiance);
        let expected = integrated_vectors(&directions, |w| DVec3::new(0.0, basis(w)[n], 0.0));
        for hemisphere in 0..6 {
            assert_eq!(found[hemisphere][0], [0.0; 3]);
            for k in 0..3 {
                let (found, expected) = (found[hemisphere][1][k], expected[hemisphere][1][k]);
                assert!((found - expected).abs() < 5e-3, "{n} {hemisphere} {k}: {found} {expected}");
            }
        }
    }
}

/// The map to vectors keeps irradiance on the axes: E(± e_a) is the component along the axis.
#[test]
fn vectors_and_harmonics_agree_on_the_axes() {
    fn law(light: Light) -> bool {
        let radiance = [light.harmonics().map(|c| c as f32); 3];
        let vectors = hemisphere_vectors(&radiance);
        (0..6).all(|h| {
            let sign = if h % 2 == 0 { 1.0 } else { -1.0 };
            let expected = irradiance_signed(&radiance, Vec3::AXES[h / 2] * sign).x;
            (vectors[h][0][h / 2] * sign - expected).abs() < 1e-5 * radiance[0][0]
        })
    }
    quickcheck::quickcheck(law as fn(Light) -> bool);
}

#[test]
fn ratios_of_light_stay_within_their_bounds() {
    fn law(light: Light) -> bool {
        let c = light.harmonics();
        (1..COEFFICIENTS).all(|n| {
            let (low, high) = ratio_bounds(n);
            (low - 1e-12..=high + 1e-12).contains(&(c[n] / c[0]))
        })
    }
    quickcheck::quickcheck(law as fn(Light) -> bool);
}

#[test]
fn the_bounds_of_ratios_are_reached() {
    for n in 1..COEFFICIENTS {
        let ratios = || fibonacci_sphere(40_000).into_iter().map(move |w| basis(w)[n] / basis(w)[0]);
        let (low, high) = ratio_bounds(n);
        let (least, most) = (ratios().fold(0.0, f64::min), ratios().fold(0.0, f64::max));
        // 40,000 directions lie within 0.02 of any: the functions are flat where they are largest.
        assert!((least - low).abs() < 2e-3 && (most - high).abs() < 2e-3, "{n}: {least} {most}");
    }
}

#[test]
fn irradiance_is_linear_before_the_cut_and_never_negative_after() {
    // A lamp at +z: behind the surface the truncated series swings below zero.
    let lamp = [basis(DVec3::Z).map(|y| y as f32); 3];
    let normals: Vec<Vec3> = fibonacci_sphere(500).iter().map(|n| n.as_vec3()).collect();
    let lowest = normals.iter().map(|&n| irradiance_signed(&lamp, n).x).fold(0.0, f32::min);
    // (1/4 + cos/2 + 5/16 (3 cos² − 1)/2) is lowest at cos = −8/15: 0.25 − 0.15625 − 0.1333 = −0.0396.
    assert!((lowest + 0.0396).abs() < 1e-3, "{lowest}");
    assert!(normals.iter().all(|&n| irradiance(&lamp, n).min_element() >= 0.0));
    let twice = lamp.map(|channel| channel.map(|c| 2.0 * c));
    for &n in &normals {
        assert_eq!(irradiance_signed(&twice, n), 2.0 * irradiance_signed(&lamp, n));
    }
}
