use glam::{Affine3A, DVec3};
use ivg_scene::{Camera, Light, LightKind, Material};

use super::*;
use crate::cpu::shadow_maps;
use crate::plan::FramePlan;
use crate::{RenderMesh, RenderOptions, RenderScene};

/// A square of half side `half` around `centre`, perpendicular to `normal`.
fn square(centre: Vec3, normal: Vec3, half: f32) -> RenderMesh {
    let (u, v) = normal.normalize().any_orthonormal_pair();
    RenderMesh {
        positions: [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(s, t)| centre + half * (s * u + t * v))
            .to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        triangle_materials: vec![0; 2],
        transform: Affine3A::IDENTITY,
        ..RenderMesh::default()
    }
}

/// Runs `test` with the only light of a scene and its shadow maps.
fn with_light<T>(
    meshes: Vec<RenderMesh>,
    kind: LightKind,
    test: impl FnOnce(&LightRecord, &ShadowMaps) -> T,
) -> T {
    let scene = RenderScene {
        origin: DVec3::ZERO,
        meshes,
        materials: vec![Material::default()],
        textures: Vec::new(),
        lights: vec![Light { name: "lamp".into(), kind }],
        sky: None,
        sky_image: None,
        camera: Camera { eye: DVec3::Z, target: DVec3::ZERO, up: DVec3::Y, vertical_fov: 1.0 },
        grid: None,
    };
    let mut options = RenderOptions::new(8, 8);
    options.shadow_size = 128;
    let plan = FramePlan::new(&scene, &options).unwrap();
    test(&plan.lights[0], &shadow_maps(&plan, 0..1))
}

fn point() -> LightKind {
    LightKind::Point { position: DVec3::new(0.1, -0.2, 0.3), intensity: Vec3::ONE }
}

#[test]
fn a_square_shadows_what_is_behind_it_in_every_direction() {
    let light_position = Vec3::new(0.1, -0.2, 0.3);
    let directions = ivg_grid::integrate::fibonacci_sphere(60);
    for direction in directions.into_iter().map(|d| d.as_vec3()) {
        let blocker = square(light_position + 2.0 * direction, direction, 0.4);
        with_light(vec![blocker], point(), |light, maps| {
            let visibility =
                |offset: Vec3| shadow_visibility(light, maps, light_position + offset, -direction);
            let side = direction.any_orthonormal_vector();
            assert_eq!(visibility(4.0 * direction), 0.0, "behind, {direction}");
            assert_eq!(visibility(1.0 * direction), 1.0, "before, {direction}");
            // The shadow at distance 4 is twice as large as the square: its corner is at 0.8 sqrt(2), and five texels
            // of the widest kind blur it by 0.4.
            assert_eq!(visibility(4.0 * direction + 1.7 * side), 1.0, "beside, {direction}");
        });
    }
}

#[test]
fn a_surface_does_not_shadow_itself_however_it_is_inclined() {
    let light_position = Vec3::new(0.1, -0.2, 0.3);
    for step in 0..40 {
        // From facing the light to 80 degrees. Beyond, the plane's horizon comes into the filter, where rounding to
        // 1/256 texel decides about a texel or two; the surface receives next to nothing there.
        let angle = step as f32 / 39.0 * 1.4;
        let normal = Vec3::new(-angle.cos(), angle.sin(), 0.1).normalize();
        let centre = light_position + Vec3::X * 1.5;
        with_light(vec![square(centre, normal, 2.0)], point(), |light, maps| {
            let (u, v) = normal.any_orthonormal_pair();
            for i in -19..20 {
                for j in -19..20 {
                    let position = centre + 0.1 * (i as f32 * u + j as f32 * v);
                    let visibility = shadow_visibility(light, maps, position, normal);
                    assert_eq!(visibility, 1.0, "inclination {angle}, ({i}, {j})");
                }
            }
        });
    }
}

#[test]
fn the_corner_of_a_room_has_no_dark_seam() {
    // Three walls that meet in the origin, seen by a light inside.
    let walls = vec![
        square(Vec3::new(1.0, 1.0, 0.0), Vec3::Z, 1.0),
        square(Vec3::new(0.0, 1.0, 1.0), Vec3::X, 1.0),
        square(Vec3::new(1.0, 0.0, 1.0), Vec3::Y, 1.0),
    ];
    let kind = LightKind::Point { position: DVec3::new(0.9, 1.1, 0.8), intensity: Vec3::ONE };
    with_light(walls, kind, |light, maps| {
        for i in 0..200 {
            let along = 0.005 + 0.0099 * i as f32;
            for from_corner in [1e-4, 1e-3, 3e-3, 0.01, 0.03] {
                let position = Vec3::new(along, from_corner, 0.0);
                let visibility = shadow_visibility(light, maps, position, Vec3::Z);
                assert_eq!(visibility, 1.0, "{position}");
            }
        }
    });
}

#[test]
fn sunlight_is_blocked_below_a_square_on_every_tile() {
    let down = Vec3::new(0.3, -1.0, 0.2).normalize();
    let kind = LightKind::Directional { direction: down, irradiance: Vec3::ONE };
    let floor = square(Vec3::ZERO, Vec3::Y, 4.0);
    for x in [-3.0, -1.5, 0.0, 1.5, 3.0] {
        for z in [-3.0, -1.5, 0.0, 1.5, 3.0] {
            let on_floor = Vec3::new(x, 0.0, z);
            let roof = square(on_floor - down, Vec3::Y, 0.4);
            with_light(vec![floor.clone(), roof], kind, |light, maps| {
                let visibility = |position| shadow_visibility(light, maps, position, Vec3::Y);
                assert_eq!(visibility(on_floor), 0.0, "{on_floor}");
                assert_eq!(visibility(on_floor + Vec3::X * 0.9), 1.0, "{on_floor}");
                assert_eq!(visibility(on_floor - down * 1.5), 1.0, "{on_floor}");
            });
        }
    }
}

#[test]
fn the_filter_blurs_an_edge_evenly() {
    let blocker = square(Vec3::new(1.0, 0.0, 2.0), Vec3::Z, 1.0);
    let kind = LightKind::Point { position: DVec3::ZERO, intensity: Vec3::ONE };
    with_light(vec![blocker], kind, |light, maps| {
        // Across the edge at x = 0; a texel is 4 * 2 / (128 - 8) wide there.
        let visibility: Vec<f32> = (-400..400)
            .map(|i| shadow_visibility(light, maps, Vec3::new(i as f32 * 1e-3, 0.0, 4.0), Vec3::NEG_Z))
            .collect();
        assert_eq!((visibility[0], visibility[799]), (1.0, 0.0));
        // A step of 1e-3 is 0.015 texels; the filter is five texels wide, so the share changes by 0.003 at most.
        for pair in visibility.windows(2) {
            assert!(pair[0] >= pair[1] - 1e-6 && pair[0] - pair[1] < 0.0031 + 1e-5, "{pair:?}");
        }
    });
}

#[test]
fn a_spot_light_falls_off_between_its_angles() {
    let kind = LightKind::Spot {
        position: DVec3::ZERO,
        direction: Vec3::X,
        intensity: Vec3::splat(8.0),
        inner_angle: 0.2,
        outer_angle: 0.6,
    };
    with_light(vec![square(Vec3::X * 9.0, Vec3::X, 9.0)], kind, |light, _| {
        let at = |angle: f32| {
            let direction = Vec3::new(angle.cos(), angle.sin(), 0.0);
            light_irradiance(light, 2.0 * direction, -direction, -direction).x
        };
        assert!((at(0.0) - 2.0).abs() < 1e-5 && (at(0.19) - 2.0).abs() < 1e-5);
        assert_eq!(at(0.61), 0.0);
        // KHR_lights_punctual: the square of the cosine's share between both angles.
        let share = (0.4f32.cos() - 0.6f32.cos()) / (0.2f32.cos() - 0.6f32.cos());
        assert!((at(0.4) - 2.0 * share * share).abs() < 1e-5);
    });
}

#[test]
fn the_weights_of_the_filter_sum_up_to_its_width() {
    for share in [0.0, 0.25, 0.999] {
        let offsets = -SHADOW_FILTER_RADIUS..=SHADOW_FILTER_RADIUS + 1;
        let sum: f32 = offsets.map(|offset| filter_weight(offset, share)).sum();
        assert!((sum - 5.0).abs() < 1e-6);
    }
}
