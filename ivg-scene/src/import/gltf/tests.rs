use glam::Vec2;
use serde_json::{Value, json};

use super::*;

/// A document with one triangle: positions, normals, texture coordinates and 16-bit indices in one data: buffer.
fn triangle() -> Value {
    let mut bytes = Vec::new();
    for v in [
        [0f32, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, 1.0],
    ] {
        v.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    }
    for v in [[0f32, 0.0], [0.5, 0.0], [0.0, 0.5]] {
        v.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    }
    [0u16, 1, 2].iter().for_each(|i| bytes.extend(i.to_le_bytes()));
    json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "byteLength": bytes.len(), "uri": uri(&bytes) }],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 72, "byteLength": 24 },
            { "buffer": 0, "byteOffset": 96, "byteLength": 6 },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC2" },
            { "bufferView": 3, "componentType": 5123, "count": 3, "type": "SCALAR" },
        ],
        "meshes": [{ "name": "m", "primitives": [{
            "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 }, "indices": 3, "material": 0,
        }] }],
        "materials": [{ "name": "paint" }],
        "nodes": [{ "name": "n", "mesh": 0 }],
        "scenes": [{ "nodes": [0] }],
    })
}

fn uri(bytes: &[u8]) -> String {
    let digit = |v: u32| {
        let table = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        char::from(table[v as usize & 63])
    };
    let mut text = String::from("data:application/octet-stream;base64,");
    for chunk in bytes.chunks(3) {
        let at = |i: usize| u32::from(chunk.get(i).copied().unwrap_or(0));
        let bits = at(0) << 16 | at(1) << 8 | at(2);
        (0..=chunk.len()).for_each(|i| text.push(digit(bits >> (18 - 6 * i))));
    }
    text
}

fn read_json(document: &Value) -> Result<Scene, SceneError> {
    let scene = read("t.gltf", document.to_string().as_bytes(), &Folder::none())?;
    scene.check()?;
    Ok(scene)
}

/// A document of [`triangle`] whose vertices have colours, as bytes of 0 to 1.
fn coloured(kind: &str, bytes: &[u8]) -> Value {
    let mut document = triangle();
    let mut add = |list: &str, value| document[list].as_array_mut().expect("a list").push(value);
    add("buffers", json!({ "byteLength": bytes.len(), "uri": uri(bytes) }));
    add("bufferViews", json!({ "buffer": 1, "byteLength": bytes.len() }));
    add(
        "accessors",
        json!({ "bufferView": 4, "componentType": 5121, "normalized": true, "count": 3, "type": kind }),
    );
    document["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = 4.into();
    document
}

fn refused(document: &Value) -> String {
    read_json(document).expect_err("refused").to_string()
}

#[test]
fn colours_of_vertices_become_srgb() {
    // 55 of 255 is 0.2157 of the light, which is code 128; 128 of 255 is 0.502, code 188 (IEC 61966-2-1).
    let scene = read_json(&coloured("VEC4", &[255, 0, 55, 128, 128, 55, 0, 255, 0, 0, 0, 0])).expect("valid");
    assert_eq!(scene.meshes[0].colours, [[255, 0, 128, 128], [188, 128, 0, 255], [0, 0, 0, 0]]);
    let document = coloured("VEC3", &[255, 0, 55, 0, 128, 55, 0, 255, 0]);
    // Three bytes do not start at multiples of four, as glTF asks for; readers are free to take them.
    let scene = read_json(&document).expect("valid");
    assert_eq!(scene.meshes[0].colours, [[255, 0, 128, 255], [0, 188, 128, 255], [0, 255, 0, 255]]);
    assert!(read_json(&triangle()).expect("valid").meshes[0].colours.is_empty());
}

#[test]
fn vertices_of_a_primitive_without_colours_are_white_beside_others() {
    let mut document = coloured("VEC4", &[0; 12]);
    let mut plain = document["meshes"][0]["primitives"][0].clone();
    plain["attributes"].as_object_mut().expect("an object").remove("COLOR_0");
    document["meshes"][0]["primitives"].as_array_mut().expect("a list").push(plain);
    let scene = read_json(&document).expect("valid");
    assert_eq!(scene.meshes[0].colours, [[[0; 4]; 3], [[255; 4]; 3]].concat());
}

#[test]
fn colours_that_do_not_fit_are_refused() {
    assert!(refused(&coloured("VEC2", &[0; 12])).contains("accessors[4] has 2 components instead of 4"));
    let mut document = coloured("VEC4", &[0; 12]);
    document["accessors"][4]["count"] = 2.into();
    assert!(refused(&document).contains("attributes of 3 and 2 vertices"), "{}", refused(&document));
}

#[test]
fn a_triangle_comes_with_all_attributes() {
    let scene = read_json(&triangle()).unwrap();
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!((mesh.normals[2], mesh.uvs[1]), (Vec3::Z, Vec2::new(0.5, 0.0)));
    assert_eq!((mesh.triangles[0], scene.nodes[0].name.as_str()), ([0, 1, 2], "n"));
    assert!(scene.warnings.is_empty() && scene.unsupported.is_empty());
}

#[test]
fn strips_fans_and_unindexed_primitives_are_triangles_with_one_winding() {
    let mut document = triangle();
    let mut bytes = Vec::new();
    for v in [[0f32, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]] {
        [v[0], v[1], 0.0].iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    }
    document["buffers"][0] = json!({ "byteLength": 48, "uri": uri(&bytes) });
    document["bufferViews"] = json!([{ "buffer": 0, "byteLength": 48 }]);
    document["accessors"] = json!([
        { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] },
    ]);
    for (mode, expected) in
        [(5, vec![[0, 1, 2], [1, 3, 2]]), (6, vec![[1, 2, 0], [2, 3, 0]]), (4, vec![[0, 1, 2]])]
    {
        document["meshes"] = json!([{ "primitives": [{ "attributes": { "POSITION": 0 }, "mode": mode }] }]);
        let scene = read_json(&document).unwrap();
        assert_eq!(scene.meshes[0].triangles, expected, "mode {mode}");
        assert_eq!(scene.materials.last(), Some(&crate::Material::default()), "the stated grey");
        assert!(scene.meshes[0].normals.is_empty());
    }
    document["meshes"] =
        json!([{ "name": "wire", "primitives": [{ "attributes": { "POSITION": 0 }, "mode": 1 }] }]);
    let scene = read_json(&document).unwrap();
    assert!(scene.unsupported[0].object.contains("wire") && scene.unsupported[0].what.contains("lines"));
}

#[test]
fn normalised_integers_and_sparse_values_are_read() {
    let mut document = triangle();
    let mut bytes: Vec<u8> = Vec::new();
    // Three positions as normalised 16-bit integers, eight bytes apart; then one sparse index and its value.
    for v in [[0i16, 0, 0, 0], [32767, 0, 0, 0], [0, -32767, -32768, 0]] {
        v.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    }
    bytes.extend([1u8, 0, 0, 0]);
    [0i16, 0, 32767].iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    document["buffers"][0] = json!({ "byteLength": bytes.len(), "uri": uri(&bytes) });
    document["bufferViews"] = json!([
        { "buffer": 0, "byteLength": 24, "byteStride": 8 },
        { "buffer": 0, "byteOffset": 24, "byteLength": 1 },
        { "buffer": 0, "byteOffset": 28, "byteLength": 6 },
    ]);
    document["accessors"] = json!([{
        "bufferView": 0, "componentType": 5122, "normalized": true, "count": 3, "type": "VEC3",
        "min": [0, -1, -1], "max": [1, 0, 1],
        "sparse": { "count": 1, "indices": { "bufferView": 1, "componentType": 5121 }, "values": { "bufferView": 2 } },
    }]);
    document["meshes"] = json!([{ "primitives": [{ "attributes": { "POSITION": 0 } }] }]);
    document["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let scene = read_json(&document).unwrap();
    assert_eq!(scene.meshes[0].positions, [Vec3::ZERO, Vec3::Z, Vec3::new(0.0, -1.0, -1.0)]);
}

#[test]
fn materials_mean_what_the_documentation_says() {
    let mut document = triangle();
    document["materials"][0] = json!({
        "name": "paint", "doubleSided": true, "emissiveFactor": [0.5, 0.25, 0], "alphaMode": "BLEND",
        "pbrMetallicRoughness": { "baseColorFactor": [0.8, 0.4, 0.2, 0.5], "metallicFactor": 0.75, "roughnessFactor": 0.125 },
        "extensions": {
            "KHR_materials_emissive_strength": { "emissiveStrength": 8.0 },
            "KHR_materials_transmission": { "transmissionFactor": 0.5 },
            "KHR_materials_ior": { "ior": 1.25 },
        },
    });
    document["extensionsUsed"] = json!([
        "KHR_materials_emissive_strength",
        "KHR_materials_transmission",
        "KHR_materials_ior",
        "KHR_materials_clearcoat",
    ]);
    let scene = read_json(&document).unwrap();
    let m = &scene.materials[0];
    assert_eq!((m.albedo, m.transmission_colour), (Vec3::new(0.4, 0.2, 0.1), Vec3::new(0.8, 0.4, 0.2)));
    assert_eq!((m.emission, m.two_sided), (Vec3::new(4.0, 2.0, 0.0), true));
    assert_eq!((m.specular, m.roughness, m.transmission, m.refractive_index), (0.75, 0.125, 0.5, 1.25));
    assert_eq!((m.specular_colour, m.metallic, m.thin), (m.transmission_colour, true, true));
    let reported: Vec<&str> = scene.unsupported.iter().map(|u| u.what.as_str()).collect();
    assert_eq!(reported, ["glTF extension KHR_materials_clearcoat: ignored", "alpha: treated as opaque"]);
}

#[test]
fn texture_coordinates_are_transformed_as_the_extension_says() {
    let mut png = Vec::new();
    let encoder = ::image::codecs::png::PngEncoder::new(&mut png);
    ::image::ImageEncoder::write_image(encoder, &[1, 2, 3], 1, 1, ::image::ExtendedColorType::Rgb8)
        .expect("a small image");
    let mut document = triangle();
    document["images"] = json!([{ "name": "dot", "uri": uri(&png) }]);
    document["textures"] = json!([{ "source": 0 }]);
    document["materials"][0]["pbrMetallicRoughness"] = json!({ "baseColorTexture": { "index": 0, "extensions": {
        "KHR_texture_transform": { "offset": [0.25, 0.5], "rotation": std::f32::consts::FRAC_PI_2, "scale": [2, 4] },
    } } });
    let scene = read_json(&document).unwrap();
    assert_eq!(scene.textures[0].texels, [1, 2, 3]);
    assert_eq!(scene.materials[0].albedo_texture, Some(0));
    // A quarter turn counter-clockwise with v downwards takes u to -v and v to u.
    let expected = [Vec2::new(0.25, 0.5), Vec2::new(0.25, 0.5 - 1.0), Vec2::new(0.25 + 2.0, 0.5)];
    for (found, expected) in scene.meshes[0].uvs.iter().zip(expected) {
        assert!((*found - expected).abs().max_element() < 1e-6, "{found} is not {expected}");
    }
}

#[test]
fn lights_and_camera_stand_where_their_nodes_say() {
    let mut document = triangle();
    document["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    document["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "spot", "name": "s", "color": [1, 0.5, 0], "intensity": 8, "spot": { "innerConeAngle": 0.25, "outerConeAngle": 0.5 } },
        { "type": "directional", "intensity": 3 },
    ] } });
    document["cameras"] = json!([
        { "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "zfar": 10, "znear": 0 } },
        { "type": "perspective", "perspective": { "yfov": 0.5, "znear": 0.1 } },
    ]);
    // A quarter turn about x takes -z to -y... and +y to +z: the lamp shines down.
    let down = [-std::f64::consts::FRAC_1_SQRT_2, 0.0, 0.0, std::f64::consts::FRAC_1_SQRT_2];
    document["nodes"] = json!([
        { "translation": [10, 0, 0], "scale": [2, 2, 2], "children": [1, 2, 3, 4] },
        { "translation": [0, 3, 0], "rotation": down, "extensions": { "KHR_lights_punctual": { "light": 0 } } },
        { "name": "sun", "extensions": { "KHR_lights_punctual": { "light": 1 } } },
        { "name": "plan", "camera": 0 },
        { "camera": 1, "translation": [0, 0, 5] },
    ]);
    let scene = read_json(&document).unwrap();
    let LightKind::Spot { position, direction, intensity, inner_angle, outer_angle } = scene.lights[0].kind
    else {
        panic!("a spot")
    };
    assert_eq!((position, intensity), (DVec3::new(10.0, 6.0, 0.0), Vec3::new(8.0, 4.0, 0.0)));
    assert!((direction - Vec3::NEG_Y).length() < 1e-6, "{direction}");
    assert_eq!((inner_angle, outer_angle), (0.25, 0.5));
    assert_eq!(scene.lights[1].name, "sun");
    assert_eq!(
        scene.lights[1].kind,
        LightKind::Directional { direction: Vec3::NEG_Z, irradiance: Vec3::splat(3.0) }
    );
    let camera = scene.camera.expect("a camera");
    assert_eq!((camera.eye, camera.target), (DVec3::new(10.0, 0.0, 10.0), DVec3::new(10.0, 0.0, 9.0)));
    assert!(scene.unsupported[0].what.contains("orthographic"));
}

#[test]
fn a_node_a_million_metres_away_moves_nothing_but_the_origin() {
    let near = read_json(&triangle()).unwrap().flatten();
    let mut document = triangle();
    document["nodes"][0]["translation"] = json!([1_000_000.0, -3_000_000.0, 1_000_000.0]);
    let far = read_json(&document).unwrap().flatten();
    assert_eq!(far.positions, near.positions);
    assert_eq!(far.origin - near.origin, DVec3::new(1e6, -3e6, 1e6));
    // Digits beyond f32 count too.
    document["nodes"][0]["translation"] = json!([1_000_000.015_625, 0, 0]);
    assert_eq!(read_json(&document).unwrap().bounds().0.x, 1_000_000.015_625);
}

#[test]
fn containers_are_told_apart_and_checked() {
    let text = triangle().to_string();
    let glb = |version: u32, kind: &[u8; 4], length: u32| {
        let mut bytes = b"glTF".to_vec();
        bytes.extend(version.to_le_bytes());
        bytes.extend((20 + text.len() as u32).to_le_bytes());
        bytes.extend(length.to_le_bytes());
        bytes.extend(kind);
        bytes.extend(text.as_bytes());
        bytes
    };
    let length = text.len() as u32;
    read("t.glb", &glb(2, b"JSON", length), &Folder::none()).unwrap();
    let check = |bytes: &[u8], what: &str| {
        let message = read("t.glb", bytes, &Folder::none()).expect_err(what).to_string();
        assert!(message.contains(what), "{message}");
    };
    check(&glb(1, b"JSON", length), "version 1");
    check(&glb(2, b"TEXT", length), "no JSON chunk");
    check(&glb(2, b"JSON", length + 1), "ends within a chunk at byte 0xc");
    check(b"glTF\x02", "ends within its header");
    check(b"{\n\"asset\": 7}", "t.glb:2: ");
}

/// Changes a sound document and expects the message.
fn check_refused(what: &str, spoil: impl Fn(&mut Value)) {
    let mut document = triangle();
    spoil(&mut document);
    let message = refused(&document);
    assert!(message.contains(what), "{message}");
}

#[test]
fn faults_are_named() {
    check_refused("KHR_draco_mesh_compression, X_y", |d| {
        d["extensionsRequired"] = json!(["KHR_texture_transform", "KHR_draco_mesh_compression", "X_y"]);
    });
    check_refused("version 1.0", |d| d["asset"]["version"] = json!("1.0"));
    check_refused("accessor 9 does not exist", |d| {
        d["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(9);
    });
    check_refused("accessors[3].bufferView", |d| d["accessors"][3]["bufferView"] = json!(17));
    check_refused("children", |d| d["nodes"][0]["children"] = json!([4]));
    check_refused("more than one parent", |d| d["nodes"] = json!([{ "children": [1] }, { "children": [0] }]));
    check_refused("more than one parent", |d| d["scenes"][0]["nodes"] = json!([0, 0]));
    check_refused("buffers[0]: has 102 bytes instead of 103", |d| d["buffers"][0]["byteLength"] = json!(103));
    check_refused("buffers[0]: ", |d| d["buffers"][0]["uri"] = json!("../secret.bin"));
    check_refused("not a file beside", |d| d["buffers"][0]["uri"] = json!("http://example.invalid/a.bin"));
    check_refused("bufferViews[0]", |d| d["bufferViews"][0]["byteLength"] = json!(1_000_000));
    check_refused("bufferViews[0]", |d| d["bufferViews"][0]["byteOffset"] = json!(u64::MAX));
    check_refused("do not fit", |d| d["accessors"][0]["count"] = json!(1u64 << 60));
    check_refused("do not fit", |d| d["accessors"][0]["byteOffset"] = json!(u64::MAX));
    check_refused("components instead of 3", |d| d["accessors"][1]["type"] = json!("VEC2"));
    check_refused("not a list of unsigned", |d| d["accessors"][3]["componentType"] = json!(5126));
    check_refused("names vertex", |d| d["bufferViews"][3]["byteOffset"] = json!(36 + 32));
    check_refused("mesh \"m\": position", |d| {
        // The bytes of the first position become those of NaN.
        let bytes = [[0xff; 36].as_slice(), &[0; 66]].concat();
        d["buffers"][0]["uri"] = json!(uri(&bytes));
    });
    check_refused("mesh \"m\": attributes of 3 and 2", |d| d["accessors"][1]["count"] = json!(2));
    check_refused("spot", |d| {
        d["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "spot" }] } });
    });
}

#[test]
fn any_member_may_be_missing_or_of_another_kind() {
    // Each value of the document in turn is taken away or replaced; whatever comes out, it must come out.
    fn paths(value: &Value, at: &mut Vec<String>, all: &mut Vec<String>) {
        let mut step = |key: String, inner: &Value| {
            at.push(key.replace('~', "~0").replace('/', "~1"));
            all.push(format!("/{}", at.join("/")));
            paths(inner, at, all);
            at.pop();
        };
        match value {
            Value::Object(members) => members.iter().for_each(|(key, inner)| step(key.clone(), inner)),
            Value::Array(items) => items.iter().enumerate().for_each(|(i, inner)| step(i.to_string(), inner)),
            _ => {}
        }
    }
    let document = triangle();
    let mut all = Vec::new();
    paths(&document, &mut Vec::new(), &mut all);
    assert!(all.len() > 60, "{}", all.len());
    for path in &all {
        for other in [
            Value::Null,
            json!(-1),
            json!(0),
            json!(1),
            json!(4_294_967_295u64),
            json!(1e300),
            json!("x"),
            json!([]),
            json!({}),
        ] {
            let mut changed = document.clone();
            *changed.pointer_mut(path).expect("a path of this document") = other;
            let _ = read_json(&changed);
        }
    }
}
