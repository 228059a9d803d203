//! The two glTF extensions (`spec/gltf-extensions.md`) as JSON: read strictly, written as read.

use std::collections::HashMap;

use serde::Deserialize;
use sha2::{Digest, Sha256};

use crate::digest::hex;
use crate::http::path::is_safe_uri;

/// Name of the extension object of a mesh.
pub const PROGRESSIVE_MESH: &str = "IVG_progressive_mesh";
/// Name of the extension object of a scene.
pub const IRRADIANCE_GRID: &str = "IVG_irradiance_grid";

/// Largest integer that JSON carries exactly everywhere, GLT-EXT-03.
const LARGEST_LENGTH: u64 = (1 << 53) - 1;

/// A file of a scene directory as `scene.glb` names it.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct FileEntry {
    /// Relative to `scene.glb`; safe by GLT-URI-01.
    pub uri: String,
    /// Length \[bytes\], >= 1.
    pub byte_length: u64,
    /// SHA-256 of the whole file.
    pub sha256: [u8; 32],
}

impl FileEntry {
    /// The entry of a file with this content.
    pub(crate) fn of(uri: String, bytes: &[u8]) -> Self {
        Self { uri, byte_length: bytes.len() as u64, sha256: Sha256::digest(bytes).into() }
    }

    /// The SHA-256 as 64 lower-case hexadecimal digits.
    #[must_use]
    pub fn sha256_hex(&self) -> String {
        hex(&self.sha256)
    }
}

/// A mesh's `IVG_progressive_mesh`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MeshExtension {
    /// Index into glTF's `meshes`.
    pub(crate) gltf_mesh: usize,
    pub(crate) file: FileEntry,
    /// Point of the progressive mesh's space at the origin of the glTF mesh's space \[m\].
    pub(crate) origin: [f64; 3],
    /// glTF material of each material of the progressive mesh; `None` means the same numbers.
    pub(crate) materials: Option<Vec<u32>>,
}

/// All uses of our extensions in one glTF file.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Extensions {
    /// In the order of glTF's `meshes`.
    pub(crate) meshes: Vec<MeshExtension>,
    /// Of the default scene.
    pub(crate) grid: Option<FileEntry>,
}

/// What is wrong with the extensions of a `scene.glb`.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ExtensionError {
    /// The container is no binary glTF 2.0 or its JSON is none.
    #[error("not a binary glTF 2.0 file: {what}")]
    NotGlb {
        /// What is wrong.
        what: String,
    },
    /// An extension object breaks a rule of `spec/gltf-extensions.md`.
    #[error("{place}: {what} ({clause})")]
    Rule {
        /// Which object, such as `meshes[2] IVG_progressive_mesh`.
        place: String,
        /// What is wrong.
        what: String,
        /// The clause that is broken.
        clause: &'static str,
    },
}

/// The form of both extension objects; members that are not known are ignored (GLT-EXT-03).
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Form {
    uri: String,
    byte_length: u64,
    sha256: String,
    #[serde(default)]
    origin: [f64; 3],
    materials: Option<Vec<u32>>,
}

/// The parts of a glTF file that matter here.
#[derive(Deserialize)]
struct Document {
    #[serde(default)]
    meshes: Vec<Extended>,
    #[serde(default)]
    scenes: Vec<Extended>,
    scene: Option<usize>,
    #[serde(default)]
    materials: Vec<serde::de::IgnoredAny>,
}

#[derive(Deserialize)]
struct Extended {
    #[serde(default)]
    extensions: HashMap<String, serde_json::Value>,
}

impl Extensions {
    /// Reads the extensions of a binary glTF file.
    pub(crate) fn of_glb(glb: &[u8]) -> Result<Self, ExtensionError> {
        let wrong = |what: String| ExtensionError::NotGlb { what };
        let document: Document =
            serde_json::from_slice(json_chunk(glb)?).map_err(|error| wrong(format!("its JSON: {error}")))?;
        let mut meshes = Vec::new();
        for (index, mesh) in document.meshes.iter().enumerate() {
            if let Some(value) = mesh.extensions.get(PROGRESSIVE_MESH) {
                let place = || format!("meshes[{index}] {PROGRESSIVE_MESH}");
                let (file, form) = read(value, &place)?;
                let Form { origin, materials, .. } = form;
                let known = document.materials.len();
                if let Some(bad) = materials.iter().flatten().find(|&&m| m as usize >= known) {
                    let what = format!("material {bad} of {known} does not exist");
                    return Err(ExtensionError::Rule { place: place(), what, clause: "GLT-PM-04" });
                }
                meshes.push(MeshExtension { gltf_mesh: index, file, origin, materials });
            }
        }
        let index = document.scene.unwrap_or(0);
        let grid = document.scenes.get(index).and_then(|scene| scene.extensions.get(IRRADIANCE_GRID));
        let grid =
            grid.map(|value| read(value, &|| format!("scenes[{index}] {IRRADIANCE_GRID}"))).transpose()?;
        let extensions = Self { meshes, grid: grid.map(|(file, _)| file) };
        extensions.check_same_file()?;
        Ok(extensions)
    }

    /// GLT-EXT-05.
    fn check_same_file(&self) -> Result<(), ExtensionError> {
        let mut first: HashMap<&str, &FileEntry> = HashMap::new();
        for file in self.meshes.iter().map(|mesh| &mesh.file).chain(&self.grid) {
            let known = *first.entry(file.uri.as_str()).or_insert(file);
            if known != file {
                let what = "two objects state different lengths or checksums".to_owned();
                return Err(ExtensionError::Rule { place: file.uri.clone(), what, clause: "GLT-EXT-05" });
            }
        }
        Ok(())
    }
}

/// The JSON of `IVG_irradiance_grid`.
pub(crate) fn grid_to_json(file: &FileEntry) -> serde_json::Value {
    serde_json::json!({ "uri": file.uri, "byteLength": file.byte_length, "sha256": file.sha256_hex() })
}

/// The JSON of `IVG_progressive_mesh` with its materials under their own numbers.
pub(crate) fn mesh_to_json(file: &FileEntry, origin: [f64; 3]) -> serde_json::Value {
    let mut object = grid_to_json(file);
    if origin != [0.0; 3] {
        object["origin"] = origin.as_slice().into();
    }
    object
}

fn read(value: &serde_json::Value, place: &dyn Fn() -> String) -> Result<(FileEntry, Form), ExtensionError> {
    let broken = |what: String, clause| ExtensionError::Rule { place: place(), what, clause };
    let form = Form::deserialize(value).map_err(|error| broken(error.to_string(), "GLT-EXT-03"))?;
    if !is_safe_uri(&form.uri) {
        return Err(broken(format!("uri {:?} is not a plain relative path", form.uri), "GLT-URI-01"));
    }
    if form.byte_length == 0 || form.byte_length > LARGEST_LENGTH {
        return Err(broken(format!("byteLength {} is out of range", form.byte_length), "GLT-EXT-03"));
    }
    if form.origin.iter().any(|x| !x.is_finite()) {
        return Err(broken("origin is not finite".to_owned(), "GLT-PM-02"));
    }
    let sha256 = parse_sha256(&form.sha256).ok_or_else(|| {
        broken(format!("sha256 {:?} is not 64 digits of 0-9a-f", form.sha256), "GLT-EXT-03")
    })?;
    let file = FileEntry { uri: form.uri.clone(), byte_length: form.byte_length, sha256 };
    Ok((file, form))
}

fn parse_sha256(text: &str) -> Option<[u8; 32]> {
    let digit = |b: u8| match b {
        b'0'..=b'9' => Some(b - b'0'),
        b'a'..=b'f' => Some(b - b'a' + 10),
        _ => None,
    };
    let digits = text.bytes().map(digit).collect::<Option<Vec<u8>>>()?;
    let bytes: Vec<u8> = digits.chunks_exact(2).map(|pair| pair[0] << 4 | pair[1]).collect();
    (digits.len() == 64).then(|| bytes.try_into().ok()).flatten()
}

/// The JSON chunk of a binary glTF file, glTF 2.0 section 4.4.
pub(crate) fn json_chunk(glb: &[u8]) -> Result<&[u8], ExtensionError> {
    let wrong = |what: &str| ExtensionError::NotGlb { what: what.to_owned() };
    let word =
        |at: usize| glb.get(at..at + 4).and_then(|bytes| bytes.try_into().ok()).map(u32::from_le_bytes);
    if glb.get(..4) != Some(b"glTF") {
        return Err(wrong("it does not begin with glTF"));
    }
    if word(4) != Some(2) {
        return Err(wrong("its container version is not 2"));
    }
    let length = word(12).ok_or_else(|| wrong("it ends inside its header"))?;
    if glb.get(16..20) != Some(b"JSON") {
        return Err(wrong("its first chunk is not JSON"));
    }
    usize::try_from(length)
        .ok()
        .and_then(|length| glb.get(20..)?.get(..length))
        .ok_or_else(|| wrong("it ends inside its JSON"))
}

#[cfg(test)]
mod tests;
