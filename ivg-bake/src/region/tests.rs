use glam::Vec3;

use super::{Mask, Region, Regions, SUB, SUB_CELLS};
use crate::accel::TraceScene;
use crate::dual::{Boxes, Line};
use crate::sampling::hemisphere::sphere;
use crate::sampling::rng::{Purpose, Stream};

const CORNER: [f32; 3] = [-400.0, -400.0, -400.0];
const STEP: [f32; 3] = [800.0; 3];

fn wall(x: f32) -> TraceScene {
    let p = |y: f32, z: f32| Vec3::new(x, y, z);
    let [a, b, c, d] = [p(-999.0, -999.0), p(999.0, -999.0), p(999.0, 999.0), p(-999.0, 999.0)];
    TraceScene::new(&[[a, b, c], [a, c, d]]).unwrap()
}

#[test]
fn a_wall_leaves_the_sub_cells_on_the_side_of_the_eye() {
    // Between layers 5 and 6, and in the middle of layer 5: what is cut does not count.
    for (x, layers) in [(200.0, 6), (150.0, 5), (101.0, 5), (99.0, 4)] {
        let scene = wall(x);
        let mask = Mask::seen(&scene, Vec3::new(-12.0, 3.0, 50.0), CORNER, STEP);
        assert_eq!(mask.count(), layers * 64, "wall at {x}");
        for at in 0..SUB {
            assert_eq!(mask.contains([at, 2, 7]), (at as u32) < layers);
            assert_eq!(mask.layer_count(0, at), if (at as u32) < layers { 64 } else { 0 });
            assert_eq!(mask.layer_count(1, at), layers * 8);
        }
        let behind = Mask::seen(&scene, Vec3::new(300.0, 0.0, 0.0), CORNER, STEP);
        assert!(behind.count_if(|at| mask.contains(at)) == 0, "no sub-cell counts on both sides");
    }
    assert_eq!(Mask::seen(&wall(900.0), Vec3::ZERO, CORNER, STEP).count(), SUB_CELLS);
}

#[test]
fn lengths_are_cut_where_sub_cells_do_not_count() {
    let mask = Mask::seen(&wall(101.0), Vec3::ZERO, CORNER, STEP);
    let regions = Regions::new([None, Some(mask), Some(Mask::NONE)].into_iter());
    let cells = Boxes { low: CORNER, step: STEP, count: [1; 3] };
    let length = |cell, origin: Vec3, direction: Vec3, to| {
        regions.get(cell).length(&cells, [0; 3], &Line::new(origin, direction), 0.0, to)
    };
    let origin = Vec3::new(-400.0, 30.0, 20.0);
    assert_eq!(length(0, origin, Vec3::X, 800.0), 800.0);
    assert!((length(1, origin, Vec3::X, 800.0) - 500.0).abs() < 1e-3);
    assert_eq!(length(2, origin, Vec3::X, 800.0), 0.0);
    // A third of the way up per way across.
    let slanted = Vec3::new(0.8, 0.6, 0.0);
    assert!((length(1, Vec3::new(-400.0, -399.0, 20.0), slanted, 900.0) - 625.0).abs() < 1e-2);
    assert_eq!(regions.get(0).share(), 1.0);
    assert_eq!(regions.get(1).share(), 5.0 / 8.0);
    assert_eq!(regions.get(2), Region::Nothing);
}

/// A wall across the corner of a cell leaves a part that is no box; its length along a line is that of its sub-cells.
#[test]
fn lengths_in_any_part_are_those_of_its_sub_cells() {
    let [a, b, c] = [Vec3::new(1500.0, 0.0, 0.0), Vec3::new(0.0, 1300.0, 0.0), Vec3::new(0.0, 0.0, 1700.0)];
    let wall = |p: Vec3| p - Vec3::splat(300.0);
    let scene = TraceScene::new(&[[wall(a), wall(b), wall(c)]]).unwrap();
    let mask = Mask::seen(&scene, Vec3::splat(-10.0), CORNER, STEP);
    assert!((1..SUB_CELLS).contains(&mask.count()));
    let regions = Regions::new([Some(mask)].into_iter());
    let cells = Boxes { low: CORNER, step: STEP, count: [1; 3] };
    let sub_cells = Boxes { low: CORNER, step: [100.0; 3], count: [SUB; 3] };
    for item in 0..200 {
        let u = Stream::new(2, item).uniforms(0, Purpose::Gather);
        let v = Stream::new(2, item).uniforms(1, Purpose::Gather);
        let direction = sphere([u[0], u[1]]);
        let origin = (Vec3::new(u[2], u[3], v[0]) - 0.5) * 790.0;
        let line = Line::new(origin, direction);
        let (mut inside, mut expected) = (0.0, 0f64);
        cells.walk(&line, 0.0, 600.0 * v[1], |_, _, to| inside = to);
        sub_cells.walk(&line, 0.0, inside, |at, t0, t1| {
            expected += if mask.contains(at) { f64::from(t1) - f64::from(t0) } else { 0.0 };
        });
        let length = regions.get(0).length(&cells, [0; 3], &line, 0.0, inside);
        // Some twenty distances below 1024, each rounded twice to 2^-15.
        assert!((f64::from(length) - expected).abs() < 2e-3, "{item}: {length} for {expected}");
    }
}
