use std::sync::atomic::{AtomicU32, Ordering};

use glam::{DVec3, Vec3};
use ivg_grid::Quantity;
use ivg_scene::{FlatScene, Scene};

use super::{Accumulator, AccumulatorError, Shard, accumulate, fuzz_accumulator};
use crate::cases::{SceneBuilder, plan};
use crate::{BakeError, BakeOptions, BakeResult, Estimator, Monitor, Silent, bake};

fn room(albedo: f32) -> (Scene, FlatScene) {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(albedo, 0.0, true);
    let lamp = builder.material(0.0, 9.0, false);
    builder.cuboid(Vec3::ZERO, Vec3::new(2.0, 1.5, 1.0), wall, true);
    builder.quad(Vec3::new(0.9, 1.45, 0.3), Vec3::X * 0.4, Vec3::Z * 0.4, lamp);
    builder.build()
}

fn options() -> BakeOptions {
    BakeOptions { dims: [5, 4, 3], photons: 150_000, threads: Some(2), ..BakeOptions::default() }
}

fn part(scene: &(Scene, FlatScene), options: &BakeOptions, shard: Shard) -> Accumulator {
    accumulate(&scene.0, &scene.1, &plan(&scene.0, 8), options, (shard, None), &Silent, &mut |_| {}).unwrap()
}

fn baked(scene: &(Scene, FlatScene), options: &BakeOptions) -> BakeResult {
    bake(&scene.0, &scene.1, &plan(&scene.0, 8), options, &Silent).unwrap()
}

fn shards(scene: &(Scene, FlatScene), options: &BakeOptions, count: u32) -> Vec<Accumulator> {
    (1..=count).map(|index| part(scene, options, Shard { index, count })).collect()
}

#[test]
fn shards_through_files_give_the_bake_bit_for_bit() {
    let scene = room(0.7);
    for quantity in [Quantity::Vectors, Quantity::Radiance] {
        let options = BakeOptions { quantity, ..options() };
        let whole = baked(&scene, &options);
        for count in [1, 2, 5] {
            let mut parts: Vec<_> = shards(&scene, &options, count)
                .iter()
                .map(|part| Accumulator::from_bytes(&part.to_bytes()).unwrap())
                .collect();
            parts.reverse();
            assert_eq!(Accumulator::merge(parts).unwrap().finish().unwrap(), whole, "{quantity:?} {count}");
        }
    }
}

/// Has enough at the second question.
struct Once(AtomicU32);

impl Monitor for Once {
    fn progress(&self, _: u64, _: u64) {}
    fn enough(&self) -> bool {
        self.0.fetch_add(1, Ordering::Relaxed) == 1
    }
}

#[test]
fn what_was_saved_or_stopped_can_be_resumed_and_extended() {
    let scene = room(0.7);
    let whole = baked(&scene, &options());
    let plan = plan(&scene.0, 8);
    let go = |from, photons, monitor: &dyn Monitor, saved: &mut Vec<Accumulator>| {
        let options = BakeOptions { photons, ..options() };
        let mut save = |a: &Accumulator| saved.push(a.clone());
        accumulate(&scene.0, &scene.1, &plan, &options, (Shard::ALL, from), monitor, &mut save).unwrap()
    };
    let mut saved = Vec::new();
    let stopped = go(None, 150_000, &Once(AtomicU32::new(0)), &mut saved);
    assert!(!stopped.is_complete() && saved.len() == 2);
    assert!(matches!(
        stopped.clone().finish(),
        Err(BakeError::Accumulator(AccumulatorError::Incomplete { traced: 131_072, photons: 150_000, .. }))
    ));
    for from in [saved[0].clone(), stopped] {
        assert_eq!(go(Some(from), 150_000, &Silent, &mut Vec::new()).finish().unwrap(), whole);
    }
    let shorter = go(None, 100_001, &Silent, &mut Vec::new());
    assert_eq!(go(Some(shorter), 150_000, &Silent, &mut Vec::new()).finish().unwrap(), whole);
}

#[test]
fn what_does_not_belong_together_is_refused_by_name() {
    let scene = room(0.7);
    let small = BakeOptions { photons: 10_000, ..options() };
    let [first, second] = <[Accumulator; 2]>::try_from(shards(&scene, &small, 2)).unwrap();
    let refused = |other: Accumulator| Accumulator::merge(vec![first.clone(), other]).unwrap_err();
    let two = Shard { index: 2, count: 2 };
    assert_eq!(refused(part(&room(0.6), &small, two)), AccumulatorError::Scene);
    let differs = |options: &BakeOptions, bounces| {
        let plan = plan(&scene.0, bounces);
        let other = accumulate(&scene.0, &scene.1, &plan, options, (two, None), &Silent, &mut |_| {});
        refused(other.unwrap()).to_string()
    };
    let grid = differs(&BakeOptions { dims: [5; 3], ..small.clone() }, 8);
    assert!(grid.contains("different numbers of vertices: ") && grid.ends_with(" and 5x5x5"), "{grid}");
    let reflections = differs(&small, 7);
    assert!(reflections.ends_with("different numbers of reflections: 8 and 7"), "{reflections}");
    let bounds = BakeOptions { bounds: Some((DVec3::splat(0.25), DVec3::splat(0.75))), ..small.clone() };
    assert!(differs(&bounds, 8).contains("different first vertices [m]: "), "{}", differs(&bounds, 8));
    let seeded = part(&scene, &BakeOptions { seed: 9, ..small.clone() }, two);
    assert_eq!(refused(seeded), AccumulatorError::Seed { seeds: [1, 9] });
    let longer = part(&scene, &BakeOptions { photons: 20_000, ..small.clone() }, two);
    assert!(matches!(refused(longer), AccumulatorError::Division { .. }));
    let mut old = second.clone();
    old.head.release ^= 1;
    assert_eq!(refused(old), AccumulatorError::Release);
    assert_eq!(refused(first.clone()), AccumulatorError::Twice { index: 1, count: 2 });
    assert_eq!(
        Accumulator::merge(vec![second]).unwrap_err(),
        AccumulatorError::Missing { index: 1, count: 2 }
    );
    let plan = plan(&scene.0, 8);
    let fails = |options: &BakeOptions, shard, from| {
        accumulate(&scene.0, &scene.1, &plan, options, (shard, from), &Silent, &mut |_| {}).unwrap_err()
    };
    let gather = BakeOptions { estimator: Estimator::Gather, ..small.clone() };
    assert_eq!(fails(&gather, Shard::ALL, None), BakeError::NotAccumulated);
    let none = Shard { index: 3, count: 2 };
    assert_eq!(fails(&small, none, None), AccumulatorError::Shard { index: 3, count: 2 }.into());
    let other = fails(&small, Shard::ALL, Some(first.clone()));
    assert_eq!(other, AccumulatorError::OtherShard { index: 1, count: 2 }.into());
}

/// Every byte is covered by a checksum, and a length is believed only when the bytes are there.
#[test]
fn damaged_files_are_refused() {
    let scene = room(0.7);
    let small = BakeOptions { dims: [2, 2, 1], photons: 3000, ..options() };
    let bytes = part(&scene, &small, Shard::ALL).to_bytes();
    for at in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0x10;
        assert!(Accumulator::from_bytes(&damaged).is_err(), "byte {at}");
        fuzz_accumulator(&damaged);
    }
    for length in (0..bytes.len()).step_by(7) {
        assert!(Accumulator::from_bytes(&bytes[..length]).is_err(), "{length} bytes");
    }
    let longer = [&bytes[..], &[0]].concat();
    assert!(Accumulator::from_bytes(&longer).is_err());
    fuzz_accumulator(&bytes);
}
