use std::f32::consts::PI;

use glam::DVec3;
use quickcheck::{Arbitrary, Gen, TestResult};

use super::*;
use crate::IrradianceError;
use crate::integrate::{fibonacci_sphere, hemisphere_vectors, irradiance};

/// Six vectors of light from a few directions: w and radiance times solid angle, so they are consistent.
#[derive(Clone, Debug)]
struct Light(Vec<(Vec3, Vec3)>);

impl Arbitrary for Light {
    fn arbitrary(g: &mut Gen) -> Self {
        let count = 1 + usize::arbitrary(g) % 6;
        Self((0..count).map(|_| (unit(g), Vec3::from_array([(); 3].map(|()| fraction(g).abs())))).collect())
    }
}

/// A unit vector anywhere on the sphere.
#[derive(Clone, Copy, Debug)]
struct Normal(Vec3);

impl Arbitrary for Normal {
    fn arbitrary(g: &mut Gen) -> Self {
        Self(unit(g))
    }
}

/// -1 to 1.
fn fraction(g: &mut Gen) -> f32 {
    f32::from(i16::arbitrary(g)) / 32_768.0
}

fn unit(g: &mut Gen) -> Vec3 {
    let v = Vec3::new(fraction(g), fraction(g), fraction(g));
    v.try_normalize().unwrap_or(Vec3::X)
}

impl Light {
    fn vectors(&self) -> HemisphereVectors {
        let mut vectors = [[[0.0; 3]; 3]; 6];
        for (hemisphere, channels) in vectors.iter_mut().enumerate() {
            for (w, colour) in &self.0 {
                let side = if hemisphere % 2 == 0 { w[hemisphere / 2] } else { -w[hemisphere / 2] };
                if side > 0.0 {
                    (0..3).for_each(|c| (0..3).for_each(|axis| channels[c][axis] += colour[c] * w[axis]));
                }
            }
        }
        vectors
    }

    fn irradiance(&self, n: Vec3) -> Vec3 {
        self.0.iter().map(|(w, colour)| *colour * w.dot(n).max(0.0)).sum()
    }
}

/// π along each axis: radiance 1 from everywhere.
fn uniform() -> HemisphereVectors {
    let mut vectors = [[[0.0; 3]; 3]; 6];
    for (hemisphere, channels) in vectors.iter_mut().enumerate() {
        let sign = if hemisphere % 2 == 0 { 1.0 } else { -1.0 };
        channels.iter_mut().for_each(|vector| vector[hemisphere / 2] = sign * PI);
    }
    vectors
}

#[test]
fn names_are_unique_and_read_back() {
    for method in Reconstruction::OF_VECTORS {
        assert_eq!(Reconstruction::from_name(method.name()), Some(method));
    }
    assert_eq!(Reconstruction::from_name("auto"), None);
    assert_eq!(Reconstruction::for_encoding(Encoding::VectorsF32), Reconstruction::SixVector);
    assert_eq!(Reconstruction::for_encoding(Encoding::PackedOct24), Reconstruction::ThreeVector);
}

#[test]
fn exact_on_the_axes() {
    fn law(light: Light) -> bool {
        let vectors = light.vectors();
        [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z].into_iter().all(|n| {
            let exact = light.irradiance(n);
            Reconstruction::OF_VECTORS.into_iter().all(|method| {
                // Six terms of at most 6 units each, summed twice in f32: 1e-5 is 14 roundings of the sum.
                (reconstruct(method, &vectors, n) - exact).abs().max_element() < 1e-5
            })
        })
    }
    quickcheck::quickcheck(law as fn(Light) -> bool);
}

#[test]
fn corrected_formulas_are_exact_in_uniform_light() {
    fn law(Normal(n): Normal) -> bool {
        [Reconstruction::ThreeVector, Reconstruction::SixVector].into_iter().all(|method| {
            // |n|² is off by up to 2e-7, and three products are summed: 2e-6 relative covers both.
            (reconstruct(method, &uniform(), n) / PI - Vec3::ONE).abs().max_element() < 2e-6
        })
    }
    quickcheck::quickcheck(law as fn(Normal) -> bool);
}

#[test]
fn the_printed_formula_loses_light_as_derived() {
    fn law(Normal(n): Normal) -> bool {
        let predicted = n.abs().powf(3.0).element_sum();
        (reconstruct(Reconstruction::NSquared, &uniform(), n) / PI - Vec3::splat(predicted))
            .abs()
            .max_element()
            < 2e-6
    }
    quickcheck::quickcheck(law as fn(Normal) -> bool);

    let diagonal = reconstruct(Reconstruction::NSquared, &uniform(), Vec3::splat(1.0 / 3.0_f32.sqrt()));
    // 1/√3 - 1 = -42.26 %.
    assert!((diagonal.x / PI - 1.0 / 3.0_f32.sqrt()).abs() < 1e-6, "{diagonal}");

    let normals: Vec<Vec3> = fibonacci_sphere(2_000).iter().map(|n| n.as_vec3()).collect();
    let mut error = IrradianceError::default();
    error.add_normals(Reconstruction::NSquared, &uniform(), &normals, |_| DVec3::splat(f64::from(PI)));
    // Mean of |n_x|³ + |n_y|³ + |n_z|³ over the sphere: 3/4. Its mean square: 3/7 + 6 × 0.024252 = 0.574084.
    assert!((error.relative_bias() + 0.25).abs() < 1e-4, "{}", error.relative_bias());
    assert!((error.relative_rmse() - 0.074_084_f64.sqrt()).abs() < 1e-4, "{}", error.relative_rmse());
}

#[test]
fn continuous_where_a_normal_component_changes_sign() {
    fn law(light: Light, Normal(n): Normal, axis: u8) -> TestResult {
        let axis = usize::from(axis % 3);
        let mut on_plane = n;
        on_plane[axis] = 0.0;
        let Some(on_plane) = on_plane.try_normalize() else { return TestResult::discard() };
        // The formulas change by at most their slope times the distance of the two normals: slope below
        // 4 × the sum of |I| (each squared or mixed term has slope 2 at most), |I| summed below 6 lights × 6.
        let step = 1e-5;
        let mut above = on_plane;
        above[axis] = step;
        let mut below = on_plane;
        below[axis] = -step;
        let vectors = light.vectors();
        TestResult::from_bool(Reconstruction::OF_VECTORS.into_iter().all(|method| {
            let jump = reconstruct(method, &vectors, above) - reconstruct(method, &vectors, below);
            jump.abs().max_element() < 2.0 * step * 4.0 * 36.0
        }))
    }
    quickcheck::quickcheck(law as fn(Light, Normal, u8) -> TestResult);
}

#[test]
fn never_negative_and_the_signed_value_only_differs_below_zero() {
    fn law(light: Light, Normal(n): Normal) -> bool {
        let vectors = light.vectors();
        Reconstruction::OF_VECTORS.into_iter().all(|method| {
            let signed = reconstruct_signed(method, &vectors, n);
            let cut = reconstruct(method, &vectors, n);
            cut.cmpge(Vec3::ZERO).all() && (cut.cmpeq(signed) | signed.cmplt(Vec3::ZERO)).all()
        })
    }
    quickcheck::quickcheck(law as fn(Light, Normal) -> bool);
    // The cut is needed: one lamp at (1, 1, 0)/√2 seen by a surface that faces away from it.
    let lamp = Light(vec![(Vec3::new(1.0, 1.0, 0.0).normalize(), Vec3::ONE)]);
    let n = Vec3::new(0.1, -0.9, 0.3).normalize();
    assert!(reconstruct_signed(Reconstruction::SixVector, &lamp.vectors(), n).x < 0.0);
}

#[test]
fn six_vectors_are_exact_for_light_of_degree_two() {
    // Positive radiance made of all nine spherical harmonics up to degree 2, and its irradiance by integration.
    let radiance = |w: DVec3| {
        let grey = 2.0 + 0.5 * w.x - 0.3 * w.y + 0.2 * w.z;
        let quadratic =
            0.3 * w.x * w.y - 0.2 * w.y * w.z + 0.25 * w.x * w.z + 0.2 * w.x * w.x - 0.3 * w.z * w.z;
        DVec3::new(grey + quadratic, grey, 2.0 + quadratic)
    };
    let directions = fibonacci_sphere(20_000);
    let vectors = hemisphere_vectors(&directions, radiance);
    let normals: Vec<Vec3> = fibonacci_sphere(60).iter().map(|n| n.as_vec3()).collect();
    let error = |method| {
        let mut error = IrradianceError::default();
        error.add_normals(method, &vectors, &normals, |n| irradiance(&directions, radiance, n));
        error.relative_rmse()
    };
    // The integration rule is good to 5e-3 / π (integrate/tests.rs); in the mean over normals it is better.
    assert!(error(Reconstruction::SixVector) < 1.6e-3, "{}", error(Reconstruction::SixVector));
    // The law is about this formula only: the others must not meet it.
    assert!(error(Reconstruction::ThreeVector) > 3e-3, "{}", error(Reconstruction::ThreeVector));
    assert!(error(Reconstruction::NSquared) > 0.2, "{}", error(Reconstruction::NSquared));
}

#[test]
fn hemispheres_that_a_formula_does_not_read_do_not_matter() {
    fn law(light: Light, Normal(n): Normal) -> bool {
        let vectors = light.vectors();
        Reconstruction::OF_VECTORS.into_iter().all(|method| {
            let mut poisoned = vectors;
            for (hemisphere, channels) in poisoned.iter_mut().enumerate() {
                if !method.reads(hemisphere, n) {
                    *channels = [[f32::NAN; 3]; 3];
                }
            }
            reconstruct(method, &poisoned, n) == reconstruct(method, &vectors, n)
        })
    }
    quickcheck::quickcheck(law as fn(Light, Normal) -> bool);
}

#[test]
fn every_component_counts_as_the_formulas_say() {
    // Vectors without any symmetry, no two components alike; the sums are written out for n = (-2, 3, 6) / 7.
    let mut vectors = [[[0.0; 3]; 3]; 6];
    for (index, component) in vectors.as_flattened_mut().as_flattened_mut().iter_mut().enumerate() {
        *component = ((index * index) % 59) as f32 / 16.0;
    }
    let n = Vec3::new(-2.0, 3.0, 6.0) / 7.0;
    for channel in 0..3 {
        let v = |hemisphere: usize| vectors[hemisphere][channel];
        let (x, y, z) = (v(1), v(2), v(4));
        let squared = (4.0 * (-2.0 * x[0] + 3.0 * x[1] + 6.0 * x[2])
            + 9.0 * (-2.0 * y[0] + 3.0 * y[1] + 6.0 * y[2])
            + 36.0 * (-2.0 * z[0] + 3.0 * z[1] + 6.0 * z[2]))
            / 343.0;
        // n_j (1 − |n_j| / 2) for the three axes: −2/7 · 6/7, 3/7 · 5.5/7, 6/7 · 4/7.
        let [a, b, c] = [-12.0 / 49.0, 16.5 / 49.0, 24.0 / 49.0];
        let three = (4.0 * (-x[0] + b * x[1] + c * x[2])
            + 9.0 * (y[1] + a * y[0] + c * y[2])
            + 36.0 * (z[2] + a * z[0] + b * z[1]))
            / 49.0;
        let sum = |axis: usize| v(2 * axis)[axis] + v(2 * axis + 1)[axis];
        let difference = |axis: usize, component: usize| v(2 * axis)[component] - v(2 * axis + 1)[component];
        let mixed = -6.0 * (difference(0, 1) + difference(1, 0))
            - 12.0 * (difference(0, 2) + difference(2, 0))
            + 18.0 * (difference(1, 2) + difference(2, 1));
        let squares = 4.0 * difference(0, 0) + 9.0 * difference(1, 1) + 36.0 * difference(2, 2);
        let six =
            0.5 * ((-2.0 * sum(0) + 3.0 * sum(1) + 6.0 * sum(2)) / 7.0 + (squares + 0.5 * mixed) / 49.0);
        for (method, expected) in Reconstruction::OF_VECTORS.into_iter().zip([squared, three, six]) {
            let found = reconstruct_signed(method, &vectors, n)[channel];
            // Some 20 roundings of sums below 8.
            assert!(
                (found - expected).abs() < 20.0 * 8.0 * 6e-8,
                "{}: {found}, not {expected}",
                method.name()
            );
        }
    }
}
