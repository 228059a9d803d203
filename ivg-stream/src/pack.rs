//! Writing a scene directory: `scene.glb`, one `.pmesh` a mesh, `light.ivg`.
//!
//! Everything is written beside the directory and put in its place by renaming, so that a directory is there whole
//! or not at all, whatever goes wrong on the way.

mod directory;
mod names;

use std::io;
use std::path::{Path, PathBuf};

use ivg_scene::Scene;
use ivg_scene::export::{GlbOptions, write_glb};
use serde_json::{Map, json};

use crate::client::{SCENE_FILE, SceneLimits, check_grid, read_mesh};
use crate::extensions::{FileEntry, IRRADIANCE_GRID, PROGRESSIVE_MESH, grid_to_json, mesh_to_json};
use crate::manifest::scene_mesh;
use directory::Staged;

/// Name of the file with the indirect light.
const GRID_FILE: &str = "light.ivg";

/// What goes into a scene directory.
#[derive(Debug, Clone, Copy)]
pub struct PackInput<'a> {
    /// The scene: nodes, materials, lights, camera, meshes.
    pub scene: &'a Scene,
    /// For each mesh of the scene the bytes of its `.pmesh`, whose material numbers are indices into
    /// [`Scene::materials`] and whose space is the mesh's own; `None` for a mesh that goes into `scene.glb` whole, as
    /// one without triangles must.
    pub meshes: &'a [Option<Vec<u8>>],
    /// The bytes of the `.ivg` with the indirect light, in the world space of the scene.
    pub grid: Option<&'a [u8]>,
}

/// How a scene directory is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PackOptions {
    /// Vertices of each mesh in `scene.glb`; the coarsest level where that has more.
    pub coarse_vertices: u32,
}

impl Default for PackOptions {
    /// 300 vertices a mesh.
    fn default() -> Self {
        Self { coarse_vertices: 300 }
    }
}

/// What was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PackReport {
    /// Length of `scene.glb` \[bytes\].
    pub scene_bytes: u64,
    /// Each `.pmesh`, in the order of the scene's meshes.
    pub meshes: Vec<FileEntry>,
    /// The `.ivg`.
    pub grid: Option<FileEntry>,
}

/// Why a scene directory was not written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PackError {
    /// The number of progressive meshes is not that of the scene's meshes.
    #[error("{found} progressive meshes for {expected} meshes of the scene")]
    MeshCount {
        /// How many were given.
        found: usize,
        /// How many the scene has.
        expected: usize,
    },
    /// A file that was given is not valid.
    #[error("{what}: {reason}")]
    Content {
        /// Which one, such as `progressive mesh of "dragon"`.
        what: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The scene cannot be written as glTF.
    #[error("scene.glb: {0}")]
    Scene(#[from] ivg_scene::SceneError),
    /// The directory holds something that is no part of a scene directory and would be lost.
    #[error(
        "{directory} holds {name}, which is no part of a packed scene; choose an empty or a new directory"
    )]
    Occupied {
        /// The directory as given.
        directory: PathBuf,
        /// The first such entry.
        name: String,
    },
    /// The file system refuses.
    #[error("cannot write {path}: {source}")]
    Write {
        /// Where.
        path: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },
}

/// Writes a scene directory. An earlier scene directory in its place is replaced as a whole; a directory with
/// anything else in it is left alone.
///
/// # Errors
/// [`PackError`]; then the directory is as it was.
pub fn pack(input: &PackInput<'_>, directory: &Path, options: &PackOptions) -> Result<PackReport, PackError> {
    let PackInput { scene, meshes, grid } = *input;
    if meshes.len() != scene.meshes.len() {
        return Err(PackError::MeshCount { found: meshes.len(), expected: scene.meshes.len() });
    }
    let file_names = names::mesh_files(scene.meshes.iter().map(|mesh| mesh.name.as_str()));
    let mut coarse = scene.clone();
    let mut entries = Vec::new();
    for (index, bytes) in meshes.iter().enumerate() {
        let Some(bytes) = bytes else {
            entries.push(None);
            continue;
        };
        put_coarse_level(&mut coarse, index, bytes, options)?;
        entries.push(Some(FileEntry::of(file_names[index].clone(), bytes)));
    }
    if let Some(bytes) = grid {
        let content = |reason| PackError::Content { what: "irradiance grid".to_owned(), reason };
        check_grid(bytes, &SceneLimits::default()).map_err(content)?;
    }
    let grid_entry = grid.map(|bytes| FileEntry::of(GRID_FILE.to_owned(), bytes));
    let glb = write_scene(&coarse, &entries, grid_entry.as_ref())?;

    let staged = Staged::create(directory)?;
    for (bytes, file) in meshes.iter().zip(&entries) {
        if let (Some(bytes), Some(file)) = (bytes, file) {
            staged.write(&file.uri, bytes)?;
        }
    }
    if let (Some(bytes), Some(file)) = (grid, &grid_entry) {
        staged.write(&file.uri, bytes)?;
    }
    staged.write(SCENE_FILE, &glb)?;
    staged.put_in_place()?;
    Ok(PackReport {
        scene_bytes: glb.len() as u64,
        meshes: entries.into_iter().flatten().collect(),
        grid: grid_entry,
    })
}

/// Replaces mesh `index` by a coarse level of its progressive mesh.
fn put_coarse_level(
    scene: &mut Scene,
    index: usize,
    bytes: &[u8],
    options: &PackOptions,
) -> Result<(), PackError> {
    let mesh = &mut scene.meshes[index];
    let content =
        |reason| PackError::Content { what: format!("progressive mesh of {:?}", mesh.name), reason };
    let mut replay = read_mesh(bytes, &SceneLimits::default()).map_err(content)?;
    let header = replay.header();
    let finest = header.vertex_count;
    let mut level = options.coarse_vertices.clamp(header.base_vertices, finest);
    if finest > 0 {
        replay.set_level(level).map_err(|error| content(error.to_string()))?;
    }
    // glTF has no mesh without triangles.
    while replay.face_count() == 0 {
        if level == finest {
            return Err(content("it has no triangle".to_owned()));
        }
        level = level.saturating_mul(2).min(finest);
        replay.set_level(level).map_err(|error| content(error.to_string()))?;
    }
    let coarse = scene_mesh(&replay.mesh(), mesh.name.clone(), u32::from);
    let known = scene.materials.len();
    if let Some(bad) = coarse.triangle_materials.iter().find(|&&m| m as usize >= known) {
        return Err(content(format!("it has material {bad}, the scene has {known} materials")));
    }
    *mesh = coarse;
    Ok(())
}

/// The bytes of `scene.glb`.
fn write_scene(
    scene: &Scene,
    meshes: &[Option<FileEntry>],
    grid: Option<&FileEntry>,
) -> Result<Vec<u8>, PackError> {
    let mesh = |(file, mesh): (&Option<FileEntry>, &ivg_scene::Mesh)| {
        file.as_ref().map(|file| json!({ PROGRESSIVE_MESH: mesh_to_json(file, mesh.origin.to_array()) }))
    };
    let mut scene_extensions = Map::new();
    if let Some(grid) = grid {
        scene_extensions.insert(IRRADIANCE_GRID.to_owned(), grid_to_json(grid));
    }
    let mut extensions_used = Vec::new();
    if meshes.iter().any(Option::is_some) {
        extensions_used.push(PROGRESSIVE_MESH.to_owned());
    }
    if grid.is_some() {
        extensions_used.push(IRRADIANCE_GRID.to_owned());
    }
    let mesh_extensions = meshes.iter().zip(&scene.meshes).map(mesh).collect();
    Ok(write_glb(scene, &GlbOptions { mesh_extensions, scene_extensions, extensions_used })?)
}
