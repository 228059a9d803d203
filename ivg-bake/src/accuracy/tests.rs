use core::f64::consts::PI;
use std::sync::atomic::{AtomicU32, Ordering};

use glam::{DVec3, Vec3};
use ivg_grid::{IrradianceGrid, Quantity};
use ivg_scene::{FlatScene, LightKind, Scene};

use super::beyond;
use crate::cases::{SceneBuilder, plan};
use crate::estimate::held::{AXES, Linear};
use crate::{BakeError, BakeOptions, BakeResult, CONFIDENCE, EndedBy, Estimator, Monitor, Silent, bake};

/// A white block under an even sky: the irradiance of everything is π.
fn furnace() -> (Scene, FlatScene) {
    let mut builder = SceneBuilder::default();
    let white = builder.material(1.0, 0.0, true);
    builder.cuboid(Vec3::new(-0.3, -0.2, -0.4), Vec3::new(0.2, 0.3, 0.1), white, false);
    builder.sky(1.0);
    builder.build()
}

/// Two rooms, of which one gets its light through a door from the other.
fn two_rooms() -> (Scene, FlatScene) {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.6, 0.0, true);
    let lamp = builder.material(0.0, 10.0, false);
    builder.cuboid(Vec3::new(-1.0, 0.0, 0.0), Vec3::ONE, wall, true);
    builder.quad(Vec3::ZERO, Vec3::Y * 0.6, Vec3::Z, wall);
    builder.quad(Vec3::new(0.0, 0.6, 0.0), Vec3::Y * 0.4, Vec3::Z * 0.6, wall);
    builder.quad(Vec3::new(-0.7, 0.95, 0.3), Vec3::X * 0.4, Vec3::Z * 0.4, lamp);
    builder.build()
}

/// A coloured room with a block, lit by a spot.
fn room() -> (Scene, FlatScene) {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.7, 0.0, true);
    let block = builder.material(0.4, 0.0, true);
    builder.cuboid(Vec3::ZERO, Vec3::new(2.0, 1.5, 1.0), wall, true);
    builder.cuboid(Vec3::new(0.3, 0.0, 0.3), Vec3::new(0.8, 0.9, 0.7), block, false);
    builder.light(LightKind::Spot {
        position: DVec3::new(1.5, 1.4, 0.5),
        direction: Vec3::new(-0.3, -1.0, 0.0),
        intensity: Vec3::new(3.0, 2.0, 1.0),
        inner_angle: 0.5,
        outer_angle: 0.8,
    });
    builder.build()
}

/// Vertices well inside a room, or around a scene in the open.
fn inside(scene: &(Scene, FlatScene)) -> Option<(DVec3, DVec3)> {
    if scene.0.sky.is_some() {
        return Some((DVec3::splat(-0.9), DVec3::splat(0.9)));
    }
    let (min, max) = crate::stage::bounds(&scene.1).unwrap();
    Some((min.lerp(max, 0.1), min.lerp(max, 0.9)))
}

fn options() -> BakeOptions {
    BakeOptions { dims: [6, 5, 4], photons: u64::MAX, threads: Some(2), ..BakeOptions::default() }
}

fn baked(scene: &(Scene, FlatScene), options: &BakeOptions) -> BakeResult {
    bake(&scene.0, &scene.1, &plan(&scene.0, 200), options, &Silent).unwrap()
}

/// The numbers that errors are measured in, of the vertices that count.
fn axes(grid: &IrradianceGrid) -> Vec<[f64; AXES]> {
    let valid = (0..grid.vertex_count()).filter(|&vertex| grid.is_valid(vertex));
    match grid.quantity() {
        Quantity::Vectors => valid.map(|v| grid.vectors()[v].axes().map(f64::from)).collect(),
        Quantity::Radiance => valid.map(|v| grid.radiance()[v].axes().map(f64::from)).collect(),
    }
}

/// Two estimates of the truth whose errors are independent of each other, so that the product of the differences from them
/// has the squared error of a bake as its mean.
struct Truth([Vec<[f64; AXES]>; 2]);

impl Truth {
    fn gathered(scene: &(Scene, FlatScene), options: &BakeOptions) -> Self {
        let gather =
            |seed| BakeOptions { estimator: Estimator::Gather, seed, paths: 2048, ..options.clone() };
        Self([101, 102].map(|seed| axes(&baked(scene, &gather(seed)).grid)))
    }

    fn error(&self, grid: &IrradianceGrid) -> f64 {
        let [first, second] = &self.0;
        let (mut error, mut signal) = (0.0, 0.0);
        for ((x, a), b) in axes(grid).iter().zip(first).zip(second) {
            for n in 0..AXES {
                error += (x[n] - a[n]) * (x[n] - b[n]);
                signal += a[n] * b[n];
            }
        }
        (error.max(0.0) / signal).sqrt()
    }
}

/// Twenty seeds of three scenes: the true error must be within the bound in 95 % of them, and the bound must not be far above
/// the error.
#[test]
fn the_error_is_what_the_report_says_it_is_at_most() {
    let mut beyond_bound = Vec::new();
    for (name, scene) in [("furnace", furnace()), ("two rooms", two_rooms()), ("room", room())] {
        let options = BakeOptions { accuracy: Some(0.06), bounds: inside(&scene), ..options() };
        let truth = if name == "furnace" {
            let count = baked(&scene, &BakeOptions { photons: 1, accuracy: None, ..options.clone() });
            [(); 2].map(|()| vec![[PI; AXES]; count.stats.valid_vertices])
        } else {
            Truth::gathered(&scene, &BakeOptions { accuracy: None, ..options.clone() }).0
        };
        let truth = Truth(truth);
        let (mut reached, mut errors) = (0.0, 0.0);
        for seed in 1..=20 {
            let result = baked(&scene, &BakeOptions { seed, ..options.clone() });
            let report = result.accuracy.unwrap();
            assert!(report.holds() && report.ended_by == EndedBy::Accuracy, "{name}: {report:?}");
            let error = truth.error(&result.grid);
            if error > report.reached {
                beyond_bound.push((name, seed, error, report.reached));
            }
            reached += report.reached.powi(2);
            errors += error.powi(2);
        }
        let ratio = (reached / errors).sqrt();
        assert!((1.0..2.5).contains(&ratio), "{name}: bounds are {ratio} times the errors");
    }
    let allowed = (60.0 * (1.0 - CONFIDENCE)).round() as usize;
    assert!(beyond_bound.len() <= allowed, "{beyond_bound:?}");
}

/// A few vertices in a room: averaging over the cell is far from the light at the vertex, and photons cannot tell.
#[test]
fn bias_that_photons_cannot_remove_is_found_and_gathered_away() {
    let scene = room();
    let options = BakeOptions { dims: [3, 2, 2], bounds: inside(&scene), accuracy: Some(0.05), ..options() };
    let result = baked(&scene, &options);
    let report = result.accuracy.unwrap();
    assert!(report.gathered_biased > 0 && report.holds(), "{report:?}");
    let truth = Truth::gathered(&scene, &BakeOptions { accuracy: None, ..options.clone() });
    assert!(truth.error(&result.grid) < report.reached, "{report:?}");
    let photons = result.stats.photons;
    let without = baked(&scene, &BakeOptions { photons, accuracy: None, ..options });
    let error = truth.error(&without.grid);
    assert!(error > 0.05, "without gathering it is {error}, which noise alone would not show: {report:?}");
}

#[test]
fn vertices_that_are_not_gathered_hold_what_as_many_photons_give() {
    let scene = furnace();
    let bounds = inside(&scene);
    for quantity in [Quantity::Vectors, Quantity::Radiance] {
        let asked = BakeOptions { accuracy: Some(0.1), quantity, bounds, ..options() };
        let one = baked(&scene, &BakeOptions { threads: Some(1), ..asked.clone() });
        let three = baked(&scene, &BakeOptions { threads: Some(3), ..asked.clone() });
        assert_eq!(one, three, "threads do not matter");
        let report = one.accuracy.unwrap();
        assert_eq!((report.gathered_biased, report.gathered_noisy), (0, 0), "{report:?}");
        let plain = baked(&scene, &BakeOptions { accuracy: None, photons: one.stats.photons, ..asked });
        assert_eq!(plain.grid, one.grid);
        assert_eq!(plain.stats.absorbed, one.stats.absorbed);
    }
}

/// The second room is so dim that the grid's error does not show its noise.
#[test]
fn vertices_in_the_dim_room_are_gathered_if_photons_leave_them_noisy() {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.3, 0.0, true);
    let lamp = builder.material(0.0, 10.0, false);
    builder.cuboid(Vec3::new(-1.0, 0.0, 0.0), Vec3::ONE, wall, true);
    builder.quad(Vec3::ZERO, Vec3::Y, Vec3::Z * 0.97, wall);
    builder.quad(Vec3::new(-0.7, 0.95, 0.3), Vec3::X * 0.4, Vec3::Z * 0.4, lamp);
    let scene = builder.build();
    let options = BakeOptions { dims: [12, 6, 6], bounds: inside(&scene), accuracy: Some(0.04), ..options() };
    let result = baked(&scene, &options);
    let report = result.accuracy.unwrap();
    assert!(report.gathered_noisy > 0 && report.noisy == 0, "{report:?}");
    // Two thirds of a per cent of all photons get through the gap.
    let dim = |grid: &IrradianceGrid| -> f64 {
        let right = (0..grid.vertex_count()).filter(|&v| grid.lattice().coords(v as u64)[0] >= 6);
        right.filter(|&v| grid.is_valid(v)).map(|v| grid.vectors()[v].axes().map(f64::from)[0]).sum()
    };
    let gather = BakeOptions { estimator: Estimator::Gather, accuracy: None, paths: 16_384, ..options };
    let (found, truth) = (dim(&result.grid), dim(&baked(&scene, &gather).grid));
    // Each vertex is within 4 × 4 %, and there are many.
    assert!((found / truth - 1.0).abs() < 0.2, "{found} {truth}");
}

#[test]
fn caps_end_a_bake_early_and_the_report_says_so() {
    let scene = two_rooms();
    let result = baked(&scene, &BakeOptions { accuracy: Some(0.01), photons: 20_000, ..options() });
    let report = result.accuracy.unwrap();
    assert!(report.ended_by == EndedBy::Photons && !report.holds() && report.noise > 0.01, "{report:?}");
    assert!((19_969..=20_000).contains(&result.stats.photons));

    /// Has enough after so many questions.
    struct Hasty(AtomicU32);
    impl Monitor for Hasty {
        fn progress(&self, _: u64, _: u64) {}
        fn enough(&self) -> bool {
            self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1)).is_err()
        }
    }
    let asked = BakeOptions { accuracy: Some(0.01), ..options() };
    let hasty = Hasty(AtomicU32::new(3));
    let result = bake(&scene.0, &scene.1, &plan(&scene.0, 64), &asked, &hasty).unwrap();
    let report = result.accuracy.unwrap();
    assert!(report.ended_by == EndedBy::Monitor && report.batches == 6, "{report:?}");
    let plain = BakeOptions { photons: 10_000_000, ..options() };
    let hasty = Hasty(AtomicU32::new(0));
    let result = bake(&scene.0, &scene.1, &plan(&scene.0, 64), &plain, &hasty).unwrap();
    assert_eq!(result.stats.photons, 65_536);
}

/// Its time passes by being asked for.
struct Clock {
    asked: AtomicU32,
    until: u32,
}

impl Clock {
    fn until(until: u32) -> Self {
        Self { asked: AtomicU32::new(0), until }
    }
}

impl Monitor for Clock {
    fn progress(&self, _: u64, _: u64) {}
    fn time_spent(&self) -> Option<f64> {
        Some(f64::from(self.asked.fetch_add(1, Ordering::Relaxed)) / f64::from(self.until))
    }
}

/// Wherever a bake is stopped, it is stopped at once, and its report does not promise more than is there: not when bias has been
/// looked at in few places, and not when half of what is to be gathered has been.
#[test]
fn a_bake_whose_time_is_up_stops_where_it_is_and_says_what_is_known() {
    let scene = room();
    let options = BakeOptions { dims: [6, 4, 3], bounds: inside(&scene), accuracy: Some(0.015), ..options() };
    let options = BakeOptions { threads: Some(1), ..options };
    let truth = Truth::gathered(&scene, &BakeOptions { accuracy: None, ..options.clone() });
    let (mut unknown, mut known, mut partly) = (0, 0, 0);
    for until in [4, 8, 12, 16, 24, 40, 60, 90, 110, 130, 150, 170] {
        let clock = Clock::until(until);
        let result = bake(&scene.0, &scene.1, &plan(&scene.0, 200), &options, &clock).unwrap();
        let report = result.accuracy.unwrap();
        assert_eq!(report.ended_by, EndedBy::Monitor, "{report:?}");
        // Every vertex and every batch asks; a few questions more say that the time is still up.
        assert!(clock.asked.into_inner() < until + 12, "{until}: {report:?}");
        assert!(!report.holds(), "{report:?}");
        let error = truth.error(&result.grid);
        if report.bias.is_none() {
            unknown += 1;
            continue;
        }
        known += 1;
        partly += u32::from(report.gathered_biased > 0);
        assert!(error < report.reached, "{until}: {error} {report:?}");
    }
    assert!(unknown > 0 && known > 2 && partly > 0, "{unknown} {known} {partly}");
}

/// A grid that is path traced has a few paths everywhere before any vertex has all.
#[test]
fn paths_for_which_there_is_no_time_are_missing_here_and_there() {
    let scene = room();
    let options =
        BakeOptions { estimator: Estimator::Gather, bounds: inside(&scene), paths: 1024, ..options() };
    let all = baked(&scene, &options);
    assert_eq!(all.stats.rough_vertices, 0);
    // Each vertex asks twice: how much time has passed, and whether that is all.
    let half = Clock::until(all.stats.valid_vertices as u32);
    let some = bake(&scene.0, &scene.1, &plan(&scene.0, 200), &options, &half).unwrap();
    let (rough, valid) = (some.stats.rough_vertices, some.stats.valid_vertices);
    assert!(rough > valid / 4 && rough < 3 * valid / 4, "{rough} of {valid}");
    let (finished, rest): (Vec<usize>, Vec<usize>) = (0..some.grid.vertex_count())
        .filter(|&vertex| some.grid.is_valid(vertex))
        .partition(|&vertex| some.grid.vectors()[vertex] == all.grid.vectors()[vertex]);
    assert_eq!((finished.len(), rest.len()), (valid - rough, rough));
    assert!(rest.iter().all(|&vertex| some.grid.vectors()[vertex].axes().iter().any(|&x| x > 0.0)));
    let low = finished.iter().filter(|&&vertex| vertex < some.grid.vertex_count() / 2).count();
    assert!(low > finished.len() / 4 && low < 3 * finished.len() / 4, "{low} of {}", finished.len());
    let patient = Clock::until(u32::MAX);
    let same = bake(&scene.0, &scene.1, &plan(&scene.0, 200), &options, &patient).unwrap();
    assert_eq!(same.grid, all.grid, "a time that is not up changes nothing");
}

#[test]
fn gathered_grids_reach_the_accuracy_asked_for() {
    let scene = room();
    for quantity in [Quantity::Vectors, Quantity::Radiance] {
        let fixed = BakeOptions {
            estimator: Estimator::Gather,
            quantity,
            dims: [3; 3],
            bounds: inside(&scene),
            ..options()
        };
        let truth = Truth::gathered(&scene, &fixed);
        let asked = BakeOptions { accuracy: Some(0.05), paths: u32::MAX, ..fixed.clone() };
        let result = baked(&scene, &asked);
        let report = result.accuracy.clone().unwrap();
        assert!(report.holds() && report.ended_by == EndedBy::Accuracy, "{report:?}");
        let error = truth.error(&result.grid);
        assert!(error < report.reached && error > 0.2 * report.reached, "{error} {report:?}");
        assert_eq!(result, baked(&scene, &BakeOptions { threads: Some(1), ..asked.clone() }));
        let few = baked(&scene, &BakeOptions { paths: 512, accuracy: Some(0.01), ..asked }).accuracy.unwrap();
        assert!(few.ended_by == EndedBy::Photons && few.noisy > 0 && !few.holds(), "{few:?}");
    }
}

#[test]
fn accuracies_that_make_no_sense_are_refused() {
    let scene = furnace();
    let fails =
        |options: BakeOptions| bake(&scene.0, &scene.1, &plan(&scene.0, 8), &options, &Silent).unwrap_err();
    for asked in [0.0, -0.1, 1.0, f64::INFINITY] {
        assert_eq!(fails(BakeOptions { accuracy: Some(asked), ..options() }), BakeError::Accuracy { asked });
    }
    let error = fails(BakeOptions { accuracy: Some(f64::NAN), ..options() });
    assert!(matches!(error, BakeError::Accuracy { .. }));
    let error = fails(BakeOptions { accuracy: Some(0.1), photons: 31, ..options() });
    assert_eq!(error, BakeError::FewPhotons { photons: 31, least: 32 });
}

#[test]
fn all_looks_together_are_wrong_as_often_as_the_confidence_allows() {
    let all: f64 = (1..10_000).map(beyond).sum();
    assert!((all - (1.0 - CONFIDENCE)).abs() < 1e-5, "{all}");
}
