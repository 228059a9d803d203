use glam::DQuat;

use super::*;
use crate::{Mesh, Node};

/// A tetrahedron with outward fronts, its corners at the origin and on the axes.
fn tetrahedron() -> Mesh {
    Mesh {
        name: "tetrahedron".into(),
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
        triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        triangle_materials: vec![0; 4],
        ..Mesh::default()
    }
}

fn placed(mesh: Mesh, transforms: &[DAffine3]) -> Scene {
    Scene {
        meshes: vec![mesh],
        nodes: transforms.iter().map(|t| Node { name: "n".into(), mesh: 0, transform: *t }).collect(),
        materials: vec![Material::default()],
        ..Scene::default()
    }
}

fn volume(flat: &FlatScene) -> f64 {
    (0..flat.triangles.len())
        .map(|t| {
            let [a, b, c] = flat.corners(t).map(|c| c.as_dvec3());
            a.dot(b.cross(c)) / 6.0
        })
        .sum()
}

#[test]
fn mirrored_and_rotated_nodes_keep_their_fronts_outside() {
    for scale in
        [DVec3::ONE, DVec3::new(-1.0, 1.0, 1.0), DVec3::new(-2.0, -3.0, -0.5), DVec3::new(-1.0, -1.0, 2.0)]
    {
        let place = DAffine3::from_scale_rotation_translation(scale, DQuat::from_rotation_y(0.7), DVec3::ONE);
        let flat = placed(tetrahedron(), &[place]).flatten();
        let expected = scale.element_product().abs() / 6.0;
        // Eight roundings of f32 in coordinates of about 3, times an area of about 3.
        assert!((volume(&flat) - expected).abs() < 1e-5, "{scale}: {} instead of {expected}", volume(&flat));
    }
}

#[test]
fn given_normals_stay_perpendicular_under_uneven_mirrored_scale() {
    let mut mesh = tetrahedron();
    let slanted = Vec3::ONE.normalize();
    mesh.normals = vec![Vec3::NEG_ONE.normalize(), slanted, slanted, slanted];
    let scene = placed(mesh, &[DAffine3::from_scale(DVec3::new(-2.0, 1.0, 3.0))]);
    let flat = scene.flatten();
    // The slanted face is the last one; its corners' normals are its own.
    let face = flat.geometric_normal(3);
    for corner in flat.triangles[3] {
        let n = flat.normals[corner as usize];
        assert!((n - face).abs().max_element() < 1e-6, "{n} is not {face}");
    }
}

#[test]
fn a_scene_a_million_metres_away_is_the_same_to_f32() {
    let far = DVec3::new(1e6, -1e6, 1e6);
    let at_home = placed(tetrahedron(), &[DAffine3::IDENTITY]).flatten();
    let by_node = placed(tetrahedron(), &[DAffine3::from_translation(far)]).flatten();
    let by_origin = placed(Mesh { origin: far, ..tetrahedron() }, &[DAffine3::IDENTITY]).flatten();
    assert_eq!(by_node, by_origin);
    assert_eq!((by_node.origin, &by_node.positions), (at_home.origin + far, &at_home.positions));
    assert_eq!(by_node.normals, at_home.normals);
}

#[test]
fn power_of_two_scales_change_no_bit_of_the_shape() {
    let at_home = placed(tetrahedron(), &[DAffine3::from_translation(DVec3::new(5.1, 3.3, -9.7))]).flatten();
    for scale in [2f64.powi(-13), 2f64.powi(20)] {
        let matrix = DAffine3::from_scale(DVec3::splat(scale))
            * DAffine3::from_translation(DVec3::new(5.1, 3.3, -9.7));
        let flat = placed(tetrahedron(), &[matrix]).flatten();
        let back: Vec<Vec3> = flat.positions.iter().map(|p| *p / scale as f32).collect();
        assert_eq!((back, flat.normals), (at_home.positions.clone(), at_home.normals.clone()));
    }
}

#[test]
fn node_starts_tell_the_triangles_of_each_node() {
    let flat = placed(tetrahedron(), &[DAffine3::IDENTITY, DAffine3::from_translation(DVec3::X)]).flatten();
    assert_eq!(flat.node_starts, [0, 4, 8]);
    assert_eq!(flat.triangles[4], flat.triangles[0].map(|i| i + 4));
    assert_eq!(flat.uvs.len(), flat.positions.len());
    assert_eq!(flat.normals.len(), flat.positions.len());
}

#[test]
fn a_node_that_flattens_space_takes_its_normals_from_the_faces() {
    let mut mesh = tetrahedron();
    mesh.normals = vec![Vec3::Y; 4];
    let flat = placed(mesh, &[DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.0))]).flatten();
    assert!(flat.normals.iter().all(|n| n.is_finite() && (n.length() - 1.0).abs() < 1e-6));
    assert_eq!(flat.normals[1].abs(), Vec3::Z);
}

#[test]
fn emitters_radiate_pi_times_area_times_radiance_and_twice_on_two_sides() {
    let mut scene = placed(tetrahedron(), &[DAffine3::from_scale(DVec3::splat(2.0))]);
    scene.materials[0].emission = Vec3::new(1.0, 2.0, 0.0);
    scene.materials[0].two_sided = false;
    let flat = scene.flatten();
    let emitters: Vec<_> = flat.emitters(&scene).collect();
    assert_eq!(emitters.len(), 4);
    // The first face is a right triangle with legs of 2 m: 2 m².
    let one_sided = std::f64::consts::PI * 2.0;
    assert!((emitters[0].1 - DVec3::new(one_sided, 2.0 * one_sided, 0.0)).length() < 1e-12);
    scene.materials[0].two_sided = true;
    let doubled = flat.emitters(&scene).next().map(|e| e.1);
    assert_eq!(doubled, Some(2.0 * emitters[0].1));
}

#[test]
fn a_scene_without_triangles_has_empty_bounds() {
    let scene = Scene::default();
    assert_eq!(scene.bounds(), (DVec3::ZERO, DVec3::ZERO));
    assert_eq!(scene.flatten().node_starts, [0]);
}

#[test]
fn meshes_without_colours_are_white_among_others() {
    let mut scene = placed(tetrahedron(), &[DAffine3::IDENTITY]);
    assert!(scene.flatten().colours.is_empty());
    let colours = vec![[1, 2, 3, 4], [5, 6, 7, 8], [9, 10, 11, 12], [0; 4]];
    scene.meshes.push(Mesh { colours: colours.clone(), ..tetrahedron() });
    scene.nodes.extend([1, 0].map(|mesh| Node { mesh, ..scene.nodes[0].clone() }));
    let white = vec![[255; 4]; 4];
    assert_eq!(scene.flatten().colours, [white.clone(), colours, white].concat());
}
