//! What the manifest says of the levels of a `.pmesh` file.

use pmesh_format::{IndexedMesh, Limits, Replay, decode_all};
use serde::Serialize;
use sha2::{Digest, Sha256};

/// A level and a hash of all that a reader shows there.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LevelHash {
    /// The number of vertices.
    pub level: u32,
    /// The SHA-256 of [`level_bytes`], hexadecimal.
    pub sha256: String,
}

/// All that a reader shows of a level, little-endian: numbers of vertices, wedges and faces as u32; positions without the origin as
/// f32, the vertex of each wedge as u32, normals and texture coordinates as f32, colours; corners as u32, materials as u16. Arrays that
/// the file does not have are left out.
#[must_use]
pub fn level_bytes(mesh: &IndexedMesh) -> Vec<u8> {
    let wedges = &mesh.wedges;
    let counts = [mesh.positions.len(), wedges.len(), mesh.triangles.len()];
    let mut bytes: Vec<u8> = counts.iter().flat_map(|&count| (count as u32).to_le_bytes()).collect();
    let floats = |array: &[f32]| array.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let words = |array: &[u32]| array.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    bytes.extend(floats(mesh.positions.as_flattened()));
    bytes.extend(words(&wedges.vertices));
    bytes.extend(floats(wedges.normals.as_flattened()));
    bytes.extend(floats(wedges.uvs.as_flattened()));
    bytes.extend(wedges.colours.as_flattened());
    bytes.extend(words(mesh.triangles.as_flattened()));
    bytes.extend(mesh.materials.iter().flat_map(|material| material.to_le_bytes()));
    bytes
}

/// The hashes of four levels of a file that is right, or of as many as it has: the coarsest, the finest, two in between.
pub(super) fn level_hashes(file: &[u8]) -> Vec<LevelHash> {
    let mut replay = Replay::default();
    if decode_all(file, &Limits::default(), |event| replay.accept(&event).map(drop)).is_err() {
        return Vec::new();
    }
    let Some(range) = replay.levels() else { return Vec::new() };
    let (coarsest, finest) = range.into_inner();
    let mut levels: Vec<u32> = (0..4).map(|third| coarsest + (finest - coarsest) * third / 3).collect();
    levels.dedup();
    levels
        .into_iter()
        .map(|level| {
            replay.set_level(level).expect("a level of the file");
            let digest = Sha256::digest(level_bytes(&replay.mesh()));
            LevelHash { level, sha256: digest.iter().map(|byte| format!("{byte:02x}")).collect() }
        })
        .collect()
}
