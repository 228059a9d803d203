use glam::DAffine3;

use super::*;
use crate::{Node, TextureFormat};

/// A scene that passes, with one of everything.
fn sound() -> Scene {
    Scene {
        name: "s".into(),
        meshes: vec![Mesh {
            name: "shape".into(),
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: vec![Vec3::Z; 3],
            uvs: vec![glam::Vec2::ZERO; 3],
            triangles: vec![[0, 1, 2]],
            triangle_materials: vec![0],
            ..Mesh::default()
        }],
        nodes: vec![Node { name: "place".into(), mesh: 0, transform: DAffine3::IDENTITY }],
        materials: vec![Material { name: "paint".into(), albedo_texture: Some(0), ..Material::default() }],
        textures: vec![Texture {
            name: "picture".into(),
            width: 1,
            height: 1,
            format: TextureFormat::Srgb8,
            texels: vec![0; 3],
        }],
        lights: vec![Light {
            name: "lamp".into(),
            kind: LightKind::Point { position: DVec3::ZERO, intensity: Vec3::ONE },
        }],
        sky: Some(Vec3::ONE),
        camera: Some(Camera { eye: DVec3::Z, target: DVec3::ZERO, up: DVec3::Y, vertical_fov: 1.0 }),
        ..Scene::default()
    }
}

#[test]
fn a_sound_scene_passes() {
    sound().check().unwrap();
    sound().require_light().unwrap();
    Scene::default().check().unwrap();
}

/// Breaks a sound scene and expects the message to name the object and the fault.
fn check_names(object: &str, fault: &str, spoil: impl Fn(&mut Scene)) {
    let mut scene = sound();
    spoil(&mut scene);
    let message = scene.check().expect_err(fault).to_string();
    assert!(message.contains(object) && message.contains(fault), "{message}");
}

#[test]
fn every_fault_is_named_with_its_object() {
    let (nan, inf) = (f32::NAN, f32::INFINITY);
    check_names("mesh \"shape\"", "position of vertex 1", |s| s.meshes[0].positions[1].y = nan);
    check_names("mesh \"shape\"", "position of vertex 2", |s| s.meshes[0].positions[2].x = inf);
    check_names("mesh \"shape\"", "origin", |s| s.meshes[0].origin.z = f64::NAN);
    check_names("mesh \"shape\"", "normal of vertex 0", |s| s.meshes[0].normals[0].x = nan);
    check_names("mesh \"shape\"", "texture coordinate of vertex 0", |s| s.meshes[0].uvs[0].x = inf);
    check_names("mesh \"shape\"", "2 normals for 3", |s| s.meshes[0].normals.truncate(2));
    check_names("mesh \"shape\"", "names vertex 3", |s| s.meshes[0].triangles[0][2] = 3);
    check_names("mesh \"shape\"", "0 materials for 1", |s| s.meshes[0].triangle_materials.clear());
    check_names("mesh \"shape\"", "names material 7", |s| s.meshes[0].triangle_materials[0] = 7);
    check_names("node \"place\"", "names mesh 1", |s| s.nodes[0].mesh = 1);
    check_names("node \"place\"", "transform", |s| s.nodes[0].transform.translation.x = f64::INFINITY);
    check_names("material \"paint\"", "albedo", |s| s.materials[0].albedo.x = nan);
    check_names("material \"paint\"", "albedo", |s| s.materials[0].albedo.y = 1.01);
    check_names("material \"paint\"", "emission", |s| s.materials[0].emission.z = -1.0);
    check_names("material \"paint\"", "emission", |s| s.materials[0].emission.z = inf);
    check_names("material \"paint\"", "names texture 4", |s| s.materials[0].albedo_texture = Some(4));
    check_names("material \"paint\"", "refraction", |s| s.materials[0].refractive_index = 0.5);
    check_names("texture \"picture\"", "instead of 3", |s| s.textures[0].texels.push(0));
    check_names("texture \"picture\"", "no texels", |s| s.textures[0].width = 0);
    check_names("light \"lamp\"", "intensity", |s| {
        s.lights[0].kind = LightKind::Point { position: DVec3::ZERO, intensity: Vec3::new(0.0, nan, 0.0) };
    });
    check_names("light \"lamp\"", "unit length", |s| {
        s.lights[0].kind = LightKind::Directional { direction: Vec3::ONE, irradiance: Vec3::ONE };
    });
    check_names("light \"lamp\"", "angles", |s| {
        s.lights[0].kind = LightKind::Spot {
            position: DVec3::ZERO,
            direction: Vec3::X,
            intensity: Vec3::ONE,
            inner_angle: 0.5,
            outer_angle: 0.5,
        };
    });
    check_names("sky", "radiance", |s| s.sky = Some(Vec3::NEG_ONE));
    check_names("camera", "same point", |s| s.camera.as_mut().unwrap().target = DVec3::Z);
    check_names("camera", "parallel", |s| s.camera.as_mut().unwrap().up = DVec3::Z);
    check_names("camera", "field of view", |s| s.camera.as_mut().unwrap().vertical_fov = 0.0);
}

#[test]
fn a_dark_scene_is_an_error_that_names_the_option() {
    let mut dark = sound();
    dark.sky = Some(Vec3::ZERO);
    dark.lights[0].kind = LightKind::Point { position: DVec3::ZERO, intensity: Vec3::ZERO };
    let message = dark.require_light().expect_err("dark").to_string();
    assert!(message.contains("--lights") && message.contains("\"s\""), "{message}");
    // An emissive material counts only where a placed triangle has it.
    dark.materials.push(Material { emission: Vec3::ONE, ..Material::default() });
    assert!(dark.require_light().is_err());
    dark.meshes[0].triangle_materials[0] = 1;
    dark.require_light().unwrap();
    dark.nodes.clear();
    assert!(dark.require_light().is_err());
}
