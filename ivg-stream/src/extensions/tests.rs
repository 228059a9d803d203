use serde_json::{Value, json};

use super::*;

const SHA: &str = "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08";

/// A binary glTF file with this JSON and no other chunk.
fn glb(json: &Value) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut glb = b"glTF".to_vec();
    glb.extend(2u32.to_le_bytes());
    glb.extend((20 + text.len() as u32).to_le_bytes());
    glb.extend((text.len() as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(text);
    glb
}

fn valid() -> Value {
    json!({
        "asset": { "version": "2.0" },
        "materials": [{}, {}],
        "meshes": [
            { "primitives": [] },
            { "primitives": [], "extensions": { PROGRESSIVE_MESH:
                { "uri": "a.pmesh", "byteLength": 10, "sha256": SHA, "materials": [1, 0], "later": true } } }
        ],
        "scenes": [{}, { "extensions": { IRRADIANCE_GRID: { "uri": "light.ivg", "byteLength": 20, "sha256": SHA } } }],
        "scene": 1
    })
}

#[test]
fn both_extensions_are_found_and_unknown_members_ignored() {
    let found = Extensions::of_glb(&glb(&valid())).unwrap();
    assert_eq!(found.meshes.len(), 1);
    let mesh = &found.meshes[0];
    assert_eq!((mesh.gltf_mesh, mesh.file.uri.as_str(), mesh.file.byte_length), (1, "a.pmesh", 10));
    assert_eq!(mesh.materials.as_deref(), Some(&[1, 0][..]));
    assert_eq!(mesh.file.sha256_hex(), SHA);
    assert_eq!(found.grid.unwrap().uri, "light.ivg");
}

#[test]
fn a_file_without_extensions_has_none() {
    assert_eq!(Extensions::of_glb(&glb(&json!({ "asset": {} }))), Ok(Extensions::default()));
}

#[test]
fn what_is_written_is_read_back() {
    let file = FileEntry { uri: "x/y.pmesh".into(), byte_length: LARGEST_LENGTH, sha256: [0xAB; 32] };
    let mut document = valid();
    document["meshes"][1]["extensions"][PROGRESSIVE_MESH] = mesh_to_json(&file, [0.1, -2e9, 3.0]);
    document["scenes"][1]["extensions"][IRRADIANCE_GRID] = grid_to_json(&file);
    let found = Extensions::of_glb(&glb(&document)).unwrap();
    assert_eq!((&found.meshes[0].file, found.meshes[0].origin), (&file, [0.1, -2e9, 3.0]));
    assert_eq!(mesh_to_json(&file, [0.0; 3]), grid_to_json(&file));
    assert_eq!(found.grid.as_ref(), Some(&file));
}

#[test]
fn each_broken_rule_is_named() {
    let mesh = "/meshes/1/extensions/IVG_progressive_mesh";
    let grid = "/scenes/1/extensions/IVG_irradiance_grid";
    for (object, member, value, clause) in [
        (mesh, "uri", json!("../a.pmesh"), "GLT-URI-01"),
        (mesh, "uri", json!("http://h/a.pmesh"), "GLT-URI-01"),
        (grid, "uri", json!("/light.ivg"), "GLT-URI-01"),
        (grid, "uri", json!(7), "GLT-EXT-03"),
        (grid, "byteLength", json!(0), "GLT-EXT-03"),
        (grid, "byteLength", json!(LARGEST_LENGTH + 1), "GLT-EXT-03"),
        (grid, "byteLength", json!(-1), "GLT-EXT-03"),
        (grid, "byteLength", json!(1.5), "GLT-EXT-03"),
        (grid, "sha256", json!(SHA.to_uppercase()), "GLT-EXT-03"),
        (grid, "sha256", json!(&SHA[1..]), "GLT-EXT-03"),
        (grid, "sha256", json!(null), "GLT-EXT-03"),
        (mesh, "materials", json!([2]), "GLT-PM-04"),
        (mesh, "origin", json!([1.0, 2.0]), "GLT-EXT-03"),
        (mesh, "origin", json!([1.0, 2.0, "3"]), "GLT-EXT-03"),
        (mesh, "materials", json!([-1]), "GLT-EXT-03"),
        (grid, "uri", json!("a.pmesh"), "GLT-EXT-05"),
    ] {
        let mut document = valid();
        document.pointer_mut(object).unwrap()[member] = value.clone();
        let error = Extensions::of_glb(&glb(&document)).unwrap_err();
        assert!(
            matches!(&error, ExtensionError::Rule { clause: c, .. } if *c == clause),
            "{member} {value}: {error}"
        );
    }
}

#[test]
fn what_is_no_binary_gltf_is_refused_at_every_length() {
    let whole = glb(&valid());
    for length in 0..whole.len() {
        assert!(
            matches!(Extensions::of_glb(&whole[..length]), Err(ExtensionError::NotGlb { .. })),
            "{length}"
        );
    }
    let mut other = whole.clone();
    other[4] = 1;
    assert!(Extensions::of_glb(&other).is_err());
    let mut long = whole;
    long[12..16].fill(0xFF);
    assert!(Extensions::of_glb(&long).is_err());
}

#[test]
fn the_schemas_and_the_reader_agree_on_the_form() {
    let schema: Value =
        serde_json::from_str(include_str!("../../../spec/gltf/external-file.schema.json")).unwrap();
    assert_eq!(schema["required"], json!(["uri", "byteLength", "sha256"]));
    assert_eq!(schema["properties"]["byteLength"]["maximum"], json!(LARGEST_LENGTH));
    assert_eq!(schema["properties"]["uri"]["maxLength"], json!(1024));
    for (text, name) in [
        (include_str!("../../../spec/gltf/mesh.IVG_progressive_mesh.schema.json"), PROGRESSIVE_MESH),
        (include_str!("../../../spec/gltf/scene.IVG_irradiance_grid.schema.json"), IRRADIANCE_GRID),
    ] {
        let schema: Value = serde_json::from_str(text).unwrap();
        assert_eq!(schema["title"], json!(name));
    }
}
