use core::f64::consts::PI;

use glam::{DVec3, Vec3};
use ivg_scene::LightKind;

use super::{Emitters, spot_cosine, spot_falloff};
use crate::BakeError;
use crate::cases::SceneBuilder;
use crate::sampling::rng::Stream;
use crate::stage::{Effects, Stage};

const ALL: Effects = Effects { textures: false, sky: true, mirrors: false, glass: false };

/// Irradiance at a point of a surface facing +x by sampling photons' starts is hard to see; what must agree is the other way: the
/// mean of [`Emitters::arrive`] and the closed form.
fn mean_arrival(emitters: &Emitters, point: Vec3, normal: Vec3) -> f64 {
    let samples = 40_000;
    let sum: f64 = (0..samples)
        .filter_map(|item| emitters.arrive(point, &Stream::new(1, item), 0))
        .map(|light| f64::from(light.irradiance.y) * f64::from(light.direction.dot(normal).max(0.0)))
        .sum();
    sum / samples as f64
}

#[test]
fn photons_carry_the_power_of_their_lights() {
    let mut builder = SceneBuilder::default();
    let lamp = builder.material(0.0, 2.0, true);
    builder.quad(Vec3::ZERO, Vec3::X * 0.5, Vec3::Y * 0.25, lamp);
    builder.light(LightKind::Point { position: DVec3::ONE, intensity: Vec3::new(0.1, 1.0, 0.5) });
    let spot = LightKind::Spot {
        position: DVec3::ZERO,
        direction: Vec3::X,
        intensity: Vec3::splat(4.0),
        inner_angle: 0.3,
        outer_angle: 0.6,
    };
    builder.light(spot);
    let (scene, flat) = builder.build();
    let stage = Stage::new(&scene, &flat, ALL, None).unwrap();
    let surface = 2.0 * PI * 0.125 * 2.0;
    let point = 4.0 * PI;
    let spot = scene.lights[1].power().unwrap().y;
    let total = stage.emitters.total_power();
    assert!((total - surface - point - spot).abs() < 1e-6 * total, "{total}");
    let photons = 60_000;
    let (mut green, mut red, mut up) = (0.0, 0.0, 0u32);
    for photon in 0..photons {
        let emission = stage.emitters.emit(&Stream::new(2, photon));
        assert!((emission.direction.length() - 1.0).abs() < 1e-5);
        assert!(emission.power.max_element() <= 1.0 && !emission.deposit_first);
        green += f64::from(emission.power.y);
        red += f64::from(emission.power.x);
        // Of the two-sided lamp as much goes up as down; the point and spot are told apart by their origins.
        let place = stage.space.to_world(emission.origin);
        up += u32::from(place.z > 0.0 && place.z < 1e-4 && emission.direction.z > 0.0);
    }
    let per_photon = total / photons as f64;
    assert!(
        (green * per_photon / (surface + point + spot) - 1.0).abs() < 1e-9,
        "every light is white or brightest in green"
    );
    // Red is missing in 90 % of the point's photons' power: binomial, five standard deviations.
    let share = point / total;
    let sigma = 0.9 * (share * (1.0 - share) / photons as f64).sqrt();
    assert!((red * per_photon / total - (1.0 - 0.9 * share)).abs() < 5.0 * sigma);
    let half = 0.5 * surface / total;
    let sigma = (half * (1.0 - half) / photons as f64).sqrt();
    assert!((f64::from(up) / photons as f64 - half).abs() < 5.0 * sigma, "{up}");
}

#[test]
fn arriving_light_has_its_closed_form() {
    // A small lamp of 2 cm, seen from 1 m: L A cos cos' / d², to 1e-4.
    let mut builder = SceneBuilder::default();
    let lamp = builder.material(0.0, 50.0, false);
    builder.quad(Vec3::new(-0.01, -0.01, 0.0), Vec3::X * 0.02, Vec3::Y * 0.02, lamp);
    let (scene, flat) = builder.build();
    let stage = Stage::new(&scene, &flat, ALL, Some((DVec3::splat(-2.0), DVec3::splat(2.0)))).unwrap();
    let at = DVec3::new(0.6, 0.0, 0.8);
    let found = mean_arrival(&stage.emitters, stage.space.to_bake(at), -at.as_vec3());
    assert!((found / (50.0 * 4e-4 * 0.8) - 1.0).abs() < 1e-3, "{found}");
    assert_eq!(
        mean_arrival(&stage.emitters, stage.space.to_bake(-at), at.as_vec3()),
        0.0,
        "the back is dark"
    );

    let (mut builder, axis) = (SceneBuilder::default(), Vec3::new(0.0, -0.8, 0.6));
    builder.light(LightKind::Spot {
        position: DVec3::new(0.0, 1.0, 0.0),
        direction: axis,
        intensity: Vec3::splat(5.0),
        inner_angle: 0.2,
        outer_angle: 0.9,
    });
    let (scene, flat) = builder.build();
    let stage = Stage::new(&scene, &flat, ALL, Some((DVec3::splat(-2.0), DVec3::splat(2.0)))).unwrap();
    let on_axis = stage.space.to_bake(DVec3::new(0.0, 1.0, 0.0) + axis.as_dvec3() * 2.0);
    assert!((mean_arrival(&stage.emitters, on_axis, -axis) - 1.25).abs() < 1e-3);
    let below = stage.space.to_bake(DVec3::ZERO);
    let expected = 5.0 * f64::from(spot_falloff(0.8, 0.2f32.cos(), 0.9f32.cos()));
    assert!((mean_arrival(&stage.emitters, below, Vec3::Y) / expected - 1.0).abs() < 1e-3);

    let mut builder = SceneBuilder::default();
    builder
        .light(LightKind::Directional { direction: Vec3::new(0.0, -0.8, 0.6), irradiance: Vec3::splat(3.0) });
    let (scene, flat) = builder.build();
    let stage = Stage::new(&scene, &flat, ALL, None).unwrap();
    assert!((mean_arrival(&stage.emitters, Vec3::ZERO, Vec3::Y) - 2.4).abs() < 1e-4);
}

/// Even light from the sky: photons that start on the world sphere cross a small ball inside in proportion to its cross-section,
/// from all sides alike; five standard deviations.
#[test]
fn sky_photons_are_even_inside() {
    let mut builder = SceneBuilder::default();
    builder.sky(1.0);
    let (scene, flat) = builder.build();
    let stage = Stage::new(&scene, &flat, ALL, Some((DVec3::splat(-1.0), DVec3::splat(1.0)))).unwrap();
    let radius = stage.space.to_bake(DVec3::X * 0.4).x;
    let middle = stage.space.to_bake(DVec3::new(0.3, -0.2, 0.1));
    let photons = 100_000u64;
    let (mut crossings, mut mean) = (0u32, DVec3::ZERO);
    for photon in 0..photons {
        let emission = stage.emitters.emit(&Stream::new(8, photon));
        assert!(emission.deposit_first);
        let way = middle - emission.origin;
        let along = way.dot(emission.direction);
        if along > 0.0 && (way.length_squared() - along * along).max(0.0).sqrt() < radius {
            crossings += 1;
            mean += emission.direction.as_dvec3();
        }
    }
    // Power of even radiance through a ball: 4 pi L times its cross-section.
    let expected = 4.0 * PI * PI * 0.16 / stage.emitters.total_power();
    let sigma = (expected * (1.0 - expected) / photons as f64).sqrt();
    let share = f64::from(crossings) / photons as f64;
    assert!((share - expected).abs() < 5.0 * sigma, "{share} for {expected}");
    let spread = (1.0 / 3.0 / f64::from(crossings)).sqrt();
    assert!((mean / f64::from(crossings)).abs().max_element() < 5.0 * spread);
}

#[test]
fn spot_cosines_follow_the_falloff() {
    let (inner, outer) = (0.9f32, 0.6f32);
    let mut bins = [0f64; 8];
    let draws = 80_000;
    for n in 0..draws {
        let cos = spot_cosine((n as f32 + 0.5) / draws as f32, inner, outer);
        assert!((outer..=1.0).contains(&cos));
        bins[((cos - outer) / (1.0 - outer) * 7.999_9) as usize] += 1.0;
    }
    let weight = |bin: usize| -> f64 {
        (0..1000)
            .map(|n| {
                let cos = outer + (1.0 - outer) * (bin as f32 + (n as f32 + 0.5) / 1000.0) / 8.0;
                f64::from(spot_falloff(cos, inner, outer))
            })
            .sum()
    };
    let total: f64 = (0..8).map(weight).sum();
    for (bin, count) in bins.iter().enumerate() {
        // Stratified draws: off by the ends of the bin alone, and by the 1000 steps of the integral.
        assert!((count / f64::from(draws) - weight(bin) / total).abs() < 2e-3, "bin {bin}");
    }
}

#[test]
fn a_scene_without_light_is_an_error() {
    let mut builder = SceneBuilder::default();
    let grey = builder.material(0.5, 0.0, true);
    builder.quad(Vec3::ZERO, Vec3::X, Vec3::Y, grey);
    builder.light(LightKind::Point { position: DVec3::ZERO, intensity: Vec3::ZERO });
    let (scene, flat) = builder.build();
    assert_eq!(Stage::new(&scene, &flat, ALL, None).unwrap_err(), BakeError::NoLight);
}
