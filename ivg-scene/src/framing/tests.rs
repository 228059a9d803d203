use glam::{DAffine3, Vec3};

use super::*;
use crate::{Material, Mesh, Node};

/// A box of the given size with fronts inside, without the sides (as in DIRECTIONS) that are named, around `centre`.
fn room(size: DVec3, centre: DVec3, without: &[usize]) -> Scene {
    let mut mesh = Mesh::default();
    for (side, outwards) in DIRECTIONS.iter().enumerate().filter(|(side, _)| !without.contains(side)) {
        let normal = -outwards.as_vec3();
        let u = if side / 2 == 1 { Vec3::Z } else { Vec3::Y };
        let v = normal.cross(u);
        let base = mesh.positions.len() as u32;
        let half = 0.5 * size.as_vec3();
        mesh.positions.extend([-u - v, u - v, u + v, -u + v].map(|p| (p - normal) * half));
        mesh.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
    }
    mesh.triangle_materials = vec![0; mesh.triangles.len()];
    Scene {
        meshes: vec![mesh],
        nodes: vec![Node { name: "room".into(), mesh: 0, transform: DAffine3::from_translation(centre) }],
        materials: vec![Material::default()],
        ..Scene::default()
    }
}

/// Half the smallest and largest distance of the corners from the view axis, as angles \[rad\]; all must be before the eye.
fn largest_angle(camera: &Camera, min: DVec3, max: DVec3) -> f64 {
    let axis = (camera.target - camera.eye).normalize();
    (0..8)
        .map(|n| {
            let pick = |axis: usize| if n >> axis & 1 == 0 { min[axis] } else { max[axis] };
            axis.angle_between(DVec3::new(pick(0), pick(1), pick(2)) - camera.eye)
        })
        .fold(0.0, f64::max)
}

#[test]
fn a_closed_room_is_seen_from_inside_along_its_length() {
    let centre = DVec3::new(1e5, 20.0, -3e4);
    let size = DVec3::new(9.0, 3.0, 4.0);
    let camera = room(size, centre, &[]).camera_or_framed();
    let inside = (camera.eye - centre).abs().cmplt(0.5 * size).all();
    assert!(inside, "{camera:?}");
    let axis = (camera.target - camera.eye).normalize();
    assert!(axis.x.abs() > 0.9, "looks along the long side: {axis}");
    // The wall ahead is far, the one behind is near.
    let ahead = 0.5 * size.x - (camera.eye.x - centre.x) * axis.x.signum();
    assert!(ahead > 0.7 * size.x, "{ahead}");
}

#[test]
fn an_open_box_is_seen_through_its_opening() {
    for (side, outwards) in DIRECTIONS.into_iter().enumerate() {
        let scene = room(DVec3::new(1.0, 1.2, 0.8), DVec3::ZERO, &[side]);
        let camera = scene.camera_or_framed();
        let towards = (camera.target - camera.eye).normalize();
        assert!(towards.dot(outwards) < -0.99, "side {side}: looks {towards}");
        let (min, max) = scene.bounds();
        assert!(camera.eye.dot(outwards) > max.abs().max(min.abs()).dot(outwards.abs()), "outside");
        Scene { camera: Some(camera), ..scene }.check().unwrap();
    }
}

#[test]
fn an_object_is_seen_whole_from_outside() {
    let mut scene = room(DVec3::new(2.0, 1.0, 3.0), DVec3::splat(7.0), &[]);
    scene.meshes[0].triangles.iter_mut().for_each(|t| t.swap(1, 2));
    let camera = scene.camera_or_framed();
    let (min, max) = scene.bounds();
    assert!(largest_angle(&camera, min, max) <= 0.5 * f64::from(camera.vertical_fov));
    assert!(camera.eye.z > max.z && camera.eye.y > max.y);
}

#[test]
fn flat_tiny_and_empty_scenes_still_get_a_sound_camera() {
    for scene in [
        Scene::default(),
        room(DVec3::new(1.0, 0.0, 1.0), DVec3::ZERO, &[]),
        room(DVec3::splat(1e-6), DVec3::ZERO, &[]),
        room(DVec3::ZERO, DVec3::ONE, &[]),
    ] {
        let camera = scene.camera_or_framed();
        Scene { camera: Some(camera), ..Scene::default() }.check().unwrap();
    }
}

#[test]
fn the_camera_of_the_scene_comes_first() {
    let own = Camera { eye: DVec3::ONE, target: DVec3::ZERO, up: DVec3::Y, vertical_fov: 0.3 };
    let scene = Scene { camera: Some(own), ..room(DVec3::ONE, DVec3::ZERO, &[]) };
    assert_eq!(scene.camera_or_framed(), own);
}
