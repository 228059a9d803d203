use glam::{DVec3, Vec3};

use super::{about, basis, cosine, disk, sin_cos_turn, sphere};
use crate::sampling::rng::{Purpose, Stream};

const SAMPLES: u64 = 200_000;

fn pairs() -> impl Iterator<Item = [f32; 2]> {
    (0..SAMPLES).map(|item| {
        let u = Stream::new(11, item).uniforms(0, Purpose::Gather);
        [u[0], u[1]]
    })
}

#[test]
fn sine_and_cosine_agree_with_libm() {
    for step in 0..10_000 {
        let turn = step as f32 / 10_000.0;
        let angle = f64::from(turn) * std::f64::consts::TAU;
        let (sin, cos) = sin_cos_turn(turn);
        // Angle error of at most one rounding (2^-24 turns·2π = 4e-7) plus the polynomials' 3e-8 and rounding.
        assert!((f64::from(sin) - libm::sin(angle)).abs() < 5e-7, "sine of {turn} turns");
        assert!((f64::from(cos) - libm::cos(angle)).abs() < 5e-7, "cosine of {turn} turns");
    }
}

#[test]
fn frames_are_orthonormal_and_right_handed() {
    for [a, b] in pairs().take(1000) {
        let n = sphere([a, b]);
        let (t, s) = basis(n);
        assert!((t.cross(s) - n).length() < 1e-5, "frame about {n}");
        assert!(t.dot(s).abs() < 1e-5 && (t.length() - 1.0).abs() < 1e-5);
    }
    let (t, s) = basis(Vec3::NEG_Z);
    assert!((t.cross(s) - Vec3::NEG_Z).length() < 1e-6);
}

/// Mean of the cosine is 2/3 with variance 1/18 and the tangential components have mean 0 and variance 1/4; five
/// standard errors.
#[test]
fn cosine_directions_have_the_moments_of_their_density() {
    let n = Vec3::new(0.48, -0.6, 0.64);
    let (t, _) = basis(n);
    let (mut along, mut across) = (0.0, 0.0);
    for u in pairs() {
        let w = cosine(n, u);
        assert!((w.length() - 1.0).abs() < 1e-5 && w.dot(n) >= -1e-6);
        along += f64::from(w.dot(n));
        across += f64::from(w.dot(t));
    }
    let samples = SAMPLES as f64;
    assert!((along / samples - 2.0 / 3.0).abs() < 5.0 * (1.0 / 18.0 / samples).sqrt());
    assert!((across / samples).abs() < 5.0 * (0.25 / samples).sqrt());
}

/// Components have mean 0 and mean square 1/3 (variance of the square 4/45); five standard errors.
#[test]
fn sphere_directions_are_even() {
    let (mut mean, mut square) = (DVec3::ZERO, DVec3::ZERO);
    for u in pairs() {
        let w = sphere(u).as_dvec3();
        mean += w;
        square += w * w;
    }
    let samples = SAMPLES as f64;
    assert!((mean / samples).abs().max_element() < 5.0 * (1.0 / 3.0 / samples).sqrt());
    assert!((square / samples - 1.0 / 3.0).abs().max_element() < 5.0 * (4.0 / 45.0 / samples).sqrt());
}

#[test]
fn disk_points_and_cones_keep_their_bounds() {
    for u in pairs().take(10_000) {
        let [x, y] = disk(u);
        assert!(x * x + y * y < 1.0 + 1e-6);
        let w = about(Vec3::Y, 0.25, u[1]);
        assert!((w.y - 0.25).abs() < 1e-6);
    }
}
