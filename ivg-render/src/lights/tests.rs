use glam::Affine3A;
use ivg_scene::Camera;

use super::*;
use crate::cpu::light_irradiance;
use crate::{RenderMesh, RenderScene};

const RADIANCE: Vec3 = Vec3::new(10.0, 5.0, 2.0);

/// Emissive polygons (fans of triangles), each with its radiance, above a black floor.
fn geometry(polygons: &[(Vec<Vec3>, Vec3)], two_sided: bool) -> (Geometry, Vec<Material>) {
    let fan = |positions: Vec<Vec3>, material: u32| {
        let triangles: Vec<[u32; 3]> = (1..positions.len() as u32 - 1).map(|i| [0, i, i + 1]).collect();
        RenderMesh {
            triangle_materials: vec![material; triangles.len()],
            positions,
            triangles,
            transform: Affine3A::IDENTITY,
            ..RenderMesh::default()
        }
    };
    let floor = [[-9.0, -9.0], [-9.0, 9.0], [9.0, 9.0], [9.0, -9.0]].map(|[x, z]| Vec3::new(x, -1.0, z));
    let mut meshes = vec![fan(floor.to_vec(), 0)];
    let mut materials = vec![Material::default()];
    for (positions, radiance) in polygons {
        meshes.push(fan(positions.clone(), materials.len() as u32));
        materials.push(Material { emission: *radiance, two_sided, ..Material::default() });
    }
    let scene = RenderScene {
        origin: DVec3::ZERO,
        meshes,
        materials,
        textures: Vec::new(),
        lights: Vec::new(),
        sky: None,
        sky_image: None,
        camera: Camera { eye: DVec3::Z, target: DVec3::ZERO, up: DVec3::Y, vertical_fov: 1.0 },
        grid: None,
    };
    (Geometry::new(&scene).unwrap(), scene.materials)
}

/// A rectangle in the plane y = 0 that faces down.
fn rectangle(half: [f32; 2]) -> Vec<Vec3> {
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
        .map(|[x, z]| Vec3::new(x * half[0], 0.0, z * half[1]))
        .to_vec()
}

/// Irradiance at the point `height` below the middle, facing up.
fn irradiance_below(polygon: Vec<Vec3>, height: f32, samples: u32) -> f32 {
    let (geometry, materials) = geometry(&[(polygon, Vec3::ONE)], false);
    let records = light_records(&geometry, &materials, &[], DVec3::ZERO, samples, false);
    assert_eq!(records.len(), samples as usize);
    let point = Vec3::new(0.0, -height, 0.0);
    records.iter().map(|record| light_irradiance(record, point, Vec3::Y, Vec3::Y).x).sum()
}

#[test]
fn a_rectangle_lights_as_the_closed_form_says() {
    // E = 2 L [X/sqrt(1+X²) atan(Y/sqrt(1+X²)) + Y/sqrt(1+Y²) atan(X/sqrt(1+Y²))], X = a/h, Y = b/h.
    let closed = |a: f64, b: f64, h: f64| {
        let (x, y) = (a / h, b / h);
        let (sx, sy) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
        2.0 * (x / sx * (y / sx).atan() + y / sy * (x / sy).atan())
    };
    assert!((closed(0.5, 0.25, 1.0) - 0.415838).abs() < 1e-6);
    for (half, height) in
        [([0.5, 0.25], 1.0), ([0.5, 0.25], 0.5), ([0.12, 0.1], 1.0), ([0.065, 0.0525], 0.5488)]
    {
        let exact = closed(f64::from(half[0]), f64::from(half[1]), f64::from(height));
        let deviation = relative_deviation(half, height);
        // Random points would be off by deviation / sqrt(n). Evenly spread ones must be better, the more so the
        // more there are; f32 rounding of n terms is below n / 2^24.
        for (samples, share) in [(16u32, 0.5), (64, 0.33), (1024, 0.1)] {
            let found = f64::from(irradiance_below(rectangle(half), height, samples));
            let bound = share * deviation / f64::from(samples).sqrt() + f64::from(samples) / 16_777_216.0;
            let error = (found / exact - 1.0).abs();
            assert!(error < bound, "{half:?} at {height}, {samples} points: {error} beyond {bound}");
        }
    }
}

/// Standard deviation of what the points of a rectangle add to the irradiance, as a share of the mean.
fn relative_deviation(half: [f32; 2], height: f32) -> f64 {
    let mut sums = [0.0; 2];
    for i in 0..100 {
        for j in 0..100 {
            let middle = |k: i32, half: f32| (f64::from(k) / 49.5 - 1.0) * f64::from(half);
            let (x, z) = (middle(i, half[0]), middle(j, half[1]));
            let share = (f64::from(height).powi(2) + x * x + z * z).powi(-2);
            sums = [sums[0] + share, sums[1] + share * share];
        }
    }
    let mean = sums[0] / 1e4;
    (sums[1] / 1e4 - mean * mean).sqrt() / mean
}

#[test]
fn a_disk_lights_as_the_closed_form_says() {
    // E = pi L r² / (r² + h²); a regular polygon of the same area stands for the disk.
    let sides = 64;
    let step = std::f32::consts::TAU / sides as f32;
    let radius = 0.5;
    let polygon_radius = radius * (step / step.sin()).sqrt();
    let polygon: Vec<Vec3> = (0..sides)
        .map(|i| {
            let (sin, cos) = (i as f32 * step).sin_cos();
            Vec3::new(polygon_radius * cos, 0.0, polygon_radius * sin)
        })
        .collect();
    let exact = 0.628_318_5;
    // One point is the disk itself, but for standing on the rim of a triangle instead of the middle; many converge.
    let error = (irradiance_below(polygon, 1.0, 1024) / exact - 1.0).abs();
    assert!(error < 1e-3, "{error}");
}

#[test]
fn a_single_point_close_to_its_surface_stays_below_pi_times_radiance() {
    let (geometry, materials) = geometry(&[(rectangle([0.1, 0.1]), Vec3::ONE)], false);
    let records = light_records(&geometry, &materials, &[], DVec3::ZERO, 1, false);
    let below = |distance: f32| {
        let point = Vec3::from(records[0].position) - Vec3::Y * distance;
        light_irradiance(&records[0], point, Vec3::Y, Vec3::Y).x
    };
    assert!((below(1e-4) - std::f32::consts::PI).abs() < 1e-4);
    // Far away: the inverse square law, L A / d², up to A / (pi d²).
    assert!((below(10.0) * 100.0 / 0.04 - 1.0).abs() < 2e-4);
}

#[test]
fn the_power_of_each_surface_is_exact() {
    let small = rectangle([0.1, 0.1]).iter().map(|p| *p + Vec3::new(3.0, 0.5, 0.0)).collect();
    let (geometry, materials) =
        geometry(&[(rectangle([0.5, 0.3]), RADIANCE), (small, 3.0 * RADIANCE)], false);
    for samples in [1, 2, 7, 16, 61] {
        let records = light_records(&geometry, &materials, &[], DVec3::ZERO, samples, false);
        assert_eq!(records.len(), samples.max(2) as usize);
        for (small, expected) in [(false, RADIANCE * 0.6), (true, 3.0 * RADIANCE * 0.04)] {
            let strengths =
                records.iter().filter(|r| (r.position[0] > 2.0) == small).map(|r| Vec3::from(r.strength));
            let sum: Vec3 = strengths.sum();
            assert!((sum / expected - 1.0).abs().max_element() < 1e-5, "{samples} points: {sum} {expected}");
        }
    }
}

#[test]
fn the_back_of_a_light_counts_only_if_something_may_see_it() {
    // The highest thing in the scene: nothing is behind it.
    let (highest, materials) = geometry(&[(rectangle([0.5, 0.3]), RADIANCE)], true);
    let records = light_records(&highest, &materials, &[], DVec3::ZERO, 16, false);
    assert!(records.len() == 16 && records.iter().all(|record| record.axis[1] < 0.0));
    // Another surface above it: both sides shine, with equal shares.
    let above = rectangle([0.1, 0.1]).iter().map(|p| *p + Vec3::Y).collect();
    let (between, materials) = geometry(&[(rectangle([0.5, 0.3]), RADIANCE), (above, Vec3::ZERO)], true);
    let records = light_records(&between, &materials, &[], DVec3::ZERO, 16, false);
    assert_eq!(records.iter().filter(|record| record.axis[1] > 0.0).count(), 8);
}

#[test]
fn points_lie_on_the_surface_and_differ_in_both_coordinates() {
    let (geometry, materials) = geometry(&[(rectangle([0.5, 0.3]), RADIANCE)], false);
    let records = light_records(&geometry, &materials, &[], DVec3::ZERO, 16, false);
    for (index, record) in records.iter().enumerate() {
        let [x, y, z] = record.position;
        assert!(x.abs() < 0.5 && y == 0.0 && z.abs() < 0.3);
        for other in &records[..index] {
            assert!((x - other.position[0]).abs() > 1e-4 || (z - other.position[2]).abs() > 1e-4);
        }
    }
    // The mean of the points is near the middle: no side is favoured by more than an eighth of the half side.
    let mean: Vec3 = records.iter().map(|r| Vec3::from(r.position)).sum::<Vec3>() / 16.0;
    assert!(mean.x.abs() < 0.5 / 8.0 && mean.z.abs() < 0.3 / 8.0, "{mean}");
}

#[test]
fn layers_follow_one_another_and_dark_lights_have_none() {
    let (geometry, materials) = geometry(&[(rectangle([0.5, 0.3]), RADIANCE)], false);
    let spot = |outer_angle| LightKind::Spot {
        position: DVec3::ZERO,
        direction: Vec3::X,
        intensity: Vec3::ONE,
        inner_angle: 0.1,
        outer_angle,
    };
    let lights: Vec<Light> = [
        LightKind::Point { position: DVec3::ZERO, intensity: Vec3::ONE },
        LightKind::Point { position: DVec3::ZERO, intensity: Vec3::ZERO },
        spot(0.7),
        spot(0.9),
        LightKind::Directional { direction: Vec3::X, irradiance: Vec3::ONE },
    ]
    .map(|kind| Light { name: String::new(), kind })
    .to_vec();
    let records = light_records(&geometry, &materials, &lights, DVec3::ZERO, 2, true);
    let layers: Vec<_> = records.iter().map(|record| (record.first_layer, record.layers)).collect();
    assert_eq!(layers, [(0, 5), (5, 5), (10, 6), (16, 1), (17, 5), (22, 16)]);
    let unshadowed = light_records(&geometry, &materials, &lights, DVec3::ZERO, 2, false);
    assert!(unshadowed.iter().all(|record| record.layers == 0));
}

#[test]
fn shares_are_whole_and_complete() {
    assert_eq!(share_out(16, &[1.0, 1.0]), [8, 8]);
    assert_eq!(share_out(16, &[1.0, 2.0]), [5, 11]);
    assert_eq!(share_out(16, &[1e-6, 1.0]), [1, 15]);
    assert_eq!(share_out(2, &[1.0, 1.0, 1.0]), [1, 1, 1]);
    assert_eq!(share_out(16, &[]), [0u32; 0]);
}
