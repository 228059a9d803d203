use core::f64::consts::PI;

use glam::{DVec3, Vec3};
use ivg_scene::{Camera, FlatScene, LightKind, Material, Scene};

use super::{GatheredVectors, KnownLight, Oracle, Sampling, Shown};
use crate::cases::{SceneBuilder, lit_rectangle_irradiance, lit_rectangle_scene};
use crate::estimate::gather::Mean;
use crate::{BakeOptions, Silent, bake};

const SAMPLING: Sampling = Sampling { paths: 30_000, seed: 7, threads: Some(2) };

/// Asserts each component of the green channel within five standard errors and `slack` of what is expected.
#[track_caller]
fn check(found: &GatheredVectors, expected: [[f64; 3]; 6], slack: f64) {
    for (h, expected) in expected.iter().enumerate() {
        for (k, expected) in expected.iter().enumerate() {
            let (value, error) = (found.vectors[h][1][k], found.standard_error[h][1][k]);
            let bound = 5.0 * error + slack + 1e-9;
            assert!(
                (value - expected).abs() < bound,
                "hemisphere {h} axis {k}: {value} for {expected} ± {error}"
            );
        }
    }
}

#[test]
fn closed_furnaces_have_their_closed_form() {
    for albedo in [0.0, 0.5, 0.9] {
        let mut builder = SceneBuilder::default();
        let wall = builder.material(albedo, 1.0, false);
        builder.cuboid(Vec3::ZERO, Vec3::new(1.0, 2.0, 0.7), wall, true);
        let (scene, flat) = builder.build();
        let oracle = Oracle::new(&scene, &flat).unwrap();
        let found = oracle.irradiance_vectors(&[DVec3::new(0.3, 1.2, 0.5)], SAMPLING, &Silent).unwrap();
        let rho = f64::from(albedo);
        let along = PI * rho / (1.0 - rho);
        let expected = core::array::from_fn(|h| {
            core::array::from_fn(
                |k| if k == h / 2 { along * if h % 2 == 0 { 1.0 } else { -1.0 } } else { 0.0 },
            )
        });
        check(&found[0], expected, 0.0);
    }
}

/// Two large parallel plates, the lower of which emits. Indirect radiosities: lower B1 − π, upper B2, with
/// B1 = π / (1 − r1 r2), B2 = r2 B1. Plates of 400 m at 1 m distance lack less than 1e-3 of infinity.
#[test]
fn parallel_plates_have_their_closed_form() {
    let mut builder = SceneBuilder::default();
    let lower = builder.material(0.5, 1.0, false);
    let upper = builder.material(0.8, 0.0, true);
    let (u, v) = (Vec3::X * 400.0, Vec3::Y * 400.0);
    builder.quad(Vec3::new(-200.0, -200.0, 0.0), u, v, lower);
    builder.quad(Vec3::new(-200.0, -200.0, 1.0), u, v, upper);
    let (scene, flat) = builder.build();
    let oracle = Oracle::new(&scene, &flat).unwrap();
    let found = oracle.irradiance_vectors(&[DVec3::new(0.0, 0.0, 0.4)], SAMPLING, &Silent).unwrap();
    let b1 = PI / (1.0 - 0.5 * 0.8);
    let (up, down) = (0.8 * b1, b1 - PI);
    let across = 0.5 * (up + down);
    let tilt = 0.5 * (up - down);
    check(
        &found[0],
        [
            [across, 0.0, tilt],
            [-across, 0.0, tilt],
            [0.0, across, tilt],
            [0.0, -across, tilt],
            [0.0, 0.0, up],
            [0.0, 0.0, -down],
        ],
        1e-3 * b1,
    );
}

/// All that `light` gathers, in closed form: in the furnace every direction is as bright, so that harmonics and vectors of
/// evenly spread directions are exact but for the rule of integration and the noise of the paths beyond.
#[test]
fn everything_gathered_at_once_has_its_closed_form() {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.5, 1.0, false);
    builder.cuboid(Vec3::ZERO, Vec3::new(1.0, 2.0, 0.7), wall, true);
    let (scene, flat) = builder.build();
    let oracle = Oracle::new(&scene, &flat).unwrap();
    let normals = [Vec3::X, Vec3::NEG_Z, Vec3::new(2.0, -3.0, 6.0) / 7.0];
    let light = |threads| {
        let sampling = Sampling { threads: Some(threads), ..SAMPLING };
        oracle.light(&[DVec3::new(0.3, 1.2, 0.5)], &normals, sampling, &Silent).unwrap().remove(0)
    };
    let found = light(2);
    assert_eq!(found, light(1));
    for (n, (irradiance, error)) in found.irradiance.iter().zip(&found.irradiance_error).enumerate() {
        // 16 batches: Student's t with 15 degrees of freedom exceeds 6 with probability 2e-5.
        assert!((irradiance.y - PI).abs() < 6.0 * error.y, "normal {n}: {irradiance} ± {error}");
        assert!(error.y > 0.0 && error.y < 0.03 * PI, "normal {n}: ± {error}");
    }
    // The same paths, added up another way.
    assert!((found.vectors[0][1][0] - found.irradiance[0].y).abs() < 1e-9);
    assert!((found.vectors[5][1][2] + found.irradiance[1].y).abs() < 1e-9);
    for (n, coefficient) in found.radiance[1].iter().enumerate() {
        let expected = if n == 0 { 2.0 * PI.sqrt() } else { 0.0 };
        // The radiance of a path is spread by up to three times its mean 1: 3 √4π / √30,000 of noise, five of them.
        assert!((coefficient - expected).abs() < 5.0 * 3.0 * 3.545 / 30_000_f64.sqrt(), "{n}: {coefficient}");
    }
}

#[test]
fn evenly_spread_directions_have_less_noise_and_no_bias() {
    let (scene, flat) = lit_rectangle_scene();
    let oracle = Oracle::new(&scene, &flat).unwrap();
    let point = DVec3::new(0.5, 0.25, 1.0);
    let sampling = Sampling { paths: 4096, ..SAMPLING };
    let found = &oracle.light(&[point], &[Vec3::NEG_Z], sampling, &Silent).unwrap()[0];
    let (irradiance, error) = (found.irradiance[0], found.irradiance_error[0].max_element());
    let off = (irradiance - lit_rectangle_irradiance()).abs().max_element();
    assert!(off < 6.0 * error, "{irradiance} ± {error}");
    // Independent paths over the sphere, each 4π L cos inside the rectangle, would have about three times as much.
    let independent =
        oracle.irradiance_vectors(&[point], sampling, &Silent).unwrap()[0].standard_error[5][1][2];
    assert!(error < 0.6 * independent, "{error} {independent}");
}

#[test]
fn a_rectangle_in_parallel_light_has_its_closed_form() {
    let (scene, flat) = lit_rectangle_scene();
    let oracle = Oracle::new(&scene, &flat).unwrap();
    let place = (DVec3::new(0.5, 0.25, 1.0), Vec3::NEG_Z);
    let found = oracle.irradiance(&[place], SAMPLING, &Silent).unwrap()[0];
    let off = (found.irradiance - lit_rectangle_irradiance()).abs().max_element();
    assert!(off < 5.0 * found.standard_error.max_element(), "{found:?} for {}", lit_rectangle_irradiance());
    assert!(found.standard_error.max_element() < 0.01);
}

/// A disk of radius r in even light of radiance L gives π L r² / (r² + h²) at distance h on its axis. Here a white disk of 2048
/// triangles lit by parallel light of 1 W/m²: L = 1/π.
#[test]
fn a_disk_has_its_closed_form() {
    let mut builder = SceneBuilder::default();
    let white = builder.material(1.0, 0.0, true);
    let rim = |n: u32| {
        let angle = f64::from(n) / 2048.0 * 2.0 * PI;
        (DVec3::new(libm::cos(angle), libm::sin(angle), 0.0) * 0.5).as_vec3()
    };
    (0..2048).for_each(|n| builder.triangle([Vec3::ZERO, rim(n), rim(n + 1)], white));
    builder.light(LightKind::Directional { direction: Vec3::NEG_Z, irradiance: Vec3::ONE });
    let (scene, flat) = builder.build();
    let oracle = Oracle::new(&scene, &flat).unwrap();
    let found = oracle.irradiance(&[(DVec3::Z, Vec3::NEG_Z)], SAMPLING, &Silent).unwrap()[0];
    assert!((found.irradiance.x - 0.2).abs() < 5.0 * found.standard_error.x, "{found:?}");
}

/// One diffuse reflection of a point light by a small patch: E = I cos / d² on the patch, radiance ρ E / π, irradiance at the
/// eye L A cos cos' / D². The patch of 2 cm, 1 m away, is small to 1e-4.
#[test]
fn a_point_light_falls_off_with_the_square() {
    for distance in [1.0, 2.0] {
        let mut builder = SceneBuilder::default();
        let grey = builder.material(0.5, 0.0, true);
        builder.quad(Vec3::new(-0.01, -0.01, 0.0), Vec3::X * 0.02, Vec3::Y * 0.02, grey);
        builder.light(LightKind::Point { position: DVec3::Z * distance, intensity: Vec3::splat(3.0) });
        let (scene, flat) = builder.build();
        let oracle = Oracle::new(&scene, &flat).unwrap();
        let camera =
            Camera { eye: DVec3::new(0.0, 0.0, 0.5), target: DVec3::ZERO, up: DVec3::Y, vertical_fov: 0.01 };
        let sampling = Sampling { paths: 8, ..SAMPLING };
        let picture = oracle.render(&camera, (4, 4), Shown::All, sampling, &Silent).unwrap();
        let expected = 0.5 / PI * 3.0 / (distance * distance);
        for pixel in &picture.pixels {
            // Within 2.5 mm of the middle E changes by less than 2e-5.
            assert!((f64::from(pixel[1]) / expected - 1.0).abs() < 1e-4, "{pixel:?} for {expected}");
        }
        let dark = oracle.render(&camera, (4, 4), Shown::Indirect, sampling, &Silent).unwrap();
        assert!(dark.pixels.iter().all(|p| *p == [0.0; 3]), "a lone patch has no indirect light");
    }
}

#[test]
fn pictures_show_emission_and_do_not_depend_on_threads() {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.5, 2.0, false);
    builder.cuboid(Vec3::ZERO, Vec3::ONE, wall, true);
    let (scene, flat) = builder.build();
    let oracle = Oracle::new(&scene, &flat).unwrap();
    let camera =
        Camera { eye: DVec3::splat(0.5), target: DVec3::new(0.9, 0.5, 0.4), up: DVec3::Y, vertical_fov: 1.2 };
    let render = |shown, threads| {
        let sampling = Sampling { paths: 400, seed: 1, threads: Some(threads) };
        oracle.render(&camera, (6, 4), shown, sampling, &Silent).unwrap()
    };
    let picture = render(Shown::All, 1);
    assert_eq!((picture.width, picture.height, picture.pixels.len()), (6, 4, 24));
    assert_eq!(picture, render(Shown::All, 3));
    let mean = |p: &super::Picture| p.pixels.iter().map(|p| f64::from(p[0])).sum::<f64>() / 24.0;
    // L = Le / (1 − ρ) = 4; the indirect part that a surface reflects is ρ (L − Le) = 1. 9600 paths whose radiance has a standard
    // deviation near its mean: 1 %; five of them.
    assert!((mean(&picture) - 4.0).abs() < 0.2, "{}", mean(&picture));
    assert!((mean(&render(Shown::Indirect, 2)) - 1.0).abs() < 0.05, "{}", mean(&render(Shown::Indirect, 2)));
}

/// A corner of a room under the image of a sky, with a lamp, and on wish a mirror and half a mirror: light of every kind that the
/// end of a path could count twice or leave out.
fn open_room(mirrors: bool) -> (Scene, FlatScene) {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.6, 0.0, true);
    let lamp = builder.material(0.2, 3.0, true);
    builder.quad(Vec3::ZERO, Vec3::X, Vec3::Y, wall);
    builder.quad(Vec3::ZERO, Vec3::Y, Vec3::Z, wall);
    builder.quad(Vec3::new(0.6, 0.6, 0.7), Vec3::X * 0.3, Vec3::Y * 0.3, lamp);
    if mirrors {
        let half =
            Material { specular: 0.5, albedo: Vec3::splat(0.4), roughness: 0.0, ..Material::default() };
        let half = builder.any_material(Material { two_sided: true, ..half });
        builder.quad(Vec3::ZERO, Vec3::Z, Vec3::X, half);
    }
    builder.sky_image([1.0, 0.2, 0.5, 0.1]);
    builder.build()
}

/// With light that is truly what arrives (by a path from there), paths that end at the second surface are as right as paths
/// that go on; so are those that go on after short flights.
#[test]
fn gathering_known_light_gives_the_picture() {
    for (mirrors, shortest_flight) in [(false, 0.0), (true, 0.0), (true, 0.4)] {
        let (scene, flat) = open_room(mirrors);
        let oracle = Oracle::new(&scene, &flat).unwrap();
        let camera = Camera {
            eye: DVec3::new(2.0, 1.6, 1.2),
            target: DVec3::new(0.2, 0.2, 0.2),
            up: DVec3::Z,
            vertical_fov: 0.6,
        };
        let irradiance = |point: DVec3, normal: Vec3| {
            let seed = (point.x + 3.0 * point.y + 7.0 * point.z).to_bits();
            let one = Sampling { paths: 1, seed, threads: Some(1) };
            oracle.irradiance(&[(point, normal)], one, &Silent).unwrap()[0].irradiance.as_vec3()
        };
        let light = KnownLight { irradiance: &irradiance, shortest_flight };
        let mut means = [Mean::<1>::default(), Mean::<1>::default()];
        for seed in 0..16 {
            let sampling = |seed| Sampling { paths: 1024, seed, threads: Some(2) };
            let whole = oracle.render(&camera, (6, 4), Shown::All, sampling(seed), &Silent).unwrap();
            let gathered =
                oracle.render_gathering(&camera, (6, 4), &light, sampling(seed + 100), &Silent).unwrap();
            for (mean, picture) in means.iter_mut().zip([whole, gathered]) {
                mean.add(&[picture.pixels.iter().map(|p| f64::from(p[1])).sum::<f64>() / 24.0]);
            }
        }
        let [whole, gathered] = [&means[0], &means[1]].map(|mean| (mean.mean()[0], mean.standard_error()[0]));
        let error = whole.1.hypot(gathered.1);
        assert!(error < 0.004 * whole.0, "too noisy to tell: {whole:?}");
        // Five standard errors.
        assert!((whole.0 - gathered.0).abs() < 5.0 * error, "mirrors {mirrors}: {gathered:?} for {whole:?}");
    }
}

#[test]
fn clearance_is_the_distance_to_the_nearest_surface() {
    let (scene, flat) = lit_rectangle_scene();
    let oracle = Oracle::new(&scene, &flat).unwrap();
    assert!((oracle.clearance(DVec3::new(0.5, 0.25, 0.3)) - 0.3).abs() < 1e-6);
    assert!((oracle.clearance(DVec3::new(-0.3, 0.25, 0.4)) - 0.5).abs() < 1e-6);
}

/// A lamp in a closed black room with an ideal mirror for a floor: the mirrored lamp is a second one below. At a point above
/// the floor that sees it: radiance 1 in a square of half side a at distance h straight below.
#[test]
fn a_mirror_shows_the_light_once() {
    let mut builder = SceneBuilder::default();
    let mirror = builder.any_material(Material {
        specular: 1.0,
        albedo: Vec3::ZERO,
        roughness: 0.0,
        ..Material::default()
    });
    let lamp = builder.material(0.0, 1.0, false);
    builder.quad(Vec3::new(-5.0, -5.0, 0.0), Vec3::X * 10.0, Vec3::Y * 10.0, mirror);
    builder.quad(Vec3::new(-0.25, 0.25, 1.0), Vec3::X * 0.5, Vec3::NEG_Y * 0.5, lamp);
    let (scene, flat) = builder.build();
    let oracle = Oracle::new(&scene, &flat).unwrap();
    let found = oracle.irradiance(&[(DVec3::new(0.0, 0.0, 0.5), Vec3::NEG_Z)], SAMPLING, &Silent).unwrap()[0];
    // Seen from 1.5 m; the rectangle's formula with half sides over distance 1/6.
    let x = 0.25f64 / 1.5;
    let root = (1.0 + x * x).sqrt();
    let expected = 4.0 * x / root * libm::atan(x / root);
    let off = (found.irradiance.x - expected).abs();
    assert!(off < 5.0 * found.standard_error.x, "{found:?} for {expected}");
    assert!(found.standard_error.x < 0.05 * expected);
}

/// A pane of index 1.5 in front of a surface lit head-on: 2 · 0.04 / 1.04 of the light is reflected. Sampled past the pane or
/// seen through it, the light counts once.
#[test]
fn light_passes_a_pane_once() {
    let lit = |pane: bool| {
        let mut builder = SceneBuilder::default();
        let white = builder.material(0.5, 0.0, true);
        let glass = builder.any_material(Material {
            albedo: Vec3::ZERO,
            transmission: 1.0,
            thin: true,
            ..Material::default()
        });
        let lamp = builder.material(0.0, 1.0, false);
        builder.quad(Vec3::new(-0.01, -0.01, 0.0), Vec3::X * 0.02, Vec3::Y * 0.02, white);
        builder.quad(Vec3::new(-0.05, 0.05, 2.0), Vec3::X * 0.1, Vec3::NEG_Y * 0.1, lamp);
        if pane {
            builder.quad(Vec3::new(-2.0, -2.0, 1.0), Vec3::X * 4.0, Vec3::Y * 4.0, glass);
        }
        let (scene, flat) = builder.build();
        let oracle = Oracle::new(&scene, &flat).unwrap();
        let camera =
            Camera { eye: DVec3::new(0.0, 0.3, 0.5), target: DVec3::ZERO, up: DVec3::Z, vertical_fov: 0.01 };
        let sampling = Sampling { paths: 4000, ..SAMPLING };
        let picture = oracle.render(&camera, (2, 2), Shown::All, sampling, &Silent).unwrap();
        picture.pixels.iter().map(|p| f64::from(p[0])).sum::<f64>() / 4.0
    };
    // Besides: of what the patch sends up, at most 8 % comes back from the pane to a patch that fills 1e-4 of its view.
    let (with, without) = (lit(true), lit(false));
    assert!((with / without - (1.0 - 0.08 / 1.04)).abs() < 2e-3, "{}", with / without);
}

/// What photons carry and what paths find agree, wherever mirrors and glass pass light on: a room with a lamp, a rough
/// and a sharp mirror, a ball of glass and a pane.
#[test]
fn photons_and_paths_agree_about_mirrors_and_glass() {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.5, 0.0, true);
    let lamp = builder.material(0.0, 5.0, false);
    let gold = Vec3::new(1.0, 0.7, 0.3);
    let metal = |roughness| Material {
        albedo: gold,
        specular: 1.0,
        specular_colour: gold,
        metallic: true,
        roughness,
        ..Material::default()
    };
    let glass = Material { albedo: Vec3::ZERO, transmission: 1.0, ..Material::default() };
    let (sharp, rough) = (builder.any_material(metal(0.0)), builder.any_material(metal(0.5)));
    let solid = builder.any_material(glass.clone());
    let pane =
        builder.any_material(Material { thin: true, transmission_colour: Vec3::new(0.5, 0.9, 1.0), ..glass });
    builder.cuboid(Vec3::ZERO, Vec3::splat(2.0), wall, true);
    builder.quad(Vec3::new(0.7, 1.3, 1.95), Vec3::X * 0.6, Vec3::NEG_Y * 0.6, lamp);
    builder.quad(Vec3::new(0.05, 0.2, 0.2), Vec3::Y * 1.6, Vec3::Z * 1.6, sharp);
    builder.quad(Vec3::new(1.95, 0.2, 0.2), Vec3::Z * 1.6, Vec3::Y * 1.6, rough);
    builder.sphere(Vec3::new(0.6, 1.5, 0.4), 0.3, 3, solid, false);
    builder.quad(Vec3::new(0.4, 0.5, 0.5), Vec3::X * 1.2, Vec3::Z * 1.2, pane);
    let (scene, flat) = builder.build();
    let plan = crate::cases::plan(&scene, 1000);
    let points = [DVec3::new(0.4, 1.0, 1.0), DVec3::new(1.4, 0.3, 0.6), DVec3::new(1.2, 1.2, 0.5)];
    let oracle = Oracle::new(&scene, &flat).unwrap();
    let sampling = Sampling { paths: 60_000, ..SAMPLING };
    let paths = oracle.irradiance_vectors(&points, sampling, &Silent).unwrap();
    for (point, paths) in points.iter().zip(&paths) {
        // Small cells around the point: means over 10 cm.
        let bounds = Some((*point - 0.025, *point + 0.025));
        let bake = |seed| {
            let options =
                BakeOptions { dims: [2; 3], bounds, photons: 400_000, seed, ..BakeOptions::default() };
            let grid = bake(&scene, &flat, &plan, &options, &Silent).unwrap().grid;
            let mean = |h: usize, c: usize| {
                grid.vectors().iter().map(|v| f64::from(v[h][c][h / 2].abs())).sum::<f64>() / 8.0
            };
            core::array::from_fn::<f64, 18, _>(|n| mean(n / 3, n % 3))
        };
        let bakes: Vec<_> = (1..=8).map(bake).collect();
        for n in 0..18 {
            let (h, c) = (n / 3, n % 3);
            let mean = bakes.iter().map(|b| b[n]).sum::<f64>() / 8.0;
            let variance = bakes.iter().map(|b| (b[n] - mean).powi(2)).sum::<f64>() / 56.0;
            let (found, error) = (paths.vectors[h][c][h / 2].abs(), paths.standard_error[h][c][h / 2]);
            // Student's t with 7 degrees of freedom exceeds 8 with probability 1e-4; the mean over a cube of 10 cm is off
            // by its half side squared over 6 times three second derivatives of the order of the value over (0.5 m)².
            let bound = 8.0 * (variance + error * error).sqrt() + 0.02 * mean;
            assert!((mean - found).abs() < bound, "{point} {h} {c}: photons {mean}, paths {found} ± {error}");
            assert!(bound < 0.4 * mean, "not sharp: {point} {h} {c}: {bound} of {mean}");
        }
    }
}

/// Radiance of a small patch of albedo 1/2 that faces a disk, radius 1/2 and radiance 1, at a distance on its axis, seen by paths with
/// their standard error. With `mixtures`, a pane that changes nothing lies between the two, and paths are those of mixtures.
fn patch_before_a_disk(distance: f32, mixtures: bool) -> (f64, f64) {
    let mut builder = SceneBuilder::default();
    let grey = builder.material(0.5, 0.0, true);
    let lamp = builder.material(0.0, 1.0, false);
    let rim = |n: u32| {
        let angle = f64::from(n) / 512.0 * 2.0 * PI;
        (DVec3::new(libm::cos(angle), libm::sin(angle), 0.0) * 0.5).as_vec3()
    };
    (0..512).for_each(|n| builder.triangle([Vec3::ZERO, rim(n), rim(n + 1)], lamp));
    let size = 0.004 * distance;
    builder.quad(
        Vec3::new(-0.5, -0.5, 0.0) * size + Vec3::Z * distance,
        Vec3::X * size,
        Vec3::Y * size,
        grey,
    );
    if mixtures {
        let glass = Material {
            albedo: Vec3::ZERO,
            transmission: 1.0,
            refractive_index: 1.0,
            thin: true,
            ..Material::default()
        };
        let glass = builder.any_material(glass);
        builder.quad(Vec3::new(-9.0, -9.0, 0.5 * distance), Vec3::X * 18.0, Vec3::Y * 18.0, glass);
    }
    let (scene, flat) = builder.build();
    let oracle = Oracle::new(&scene, &flat).unwrap();
    let distance = f64::from(distance);
    let camera = Camera {
        eye: DVec3::new(0.2, 0.0, 0.7) * distance,
        target: DVec3::Z * distance,
        up: DVec3::Y,
        vertical_fov: 0.002,
    };
    let sampling = Sampling { paths: 1000, ..SAMPLING };
    let picture = oracle.render(&camera, (8, 8), Shown::All, sampling, &Silent).unwrap();
    let mut mean = Mean::<1>::default();
    picture.pixels.iter().for_each(|pixel| mean.add(&[f64::from(pixel[1])]));
    (mean.mean()[0], mean.standard_error()[0])
}

/// A disk of radius r and radiance L at distance h on its axis gives π L r² / (r² + h²). The lamp counts as near up to a quarter of
/// the root of its area, 0.22: so close to it that all, much, and none of what reaches the patch is met by chance.
#[test]
fn near_lights_are_met_by_chance_and_count_once() {
    for mixtures in [false, true] {
        for distance in [0.01, 0.1, 0.2, 0.3, 1.0] {
            let (found, error) = patch_before_a_disk(distance, mixtures);
            let h = f64::from(distance);
            let expected = 0.5 * 0.25 / (0.25 + h * h);
            // Five standard errors. 512 triangles lack 2.5e-5 of the disk's area; light at most 2e-3 h off the axis is the same to
            // its square.
            assert!(
                (found - expected).abs() < 5.0 * error + 1e-4 * expected,
                "{found} ± {error} for {expected} at {h}, mixtures {mixtures}"
            );
            // 64,000 paths. What is met by chance is the lamp's radiance or nothing, at most 1/2 apart from the mean. What is chosen
            // on the lamp is at most 16 times its radiance all around (where a near light ends), 1/π of that of each steradian
            // on average: their standard deviation is below four times the mean. Chosen at 0.01, it would be 25.
            assert!(error < 4.0 * expected / 64_000_f64.sqrt(), "{error} of {expected} at {h}");
        }
    }
}

/// A closed box that absorbs nothing but in its lamp: the radiance is the lamp's everywhere, however long the paths. The lamp has a
/// fortieth of all area: a fifth of the light has been reflected more often than paths go on without roulette between white walls.
#[test]
fn roulette_between_white_walls_keeps_the_mean() {
    for mixtures in [false, true] {
        let mut builder = SceneBuilder::default();
        let white = builder.material(1.0, 0.0, true);
        let lamp = builder.material(0.0, 1.0, true);
        builder.cuboid(Vec3::ZERO, Vec3::ONE, white, true);
        // 2 s² / (6 + 2 s²) = 1/40.
        let s = 0.277_35;
        builder.quad(Vec3::new(0.5 - 0.5 * s, 0.5 - 0.5 * s, 0.5), Vec3::X * s, Vec3::Y * s, lamp);
        if mixtures {
            let mirror =
                Material { specular: 1.0, albedo: Vec3::ZERO, roughness: 0.0, ..Material::default() };
            let mirror = builder.any_material(mirror);
            builder.quad(Vec3::new(0.1, 0.1, 0.2), Vec3::X * 0.2, Vec3::Y * 0.2, mirror);
        }
        let (scene, flat) = builder.build();
        let oracle = Oracle::new(&scene, &flat).unwrap();
        let camera = Camera {
            eye: DVec3::new(0.2, 0.3, 0.8),
            target: DVec3::new(0.9, 0.8, 0.4),
            up: DVec3::Z,
            vertical_fov: 1.2,
        };
        let sampling = Sampling { paths: 64, ..SAMPLING };
        let picture = oracle.render(&camera, (16, 16), Shown::All, sampling, &Silent).unwrap();
        let mut mean = Mean::<1>::default();
        picture.pixels.iter().for_each(|pixel| mean.add(&[f64::from(pixel[1])]));
        let (found, error) = (mean.mean()[0], mean.standard_error()[0]);
        // Five standard errors, which tell a loss of the light from beyond the first roulette: 8 %.
        assert!((found - 1.0).abs() < 5.0 * error, "{found} ± {error}, mixtures {mixtures}");
        assert!(error < 0.015, "{error}");
    }
}
