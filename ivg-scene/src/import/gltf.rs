//! glTF 2.0, as `.gltf` and `.glb`. The gltf crate reads and validates the JSON; the binary data is read here, with
//! every range checked, since buffers may be compressed, quantised or hostile.
//!
//! Node transforms, light placements and the camera are read as f64: JSON holds them as decimal text, and our own writer
//! writes all digits.

mod accessor;
mod buffers;
mod material;
mod mesh;

use ::gltf::json::{self, Root, validation::Validate};
use glam::{DAffine3, DMat4, DQuat, DVec3, Vec3};
use serde::Deserialize;

use super::folder::Folder;
use crate::{Camera, Light, LightKind, Node, Scene, SceneError, Unsupported};
use accessor::Data;

/// Extensions that a file may require.
const SUPPORTED: [&str; 9] = [
    "EXT_meshopt_compression",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_texture_transform",
];
/// Extensions of this project, which its other crates read.
const OWN_PREFIX: &str = "IVG_";

/// Distance of the camera's target from its eye, which glTF does not state \[m\].
const TARGET_DISTANCE: f64 = 1.0;

/// What is read beside the gltf crate's own types: f64 transforms and our extras.
#[derive(Deserialize)]
struct Precise {
    #[serde(default)]
    nodes: Vec<PreciseNode>,
    #[serde(default)]
    scenes: Vec<PreciseScene>,
}

#[derive(Deserialize)]
struct PreciseNode {
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

#[derive(Deserialize)]
struct PreciseScene {
    #[serde(default)]
    extras: Option<serde_json::Value>,
}

/// The key under `scenes[i].extras` that holds the radiance of the sky \[W/(m² sr)\], linear RGB.
pub(crate) const SKY_KEY: &str = "skyRadiance";

/// Reads a `.gltf` or `.glb`, told apart by the first bytes.
pub(crate) fn read(name: &str, bytes: &[u8], folder: &Folder) -> Result<Scene, SceneError> {
    let (text, blob) = split(name, bytes)?;
    let bad_json = |e: serde_json::Error| SceneError::line(name, e.line(), format!("JSON: {e}"));
    let mut root: Root = serde_json::from_slice(text).map_err(bad_json)?;
    let precise: Precise = serde_json::from_slice(text).map_err(bad_json)?;
    check(name, &mut root)?;

    let data = Data::new(name, &root, buffers::load(name, &root, blob, folder)?);
    let mut scene = Scene::default();
    report_unsupported(name, &root, &mut scene);
    let textures = material::read(&data, folder, &mut scene)?;
    mesh::read(&data, &textures, &mut scene)?;
    Walk { name, root: &root, precise: &precise, scene: &mut scene }.run()?;
    Ok(scene)
}

/// The JSON text and the binary chunk of a file.
fn split<'a>(name: &str, bytes: &'a [u8]) -> Result<(&'a [u8], Option<&'a [u8]>), SceneError> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes, None));
    }
    let bad = |offset: usize, what: &str| {
        Err(SceneError::Byte { file: name.into(), offset: offset as u64, what: what.into() })
    };
    let word = |at: usize| {
        let four = bytes.get(at..at.checked_add(4)?)?;
        Some(u32::from_le_bytes([four[0], four[1], four[2], four[3]]))
    };
    match word(4) {
        Some(2) => {}
        Some(other) => return bad(4, &format!("GLB version {other} is not 2")),
        None => return bad(bytes.len(), "GLB ends within its header"),
    }
    let (mut at, mut text, mut blob) = (12, None, None);
    while at < bytes.len() {
        let (Some(length), Some(kind)) = (word(at), word(at + 4)) else {
            return bad(at, "GLB ends within a chunk header");
        };
        let Some(chunk) = (at + 8).checked_add(length as usize).and_then(|end| bytes.get(at + 8..end)) else {
            return bad(at, "GLB ends within a chunk");
        };
        match &kind.to_le_bytes() {
            b"JSON" if text.is_none() => text = Some(chunk),
            b"BIN\0" if blob.is_none() => blob = Some(chunk),
            // Chunks of other kinds are to be passed over (glTF 2.0, 4.4.3).
            _ => {}
        }
        at += 8 + length as usize;
    }
    match text {
        Some(text) => Ok((text, blob)),
        None => bad(12, "GLB has no JSON chunk"),
    }
}

/// Extensions, version and all indices; what comes after may follow them.
fn check(name: &str, root: &mut Root) -> Result<(), SceneError> {
    if !root.asset.version.starts_with("2.") {
        return Err(SceneError::file(name, format!("glTF version {} is not 2", root.asset.version)));
    }
    let unknown: Vec<&str> = (root.extensions_required.iter().map(String::as_str))
        .filter(|e| !SUPPORTED.contains(e) && !e.starts_with(OWN_PREFIX))
        .collect();
    if !unknown.is_empty() {
        return Err(SceneError::file(
            name,
            format!(
                "requires glTF extensions that are not supported: {}; export without them",
                unknown.join(", ")
            ),
        ));
    }
    // Checked above; the validation below knows fewer.
    root.extensions_required.clear();
    // The crate's validation looks POSITION up before it has checked the index.
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            if let Some(index) = primitive.attributes.values().find(|i| i.value() >= root.accessors.len()) {
                let what = format!("meshes[{m}].primitives[{p}]: accessor {} does not exist", index.value());
                return Err(SceneError::file(name, what));
            }
        }
    }
    let mut first = None;
    root.validate(root, json::Path::new, &mut |path, error| {
        first.get_or_insert_with(|| format!("{}: {error}", path()));
    });
    first.map_or(Ok(()), |what| Err(SceneError::file(name, what)))
}

fn report_unsupported(name: &str, root: &Root, scene: &mut Scene) {
    let mut report = |what: String| scene.unsupported.push(Unsupported { object: name.into(), what });
    for extension in &root.extensions_used {
        if !SUPPORTED.contains(&extension.as_str()) && !extension.starts_with(OWN_PREFIX) {
            report(format!("glTF extension {extension}: ignored"));
        }
    }
    if !root.animations.is_empty() {
        report(format!("{} animations: the scene is taken as it stands", root.animations.len()));
    }
}

/// The walk down the nodes of the default scene.
struct Walk<'a> {
    name: &'a str,
    root: &'a Root,
    precise: &'a Precise,
    scene: &'a mut Scene,
}

impl Walk<'_> {
    fn run(&mut self) -> Result<(), SceneError> {
        let roots: Vec<usize> = match self.root.scenes.get(self.root.scene.map_or(0, |s| s.value())) {
            Some(scene) => scene.nodes.iter().map(|n| n.value()).collect(),
            None => {
                let children = self.root.nodes.iter().filter_map(|n| n.children.as_ref()).flatten();
                let mut is_root = vec![true; self.root.nodes.len()];
                children.for_each(|c| is_root[c.value()] = false);
                (0..is_root.len()).filter(|n| is_root[*n]).collect()
            }
        };
        self.sky();
        let mut visited = vec![false; self.root.nodes.len()];
        // Last in, first out: pushing in reverse keeps the order of the file.
        let mut todo: Vec<(usize, DAffine3)> =
            roots.into_iter().rev().map(|n| (n, DAffine3::IDENTITY)).collect();
        while let Some((index, parent)) = todo.pop() {
            if std::mem::replace(&mut visited[index], true) {
                return Err(SceneError::file(self.name, format!("nodes[{index}] has more than one parent")));
            }
            let transform = parent * self.transform(index);
            self.node(index, transform);
            let children = self.root.nodes[index].children.iter().flatten();
            todo.extend(children.rev().map(|child| (child.value(), transform)));
        }
        Ok(())
    }

    fn sky(&mut self) {
        let extras =
            self.precise.scenes.get(self.root.scene.map_or(0, |s| s.value())).and_then(|s| s.extras.as_ref());
        let sky = extras.and_then(|e| e.get(SKY_KEY)).and_then(|v| <[f32; 3]>::deserialize(v).ok());
        self.scene.sky = sky.map(Vec3::from_array);
    }

    fn transform(&self, index: usize) -> DAffine3 {
        let Some(node) = self.precise.nodes.get(index) else { return DAffine3::IDENTITY };
        if let Some(matrix) = node.matrix {
            return DAffine3::from_mat4(DMat4::from_cols_array(&matrix));
        }
        let rotation = DQuat::from_array(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
        let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY };
        DAffine3::from_scale_rotation_translation(
            DVec3::from_array(node.scale.unwrap_or([1.0; 3])),
            rotation,
            DVec3::from_array(node.translation.unwrap_or([0.0; 3])),
        )
    }

    fn node(&mut self, index: usize, transform: DAffine3) {
        let node = &self.root.nodes[index];
        let named = |fallback: Option<&String>| node.name.as_ref().or(fallback).cloned().unwrap_or_default();
        if let Some(mesh) = node.mesh {
            let mesh = mesh.value() as u32;
            let name = named(Some(&self.scene.meshes[mesh as usize].name));
            if node.skin.is_some() {
                self.report(&name, "skin: the mesh is taken as it stands");
            }
            if transform.matrix3.determinant() == 0.0 {
                self.scene.warnings.push(format!("node \"{name}\": scaled to nothing, left out"));
            } else {
                self.scene.nodes.push(Node { name, mesh, transform });
            }
        }
        let axis = (transform.matrix3 * DVec3::NEG_Z).normalize_or(DVec3::NEG_Z);
        if let Some(camera) = node.camera.and_then(|c| self.root.cameras.get(c.value())) {
            match (&camera.perspective, self.scene.camera) {
                (Some(perspective), None) => {
                    self.scene.camera = Some(Camera {
                        eye: transform.translation,
                        target: transform.translation + TARGET_DISTANCE * axis,
                        up: (transform.matrix3 * DVec3::Y).normalize_or(DVec3::Y),
                        vertical_fov: perspective.yfov,
                    });
                }
                (Some(_), Some(_)) => {}
                (None, _) => self.report(&named(camera.name.as_ref()), "orthographic camera: left out"),
            }
        }
        let light = node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref()).and_then(|l| {
            self.root.extensions.as_ref()?.khr_lights_punctual.as_ref()?.lights.get(l.light.value())
        });
        if let Some(light) = light {
            let name = light.name.clone().or_else(|| node.name.clone());
            let name = name.unwrap_or_else(|| format!("light {}", self.scene.lights.len() + 1));
            let kind = punctual(light, transform.translation, axis.as_vec3());
            self.scene.lights.push(Light { name, kind });
        }
    }

    fn report(&mut self, object: &str, what: &str) {
        self.scene.unsupported.push(Unsupported { object: format!("node \"{object}\""), what: what.into() });
    }
}

fn punctual(
    light: &json::extensions::scene::khr_lights_punctual::Light,
    position: DVec3,
    direction: Vec3,
) -> LightKind {
    use json::extensions::scene::khr_lights_punctual::Type;
    use json::validation::Checked;
    let strength = light.intensity * Vec3::from_array(light.color);
    match (&light.type_, &light.spot) {
        (Checked::Valid(Type::Directional), _) => LightKind::Directional { direction, irradiance: strength },
        (Checked::Valid(Type::Spot), Some(spot)) => LightKind::Spot {
            position,
            direction,
            intensity: strength,
            inner_angle: spot.inner_cone_angle,
            outer_angle: spot.outer_cone_angle,
        },
        _ => LightKind::Point { position, intensity: strength },
    }
}

#[cfg(test)]
mod tests;
