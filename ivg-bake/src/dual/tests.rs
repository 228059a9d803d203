use glam::{DVec3, Vec3};
use ivg_format::Lattice;

use super::{Boxes, Line};
use crate::sampling::hemisphere::sphere;
use crate::sampling::rng::{Purpose, Stream};
use crate::space::Space;

fn boxes() -> Boxes {
    Boxes { low: [-3.0, 1.0, 0.5], step: [1.0, 0.5, 2.0], count: [5, 7, 3] }
}

/// Length of a ray inside one box, by clipping at its six planes in f64.
fn clipped(boxes: &Boxes, at: [usize; 3], origin: Vec3, direction: Vec3, to: f32) -> f64 {
    let (mut from, mut to) = (0f64, f64::from(to));
    for a in 0..3 {
        let low = f64::from(boxes.low[a]) + at[a] as f64 * f64::from(boxes.step[a]);
        let high = low + f64::from(boxes.step[a]);
        let (o, d) = (f64::from(origin[a]), f64::from(direction[a]));
        if d == 0.0 {
            if o < low || o >= high {
                return 0.0;
            }
            continue;
        }
        let (t0, t1) = ((low - o) / d, (high - o) / d);
        from = from.max(t0.min(t1));
        to = to.min(t0.max(t1));
    }
    (to - from).max(0.0)
}

#[test]
fn lengths_in_every_box_agree_with_clipping() {
    let boxes = boxes();
    for item in 0..400 {
        let u = Stream::new(1, item).uniforms(0, Purpose::Gather);
        let v = Stream::new(1, item).uniforms(1, Purpose::Gather);
        let origin = Vec3::new(u[0] * 9.0 - 5.0, u[1] * 6.0, u[2] * 9.0 - 1.0);
        let mut direction = sphere([v[0], v[1]]);
        // Some rays exactly along an axis or in a coordinate plane.
        match item % 10 {
            0 => direction = Vec3::X,
            1 => direction = Vec3::NEG_Y,
            2 => direction = direction.with_z(0.0).normalize(),
            _ => {}
        }
        let to = if v[2] < 0.3 { f32::INFINITY } else { v[3] * 8.0 };
        let mut lengths = vec![0f64; boxes.len()];
        boxes.walk(&Line::new(origin, direction), 0.0, to, |at, t0, t1| {
            assert!(t1 > t0);
            lengths[boxes.index(at)] += f64::from(t1) - f64::from(t0);
        });
        for (index, &length) in lengths.iter().enumerate() {
            let expected = clipped(&boxes, boxes.coords(index), origin, direction, to);
            // A few roundings of f32 at coordinates and distances below 16.
            assert!((length - expected).abs() < 2e-5, "box {index} of ray {item}: {length} for {expected}");
        }
    }
}

#[test]
fn nothing_is_visited_outside() {
    boxes().walk(&Line::new(Vec3::new(-9.0, 2.0, 2.0), Vec3::NEG_X), 0.0, f32::INFINITY, |_, _, _| {
        panic!("visited")
    });
    boxes().walk(&Line::new(Vec3::new(-9.0, 9.0, 2.0), Vec3::X), 0.0, f32::INFINITY, |_, _, _| {
        panic!("visited")
    });
    boxes().walk(&Line::new(Vec3::new(0.0, 2.0, 2.0), Vec3::X), 1.0, 1.0, |_, _, _| panic!("visited"));
}

#[test]
fn dual_cells_lie_around_the_vertices() {
    let lattice = Lattice::new([3, 1, 2], [0.0, 5.0, 1.0], [2.0, 5.5, 4.0]).unwrap();
    let space = Space::new(DVec3::ZERO, DVec3::splat(8.0));
    let cells = Boxes::dual_cells(&lattice, [1.0, 0.5, 1.0], space);
    assert_eq!(cells.count, [3, 1, 2]);
    for index in 0..6u16 {
        let at = cells.coords(usize::from(index));
        assert_eq!(cells.index(at), usize::from(index));
        let world: DVec3 = lattice.position(at[0] as u16, at[1] as u16, at[2] as u16).into();
        assert!((space.to_world(cells.middle(at)) - world).length() < 1e-6);
    }
    let metre = space.scale();
    assert!((cells.volume() / metre.powi(3) - 1.0 * 0.5 * 3.0).abs() < 1e-6);
}
