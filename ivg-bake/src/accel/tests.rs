use std::collections::HashMap;

use glam::Vec3;

use super::{Hit, TraceScene};
use crate::intersect::{ShearedRay, corners};
use crate::sampling::hemisphere::sphere;
use crate::sampling::rng::{Purpose, Stream};

/// A closed sphere of 20 · 4^`levels` triangles with radius `radius` about `centre`.
fn icosphere(levels: u32, centre: Vec3, radius: f32) -> Vec<[Vec3; 3]> {
    let g = 0.5 * (1.0 + 5f32.sqrt());
    let mut points: Vec<Vec3> = [(0, 1), (1, 2), (2, 0)]
        .into_iter()
        .flat_map(|(a, b)| {
            [(1.0, g), (1.0, -g), (-1.0, g), (-1.0, -g)].map(|(x, y)| {
                let mut p = Vec3::ZERO;
                p[a] = x;
                p[b] = y;
                p
            })
        })
        .map(Vec3::normalize)
        .collect();
    let mut triangles: Vec<[usize; 3]> = Vec::new();
    let near = |a: Vec3, b: Vec3| a.distance(b) < 1.1;
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let [p, q, r] = [points[a], points[b], points[c]];
                if near(p, q) && near(q, r) && near(r, p) {
                    let outwards = (q - p).cross(r - p).dot(p) > 0.0;
                    triangles.push(if outwards { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    assert_eq!(triangles.len(), 20);
    for _ in 0..levels {
        let mut middles: HashMap<(usize, usize), usize> = HashMap::new();
        let mut split = Vec::new();
        for [a, b, c] in triangles {
            let mut middle = |i: usize, j: usize| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    points.push((points[i] + points[j]).normalize());
                    points.len() - 1
                })
            };
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            split.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        triangles = split;
    }
    triangles.into_iter().map(|t| t.map(|i| centre + points[i] * radius)).collect()
}

fn brute_force(triangles: &[[Vec3; 3]], origin: Vec3, direction: Vec3, limit: f32) -> Option<Hit> {
    let ray = ShearedRay::new(origin, direction);
    let mut best: Option<Hit> = None;
    for (index, triangle) in (0u32..).zip(triangles) {
        if let Some(c) = ray.intersect(&corners(*triangle), limit)
            && best.is_none_or(|b| c.distance < b.distance)
        {
            best = Some(Hit { distance: c.distance, triangle: index, weights: c.weights });
        }
    }
    best
}

fn random_point(item: u64, step: u32, size: f32) -> Vec3 {
    let u = Stream::new(4, item).uniforms(step, Purpose::Gather);
    (Vec3::new(u[0], u[1], u[2]) - 0.5) * size
}

fn random_direction(item: u64, step: u32) -> Vec3 {
    let u = Stream::new(4, item).uniforms(step, Purpose::Light);
    sphere([u[0], u[1]])
}

#[test]
fn rays_at_vertices_and_edges_of_a_closed_sphere_never_leak() {
    let triangles = icosphere(4, Vec3::new(40.0, -90.0, 13.0), 1500.0);
    let scene = TraceScene::new(&triangles).unwrap();
    let eyes: Vec<Vec3> =
        (0..6).map(|item| Vec3::new(40.0, -90.0, 13.0) + random_point(item, 0, 900.0)).collect();
    let mut leaks = 0;
    for eye in &eyes {
        for [a, b, c] in &triangles {
            for target in [*a, *b, *c, (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5] {
                let direction = (target - eye).normalize();
                leaks += u32::from(scene.closest_hit(*eye, direction, f32::MAX).is_none());
                leaks += u32::from(!scene.occluded(*eye, direction, f32::MAX));
            }
        }
    }
    assert_eq!(leaks, 0, "of {} rays", eyes.len() * triangles.len() * 12);
}

#[test]
fn hits_agree_with_trying_every_triangle() {
    // Triangles of very different size, some of them in the same plane.
    let mut triangles: Vec<[Vec3; 3]> = (0..400)
        .map(|item| {
            let size = [4.0, 60.0, 900.0][item as usize % 3];
            let middle = random_point(item, 0, 3000.0);
            [1, 2, 3].map(|corner| middle + random_point(item, corner, size))
        })
        .collect();
    triangles.extend(triangles.clone().iter().step_by(7));
    let scene = TraceScene::new(&triangles).unwrap();
    let (mut hits, mut shadows) = (0, 0);
    for item in 0..20_000 {
        let origin = random_point(item, 9, 3500.0);
        let direction = random_direction(item, 8);
        let limit = if item % 2 == 0 { f32::MAX } else { 300.0 };
        let expected = brute_force(&triangles, origin, direction, limit);
        assert_eq!(scene.closest_hit(origin, direction, limit), expected, "ray {item}");
        assert_eq!(scene.occluded(origin, direction, limit), expected.is_some(), "ray {item}");
        hits += u32::from(expected.is_some());
        shadows += u32::from(limit < f32::MAX && expected.is_some());
    }
    assert!(hits > 1000 && shadows > 50, "{hits} hits, {shadows} with a limit");
}

#[test]
fn rays_along_axes_and_in_the_plane_of_walls_agree_with_trying_every_triangle() {
    let mut triangles = Vec::new();
    // A room of axis-aligned walls, as flat boxes as there are.
    for axis in 0..3 {
        for side in [-1000.0, 0.0, 1000.0] {
            let corner = |u: f32, v: f32| {
                let mut p = Vec3::ZERO;
                p[axis] = side;
                p[(axis + 1) % 3] = u;
                p[(axis + 2) % 3] = v;
                p
            };
            let [a, b, c, d] = [
                corner(-1000.0, -1000.0),
                corner(1000.0, -1000.0),
                corner(1000.0, 1000.0),
                corner(-1000.0, 1000.0),
            ];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let scene = TraceScene::new(&triangles).unwrap();
    for item in 0..3000 {
        let mut origin = random_point(item, 0, 1990.0);
        if item % 3 == 0 {
            origin[item as usize % 2] = 1000.0 - 1e-3 * (item % 7) as f32;
        }
        let mut direction = match item % 4 {
            0 => random_direction(item, 1),
            1 => Vec3::AXES[item as usize / 4 % 3],
            2 => -Vec3::AXES[item as usize / 4 % 3],
            _ => random_direction(item, 1).with_x(0.0).normalize(),
        };
        if item % 5 == 0 && direction.y == 0.0 {
            direction.y = 1e-9;
        }
        let expected = brute_force(&triangles, origin, direction, f32::MAX);
        assert_eq!(scene.closest_hit(origin, direction, f32::MAX), expected, "{origin} {direction}");
    }
}

/// Boxes left within 1e-4 units are culled by obvhs; in bake space coordinates are thousands of units, and two surfaces
/// may be a step of f32 apart.
#[test]
fn hits_close_to_the_origin_are_found() {
    let mut triangles = icosphere(3, Vec3::ZERO, 1500.0);
    let small = icosphere(1, Vec3::new(700.0, 300.0, -900.0), 0.05);
    triangles.extend(&small);
    let scene = TraceScene::new(&triangles).unwrap();
    for item in 0..2000 {
        let target = small[item as usize % small.len()];
        let middle = (target[0] + target[1] + target[2]) / 3.0;
        let origin = middle + random_direction(item, 0) * 2e-4;
        let direction = random_direction(item, 1);
        let expected = brute_force(&triangles, origin, direction, f32::MAX);
        assert_eq!(scene.closest_hit(origin, direction, f32::MAX), expected, "ray {item}");
    }
}

#[test]
fn of_equal_hits_the_lowest_index_counts() {
    let triangle =
        [Vec3::new(-500.0, -500.0, 9.0), Vec3::new(500.0, -500.0, 9.0), Vec3::new(0.0, 700.0, 9.0)];
    let mut triangles = icosphere(2, Vec3::ZERO, 1000.0);
    let first = triangles.len() as u32;
    triangles.extend([triangle; 40]);
    let scene = TraceScene::new(&triangles).unwrap();
    for item in 0..500 {
        let target = (random_point(item, 0, 200.0)).with_z(9.0);
        let origin = Vec3::new(3.0, -2.0, 400.0);
        let hit = scene.closest_hit(origin, (target - origin).normalize(), f32::MAX).unwrap();
        assert_eq!(hit.triangle, first);
    }
}

#[test]
fn nothing_is_hit_without_triangles_or_area() {
    let empty = TraceScene::new(&[]).unwrap();
    assert_eq!(empty.closest_hit(Vec3::ZERO, Vec3::X, f32::MAX), None);
    assert!(!empty.occluded(Vec3::ZERO, Vec3::X, f32::MAX));
    let flat = [[Vec3::X; 3], [Vec3::X, Vec3::X * 2.0, Vec3::X * 3.0]];
    let flat = TraceScene::new(&flat).unwrap();
    assert_eq!(flat.closest_hit(Vec3::ZERO, Vec3::X, f32::MAX), None);
}

#[test]
fn boxes_on_a_floor_stay_closed() {
    let mut triangles: Vec<[Vec3; 3]> = Vec::new();
    for (low, high) in [
        (Vec3::splat(-1500.0), Vec3::splat(1500.0)),
        (Vec3::new(-1000.0, -1500.0, -900.0), Vec3::new(-150.0, 300.0, 77.7)),
        (Vec3::new(150.3, -1500.0, -100.1), Vec3::new(1051.0, -600.0, 800.0)),
    ] {
        for axis in 0..3 {
            for side in [low, high] {
                let (mut u, mut v) = (Vec3::ZERO, Vec3::ZERO);
                u[(axis + 1) % 3] = (high - low)[(axis + 1) % 3];
                v[(axis + 2) % 3] = (high - low)[(axis + 2) % 3];
                let mut corner = low;
                corner[axis] = side[axis];
                triangles
                    .extend([[corner, corner + u, corner + u + v], [corner, corner + u + v, corner + v]]);
            }
        }
    }
    let scene = TraceScene::new(&triangles).unwrap();
    for item in 0..100_000 {
        let origin = Vec3::new(-600.0, -900.0, -400.0) + random_point(item, 0, 600.0);
        let direction = random_direction(item, 1);
        let expected = brute_force(&triangles, origin, direction, f32::MAX);
        assert_eq!(
            scene.closest_hit(origin, direction, f32::MAX),
            expected,
            "ray {item} {origin} {direction}"
        );
    }
}

/// A groove in a kitchen: its side is long, thin and seen nearly from its edge, and an edge function's rounding moves the hit by
/// more than its distance. In exact arithmetic the side is hit at 0.003 392 786 3, its bottom behind it at 0.094 155.
#[test]
fn near_hits_on_long_thin_triangles_are_not_lost() {
    let (x, front, back) = (210.585_85, -241.354_61, -241.287_3);
    let (low, high) = (-30.388_73, 152.821_76);
    let side = [Vec3::new(x, low, back), Vec3::new(x, high, front), Vec3::new(x, low, front)];
    let bottom = [Vec3::new(x, low, back), Vec3::new(213.150_33, high, back), Vec3::new(x, high, back)];
    let scene = TraceScene::new(&[bottom, side]).unwrap();
    let origin = Vec3::new(210.585_65, 65.126_625, -241.353_44);
    let direction = Vec3::new(0.058_466_475, 0.709_248_07, 0.702_530_3);
    let hit = scene.closest_hit(origin, direction, f32::MAX).unwrap();
    assert_eq!(hit.triangle, 1);
    assert!((hit.distance - 0.003_392_786_3).abs() < 1e-9, "{}", hit.distance);
    assert!(scene.occluded(origin, direction, 0.0034) && !scene.occluded(origin, direction, 0.0033));
}
