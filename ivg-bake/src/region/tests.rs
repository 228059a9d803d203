use glam::Vec3;

use super::{Mask, Region, Regions, SUB, SUB_CELLS};
use crate::accel::TraceScene;
use crate::dual::Boxes;

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
        regions.get(cell).length(&cells, [0; 3], origin, direction, 0.0, to)
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
