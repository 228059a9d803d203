use glam::{DVec3, Vec3};
use ivg_format::{EncodeOptions, Limits, encode};
use ivg_grid::{IrradianceGrid, Reconstruction, VertexValues};
use ivg_scene::{FlatScene, Scene};

use crate::cases::{SceneBuilder, plan};
use crate::reference::{Brightness, DARKEST, LitPlace, Oracle, Sampling};
use crate::{BakeOptions, Silent, bake};

/// A room with a block on its floor, lit from its ceiling.
fn room() -> (Scene, FlatScene) {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.7, 0.0, true);
    let block = builder.material(0.4, 0.0, true);
    let lamp = builder.material(0.0, 10.0, false);
    builder.cuboid(Vec3::ZERO, Vec3::new(2.0, 1.5, 1.6), wall, true);
    builder.cuboid(Vec3::new(0.3, 0.0, 0.3), Vec3::new(0.9, 0.8, 0.9), block, false);
    builder.quad(Vec3::new(0.8, 1.45, 0.6), Vec3::X * 0.5, Vec3::Z * 0.5, lamp);
    builder.build()
}

fn compared(scene: &(Scene, FlatScene), grid: &IrradianceGrid, places: usize) -> Vec<Brightness> {
    let oracle = Oracle::new(&scene.0, &scene.1).unwrap();
    let sampling = Sampling { paths: 64, seed: 5, threads: Some(2) };
    oracle.brightness(grid, Reconstruction::ThreeVector, (places, 2), sampling, &Silent).unwrap()
}

/// A picture from the grid is as bright as a path-traced one: the mean ratio within 2 %, no region off by more than 10 %.
/// Through a file in the default encoding, as clients get it.
#[test]
fn surfaces_lit_from_a_grid_are_as_bright_as_path_traced_ones() {
    let scene = room();
    let options =
        BakeOptions { dims: [16; 3], photons: 1_000_000, threads: Some(2), ..BakeOptions::default() };
    let grid = bake(&scene.0, &scene.1, &plan(&scene.0, 64), &options, &Silent).unwrap().grid;
    let file = encode(&grid.as_source(), &EncodeOptions::new()).unwrap();
    let (decoded, _) = IrradianceGrid::from_file(&file, &Limits::default()).unwrap();
    let all = compared(&scene, &decoded, 2000);
    let (whole, parts) = all.split_first().unwrap();
    assert_eq!(parts.len(), 8);
    assert!(whole.error < 0.004 && (whole.ratio - 1.0).abs() < 0.02, "{whole:?}");
    for part in parts {
        assert!(part.error < 0.02 && (part.ratio - 1.0).abs() < 0.10, "{part:?}");
    }
}

/// Half of the light is half as bright, everywhere; and a part as bright as it should be does not hide one that is not.
#[test]
fn what_is_too_dark_shows() {
    let scene = room();
    let options = BakeOptions { dims: [8; 3], photons: 100_000, threads: Some(2), ..BakeOptions::default() };
    let grid = bake(&scene.0, &scene.1, &plan(&scene.0, 64), &options, &Silent).unwrap().grid;
    let right = compared(&scene, &grid, 300);
    let darker = |factor: &dyn Fn(usize) -> f32| {
        let mut darker = grid.clone();
        for vertex in 0..grid.vertex_count() {
            let shared = grid.vectors()[vertex].map(|h| h.map(|c| c.map(|x| x * factor(vertex))));
            darker.set(vertex, VertexValues::Vectors(shared));
        }
        compared(&scene, &darker, 300)
    };
    for (right, half) in right.iter().zip(darker(&|_| 0.5)) {
        assert!((half.ratio / right.ratio - 0.5).abs() < 1e-5, "{half:?}");
    }
    // The lower half of the layers across z.
    let below = darker(&|vertex| if vertex < 4 * 64 { 0.5 } else { 1.0 });
    let off = |a: &Brightness, b: &Brightness| (a.ratio / b.ratio - 1.0).abs();
    let farthest = below[1..].iter().zip(&right[1..]).map(|(a, b)| off(a, b)).fold(0.0, f64::max);
    assert!(farthest > 0.4 && off(&below[0], &right[0]) < 0.4, "{below:?}");
}

/// A block a centimetre above the floor: a little light gets into the gap, and one sees as much of it as one can from outside; none
/// into the block, and one sees nothing there.
#[test]
fn places_that_nobody_sees_do_not_count() {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.7, 0.0, true);
    let lamp = builder.material(0.0, 10.0, false);
    let (low, high) = (Vec3::new(0.4, 0.01, 0.4), Vec3::new(1.6, 0.5, 1.2));
    builder.cuboid(Vec3::ZERO, Vec3::new(2.0, 1.5, 1.6), wall, true);
    builder.cuboid(low, high, wall, false);
    builder.quad(Vec3::new(0.8, 1.45, 0.6), Vec3::X * 0.5, Vec3::Z * 0.5, lamp);
    let scene = builder.build();
    let options = BakeOptions { dims: [8; 3], photons: 100_000, threads: Some(2), ..BakeOptions::default() };
    let grid = bake(&scene.0, &scene.1, &plan(&scene.0, 64), &options, &Silent).unwrap().grid;
    let oracle = Oracle::new(&scene.0, &scene.1).unwrap();
    let sampling = Sampling { paths: 8, seed: 5, threads: Some(2) };
    let found = oracle.lit_places(&grid, Reconstruction::ThreeVector, 2000, sampling, &Silent).unwrap();
    let (low, high) = (low.as_dvec3(), high.as_dvec3());
    let within = |low: DVec3, high: DVec3| {
        let inside = |place: &&LitPlace| place.point.cmpgt(low).all() && place.point.cmplt(high).all();
        found.iter().filter(inside).count()
    };
    // Every look ends at a surface, some of them at the lamp, which reflects nothing.
    assert!((1800..=2000).contains(&found.len()), "{}", found.len());
    assert_eq!(within(low, high), 0);
    // The gap has a tenth of all surfaces; its mouth is 0.04 m² of 17 m² that rays end at, which makes 5 of 2000.
    let gap = within(DVec3::new(low.x, -1.0, low.z), DVec3::new(high.x, 0.02, high.z));
    assert!((1..20).contains(&gap), "{gap}");
}

/// An error of a place so dark that a picture does not show it counts as little as one sees of it.
#[test]
fn what_a_picture_cannot_show_counts_little() {
    let part = |traced: f64, ratio: f64| {
        Brightness { low: DVec3::ZERO, high: DVec3::ONE, places: 1, traced, error: 0.0, ratio }.off(1.0)
    };
    assert!((part(0.5, 0.9) - 0.1).abs() < 1e-12);
    assert!((part(DARKEST, 1.1) - 0.1).abs() < 1e-12);
    assert!((part(DARKEST / 10.0, 2.0) - 0.1).abs() < 1e-12);
    // A tenth of the darkest light that counts in full is one code of a picture whose mean is middle grey.
    let code = (12.92 * 255.0 * 0.18 * DARKEST / 10.0).round();
    assert!((code - 1.0).abs() < 1e-12);
}
