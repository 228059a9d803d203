//! What a reader shows of a level of a `.pmesh` file.

use pmesh_format::IndexedMesh;

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
