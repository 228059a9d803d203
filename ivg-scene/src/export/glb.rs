use glam::{DAffine3, DQuat, DVec3, Vec3};
use serde_json::{Map, Value, json};

use crate::import::SKY_KEY;
use crate::{LightKind, Material, Mesh, Scene, SceneError, Texture, TextureFormat};

/// What else a GLB shall hold: the hook for extensions that this crate does not know.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GlbOptions {
    /// The member `extensions` of each mesh, in the order of [`Scene::meshes`]; missing entries count as `None`.
    pub mesh_extensions: Vec<Option<Value>>,
    /// The member `extensions` of the scene.
    pub scene_extensions: Map<String, Value>,
    /// Names of the extensions used in the two above.
    pub extensions_used: Vec<String>,
}

/// Vertex attributes and vertex indices, as targets of buffer views (glTF 2.0, section 5.11.5).
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
/// Component types (glTF 2.0, section 3.6.2.2).
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
/// Distance of the near plane that glTF requires of a camera \[m\]; viewers need one, this project does not.
const NEAR_PLANE: f64 = 0.01;

/// The scene as one binary glTF 2.0 file: meshes, nodes, materials, images as PNG, punctual lights, camera; the sky as
/// `extras.skyRadiance` of the scene, of an image its mean.
///
/// A mesh becomes one glTF mesh with one primitive for each material, in order of first use; all share the vertices.
/// [`Mesh::origin`] goes into the matrices of the nodes, so **the space of a glTF mesh is that of the mesh minus its
/// origin**. Numbers in JSON keep all digits of f64, which [`import`](crate::import) reads back; other readers round
/// matrices to f32, which at 10^6 m from the origin is 6 cm. glTF wants matrices without shear; one with shear is written
/// all the same.
///
/// Colours of vertices are left out: other readers would multiply the materials by them. What glTF cannot say: where a material lets light through, its base colour is the colour of the transmission, and
/// the diffuse albedo that is read back is that times the share not let through; a layer that mirrors becomes metal. Meshes without triangles are left out,
/// their nodes stay. A scene without nodes, lights and camera
/// becomes a file without a glTF scene.
///
/// # Errors
///
/// [`SceneError::File`] if the file would be longer than the 4 GiB that GLB can state.
///
/// # Panics
///
/// Panics if [`Scene::check`] would fail.
pub fn write_glb(scene: &Scene, options: &GlbOptions) -> Result<Vec<u8>, SceneError> {
    let mut writer = Writer::default();
    writer.extensions_used.extend(options.extensions_used.iter().cloned());
    let mesh_indices: Vec<Option<usize>> = (scene.meshes.iter().enumerate())
        .map(|(i, mesh)| writer.mesh(mesh, options.mesh_extensions.get(i).and_then(Option::as_ref)))
        .collect();
    let images: Vec<Value> = scene.textures.iter().map(|t| writer.image(t)).collect();
    let textures: Vec<Value> = (0..images.len()).map(|i| json!({ "source": i })).collect();
    let materials: Vec<Value> = scene.materials.iter().map(|m| writer.material(m)).collect();
    let (nodes, lights, cameras) = writer.nodes(scene, &mesh_indices);

    let mut root = json!({
        "asset": { "version": "2.0", "generator": concat!("ivg ", env!("CARGO_PKG_VERSION")) },
    });
    // A list of nodes may not be empty (glTF 2.0, section 5.25), and the gltf crate wants one in each scene.
    if !nodes.is_empty() {
        let mut top = json!({ "name": scene.name, "nodes": (0..nodes.len()).collect::<Vec<_>>() });
        if !options.scene_extensions.is_empty() {
            top["extensions"] = Value::Object(options.scene_extensions.clone());
        }
        if let Some(sky) = scene.mean_sky() {
            top["extras"] = json!({ SKY_KEY: sky.to_array() });
        }
        root["scene"] = 0.into();
        root["scenes"] = json!([top]);
    }
    if !lights.is_empty() {
        root["extensions"] = json!({ "KHR_lights_punctual": { "lights": lights } });
        writer.used("KHR_lights_punctual");
    }
    if !writer.bytes.is_empty() {
        writer.pad();
        root["buffers"] = json!([{ "byteLength": writer.bytes.len() }]);
    }
    writer.extensions_used.sort();
    writer.extensions_used.dedup();
    // glTF forbids empty arrays at the top level.
    for (key, values) in [
        ("nodes", nodes),
        ("cameras", cameras),
        ("meshes", std::mem::take(&mut writer.meshes)),
        ("materials", materials),
        ("textures", textures),
        ("images", images),
        ("accessors", std::mem::take(&mut writer.accessors)),
        ("bufferViews", std::mem::take(&mut writer.views)),
        ("extensionsUsed", writer.extensions_used.iter().cloned().map(Value::String).collect()),
    ] {
        if !values.is_empty() {
            root[key] = Value::Array(values);
        }
    }
    container(&scene.name, root.to_string().into_bytes(), &writer.bytes)
}

/// Header, JSON chunk padded with spaces, binary chunk padded with zeros (glTF 2.0, section 4.4).
fn container(name: &str, mut text: Vec<u8>, binary: &[u8]) -> Result<Vec<u8>, SceneError> {
    text.resize(text.len().next_multiple_of(4), b' ');
    let chunks = [(b"JSON", text.as_slice()), (b"BIN\0", binary)];
    let written = chunks.iter().filter(|(_, data)| !data.is_empty());
    let length = 12 + written.clone().map(|(_, data)| 8 + data.len()).sum::<usize>();
    let Ok(total) = u32::try_from(length) else {
        return Err(SceneError::file(name, "needs more than the 4 GiB that a GLB file can hold"));
    };
    let mut file = Vec::with_capacity(length);
    file.extend_from_slice(b"glTF");
    file.extend_from_slice(&2u32.to_le_bytes());
    file.extend_from_slice(&total.to_le_bytes());
    for (kind, data) in written {
        file.extend_from_slice(&(data.len() as u32).to_le_bytes());
        file.extend_from_slice(*kind);
        file.extend_from_slice(data);
    }
    Ok(file)
}

#[derive(Default)]
struct Writer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    extensions_used: Vec<String>,
}

impl Writer {
    fn used(&mut self, extension: &str) {
        self.extensions_used.push(extension.into());
    }

    fn pad(&mut self) {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
    }

    /// Adds bytes as a buffer view, aligned to four; returns its index.
    fn view(&mut self, bytes: impl IntoIterator<Item = u8>, target: Option<u32>) -> usize {
        self.pad();
        let offset = self.bytes.len();
        self.bytes.extend(bytes);
        let mut view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": self.bytes.len() - offset });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.views.push(view);
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Adds an attribute; returns the index of its accessor.
    fn attribute<const N: usize>(&mut self, kind: &str, values: &[[f32; N]]) -> usize {
        let bytes = values.iter().flatten().flat_map(|v| v.to_le_bytes());
        let view = self.view(bytes, Some(ARRAY_BUFFER));
        self.accessor(
            json!({ "bufferView": view, "componentType": FLOAT, "count": values.len(), "type": kind }),
        )
    }

    fn mesh(&mut self, mesh: &Mesh, extensions: Option<&Value>) -> Option<usize> {
        if mesh.triangles.is_empty() {
            return None;
        }
        let positions: Vec<[f32; 3]> = mesh.positions.iter().map(|p| p.to_array()).collect();
        let accessor = self.attribute("VEC3", &positions);
        let min = mesh.positions.iter().fold(Vec3::INFINITY, |a, b| a.min(*b));
        let max = mesh.positions.iter().fold(Vec3::NEG_INFINITY, |a, b| a.max(*b));
        self.accessors[accessor]["min"] = json!(min.to_array());
        self.accessors[accessor]["max"] = json!(max.to_array());
        let mut attributes = json!({ "POSITION": accessor });
        if !mesh.normals.is_empty() {
            let normals: Vec<[f32; 3]> = mesh.normals.iter().map(|n| n.to_array()).collect();
            attributes["NORMAL"] = self.attribute("VEC3", &normals).into();
        }
        if !mesh.uvs.is_empty() {
            let uvs: Vec<[f32; 2]> = mesh.uvs.iter().map(|uv| uv.to_array()).collect();
            attributes["TEXCOORD_0"] = self.attribute("VEC2", &uvs).into();
        }
        let mut materials: Vec<u32> = Vec::new();
        let mut triangles: Vec<Vec<[u32; 3]>> = Vec::new();
        for (t, m) in mesh.triangles.iter().zip(&mesh.triangle_materials) {
            let slot = materials.iter().position(|known| known == m).unwrap_or_else(|| {
                materials.push(*m);
                triangles.push(Vec::new());
                materials.len() - 1
            });
            triangles[slot].push(*t);
        }
        let indices = triangles.iter().flatten().flatten().flat_map(|i| i.to_le_bytes());
        let view = self.view(indices, Some(ELEMENT_ARRAY_BUFFER));
        let mut offset = 0;
        let mut primitives = Vec::new();
        for (material, triangles) in materials.iter().zip(&triangles) {
            let count = 3 * triangles.len();
            let accessor = self.accessor(json!({
                "bufferView": view, "byteOffset": offset, "componentType": UNSIGNED_INT, "count": count,
                "type": "SCALAR",
            }));
            offset += 4 * count;
            primitives.push(json!({ "attributes": attributes, "indices": accessor, "material": material }));
        }
        let mut value = json!({ "name": mesh.name, "primitives": primitives });
        if let Some(extensions) = extensions {
            value["extensions"] = extensions.clone();
        }
        self.meshes.push(value);
        Some(self.meshes.len() - 1)
    }

    fn image(&mut self, texture: &Texture) -> Value {
        let mut png = Vec::new();
        let colour = match texture.format {
            TextureFormat::Srgb8 => image::ExtendedColorType::Rgb8,
        };
        let encoder = image::codecs::png::PngEncoder::new(&mut png);
        image::ImageEncoder::write_image(encoder, &texture.texels, texture.width, texture.height, colour)
            .expect("a checked texture has as many texels as its size says, and memory takes all of them");
        let view = self.view(png, None);
        json!({ "name": texture.name, "bufferView": view, "mimeType": "image/png" })
    }

    fn material(&mut self, m: &Material) -> Value {
        let base = if m.transmission > 0.0 { m.transmission_colour } else { m.albedo };
        let mut pbr = json!({
            "baseColorFactor": [base.x, base.y, base.z, 1.0],
            "metallicFactor": m.specular,
            "roughnessFactor": m.roughness,
        });
        if let Some(texture) = m.albedo_texture {
            pbr["baseColorTexture"] = json!({ "index": texture });
        }
        let mut value = json!({ "name": m.name, "pbrMetallicRoughness": pbr, "doubleSided": m.two_sided });
        let mut extensions = Map::new();
        if m.emission != Vec3::ZERO {
            let (factor, strength) = in_unit_range(m.emission);
            value["emissiveFactor"] = json!(factor.to_array());
            if strength != 1.0 {
                extensions.insert(
                    "KHR_materials_emissive_strength".into(),
                    json!({ "emissiveStrength": strength }),
                );
            }
        }
        if m.transmission > 0.0 {
            extensions
                .insert("KHR_materials_transmission".into(), json!({ "transmissionFactor": m.transmission }));
        }
        if m.transmission > 0.0 && !m.thin {
            // Any thickness above 0 says that the mesh is the border of a solid.
            extensions.insert("KHR_materials_volume".into(), json!({ "thicknessFactor": 1.0 }));
        }
        if m.refractive_index != Material::default().refractive_index {
            extensions.insert("KHR_materials_ior".into(), json!({ "ior": m.refractive_index }));
        }
        if !extensions.is_empty() {
            extensions.keys().for_each(|name| self.extensions_used.push(name.clone()));
            value["extensions"] = Value::Object(extensions);
        }
        value
    }

    /// Nodes of meshes, lights and camera; lights; cameras.
    fn nodes(
        &mut self,
        scene: &Scene,
        mesh_indices: &[Option<usize>],
    ) -> (Vec<Value>, Vec<Value>, Vec<Value>) {
        let (mut nodes, mut lights, mut cameras) = (Vec::new(), Vec::new(), Vec::new());
        for node in &scene.nodes {
            let mesh = node.mesh as usize;
            let matrix = node.transform * DAffine3::from_translation(scene.meshes[mesh].origin);
            let mut value = json!({ "name": node.name });
            if matrix != DAffine3::IDENTITY {
                value["matrix"] = json!(glam::DMat4::from(matrix).to_cols_array());
            }
            if let Some(index) = mesh_indices[mesh] {
                value["mesh"] = index.into();
            }
            nodes.push(value);
        }
        for light in &scene.lights {
            let (factor, intensity) = in_unit_range(light.kind.strength());
            let mut value = json!({ "name": light.name, "color": factor.to_array(), "intensity": intensity });
            let (position, direction) = match light.kind {
                LightKind::Point { position, .. } => {
                    value["type"] = "point".into();
                    (position, Vec3::NEG_Z)
                }
                LightKind::Spot { position, direction, inner_angle, outer_angle, .. } => {
                    value["type"] = "spot".into();
                    value["spot"] = json!({ "innerConeAngle": inner_angle, "outerConeAngle": outer_angle });
                    (position, direction)
                }
                LightKind::Directional { direction, .. } => {
                    value["type"] = "directional".into();
                    (DVec3::ZERO, direction)
                }
            };
            let rotation = DQuat::from_rotation_arc(DVec3::NEG_Z, direction.as_dvec3().normalize());
            nodes.push(json!({
                "name": light.name,
                "translation": position.to_array(),
                "rotation": rotation.to_array(),
                "extensions": { "KHR_lights_punctual": { "light": lights.len() } },
            }));
            lights.push(value);
        }
        if let Some(camera) = scene.camera {
            let back = (camera.eye - camera.target).normalize();
            let right = camera.up.cross(back).normalize();
            let rotation = DQuat::from_mat3(&glam::DMat3::from_cols(right, back.cross(right), back));
            nodes.push(json!({
                "name": "camera", "camera": 0, "translation": camera.eye.to_array(), "rotation": rotation.to_array(),
            }));
            let perspective = json!({ "yfov": camera.vertical_fov, "znear": NEAR_PLANE });
            cameras.push(json!({ "type": "perspective", "perspective": perspective }));
        }
        (nodes, lights, cameras)
    }
}

/// A colour in [0, 1] and a strength whose product is `value`, exactly: the strength is a power of two, at least 1.
fn in_unit_range(value: Vec3) -> (Vec3, f32) {
    let mut strength = 1.0f32;
    while value.max_element() > strength {
        strength *= 2.0;
    }
    (value / strength, strength)
}
