use glam::{DVec3, Vec3};
use ivg_scene::LightKind;

use super::{Surroundings, directions, distances};
use crate::Silent;
use crate::cases::SceneBuilder;
use crate::dual::Boxes;
use crate::region::{Part, Region};
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
    let effects = Effects { textures: false, sky: false, mirrors: false, glass: false };
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
        let Region::Part(Part { mask, .. }) = found.regions.get(vertex) else { continue };
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

/// Validity at the middle of a cube of 0.4 m, its faces wound outwards, with a hole of `hole` m in its top.
fn in_a_cube(hole: f32, builder: SceneBuilder) -> u8 {
    let mut builder = builder;
    let wall = builder.material(0.7, 0.0, true);
    let (low, high) = (Vec3::splat(0.3), Vec3::splat(0.7));
    let (x, y, z) = (Vec3::X * 0.4, Vec3::Y * 0.4, Vec3::Z * 0.4);
    for (corner, u, v) in [(low, y, x), (low, z, y), (low, x, z), (high, -y, -z), (high, -x, -y)] {
        builder.quad(corner, u, v, wall);
    }
    // The top, in two strips beside the hole and two at its ends.
    let (near, far) = (0.2 - 0.5 * hole, 0.2 + 0.5 * hole);
    let strip = |builder: &mut SceneBuilder, x0: f32, x1: f32, z0: f32, z1: f32| {
        let corner = low + y + Vec3::new(x0, 0.0, z0);
        builder.quad(corner, Vec3::Z * (z1 - z0), Vec3::X * (x1 - x0), wall);
    };
    strip(&mut builder, 0.0, near, 0.0, 0.4);
    strip(&mut builder, far, 0.4, 0.0, 0.4);
    if hole > 0.0 {
        strip(&mut builder, near, far, 0.0, near);
        strip(&mut builder, near, far, far, 0.4);
    }
    let (scene, flat) = builder.build();
    let effects = Effects { textures: false, sky: scene.sky.is_some(), mirrors: false, glass: false };
    let bounds = Some((DVec3::ZERO, DVec3::ONE));
    let stage = Stage::new(&scene, &flat, effects, bounds).unwrap();
    let metre = stage.space.scale();
    let cells = Boxes {
        low: stage.space.to_bake(DVec3::splat(-0.25)).to_array(),
        step: [(0.5 * metre) as f32; 3],
        count: [3; 3],
    };
    let workers = Workers { threads: 2, monitor: &Silent, total_photons: 0 };
    Surroundings::new(&stage, &cells, &workers).unwrap().validity[cells.index([1, 1, 1])]
}

#[test]
fn inside_a_model_with_a_hole_is_inside() {
    let mut outdoors = SceneBuilder::default();
    outdoors.sky(1.0);
    assert_eq!(in_a_cube(0.1, outdoors), 0, "a little light through a hole does not make it outside");
}

#[test]
fn a_room_wound_outwards_is_a_room() {
    let mut lit = SceneBuilder::default();
    lit.light(LightKind::Point { position: DVec3::new(0.4, 0.6, 0.5), intensity: Vec3::ONE });
    assert_ne!(in_a_cube(0.0, lit), 0, "all light, although it sees nothing but backs");
}
