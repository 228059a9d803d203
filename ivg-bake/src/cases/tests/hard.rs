//! Lights and flights at the edge of what numbers hold.

use core::f64::consts::PI;

use glam::{DVec3, Vec3};
use ivg_scene::{LightKind, Material, SkyImage};

use crate::cases::{SceneBuilder, plan, spherical_cavity};
use crate::{BakeError, BakeOptions, BakeResult, Silent, bake};

fn baked(builder: SceneBuilder, options: &BakeOptions) -> Result<BakeResult, BakeError> {
    let (scene, flat) = builder.build();
    bake(&scene, &flat, &plan(&scene, 64), options, &Silent)
}

/// A closed room of 1 m with a point light of a power.
fn room(power: f64) -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.7, 0.0, true);
    builder.cuboid(Vec3::ZERO, Vec3::ONE, wall, true);
    let intensity = Vec3::new(1.0, 0.5, 0.25) * (power / (4.0 * PI)) as f32;
    builder.light(LightKind::Point { position: DVec3::new(0.3, 0.6, 0.45), intensity });
    builder
}

const SMALL: BakeOptions = BakeOptions {
    dims: [4; 3],
    bounds: Some((DVec3::splat(0.2), DVec3::splat(0.8))),
    photons: 20_000,
    estimator: crate::Estimator::TrackLength,
    quantity: ivg_grid::Quantity::Vectors,
    seed: 1,
    threads: Some(2),
    accuracy: None,
    paths: 0,
};

/// The same photons, whatever they carry: all values in proportion, to the rounding of f32.
#[test]
fn lights_of_a_millionth_and_of_a_thousand_million_watts_differ_in_power_alone() {
    let one = baked(room(1.0), &SMALL).unwrap();
    for power in [1e-6, 1e9] {
        let other = baked(room(power), &SMALL).unwrap();
        for (a, b) in one.grid.vectors().iter().zip(other.grid.vectors()) {
            for (a, b) in a.as_flattened().as_flattened().iter().zip(b.as_flattened().as_flattened()) {
                let expected = f64::from(*a) * power;
                assert!(
                    (f64::from(*b) - expected).abs() <= 1e-5 * expected.abs(),
                    "{power} W: {b} {expected}"
                );
            }
        }
        assert!((other.stats.emitted.x / (one.stats.emitted.x * power) - 1.0).abs() < 1e-5);
    }
}

/// Parallel light of 1 W/m² straight down on a mirror comes back straight up, along an axis and in the planes between cells:
/// 1 W/m² from below on every vertex, nothing from anywhere else. Of 60,000 photons at least a tenth meet the mirror, and a
/// share of 1/200 of these each block of cells that is averaged here: 5 / √(6000).
#[test]
fn flights_along_an_axis_are_all_counted() {
    let mut builder = SceneBuilder::default();
    let mirror = builder.any_material(Material {
        albedo: Vec3::ZERO,
        specular: 1.0,
        roughness: 0.0,
        ..Material::default()
    });
    builder.quad(Vec3::ZERO, Vec3::Z * 2.0, Vec3::X * 2.0, mirror);
    builder.light(LightKind::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::ONE });
    let bounds = Some((DVec3::splat(0.5), DVec3::splat(1.5)));
    let result = baked(builder, &BakeOptions { bounds, photons: 60_000, ..SMALL }).unwrap();
    let mut sum = 0.0;
    for vectors in result.grid.vectors() {
        let [x, y, z] = vectors[3][1];
        assert!(y < 0.0 && x.abs().max(z.abs()) < 1e-6 * y.abs(), "{x} {y} {z}");
        assert_eq!(vectors[2], [[0.0; 3]; 3], "nothing comes from above but the light itself");
        sum -= f64::from(y) / 64.0;
    }
    assert!((sum - 1.0).abs() < 5.0 / 6000f64.sqrt(), "{sum}");
}

/// A lamp between the two sheets of a wall lights nothing, and nothing of it is lost from the books.
#[test]
fn a_light_inside_a_wall_lights_nothing() {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.5, 0.0, true);
    let lamp = builder.material(0.0, 9.0, true);
    builder.cuboid(Vec3::ZERO, Vec3::ONE, wall, true);
    builder.cuboid(Vec3::splat(-0.1), Vec3::splat(1.1), wall, false);
    builder.quad(Vec3::new(0.3, 1.05, 0.3), Vec3::X * 0.3, Vec3::Z * 0.3, lamp);
    let result = baked(builder, &SMALL).unwrap();
    assert!(result.grid.vectors().iter().all(|v| *v == [[[0.0; 3]; 3]; 6]));
    let books = &result.stats;
    let spent = books.absorbed + books.escaped + books.cut;
    assert!((books.emitted - spent).abs().max_element() <= 1e-9 * books.emitted.max_element(), "{books:?}");
    assert_eq!(books.escaped, DVec3::ZERO);
}

#[test]
fn spherical_cavities_hold_to_albedo_095() {
    for albedo in [0.0, 0.8, 0.95] {
        let outcome = spherical_cavity(albedo, 30_000).unwrap();
        assert!(outcome.holds() && outcome.bound < 0.25, "{outcome:?}");
    }
}

/// Two mirrors face each other and glass lies between them: photons that nothing absorbs end at the cap and say so.
#[test]
fn light_between_mirrors_ends_at_the_cap() {
    let mut builder = SceneBuilder::default();
    let ideal = Material { albedo: Vec3::ZERO, roughness: 0.0, ..Material::default() };
    let mirror = builder.any_material(Material { specular: 1.0, ..ideal.clone() });
    let glass = builder.any_material(Material { transmission: 1.0, ..ideal });
    builder.cuboid(Vec3::ZERO, Vec3::ONE, mirror, true);
    builder.cuboid(Vec3::splat(0.4), Vec3::splat(0.6), glass, false);
    builder.light(LightKind::Point { position: DVec3::new(0.3, 0.6, 0.45), intensity: Vec3::ONE });
    let result = baked(builder, &BakeOptions { photons: 2000, ..SMALL }).unwrap();
    assert_eq!((result.stats.absorbed, result.stats.escaped), (DVec3::ZERO, DVec3::ZERO));
    assert_eq!(result.stats.cut, result.stats.emitted);
}

#[test]
fn numbers_of_mirrors_glass_and_skies_that_cannot_be_used_are_named() {
    let plain = Material::default;
    let materials = [
        (Material { roughness: f32::NAN, ..plain() }, "roughness"),
        (Material { specular: f32::INFINITY, ..plain() }, "mirror reflection"),
        (Material { transmission: 1.5, ..plain() }, "transmission"),
        (Material { transmission_colour: Vec3::splat(-1.0), ..plain() }, "colour of transmission"),
        (Material { refractive_index: 0.5, ..plain() }, "index of refraction less 1"),
    ];
    for (material, name) in materials {
        let mut builder = room(1.0);
        builder.any_material(material);
        let found = baked(builder, &SMALL).expect_err(name);
        assert!(matches!(&found, BakeError::BadNumber { what, .. } if *what == name), "{found}");
    }
    let sky =
        |texels: Vec<[f32; 3]>| SkyImage { name: "s".into(), width: 1, height: 1, rotation: 0.0, texels };
    for (sky, name) in [(sky(vec![[0.0, f32::NAN, 0.0]]), "radiance"), (sky(Vec::new()), "size")] {
        let (mut scene, flat) = room(1.0).build();
        scene.sky_image = Some(sky);
        let found = bake(&scene, &flat, &plan(&scene, 4), &SMALL, &Silent).expect_err(name);
        assert!(matches!(&found, BakeError::BadNumber { what, .. } if *what == name), "{found}");
    }
}
