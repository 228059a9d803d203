use glam::Vec3;
use ivg_format::{EncodeOptions, Limits, encode};
use ivg_grid::{IrradianceGrid, Reconstruction, VertexValues};
use ivg_scene::{FlatScene, Scene};

use crate::cases::{SceneBuilder, plan};
use crate::reference::{Brightness, LitPlace, Oracle, Sampling, brightness_of};
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

/// A block a centimetre above the floor: a little light gets into the gap, and no camera. Between vertices 29 cm apart a grid
/// knows nothing about it, so that what it says there does not count; what it says between the block and the lamp does.
#[test]
fn places_that_nobody_sees_do_not_count() {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.7, 0.0, true);
    let lamp = builder.material(0.0, 10.0, false);
    builder.cuboid(Vec3::ZERO, Vec3::new(2.0, 1.5, 1.6), wall, true);
    builder.cuboid(Vec3::new(0.4, 0.01, 0.4), Vec3::new(1.6, 0.5, 1.2), wall, false);
    builder.quad(Vec3::new(0.8, 1.45, 0.6), Vec3::X * 0.5, Vec3::Z * 0.5, lamp);
    let scene = builder.build();
    let options = BakeOptions { dims: [8; 3], photons: 100_000, threads: Some(2), ..BakeOptions::default() };
    let grid = bake(&scene.0, &scene.1, &plan(&scene.0, 64), &options, &Silent).unwrap().grid;
    let oracle = Oracle::new(&scene.0, &scene.1).unwrap();
    let sampling = Sampling { paths: 64, seed: 5, threads: Some(2) };
    let found = oracle.lit_places(&grid, Reconstruction::ThreeVector, 2000, sampling, &Silent).unwrap();
    let in_gap = |place: &LitPlace| {
        let [x, y, z] = place.point.to_array();
        y < 0.011 && (0.4..1.6).contains(&x) && (0.4..1.2).contains(&z)
    };
    let hidden = found.iter().filter(|place| !place.seen && in_gap(place)).count();
    assert!(hidden > 20, "{hidden}");
    // Between the block and the lamp nothing is in the way.
    assert!(found.iter().filter(|place| (0.51..1.44).contains(&place.point.y)).all(|place| place.seen));
    // What they hold changes nothing.
    let mut brighter = found.clone();
    brighter.iter_mut().filter(|place| !place.seen).for_each(|place| place.baked *= 100.0);
    assert_eq!(brightness_of(&brighter, grid.lattice(), 2), brightness_of(&found, grid.lattice(), 2));
    brighter.iter_mut().for_each(|place| place.seen = true);
    assert_ne!(brightness_of(&brighter, grid.lattice(), 2), brightness_of(&found, grid.lattice(), 2));
}
