use glam::Vec3;

use super::{closest_point, triangle_meets_box};
use crate::sampling::rng::{Purpose, Stream};

fn random_triangle(item: u64, size: f32) -> [Vec3; 3] {
    core::array::from_fn(|corner| {
        let u = Stream::new(2, item).uniforms(corner as u32, Purpose::Gather);
        (Vec3::new(u[0], u[1], u[2]) - 0.5) * size
    })
}

/// Closest of a fine grid of points of the triangle.
fn closest_by_search(triangle: &[Vec3; 3], p: Vec3) -> f32 {
    const STEPS: u32 = 60;
    let mut best = f32::INFINITY;
    for i in 0..=STEPS {
        for j in 0..=STEPS - i {
            let (v, w) = (i as f32 / STEPS as f32, j as f32 / STEPS as f32);
            let q = triangle[0] * (1.0 - v - w) + triangle[1] * v + triangle[2] * w;
            best = best.min(q.distance(p));
        }
    }
    best
}

#[test]
fn closest_points_are_no_farther_than_a_search_finds() {
    for item in 0..300 {
        let triangle = random_triangle(item, 2.0);
        let u = Stream::new(9, item).uniforms(0, Purpose::Gather);
        let p = (Vec3::new(u[0], u[1], u[2]) - 0.5) * 4.0;
        let distance = closest_point(&triangle, p).distance(p);
        let searched = closest_by_search(&triangle, p);
        // The grid of the search is spaced by at most the longest edge (3.5) / 60.
        assert!(distance <= searched + 1e-5 && distance > searched - 0.06, "{item}: {distance} {searched}");
    }
}

#[test]
fn boxes_meet_triangles_that_have_a_point_inside() {
    let half = Vec3::new(0.3, 0.2, 0.25);
    let (mut met, mut missed) = (0, 0);
    for item in 0..2000 {
        let triangle = random_triangle(item, 3.0);
        let middle = Vec3::new(0.1, -0.2, 0.0);
        let mut inside = false;
        for i in 0..=40u32 {
            for j in 0..=40 - i {
                let (v, w) = (i as f32 / 40.0, j as f32 / 40.0);
                let q = triangle[0] * (1.0 - v - w) + triangle[1] * v + triangle[2] * w;
                inside |= (q - middle).abs().cmple(half).all();
            }
        }
        let meets = triangle_meets_box(&triangle, middle, half);
        assert!(meets || !inside, "triangle {item} has a point in the box");
        // The box grown by the spacing of the search (5.2/40) must contain one of its points if the test says so.
        if meets && !inside {
            let near = (0..=40u32).any(|i| {
                (0..=40 - i).any(|j| {
                    let (v, w) = (i as f32 / 40.0, j as f32 / 40.0);
                    let q = triangle[0] * (1.0 - v - w) + triangle[1] * v + triangle[2] * w;
                    (q - middle).abs().cmple(half + 0.13).all()
                })
            });
            assert!(near, "triangle {item} is far from the box");
        }
        met += u32::from(meets);
        missed += u32::from(!meets);
    }
    assert!(met > 100 && missed > 100);
}

#[test]
fn degenerate_triangles_are_points_and_segments() {
    let point = [Vec3::ONE; 3];
    assert_eq!(closest_point(&point, Vec3::ZERO), Vec3::ONE);
    let segment = [Vec3::ZERO, Vec3::X * 2.0, Vec3::X];
    let closest = closest_point(&segment, Vec3::new(0.5, 1.0, 0.0));
    assert!((closest - Vec3::X * 0.5).length() < 1e-6, "{closest}");
}
