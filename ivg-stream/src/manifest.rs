//! What a `scene.glb` says: the scene with its coarse meshes, and the files with the rest.

use ivg_scene::{Material, Mesh, Scene, SceneError, import};
use pmesh_format::{IndexedMesh, Mode, Replay};

use glam::{DAffine3, DVec3, Vec2, Vec3};

use crate::extensions::{ExtensionError, Extensions, FileEntry, MeshExtension};

/// The content of a `scene.glb`.
#[derive(Debug, Clone, PartialEq)]
pub struct Manifest {
    /// The scene as any viewer sees it: coarse meshes, materials, lights, camera, nodes.
    pub scene: Scene,
    /// The meshes that have a file of their own, in the order of [`Scene::meshes`].
    pub meshes: Vec<MeshEntry>,
    /// The file with the indirect light, if the scene has one.
    pub grid: Option<FileEntry>,
}

/// A mesh that has a file of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshEntry {
    /// Index into [`Scene::meshes`] of the mesh it replaces.
    pub mesh: usize,
    /// The progressive mesh.
    pub file: FileEntry,
    /// Point of the progressive mesh's space at the origin of the mesh's space in `scene.glb` \[m\].
    pub origin: [f64; 3],
    /// Index into [`Scene::materials`] of each material of the progressive mesh; `None` means the same numbers.
    pub materials: Option<Vec<u32>>,
}

/// Why a `scene.glb` cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ManifestError {
    /// The extensions are wrong.
    #[error(transparent)]
    Extension(#[from] ExtensionError),
    /// The scene itself is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

impl Manifest {
    /// Reads a `scene.glb`.
    ///
    /// # Errors
    /// [`ManifestError`] if it is no glTF 2.0 file, its scene cannot be read, or an extension object breaks a rule
    /// of `spec/gltf-extensions.md`.
    pub fn from_glb(glb: &[u8]) -> Result<Self, ManifestError> {
        let Extensions { meshes, grid } = Extensions::of_glb(glb)?;
        let scene = import::from_bytes("scene.glb", glb)?;
        let meshes = meshes
            .into_iter()
            .map(|MeshExtension { gltf_mesh, file, origin, materials }| MeshEntry {
                mesh: gltf_mesh,
                file,
                origin,
                materials,
            })
            .collect();
        Ok(Self { scene, meshes, grid })
    }
}

impl MeshEntry {
    /// From the space of the progressive mesh to the world, where a node of this transform shows it.
    #[must_use]
    pub fn transform(&self, node: &DAffine3) -> DAffine3 {
        *node * DAffine3::from_translation(-DVec3::from_array(self.origin))
    }

    /// Puts the level that `replay` is at in the place of the mesh.
    pub(crate) fn put(&self, replay: &Replay, scene: &mut Scene) {
        let level = replay.mesh();
        let fallback = scene.materials.len() as u32;
        let material = |number: u16| {
            let index = match &self.materials {
                Some(materials) => materials.get(usize::from(number)).copied(),
                None => Some(u32::from(number)),
            };
            index.filter(|&index| index < fallback).unwrap_or(fallback)
        };
        let Some(mesh) = scene.meshes.get_mut(self.mesh) else { return };
        *mesh = scene_mesh(&level, std::mem::take(&mut mesh.name), material);
        mesh.origin -= DVec3::from_array(self.origin);
        // GLT-PM-04: the default material of glTF, added only where a face needs it.
        if mesh.triangle_materials.contains(&fallback) {
            scene.materials.push(Material::default());
        }
    }
}

/// The level of so many vertices, or the nearest that has arrived.
pub(crate) fn nearest_level(replay: &Replay, wanted: u32) -> Option<u32> {
    let levels = replay.levels()?;
    Some(wanted.clamp(*levels.start(), *levels.end()))
}

/// The level of that share of all vertices, in \[0, 1\], or the highest that has arrived if that is lower; of a coded mesh the
/// last one of its packet: in between, levels are not whole (PMESH-LVL-06).
pub(crate) fn level_of_share(replay: &Replay, share: f64) -> Option<u32> {
    let header = replay.header();
    let wanted = (share.clamp(0.0, 1.0) * f64::from(header.vertex_count)).ceil() as u32;
    let packet = header.packet_of_level(wanted).filter(|_| header.mode == Mode::Coded);
    let end = packet.and_then(|packet| header.packets.get(packet as usize)).map(|entry| entry.vertices.end);
    nearest_level(replay, end.unwrap_or(wanted))
}

/// A level of a progressive mesh as a mesh of a scene: one vertex a wedge, so that every corner keeps its normal, texture
/// coordinate and colour. `material` gives the scene's number of a material.
///
/// # Panics
///
/// If a wedge names a vertex that the mesh does not have; [`pmesh_format::check_level`] finds that out without a panic.
#[must_use]
pub fn scene_mesh(mesh: &IndexedMesh, name: String, material: impl Fn(u16) -> u32) -> Mesh {
    let wedges = &mesh.wedges;
    Mesh {
        name,
        origin: DVec3::from_array(mesh.origin),
        positions: wedges.vertices.iter().map(|&v| Vec3::from_array(mesh.positions[v as usize])).collect(),
        normals: wedges.normals.iter().map(|&n| Vec3::from_array(n)).collect(),
        uvs: wedges.uvs.iter().map(|&uv| Vec2::from_array(uv)).collect(),
        colours: wedges.colours.clone(),
        triangles: mesh.triangles.clone(),
        triangle_materials: (0..mesh.triangles.len()).map(|i| material(mesh.material(i))).collect(),
    }
}

#[cfg(test)]
mod tests;
