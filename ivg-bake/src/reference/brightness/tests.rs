use glam::{DVec3, Vec3};
use ivg_format::{EncodeOptions, Lattice, Limits, encode};
use ivg_grid::{IrradianceGrid, Reconstruction, VertexValues};
use ivg_scene::{FlatScene, Scene};

use crate::cases::{SceneBuilder, plan};
use crate::reference::{Brightness, DARKEST, LitPlace, Oracle, Sampling, brightness_of};
use crate::sampling::rng::{Purpose, Stream};
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
    // Every look ends at a surface; those at the lamp, which reflects nothing, give no place. Points are even over V = 4.1 m³ of open
    // space and directions over the sphere, so a share of the integral of cos ℓ / (4π V) over the lamp and the hemisphere ends
    // there, ℓ the way there is up to the next surface. Below it is at most the room's diagonal, 2.97 m, which makes at most
    // 0.25 m² · π · 2.97 m / (4π V) = 4.5 %; above it is 0.05 m over the cosine, which makes 0.15 %. Of 2000 that is at most 94,
    // with a (binomial) standard deviation of 9.5, of which five are added.
    assert!((2000 - 94 - 48..2000).contains(&found.len()), "{}", found.len());
    assert_eq!(within(low, high), 0);
    // The gap has a tenth of all surfaces; its mouth is 0.04 m² of 17 m² that rays end at, which makes 5 of 2000.
    let gap = within(DVec3::new(low.x, -1.0, low.z), DVec3::new(high.x, 0.02, high.z));
    assert!((1..20).contains(&gap), "{gap}");
}

/// Places of a tenth more and of a tenth less light: the error is that of the mean of so many coins, and is what becomes of the mean
/// when others are drawn.
#[test]
fn the_error_is_that_of_other_places_and_paths() {
    let (grid, count) =
        (IrradianceGrid::new(Lattice::new([2; 3], [0.0; 3], [1.0; 3]).unwrap()).unwrap(), 1000);
    let stream = Stream::new(3, 0);
    let place = |n: u32| {
        let [coin, light, ..] = stream.uniforms(n, Purpose::View).map(f64::from);
        let traced = 1.0 + light;
        let baked = traced * if coin < 0.5 { 0.9 } else { 1.1 };
        LitPlace { point: DVec3::splat(0.5), normal: Vec3::Z, baked, traced, error: 0.0 }
    };
    let found = |draw: u32| {
        let places: Vec<_> = (0..count).map(|n| place(draw * count + n)).collect();
        brightness_of(&places, grid.lattice(), 1)[0]
    };
    let all: Vec<Brightness> = (0..200).map(found).collect();
    // The variance of a sum of t (±0.1) over the square of its mean: 0.01 <t²> / <t>², t even in [1, 2].
    let expected = 0.1 * (7.0f64 / 3.0).sqrt() / 1.5 / f64::from(count).sqrt();
    for part in &all {
        // <t²>/<t>² of 1000 places is known to less than 2 %.
        assert!((part.error / expected - 1.0).abs() < 0.05, "{part:?} for {expected}");
    }
    let spread = (all.iter().map(|part| (part.ratio - 1.0).powi(2)).sum::<f64>() / 200.0).sqrt();
    // A standard deviation of 200 draws is known to 1/20; four of them.
    assert!((spread / expected - 1.0).abs() < 0.2, "{spread} for {expected}");
    assert!(brightness_of(&[place(0)], grid.lattice(), 1)[0].error.is_infinite());
}

/// An error of a place so dark that a picture does not show it counts as little as one sees of it.
#[test]
fn what_a_picture_cannot_show_counts_little() {
    let bright =
        Brightness { low: DVec3::ZERO, high: DVec3::ONE, places: 1, traced: 0.5, error: 0.3, ratio: 1.0 };
    let part = |traced: f64, ratio: f64| Brightness { traced, ratio, ..bright }.off(1.0);
    assert!((part(0.5, 0.9) - 0.1).abs() < 1e-12);
    assert!((part(DARKEST, 1.1) - 0.1).abs() < 1e-12);
    assert!((part(DARKEST / 10.0, 2.0) - 0.1).abs() < 1e-12);
    let dark = Brightness { error: 0.5, traced: DARKEST / 10.0, ..bright };
    assert!((bright.off_error(1.0) - 0.3).abs() < 1e-12 && (dark.off_error(1.0) - 0.05).abs() < 1e-12);
    // A tenth of the darkest light that counts in full is one code of a picture whose mean is middle grey.
    let code = (12.92 * 255.0 * 0.18 * DARKEST / 10.0).round();
    assert!((code - 1.0).abs() < 1e-12);
}
