use glam::{DAffine3, DQuat, DVec3, Vec2, Vec3};
use serde_json::{Value, json};

use super::*;
use crate::{Camera, Light, LightKind, Material, Mesh, Node, Scene, Texture, TextureFormat, demo, import};

/// A scene with one of everything that a GLB can say.
fn everything() -> Scene {
    let mesh = Mesh {
        name: "shape".into(),
        origin: DVec3::new(1e6, -2e6, 3.0),
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
        normals: vec![Vec3::Z, Vec3::X, Vec3::Y, Vec3::NEG_Z],
        uvs: vec![Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::new(0.3, 0.6)],
        colours: Vec::new(),
        triangles: vec![[0, 1, 2], [0, 2, 3], [0, 3, 1]],
        triangle_materials: vec![1, 1, 0],
    };
    let plain = Mesh {
        name: "plain".into(),
        positions: vec![Vec3::ONE, Vec3::X, Vec3::Y],
        triangles: vec![[0, 1, 2]],
        triangle_materials: vec![2],
        ..Mesh::default()
    };
    let turned = DAffine3::from_scale_rotation_translation(
        DVec3::new(2.0, 3.0, -4.0),
        DQuat::from_rotation_y(0.5),
        DVec3::new(0.1, 1e5, 0.0),
    );
    let node = |name: &str, mesh, transform| Node { name: name.into(), mesh, transform };
    let paint = Material {
        name: "paint".into(),
        albedo: Vec3::new(0.1, 0.2, 0.3),
        specular: 0.0,
        ..Material::default()
    };
    Scene {
        name: "everything".into(),
        meshes: vec![mesh, plain],
        nodes: vec![node("a", 0, turned), node("b", 0, DAffine3::IDENTITY), node("c", 1, DAffine3::IDENTITY)],
        materials: vec![
            paint.clone(),
            Material { name: "picture".into(), albedo_texture: Some(0), two_sided: false, ..paint.clone() },
            Material {
                name: "lamp".into(),
                emission: Vec3::new(18.387, 13.9873, 0.1),
                refractive_index: 1.75,
                specular: 0.5,
                specular_colour: paint.albedo,
                metallic: true,
                roughness: 0.25,
                ..paint.clone()
            },
            Material {
                name: "glass".into(),
                albedo: Vec3::ZERO,
                transmission: 1.0,
                transmission_colour: Vec3::new(0.5, 0.75, 1.0),
                ..paint.clone()
            },
            Material {
                name: "pane".into(),
                albedo: Vec3::splat(0.25),
                transmission: 0.5,
                transmission_colour: Vec3::splat(0.5),
                thin: true,
                ..paint
            },
        ],
        textures: vec![Texture {
            name: "checks".into(),
            width: 2,
            height: 1,
            format: TextureFormat::Srgb8,
            texels: vec![1, 2, 3, 254, 128, 0],
        }],
        lights: vec![
            Light {
                name: "spot".into(),
                kind: LightKind::Spot {
                    position: DVec3::new(1.0, 2.0, 3.0),
                    direction: Vec3::new(0.6, -0.8, 0.0),
                    intensity: Vec3::new(1e-6, 2.0, 1e9),
                    inner_angle: 0.25,
                    outer_angle: 0.75,
                },
            },
            Light {
                name: "bulb".into(),
                kind: LightKind::Point { position: DVec3::X, intensity: Vec3::splat(0.3) },
            },
            Light {
                name: "sun".into(),
                kind: LightKind::Directional { direction: Vec3::Z, irradiance: Vec3::new(3.0, 0.0, 1.0) },
            },
        ],
        sky: Some(Vec3::new(0.1, 0.2, 0.4)),
        camera: Some(Camera {
            eye: DVec3::new(1.0, 2.0, 3.0),
            target: DVec3::new(1.0, 2.0, 2.0),
            up: DVec3::Y,
            vertical_fov: 0.7,
        }),
        ..Scene::default()
    }
}

fn reread(scene: &Scene) -> Scene {
    import::from_bytes("everything.glb", &write_glb(scene, &GlbOptions::default()).unwrap()).unwrap()
}

/// The parts of a GLB: JSON and binary.
fn parts(glb: &[u8]) -> (Value, &[u8]) {
    let word = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().expect("four bytes")) as usize;
    assert_eq!((&glb[..4], word(4), word(8)), (b"glTF".as_slice(), 2, glb.len()));
    assert_eq!((&glb[16..20], word(12) % 4), (b"JSON".as_slice(), 0));
    let binary = 20 + word(12);
    assert_eq!((&glb[binary + 4..binary + 8], word(binary) % 4), (b"BIN\0".as_slice(), 0));
    (serde_json::from_slice(&glb[20..binary]).expect("JSON"), &glb[binary + 8..])
}

#[test]
fn a_written_scene_reads_back_as_the_same_scene() {
    let scene = everything();
    scene.check().unwrap();
    let back = reread(&scene);
    assert_eq!(back.name, scene.name);
    assert_eq!(back.materials, scene.materials);
    assert_eq!(back.textures, scene.textures);
    assert_eq!(back.sky, scene.sky);
    assert!(
        back.warnings.is_empty() && back.unsupported.is_empty(),
        "{:?} {:?}",
        back.warnings,
        back.unsupported
    );
    for (a, b) in scene.meshes.iter().zip(&back.meshes) {
        assert_eq!((&a.name, &a.positions, &a.normals, &a.uvs), (&b.name, &b.positions, &b.normals, &b.uvs));
        assert_eq!((&a.triangles, &a.triangle_materials), (&b.triangles, &b.triangle_materials));
    }
    for (a, b) in scene.nodes.iter().zip(&back.nodes) {
        let point = |scene: &Scene, node: &Node| {
            let mesh = &scene.meshes[node.mesh as usize];
            node.transform.transform_point3(mesh.origin + mesh.positions[1].as_dvec3())
        };
        // Coordinates up to 10^7 in f64, a few roundings of 10^-16 of that.
        assert!((point(&scene, a) - point(&back, b)).abs().max_element() < 1e-8, "{}", a.name);
    }
    for (a, b) in scene.lights.iter().zip(&back.lights) {
        assert_eq!((&a.name, a.kind.strength()), (&b.name, b.kind.strength()));
        if let (
            LightKind::Spot { position, direction, inner_angle, outer_angle, .. },
            LightKind::Spot { position: p, direction: d, inner_angle: i, outer_angle: o, .. },
        ) = (a.kind, b.kind)
        {
            assert_eq!((position, inner_angle, outer_angle), (p, i, o));
            assert!((direction - d).length() < 1e-6);
        } else {
            assert_eq!(std::mem::discriminant(&a.kind), std::mem::discriminant(&b.kind));
        }
    }
    let (a, b) = (scene.camera.expect("a camera"), back.camera.expect("a camera"));
    assert_eq!((a.eye, a.vertical_fov), (b.eye, b.vertical_fov));
    assert!((a.target - b.target).length() < 1e-12 && (a.up - b.up).length() < 1e-12);
}

#[test]
fn what_is_written_follows_the_rules_of_gltf() {
    let glb = write_glb(&everything(), &GlbOptions::default()).unwrap();
    let (root, binary) = parts(&glb);
    assert_eq!(root["asset"]["version"], "2.0");
    assert_eq!(root["buffers"][0]["byteLength"].as_u64(), Some(binary.len() as u64));
    let views = root["bufferViews"].as_array().expect("views");
    for view in views {
        let (offset, length) = (view["byteOffset"].as_u64().unwrap(), view["byteLength"].as_u64().unwrap());
        assert_eq!(offset % 4, 0);
        assert!(offset + length <= binary.len() as u64);
    }
    for primitive in
        root["meshes"].as_array().expect("meshes").iter().flat_map(|m| m["primitives"].as_array().unwrap())
    {
        let accessor = &root["accessors"][primitive["attributes"]["POSITION"].as_u64().unwrap() as usize];
        assert_eq!(
            (accessor["min"].as_array().unwrap().len(), accessor["max"].as_array().unwrap().len()),
            (3, 3)
        );
        let target = |index: &Value| {
            let accessor = &root["accessors"][index.as_u64().unwrap() as usize];
            views[accessor["bufferView"].as_u64().unwrap() as usize]["target"].as_u64()
        };
        for attribute in primitive["attributes"].as_object().unwrap().values() {
            assert_eq!(target(attribute), Some(34962));
        }
        assert_eq!(target(&primitive["indices"]), Some(34963));
    }
    assert_eq!(root["accessors"][0]["max"], json!([1.0, 1.0, 1.0]));
    for material in root["materials"].as_array().expect("materials") {
        let factors = material["emissiveFactor"].as_array().into_iter().flatten();
        factors.for_each(|f| assert!((0.0..=1.0).contains(&f.as_f64().unwrap())));
    }
    let used = json!([
        "KHR_lights_punctual",
        "KHR_materials_emissive_strength",
        "KHR_materials_ior",
        "KHR_materials_transmission",
        "KHR_materials_volume",
    ]);
    assert_eq!(root["extensionsUsed"], used);
}

#[test]
fn extensions_go_where_the_caller_says() {
    let options = GlbOptions {
        mesh_extensions: vec![None, Some(json!({ "X_mesh": { "uri": "a" } }))],
        scene_extensions: json!({ "X_scene": 1 }).as_object().expect("an object").clone(),
        extensions_used: vec!["X_scene".into(), "X_mesh".into()],
    };
    let glb = write_glb(&everything(), &options).unwrap();
    let (root, _) = parts(&glb);
    assert_eq!(root["meshes"][0].get("extensions"), None);
    assert_eq!(root["meshes"][1]["extensions"]["X_mesh"]["uri"], "a");
    assert_eq!(root["scenes"][0]["extensions"]["X_scene"], 1);
    let used: Vec<&str> =
        root["extensionsUsed"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    assert!(used.is_sorted() && used.contains(&"X_mesh") && used.contains(&"X_scene"));
}

#[test]
fn the_demo_scene_survives_the_way_through_glb() {
    let scene = demo::scene();
    let (a, b) = (scene.flatten(), reread(&scene).flatten());
    assert_eq!((a.origin, &a.positions, &a.uvs), (b.origin, &b.positions, &b.uvs));
    assert_eq!(a.triangles.len(), b.triangles.len());
    // Normals are normalised once more on the way.
    assert!(a.normals.iter().zip(&b.normals).all(|(a, b)| (*a - *b).abs().max_element() < 1e-6));
}

#[test]
fn an_empty_scene_is_a_valid_file() {
    let glb = write_glb(&Scene::default(), &GlbOptions::default()).unwrap();
    assert_eq!(import::from_bytes("e.glb", &glb).unwrap().meshes, []);
    let empty = Scene {
        meshes: vec![Mesh { name: "nothing".into(), ..Mesh::default() }],
        nodes: vec![Node { name: "n".into(), mesh: 0, transform: DAffine3::IDENTITY }],
        ..Scene::default()
    };
    import::from_bytes("e.glb", &write_glb(&empty, &GlbOptions::default()).unwrap()).unwrap();
}

#[test]
fn meshes_read_back_from_obj_and_ply_as_they_were() {
    let mut meshes = everything().meshes;
    let mut coloured = meshes.clone();
    for (k, mesh) in coloured.iter_mut().enumerate() {
        // All channels of all bytes that an opaque colour can have come by.
        mesh.colours =
            (0..mesh.positions.len() as u8).map(|i| [i * 85 + k as u8, 17, 254 - i, 255]).collect();
    }
    meshes.append(&mut coloured);
    for mut mesh in meshes {
        mesh.triangle_materials.fill(0);
        let (mut obj, mut ply) = (Vec::new(), Vec::new());
        write_obj(&mesh, &mut obj).expect("memory takes all bytes");
        write_ply(&mesh, &mut ply).expect("memory takes all bytes");
        for (name, bytes) in [("shape.obj", obj), ("shape.ply", ply)] {
            let back = &import::from_bytes(name, &bytes).unwrap().meshes[0];
            assert_eq!((&back.triangles, &back.normals), (&mesh.triangles, &mesh.normals), "{name}");
            assert_eq!(back.colours, mesh.colours, "{name}");
            for (a, b) in back.positions.iter().zip(&mesh.positions) {
                assert_eq!(back.origin + a.as_dvec3(), mesh.origin + b.as_dvec3(), "{name}");
            }
            for (a, b) in back.uvs.iter().zip(&mesh.uvs) {
                // 1 - v, twice, in f32.
                assert!((*a - *b).abs().max_element() <= f32::EPSILON, "{name}: {a} {b}");
            }
        }
    }
}

#[test]
fn every_channel_reads_back_from_obj_and_alpha_too_from_ply() {
    let mut mesh = Mesh {
        positions: (0..=255u8).map(|k| Vec3::new(f32::from(k), f32::from(k).powi(2), 0.0)).collect(),
        colours: (0..=255u8).map(|k| [k, 255 - k, k.wrapping_mul(7), 255]).collect(),
        triangles: (0..86).map(|k| [3 * k, 3 * k + 1, 3 * k + 2].map(|v| v.min(255))).collect(),
        triangle_materials: vec![0; 86],
        ..Mesh::default()
    };
    let read = |name: &str, bytes: &[u8]| import::from_bytes(name, bytes).unwrap().meshes[0].colours.clone();
    let mut obj = Vec::new();
    write_obj(&mesh, &mut obj).expect("memory takes all bytes");
    assert_eq!(read("shape.obj", &obj), mesh.colours);
    mesh.colours.iter_mut().for_each(|colour| colour[3] = colour[0]);
    let mut ply = Vec::new();
    write_ply(&mesh, &mut ply).expect("memory takes all bytes");
    assert_eq!(read("shape.ply", &ply), mesh.colours);
}

#[test]
fn vertices_of_one_place_share_a_position_and_keep_their_attributes() {
    let mesh = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::X, Vec3::Y],
        normals: vec![Vec3::Z, Vec3::Z, Vec3::X, Vec3::Z],
        uvs: vec![Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE],
        triangles: vec![[0, 1, 3], [0, 3, 2]],
        triangle_materials: vec![0, 0],
        ..Mesh::default()
    };
    let mut obj = Vec::new();
    write_obj_joined(&mesh, &[0, 1, 1, 2], &mut obj).expect("memory takes all bytes");
    let text = String::from_utf8(obj).expect("text");
    assert_eq!(
        text,
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 1\nvt 1 1\nvt 0 0\nvt 1 0\nvn 0 0 1\nvn 0 0 1\nvn 1 0 0\nvn 0 0 1\n\
         f 1/1/1 2/2/2 3/4/4\nf 1/1/1 3/4/4 2/3/3\n"
    );
}
