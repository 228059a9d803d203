//! Between the meshes of a scene and those that have a collapse order.

use std::path::Path;

use glam::DVec3;
use ivg_scene::{Material, Mesh, Scene};
use pmesh_format::{IndexedMesh, Wedges};

use crate::failure::Failure;

/// One scene mesh in its own space; every vertex of the source is a wedge. A mesh without normals gets some if its sharp
/// edges would be lost otherwise: the build joins vertices at one place.
///
/// # Errors
///
/// Fails if a material index does not fit the format's 16 bits.
pub(crate) fn indexed_mesh(mesh: &Mesh, materials: &[Material]) -> Result<IndexedMesh, Failure> {
    let mut out = IndexedMesh::from_positions(
        mesh.positions.iter().map(|p| p.to_array()).collect(),
        mesh.triangles.clone(),
    );
    out.origin = mesh.origin.to_array();
    if !mesh.normals.is_empty() || mesh.has_unstored_creases() {
        out.wedges.normals = mesh.shading_normals().iter().map(|n| n.to_array()).collect();
    }
    out.wedges.uvs = mesh.uvs.iter().map(|uv| uv.to_array()).collect();
    out.wedges.colours = mesh.colours.clone();
    set_materials(&mut out, &mesh.triangle_materials, materials, &mesh.name)?;
    Ok(out)
}

/// All meshes of the scene from `path`, placed by its nodes, as one mesh in world space.
///
/// Normals and texture coordinates are kept only if every mesh has them: a mesh has one set of attributes. What is left out
/// for that is named, one sentence each, with what the file asks for and scenes do not have.
///
/// # Errors
///
/// Fails if the scene has no triangle, or a material index does not fit the format's 16 bits.
pub(crate) fn joined_mesh(path: &Path, scene: &Scene) -> Result<(IndexedMesh, Vec<String>), Failure> {
    let placed = || scene.nodes.iter().map(|node| &scene.meshes[node.mesh as usize]);
    if placed().all(|mesh| mesh.triangles.is_empty()) {
        return Err(Failure::file(path, "the file has no triangle"));
    }
    let with_normals = placed().all(|mesh| !mesh.normals.is_empty());
    let with_uvs = placed().all(|mesh| !mesh.uvs.is_empty());
    let dropped = [
        ("normals", with_normals, placed().any(|mesh| !mesh.normals.is_empty())),
        ("texture coordinates", with_uvs, placed().any(|mesh| !mesh.uvs.is_empty())),
    ]
    .into_iter()
    .filter(|&(_, all, any)| any && !all)
    .map(|(what, ..)| format!("{}: {what}, as not every mesh of the file has them: left out", scene.name));
    let left_out = scene.unsupported.iter().map(|item| format!("{}: {}", item.object, item.what));
    let left_out = left_out.chain(dropped).collect();
    let flat = scene.flatten();
    let mut out = IndexedMesh::from_positions(
        flat.positions.iter().map(|p| p.to_array()).collect(),
        flat.triangles.clone(),
    );
    out.origin = DVec3::to_array(&flat.origin);
    if with_normals {
        out.wedges.normals = flat.normals.iter().map(|n| n.to_array()).collect();
    }
    if with_uvs {
        out.wedges.uvs = flat.uvs.iter().map(|uv| uv.to_array()).collect();
    }
    out.wedges.colours = flat.colours;
    set_materials(&mut out, &flat.triangle_materials, &scene.materials, &scene.name)?;
    Ok((out, left_out))
}

fn set_materials(
    out: &mut IndexedMesh,
    triangle_materials: &[u32],
    materials: &[Material],
    object: &str,
) -> Result<(), Failure> {
    out.materials = triangle_materials
        .iter()
        .map(|&index| u16::try_from(index))
        .collect::<Result<_, _>>()
        .map_err(|_| Failure::new(format_args!("{object}: more than 65536 materials; join some")))?;
    out.material_names = materials.iter().map(|material| material.name.clone()).collect();
    Ok(())
}

/// How many bytes the mesh takes as plain arrays: positions, attributes, corner indices.
pub(crate) fn plain_bytes(mesh: &IndexedMesh) -> u64 {
    let Wedges { vertices, normals, uvs, colours } = &mesh.wedges;
    let attributes = normals.len() * 12 + uvs.len() * 8 + colours.len() * 4;
    // A mesh with attributes is drawn by wedge, so it stores a position for each.
    let positions = if attributes > 0 { vertices.len() } else { mesh.positions.len() };
    (positions * 12 + attributes + mesh.triangles.len() * 12) as u64
}
