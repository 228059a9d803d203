use glam::Vec3;

use super::{Found, Kind, Preset, Tree, flights};
use crate::BakeOptions;
use crate::cases::{SceneBuilder, plan};

fn room() -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.6, 1.0, false);
    let box_in_it = builder.material(0.3, 0.0, false);
    builder.cuboid(Vec3::splat(-1.0), Vec3::ONE, wall, true);
    builder.cuboid(Vec3::splat(-0.3), Vec3::splat(0.4), box_in_it, false);
    builder
}

#[test]
fn flights_start_at_surfaces_and_all_trees_find_the_same_ends() {
    let (scene, flat) = room().build();
    let options = BakeOptions { photons: 1000, ..BakeOptions::default() };
    let flights = flights(&scene, &flat, &plan(&scene, 8), &options, 700).unwrap();
    assert_eq!((flights.rays.len(), flights.triangles.len()), (700, 24));
    let found = |kind, preset| -> Vec<Option<Found>> {
        Tree::new(&flights.triangles, kind, preset).unwrap().closest_hits(&flights.rays)
    };
    let expected = found(Kind::Wide, Preset::Medium);
    assert!(expected.iter().all(Option::is_some), "the room is closed");
    for kind in [Kind::Wide, Kind::Binary] {
        for preset in [Preset::Fast, Preset::Medium, Preset::VerySlow] {
            assert_eq!(found(kind, preset), expected, "{kind:?} {preset:?}");
        }
    }
    // A reflection starts where the photon arrived: off a surface by no more than rounding.
    let reach = flights.triangles.iter().flatten().fold(0f32, |reach, p| reach.max(p.abs().max_element()));
    for ray in &flights.rays {
        let off = flights.triangles.iter().map(|t| {
            let normal = (t[1] - t[0]).cross(t[2] - t[0]).normalize();
            (ray.origin - t[0]).dot(normal).abs()
        });
        assert!(off.fold(f32::INFINITY, f32::min) < 1e-4 * reach, "{ray:?}");
        assert!((ray.direction.length() - 1.0).abs() < 1e-5, "{ray:?}");
    }
}
