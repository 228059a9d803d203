use std::collections::HashMap;
use std::sync::LazyLock;

use glam::{DVec3, Vec3};

use super::*;
use crate::geometry::area_vector;

static SCENE: LazyLock<Scene> = LazyLock::new(scene);

fn mesh(name: &str) -> &'static Mesh {
    SCENE.meshes.iter().find(|m| m.name == name).unwrap_or_else(|| panic!("no mesh {name}"))
}

/// Joins vertices at the same place, so that sharp rims do not count as borders.
fn welded(mesh: &Mesh) -> Vec<[u32; 3]> {
    let mut first: HashMap<[u32; 3], u32> = HashMap::new();
    let remap: Vec<u32> = (mesh.positions.iter().zip(0..))
        .map(|(p, i)| *first.entry((*p + Vec3::ZERO).to_array().map(f32::to_bits)).or_insert(i))
        .collect();
    mesh.triangles.iter().map(|t| t.map(|i| remap[i as usize])).collect()
}

/// Each directed edge once, with its opposite; the triangles around each vertex form one fan.
fn assert_closed_manifold(triangles: &[[u32; 3]]) {
    let mut next: HashMap<(u32, u32), u32> = HashMap::new();
    for t in triangles {
        for k in 0..3 {
            let (a, b, c) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
            assert!(a != b, "degenerate triangle {t:?}");
            assert!(next.insert((a, b), c).is_none(), "edge {a}-{b} is used twice in one direction");
        }
    }
    let mut valence: HashMap<u32, usize> = HashMap::new();
    for &(a, b) in next.keys() {
        assert!(next.contains_key(&(b, a)), "edge {a}-{b} is on a border");
        *valence.entry(a).or_default() += 1;
    }
    for &(a, b) in next.keys() {
        // Turn once around a, from b; a second fan at the same vertex would not be reached.
        let (mut at, mut steps) = (b, 0);
        loop {
            at = next[&(a, at)];
            steps += 1;
            if at == b || steps > valence[&a] {
                break;
            }
        }
        assert_eq!(steps, valence[&a], "vertex {a} has more than one fan");
    }
}

fn volume(mesh: &Mesh) -> f64 {
    let corner = |i: u32| mesh.positions[i as usize].as_dvec3();
    mesh.triangles.iter().map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2]))) / 6.0).sum()
}

#[test]
fn the_scene_is_sound_lit_and_has_a_camera() {
    SCENE.check().unwrap();
    SCENE.require_light().unwrap();
    assert!(SCENE.camera.is_some());
    let names: Vec<&str> = SCENE.nodes.iter().map(|n| n.name.as_str()).collect();
    assert_eq!(names, ["box", "figure", "plinth", "block", "light"]);
}

#[test]
fn every_call_gives_the_same_scene() {
    assert_eq!(scene(), *SCENE);
}

#[test]
fn the_figure_is_detailed_welded_and_a_closed_manifold() {
    let figure = mesh("figure");
    assert!(figure.triangles.len() >= 100_000, "{} triangles", figure.triangles.len());
    assert_closed_manifold(&figure.triangles);
    assert!(volume(figure) > 0.05, "fronts point outwards");
}

#[test]
fn plinth_and_block_are_closed() {
    for name in ["plinth", "block"] {
        assert_closed_manifold(&welded(mesh(name)));
        assert!(volume(mesh(name)) > 0.0, "{name}: fronts point outwards");
    }
}

#[test]
fn shading_normals_of_the_figure_follow_its_faces() {
    let figure = mesh("figure");
    let mut against = 0;
    for t in &figure.triangles {
        let face = area_vector(t.map(|i| figure.positions[i as usize]));
        let shading: DVec3 = t.iter().map(|i| figure.normals[*i as usize].as_dvec3()).sum();
        against += usize::from(face.dot(shading) <= 0.0);
    }
    // Where two bodies meet at a sharp angle inside one cell, a face may turn away; that must stay a rare exception.
    assert!(against * 1000 <= figure.triangles.len(), "{against} of {}", figure.triangles.len());
}

#[test]
fn everything_stands_inside_the_box_and_the_wall_fronts_face_inwards() {
    let (min, max) = SCENE.bounds();
    assert_eq!((min, max), (DVec3::new(-0.5, 0.0, -0.5), DVec3::new(0.5, 1.0, 0.5)));
    let walls = mesh("box");
    let middle = Vec3::new(0.0, 0.5, 0.0);
    for t in &walls.triangles {
        let corners = t.map(|i| walls.positions[i as usize]);
        assert!(area_vector(corners).dot((middle - corners[0]).as_dvec3()) > 0.0);
    }
    let light = mesh("light");
    let corners = light.triangles[0].map(|i| light.positions[i as usize]);
    assert!(area_vector(corners).y < 0.0, "the lamp shines down");
}
