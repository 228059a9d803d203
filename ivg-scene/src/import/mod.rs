//! Reading scenes: OBJ with MTL, glTF 2.0 (`.gltf`, `.glb`) and PLY, each also as `.gz` or `.zst`; and lights
//! files, which add lights and a camera to any of them.
//!
//! | format | lights | camera | materials |
//! |---|---|---|---|
//! | OBJ + MTL | `Ke`: emitted radiance \[W/(m² sr)\] | none | `Kd` linear, `map_Kd` sRGB, `Ks Ns Tf Ni d illum` |
//! | glTF 2.0 | emissive factor × strength as radiance \[W/(m² sr)\], punctual lights in W/sr and W/m² | perspective | base colour, metallic, roughness, transmission, index of refraction, thin or solid |
//! | PLY | none | none | [`Material::default`](crate::Material) |
//!
//! glTF states punctual lights in candela and lux. They are taken 1:1 as radiometric figures (W/sr, W/m²), as
//! is emissive strength: this project is radiometric throughout, and a luminous efficacy would be a guess.
//!
//! Input may be hostile: nothing here panics, allocates from a declared count alone, or reads a file outside
//! the folder of the scene file.

mod compress;
pub(crate) mod folder;
mod gltf;
pub(crate) mod image;
mod obj;
mod ply;

use std::path::{Path, PathBuf};

use crate::{Scene, SceneError, lights};
use compress::MAX_FILE_BYTES;
use folder::Folder;
pub(crate) use gltf::SKY_KEY;

/// What may be said about an import besides the file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ImportOptions {
    /// A lights file (TOML) whose lights, sky, camera and unit are applied to the scene.
    pub lights: Option<PathBuf>,
}

/// Reads a scene, by the extension of its name with `.gz` or `.zst` stripped, and checks it.
///
/// # Errors
///
/// [`SceneError`] naming file and line, byte or object; an unknown extension names the known ones.
pub fn load(path: &Path, options: &ImportOptions) -> Result<Scene, SceneError> {
    let bytes = compress::read_file(path, MAX_FILE_BYTES)?;
    let name = path.display().to_string();
    let mut scene = read(&name, &bytes, &Folder::of(path))?;
    drop(bytes);
    if let Some(file) = &options.lights {
        let text = compress::read_file(file, lights::MAX_BYTES)?;
        let name = file.display().to_string();
        let text = String::from_utf8(text).map_err(|_| SceneError::file(&name, "is not UTF-8 text"))?;
        lights::apply_beside(&mut scene, &name, &text, &Folder::of(file))?;
    }
    scene.check()?;
    Ok(scene)
}

/// A channel of a colour in eight bits; `None` unless it lies in \[0, `full`\].
fn channel(value: f64, full: f64) -> Option<u8> {
    (0.0..=full).contains(&value).then(|| (value / full * f64::from(u8::MAX)).round() as u8)
}

/// Reads a scene from memory, without access to any other file: OBJ materials and glTF data must be in
/// `bytes`. `name` decides the format by its extension and is named in errors.
///
/// # Errors
///
/// As [`load`].
pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<Scene, SceneError> {
    let scene = read(name, bytes, &Folder::none())?;
    scene.check()?;
    Ok(scene)
}

/// Body of the fuzz target `scene_import`: the first byte chooses the format, the rest is the file.
#[cfg(feature = "fuzz")]
pub fn fuzz_scene_import(data: &[u8]) {
    let Some((choice, bytes)) = data.split_first() else { return };
    let name = ["fuzz.obj", "fuzz.ply", "fuzz.glb", "fuzz.gltf"][usize::from(choice % 4)];
    if let Ok(scene) = from_bytes(name, bytes) {
        // What passes the check must be fit for all that comes after it.
        let flat = scene.flatten();
        let _ = crate::plan::analyse(&scene, &flat, &crate::PlanOptions::default());
        let _ = scene.camera_or_framed();
        let _ = crate::export::write_glb(&scene, &crate::export::GlbOptions::default());
    }
    if let Ok(text) = std::str::from_utf8(bytes) {
        let _ = lights::apply(&mut Scene::default(), "fuzz.toml", text);
    }
}

fn read(name: &str, bytes: &[u8], folder: &Folder) -> Result<Scene, SceneError> {
    let (plain, _) = compress::strip(name);
    let stem = Path::new(plain).file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    let extension = Path::new(plain).extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    let mut scene = match extension.as_deref() {
        Some("obj") => obj::read(name, &stem, bytes, folder)?,
        Some("gltf" | "glb") => gltf::read(name, bytes, folder)?,
        Some("ply") => ply::read(name, &stem, bytes)?,
        _ => {
            return Err(SceneError::file(
                name,
                "has no known extension; known are .obj .gltf .glb .ply, each also with .gz or .zst",
            ));
        }
    };
    scene.name = stem;
    Ok(scene)
}

#[cfg(test)]
mod tests;
