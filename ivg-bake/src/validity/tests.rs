use glam::{DVec3, Vec3};

use super::{Surroundings, directions, distances};
use crate::Silent;
use crate::cases::SceneBuilder;
use crate::dual::Boxes;
use crate::region::Region;
use crate::stage::{Effects, Stage};
use crate::workers::Workers;

/// A closed room from 0 to 1 m whose walls shine inwards (or not), and the surroundings of a lattice of `count` vertices an axis from `low` to `high`.
fn surroundings(lit: bool, low: f64, high: f64, count: usize) -> (Boxes, Surroundings) {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.7, if lit { 1.0 } else { 0.0 }, false);
    let lamp = builder.material(0.0, 1.0, false);
    builder.cuboid(Vec3::ZERO, Vec3::ONE, wall, true);
    // Outside, shining away from the room.
    builder.quad(Vec3::new(0.3, -0.9, 0.3), Vec3::X * 0.4, Vec3::Z * 0.4, lamp);
    let (scene, flat) = builder.build();
    let effects = Effects { textures: false, sky: false };
    let stage = Stage::new(&scene, &flat, effects, Some((DVec3::splat(-1.0), DVec3::splat(2.0)))).unwrap();
    let step = (high - low) / (count - 1) as f64;
    let metre = stage.space.scale();
    let cells = Boxes {
        low: stage.space.to_bake(DVec3::splat(low - 0.5 * step)).to_array(),
        step: [(step * metre) as f32; 3],
        count: [count; 3],
    };
    let workers = Workers { threads: 2, monitor: &Silent, total_photons: 0 };
    let found = Surroundings::new(&stage, &cells, &workers).unwrap();
    (cells, found)
}

#[test]
fn vertices_on_the_walls_belong_to_the_room() {
    let (cells, found) = surroundings(true, 0.0, 1.0, 5);
    for vertex in 0..cells.len() {
        let at = cells.coords(vertex);
        let walls = at.iter().filter(|&&c| c == 0 || c == 4).count();
        let share = found.regions.get(vertex).share();
        assert_eq!(share, 0.5f64.powi(walls as i32), "{at:?}");
        assert_eq!(found.validity[vertex], 255, "{at:?}");
        let Region::Part(mask) = found.regions.get(vertex) else { continue };
        for x in 0..8 {
            let inside = if at[0] == 0 { x >= 4 } else { at[0] != 4 || x < 4 };
            assert_eq!(mask.layer_count(0, x) > 0, inside, "{at:?} layer {x}");
        }
    }
    assert!(
        found.blocked_edges.iter().all(|&bits| bits == 0),
        "nothing is between vertices that look into the room"
    );
}

#[test]
fn vertices_outside_a_closed_room_are_invalid() {
    let (cells, found) = surroundings(true, -0.25, 1.25, 7);
    for vertex in 0..cells.len() {
        let outside = cells.coords(vertex).iter().any(|&c| c == 0 || c == 6);
        assert_eq!(found.validity[vertex] == 0, outside, "{:?}", cells.coords(vertex));
        assert_eq!(found.regions.get(vertex) == Region::Nothing, outside);
    }
    // From outside in, and back out; not along a wall.
    let bits = |i, j, k| found.blocked_edges[cells.index([i, j, k])];
    assert_eq!(bits(0, 3, 3) & 1, 1);
    assert_eq!(bits(5, 3, 3) & 1, 1);
    assert_eq!(bits(2, 3, 3) & 1, 0);
}

#[test]
fn where_no_light_reaches_darkness_is_valid() {
    let (cells, found) = surroundings(false, 0.2, 0.8, 4);
    assert!(found.validity.iter().all(|&v| v == 255), "{} vertices", cells.len());
}

#[test]
fn distances_are_in_steps_and_infinite_far_from_surfaces() {
    let cells = Boxes { low: [0.0; 3], step: [10.0, 20.0, 20.0], count: [4, 1, 1] };
    let wall = [Vec3::new(13.0, -99.0, -99.0), Vec3::new(13.0, 99.0, -99.0), Vec3::new(13.0, 0.0, 99.0)];
    let found = distances(&[wall], &cells);
    assert_eq!(found[0], f32::INFINITY);
    assert!((found[1] - 0.2).abs() < 1e-6);
    assert_eq!(found[2], f32::INFINITY);
}

#[test]
fn there_are_26_directions_axes_first() {
    let all: Vec<Vec3> = directions().collect();
    assert_eq!(all.len(), 26);
    assert!(all[..6].iter().all(|d| d.length() == 1.0));
    for (n, d) in all.iter().enumerate() {
        assert!(!all[..n].contains(d));
    }
}
