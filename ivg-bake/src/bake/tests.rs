use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DAffine3, DVec3, Vec3};
use ivg_grid::{Quantity, harmonics};
use ivg_scene::{FlatScene, LightKind, Scene};

use super::bake;
use crate::cases::{SceneBuilder, plan};
use crate::reference::{Oracle, Sampling};
use crate::{BakeError, BakeOptions, BakeResult, Estimator, Monitor, Silent};

/// An open room with a block in it, lit by a square and a point.
fn room() -> (Scene, FlatScene) {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.7, 0.0, true);
    let lamp = builder.material(0.0, 9.0, false);
    builder.cuboid(Vec3::ZERO, Vec3::new(2.0, 1.5, 1.0), wall, true);
    builder.cuboid(Vec3::new(0.3, 0.0, 0.3), Vec3::new(0.8, 0.9, 0.7), wall, false);
    builder.quad(Vec3::new(0.9, 1.45, 0.3), Vec3::X * 0.4, Vec3::Z * 0.4, lamp);
    builder
        .light(LightKind::Point { position: DVec3::new(1.7, 0.4, 0.8), intensity: Vec3::new(1.0, 0.5, 0.1) });
    builder.build()
}

fn options(photons: u64) -> BakeOptions {
    BakeOptions { dims: [7, 6, 5], photons, threads: Some(2), ..BakeOptions::default() }
}

fn baked(scene: &(Scene, FlatScene), options: &BakeOptions) -> BakeResult {
    bake(&scene.0, &scene.1, &plan(&scene.0, 32), options, &Silent).unwrap()
}

#[test]
fn one_two_and_five_threads_give_the_same_result() {
    let scene = room();
    let vectors = Estimator::ALL.map(|estimator| (estimator, Quantity::Vectors));
    let radiance = Estimator::ALL.into_iter().filter(|e| e.gives_radiance()).map(|e| (e, Quantity::Radiance));
    for (estimator, quantity) in vectors.into_iter().chain(radiance) {
        let [one, two, five] = [1, 2, 5].map(|threads| {
            let paths = 512;
            let threads = Some(threads);
            baked(&scene, &BakeOptions { estimator, quantity, threads, paths, ..options(20_000) })
        });
        assert!(one.grid.largest_component() > 0.0);
        assert_eq!(one, two, "{estimator:?} {quantity:?}");
        assert_eq!(one, five, "{estimator:?} {quantity:?}");
    }
}

#[test]
fn radiance_and_vectors_are_baked_from_the_same_photons() {
    let scene = room();
    let vectors = baked(&scene, &options(50_000));
    let radiance = baked(&scene, &BakeOptions { quantity: Quantity::Radiance, ..options(50_000) });
    assert_eq!(vectors.stats, radiance.stats);
    assert_eq!(vectors.grid.validity(), radiance.grid.validity());
    // The sum of opposite hemispheres is the net flux, the integral of L w: 2 √(π/3) times the coefficients of degree 1.
    let factor = (4.0 / 3.0 * std::f64::consts::PI).sqrt() as f32;
    for (vectors, radiance) in vectors.grid.vectors().iter().zip(radiance.grid.radiance()) {
        for channel in 0..3 {
            for (component, coefficient) in [3, 1, 2].into_iter().enumerate() {
                let flux = vectors[0][channel][component] + vectors[1][channel][component];
                let found = factor * radiance[channel][coefficient];
                // Some 50,000 deposits a vertex rounded to 2⁻²² of what a whole photon can add, and a few roundings of
                // vectors of up to 10 W/m² that cancel.
                assert!((flux - found).abs() < 2e-5, "{flux} {found}");
            }
        }
    }
}

/// Light is even, so that averaging over cells changes nothing and what is left is noise, whose size the spread over eight
/// seeds tells: eight standard errors, as in `cases`. L = ρ / (1 − ρ), so that the first coefficient is 2√π L and all
/// others vanish.
#[test]
fn radiance_of_a_furnace_is_its_first_coefficient() {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.6, 1.0, false);
    builder.cuboid(Vec3::ZERO, Vec3::ONE, wall, true);
    let scene = builder.build();
    let means: Vec<[f64; 9]> = (1..=8)
        .map(|seed| {
            let bounds = Some((DVec3::splat(0.2), DVec3::splat(0.8)));
            let quantity = Quantity::Radiance;
            let options = BakeOptions { dims: [4; 3], bounds, quantity, seed, ..options(20_000) };
            let result = bake(&scene.0, &scene.1, &plan(&scene.0, 1000), &options, &Silent).unwrap();
            let all = result.grid.radiance();
            core::array::from_fn(|n| all.iter().map(|r| f64::from(r[1][n])).sum::<f64>() / all.len() as f64)
        })
        .collect();
    for n in 0..9 {
        let mean = means.iter().map(|m| m[n]).sum::<f64>() / 8.0;
        let variance = means.iter().map(|m| (m[n] - mean).powi(2)).sum::<f64>() / 7.0;
        let expected = if n == 0 { 2.0 * std::f64::consts::PI.sqrt() * 0.6 / 0.4 } else { 0.0 };
        let bound = 8.0 * (variance / 8.0).sqrt();
        assert!((mean - expected).abs() < bound, "coefficient {n}: {mean} for {expected} within {bound}");
        assert!(bound < 0.04 * 5.3, "coefficient {n}: the bound {bound} means something");
    }
}

/// A lit wall 4 m away and 0.2 m wide: nearly a single direction, for which the ratios to the first coefficient are
/// those of the basis functions. From a corner of the cell to one of the wall is 3 degrees, which changes them by less than 0.01.
#[test]
fn light_from_one_side_has_the_signs_of_that_side() {
    for (axis, ones, squares) in [(0, 3, 0.968), (1, 1, -0.968), (2, 2, 0.0)] {
        for side in [1.0_f32, -1.0] {
            let mut builder = SceneBuilder::default();
            let white = builder.material(0.8, 0.0, true);
            let [along, u, v] = [0, 1, 2].map(|n| Vec3::AXES[(axis + n) % 3] * 0.2);
            builder.quad(along * (20.0 * side) - (u + v) * 0.5, u, v, white);
            let direction = along.normalize() * side;
            builder.light(LightKind::Spot {
                position: DVec3::ZERO,
                direction,
                intensity: Vec3::ONE,
                inner_angle: 0.02,
                outer_angle: 0.03,
            });
            let (scene, flat) = builder.build();
            let options = BakeOptions {
                dims: [1; 3],
                bounds: Some((DVec3::splat(-0.05), DVec3::splat(0.05))),
                quantity: Quantity::Radiance,
                ..options(200_000)
            };
            let result = bake(&scene, &flat, &plan(&scene, 4), &options, &Silent).unwrap();
            let radiance = result.grid.radiance()[0];
            let [first, ..] = radiance[0];
            assert!(first > 0.0);
            let ratio = |n: usize| radiance[0][n] / first;
            assert!((ratio(ones) - side * 3.0_f32.sqrt()).abs() < 0.01, "{axis} {side}: {radiance:?}");
            assert!((ratio(8) - 2.0 * squares).abs() < 0.01, "{axis} {side}: {radiance:?}");
            let facing = harmonics::irradiance(&radiance, direction).x;
            assert!(facing > 0.0 && harmonics::irradiance(&radiance, -direction).x < 0.1 * facing);
        }
    }
}

#[test]
fn the_seed_changes_the_result_and_nothing_else_does() {
    let scene = room();
    let first = baked(&scene, &options(5000));
    assert_eq!(first, baked(&scene, &options(5000)));
    let other = baked(&scene, &BakeOptions { seed: 2, ..options(5000) });
    assert_ne!(first.grid.vectors(), other.grid.vectors());
    assert_eq!(first.grid.validity(), other.grid.validity());
}

/// The scene a power of two larger: the same bytes (radiance is the same everywhere, so irradiance is too). Moved and scaled
/// by other numbers: positions are rounded anew, so a few photons go another way; all but a few vertices agree.
#[test]
fn scale_and_place_do_not_matter() {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.6, 1.0, false);
    builder.cuboid(Vec3::new(-0.75, -0.5, -0.25), Vec3::new(0.75, 0.5, 0.5), wall, true);
    let (scene, flat) = builder.build();
    let here = baked(&(scene.clone(), flat), &options(3000));
    for exponent in [-13, 20] {
        let scale = libm::scalbn(1.0, exponent);
        let mut scene = scene.clone();
        scene.nodes[0].transform = DAffine3::from_scale(DVec3::splat(scale));
        let flat = scene.flatten();
        let there = baked(&(scene, flat), &options(3000));
        assert_eq!(here.grid.vectors(), there.grid.vectors(), "scaled by 2^{exponent}");
        assert_eq!(here.grid.validity(), there.grid.validity());
    }
    let mut far = scene;
    far.nodes[0].transform = DAffine3::from_translation(DVec3::new(1_048_576.0, -524_288.0, 0.0));
    let flat = far.flatten();
    let there = baked(&(far, flat), &options(3000));
    let largest = here.grid.largest_component();
    for (a, b) in
        here.grid.vectors().iter().flatten().flatten().zip(there.grid.vectors().iter().flatten().flatten())
    {
        for (a, b) in a.iter().zip(b) {
            // A photon of 3000 that just misses an edge changes a vertex by its own share.
            assert!((a - b).abs() < 0.01 * largest, "{a} {b}");
        }
    }
}

#[test]
fn vertices_inside_solids_are_invalid_and_edges_through_walls_are_blocked() {
    let scene = room();
    let options = BakeOptions {
        dims: [21, 16, 11],
        bounds: Some((DVec3::ZERO, DVec3::new(2.0, 1.5, 1.0))),
        ..options(2000)
    };
    let result = baked(&scene, &options);
    let lattice = *result.grid.lattice();
    let (mut inside, mut free, mut walls) = (0, 0, 0);
    for index in 0..result.grid.vertex_count() {
        let at = lattice.coords(index as u64);
        let [i, j, k] = at;
        let p = DVec3::from(lattice.position(i, j, k));
        let block = |margin: f64| {
            p.cmpgt(DVec3::new(0.3, 0.0, 0.3) - margin).all()
                && p.cmplt(DVec3::new(0.8, 0.9, 0.7) + margin).all()
        };
        if block(-0.01) && j > 0 {
            assert_eq!(result.grid.validity()[index], 0, "{p} lies in the block");
            inside += 1;
        } else if !block(0.01) {
            assert!(result.grid.validity()[index] > 0, "{p} lies in the room");
            free += 1;
            walls += u32::from(at.iter().zip(lattice.dims).any(|(&c, n)| c == 0 || c + 1 == n));
        }
    }
    assert!(inside > 50 && free > 1000 && walls > 500, "{inside} {free} {walls}");
    // From beside the block into it, and along free air.
    let bits = |i: u16, j: u16, k: u16| result.grid.blocked_edges()[lattice.index(i, j, k) as usize];
    assert_eq!(bits(2, 4, 5) & 1, 0, "x = 0.2 to 0.3: a vertex on the block's face belongs to the room");
    assert_eq!(bits(3, 4, 5) & 1, 1, "x = 0.3 to 0.4: through the block's face");
    assert_eq!(bits(15, 8, 5), 0);
    // Invalid vertices hold no light.
    let dark = result.grid.vectors().iter().zip(result.grid.validity()).filter(|(_, v)| **v == 0);
    assert!(dark.flat_map(|(v, _)| v.as_flattened().as_flattened()).all(|&x| x == 0.0));
}

/// At vertices on walls, in edges and near the block, bakes must be as bright as the oracle: no dark seams, no leaks. Dual
/// cells average over half a step, so single vertices differ; the mean over all of them must not, by more than the averaging
/// (2 %) and noise (4 standard errors of the oracle, whose paths are the fewer).
#[test]
fn vertices_at_walls_are_as_bright_as_the_oracle() {
    let scene = room();
    let (low, high) = (DVec3::ZERO, DVec3::new(2.0, 1.5, 1.0));
    let options = BakeOptions { dims: [9, 7, 5], bounds: Some((low, high)), ..options(400_000) };
    let result = baked(&scene, &options);
    let lattice = *result.grid.lattice();
    let oracle = Oracle::new(&scene.0, &scene.1).unwrap();
    let mut chosen = Vec::new();
    let mut points = Vec::new();
    for index in (0..result.grid.vertex_count()).filter(|&index| result.grid.is_valid(index)) {
        let at = lattice.coords(index as u64);
        if at.iter().zip(lattice.dims).all(|(&c, n)| c > 0 && c + 1 < n) {
            continue;
        }
        let p = DVec3::from(lattice.position(at[0], at[1], at[2]));
        chosen.push(index);
        // Where a vertex on the bounds looks from: a 32nd of a step inside.
        points.push(p.clamp(low + DVec3::from(lattice.step) / 32.0, high - DVec3::from(lattice.step) / 32.0));
    }
    let sampling = Sampling { paths: 1024, seed: 5, threads: Some(2) };
    let truth = oracle.irradiance_vectors(&points, sampling, &Silent).unwrap();
    let (mut found, mut expected, mut variance) = (0.0, 0.0, 0.0);
    for (index, truth) in chosen.iter().zip(&truth) {
        for h in 0..6 {
            found += f64::from(result.grid.vectors()[*index][h][1][h / 2].abs());
            expected += truth.vectors[h][1][h / 2].abs();
            variance += truth.standard_error[h][1][h / 2].powi(2);
        }
    }
    assert!(chosen.len() > 100);
    let bound = 0.02 + 4.0 * variance.sqrt() / expected;
    assert!((found / expected - 1.0).abs() < bound, "{} within {bound}", found / expected);
    assert!(bound < 0.035);
}

#[test]
fn without_reflections_the_grid_is_dark_but_for_the_sky() {
    let (scene, flat) = room();
    let result = bake(&scene, &flat, &plan(&scene, 0), &options(1000), &Silent).unwrap();
    assert_eq!(result.grid.largest_component().to_bits(), 0);
    assert_eq!(result.stats.absorbed, DVec3::ZERO);
    assert!(result.stats.lights.iter().all(|light| !light.direct));
    let mut open = SceneBuilder::default();
    open.sky(2.0);
    let (scene, flat) = open.build();
    let bounds = Some((DVec3::ZERO, DVec3::ONE));
    let result =
        bake(&scene, &flat, &plan(&scene, 0), &BakeOptions { bounds, ..options(20_000) }, &Silent).unwrap();
    assert!(result.grid.largest_component() > 1.0);
    assert_eq!(result.stats.lights.len(), 1);
    assert!(result.stats.lights[0].direct);
}

#[test]
fn emitted_power_is_that_of_the_lights() {
    let (scene, flat) = room();
    let stats = bake(&scene, &flat, &plan(&scene, 8), &options(50_000), &Silent).unwrap().stats;
    let square = std::f64::consts::PI * 0.16 * 9.0;
    let point = 4.0 * std::f64::consts::PI;
    let expected = DVec3::splat(square) + DVec3::new(1.0, 0.5, 0.1) * point;
    // Two kinds of photons, of which one in 50,000 more or less shifts a share: five standard deviations.
    let share = square / (square + point);
    let sigma = (share * (1.0 - share) / 50_000.0).sqrt() * (square + point);
    assert!((stats.emitted - expected).abs().max_element() < 5.0 * sigma, "{} {expected}", stats.emitted);
    let spent = stats.absorbed + stats.escaped + stats.cut;
    assert!((stats.emitted - spent).abs().max_element() <= 1e-9 * stats.emitted.max_element());
}

#[test]
fn grids_of_one_and_two_vertices_an_axis_work() {
    let scene = room();
    for dims in [[1, 5, 4], [2, 2, 2], [1, 1, 1], [3, 1, 2]] {
        for estimator in Estimator::ALL {
            let result = baked(&scene, &BakeOptions { dims, estimator, paths: 512, ..options(4000) });
            assert!(result.grid.largest_component().is_finite(), "{dims:?}");
        }
    }
}

#[test]
fn unusable_input_is_an_error_that_names_it() {
    let (scene, flat) = room();
    let plan = plan(&scene, 8);
    let fails = |scene: &Scene, flat: &FlatScene, options: &BakeOptions| {
        bake(scene, flat, &plan, options, &Silent).unwrap_err()
    };
    assert_eq!(fails(&scene, &flat, &options(0)), BakeError::NoPhotons);
    assert!(matches!(fails(&scene, &flat, &options(u64::MAX)), BakeError::TooManyPhotons { bounces: 8, .. }));
    let zero = BakeOptions { dims: [0, 2, 2], ..options(10) };
    assert!(matches!(fails(&scene, &flat, &zero), BakeError::Lattice(_)));
    let huge = BakeOptions { dims: [65_535; 3], ..options(10) };
    assert!(matches!(fails(&scene, &flat, &huge), BakeError::Grid(_)));
    let upside_down = BakeOptions { bounds: Some((DVec3::ONE, DVec3::ZERO)), ..options(10) };
    assert!(matches!(fails(&scene, &flat, &upside_down), BakeError::Lattice(_)));

    for estimator in [Estimator::FaceCrossing, Estimator::FaceCrossingRr6983] {
        let quantity = Quantity::Radiance;
        let error = fails(&scene, &flat, &BakeOptions { estimator, quantity, ..options(10) });
        assert_eq!(error, BakeError::Quantity { estimator });
        assert!(error.to_string().contains("track-length"), "{error}");
    }

    let dark = {
        let mut scene = scene.clone();
        scene.materials[1].emission = Vec3::ZERO;
        scene.lights.clear();
        scene
    };
    assert_eq!(fails(&dark, &flat, &options(10)), BakeError::NoLight);
    for (value, named) in [(f32::NAN, "albedo"), (f32::INFINITY, "albedo"), (-0.5, "albedo"), (1.5, "albedo")]
    {
        let mut bad = scene.clone();
        bad.materials[0].albedo.y = value;
        let error = fails(&bad, &flat, &options(10)).to_string();
        assert!(error.contains("material 0") && error.contains(named), "{error}");
    }
    let mut bad = scene.clone();
    bad.lights[0].kind = LightKind::Point { position: DVec3::ZERO, intensity: Vec3::splat(f32::NAN) };
    assert!(fails(&bad, &flat, &options(10)).to_string().contains("light 0"));
    let mut broken = flat.clone();
    broken.positions[3].z = f32::NAN;
    let bounds = Some((DVec3::ZERO, DVec3::ONE));
    let error = fails(&scene, &broken, &BakeOptions { bounds, ..options(10) });
    assert!(error.to_string().contains("vertex 3"), "{error}");
    let mut broken = flat.clone();
    broken.triangles[2][1] = 9999;
    assert!(matches!(
        fails(&scene, &broken, &options(10)),
        BakeError::BadIndex { triangle: 2, index: 9999, .. }
    ));
    let mut broken = flat.clone();
    broken.triangle_materials[4] = 77;
    assert!(matches!(
        fails(&scene, &broken, &options(10)),
        BakeError::BadIndex { triangle: 4, index: 77, .. }
    ));
}

/// Cancels once so many photons are done.
struct Impatient {
    seen: AtomicU64,
    patience: u64,
}

impl Monitor for Impatient {
    fn progress(&self, done: u64, total: u64) {
        assert!(done <= total);
        self.seen.fetch_max(done, Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        self.seen.load(Ordering::Relaxed) >= self.patience
    }
}

#[test]
fn progress_reaches_the_end_and_cancelling_stops_early() {
    let (scene, flat) = room();
    let plan = plan(&scene, 8);
    let patient = Impatient { seen: AtomicU64::new(0), patience: u64::MAX };
    bake(&scene, &flat, &plan, &options(30_000), &patient).unwrap();
    assert_eq!(patient.seen.into_inner(), 30_000);
    let hasty = Impatient { seen: AtomicU64::new(0), patience: 5000 };
    let error = bake(&scene, &flat, &plan, &options(10_000_000), &hasty).unwrap_err();
    let BakeError::Cancelled { done, total: 10_000_000 } = error else { panic!("{error}") };
    assert!((5000..100_000).contains(&done), "{done}");
}

/// Quarters of a sky of different radiance, and a speck of dust: from the left half above 1 and below 2, from the right 3 and 4.
/// Each quarter gives the axis it is cut by π/2 of its radiance, across π/2 as well.
#[test]
fn the_image_of_a_sky_is_in_the_grid_and_the_oracle_finds_the_same() {
    let mut builder = SceneBuilder::default();
    let black = builder.material(0.0, 0.0, true);
    builder.cuboid(Vec3::splat(-1e-3), Vec3::splat(1e-3), black, false);
    builder.sky_image([1.0, 3.0, 2.0, 4.0]);
    let (scene, flat) = builder.build();
    let bounds = Some((DVec3::splat(0.1), DVec3::splat(0.5)));
    let options = BakeOptions { dims: [3; 3], bounds, photons: 200_000, ..BakeOptions::default() };
    let grid = bake(&scene, &flat, &plan(&scene, 8), &options, &Silent).unwrap().grid;
    let mean = |h: usize| {
        grid.vectors().iter().map(|v| f64::from(v[h][1][h / 2].abs())).sum::<f64>()
            / grid.vectors().len() as f64
    };
    let oracle = Oracle::new(&scene, &flat).unwrap();
    let sampling = Sampling { paths: 4096, seed: 1, threads: Some(2) };
    let found = oracle.light(&[DVec3::splat(0.3)], &[], sampling, &Silent).unwrap().remove(0);
    let half = 0.5 * core::f64::consts::PI;
    // +x, −x, +y (above), −y, +z, −z: sums of the two quarters on that side, of all four halves where all are.
    for (h, expected) in [7.0, 3.0, 4.0, 6.0, 5.0, 5.0].into_iter().enumerate() {
        let expected = expected * half;
        let path = found.vectors[h][1][h / 2].abs();
        // 4096 evenly spread directions: borders of the quarters are met to 1 %.
        assert!((path / expected - 1.0).abs() < 0.01, "{h}: {path} {expected}");
        // Some 20,000 photons cross the block of cells; weights vary by less than their mean: 5 / √20,000.
        assert!((mean(h) / expected - 1.0).abs() < 0.036, "{h}: {} {expected}", mean(h));
    }
    assert_eq!(scene.mean_sky(), Some(Vec3::splat(2.5)));
}

/// A white floor under the image of a sky: what it sends up is sampled light, once.
#[test]
fn a_floor_under_the_image_of_a_sky_is_lit_once() {
    let mut builder = SceneBuilder::default();
    let white = builder.material(0.8, 0.0, true);
    builder.quad(Vec3::new(-50.0, 0.0, -50.0), Vec3::Z * 100.0, Vec3::X * 100.0, white);
    builder.sky_image([1.0, 3.0, 0.0, 0.0]);
    let (scene, flat) = builder.build();
    let oracle = Oracle::new(&scene, &flat).unwrap();
    let sampling = Sampling { paths: 20_000, seed: 1, threads: Some(2) };
    let found = oracle.irradiance(&[(DVec3::Y * 0.1, Vec3::NEG_Y)], sampling, &Silent).unwrap()[0];
    // Radiosity 0.8 · π · 2; the floor's edge is 0.1 / 50 away from the horizon.
    let expected = 0.8 * core::f64::consts::PI * 2.0;
    let off = (found.irradiance.y - expected).abs();
    assert!(off < 5.0 * found.standard_error.y + 1e-4, "{found:?} {expected}");
    assert!(found.standard_error.y < 0.02 * expected);
}
