//! From a scene to the files a client streams: shared by `pack` and `demo`.

use std::path::Path;
use std::time::Instant;

use ivg_scene::Scene;
use ivg_stream::{PackInput, PackOptions, PackReport};
use pmesh_build::BuildOptions;

use crate::args::{SCENE_POSITIONS, StorageArguments};
use crate::convert;
use crate::failure::Failure;
use crate::progress::FractionBar;
use crate::reading;
use crate::rounding::Rounding;

/// The streams of a scene's meshes.
#[derive(Debug, Default)]
pub(crate) struct Meshes {
    /// For each mesh of the scene its `.pmesh`, or `None` for a mesh that goes into `scene.glb` whole.
    pub(crate) files: Vec<Option<Vec<u8>>>,
    /// What the progressive meshes take as plain arrays \[bytes\].
    pub(crate) plain_bytes: u64,
    /// Vertices of the progressive meshes.
    pub(crate) vertices: u64,
    /// What is rounded in them, at most.
    pub(crate) rounding: Rounding,
    /// Wall time \[s\].
    pub(crate) seconds: f64,
}

/// Orders and encodes every mesh of more than `coarse_vertices` vertices; smaller ones are not worth a stream of their
/// own, and go into `scene.glb` as they are.
///
/// # Errors
///
/// A usage error if the options contradict each other; or a mesh cannot be ordered or written.
pub(crate) fn order_meshes(
    scene: &Scene,
    coarse_vertices: u32,
    storage: &StorageArguments,
) -> Result<Meshes, Failure> {
    let start = Instant::now();
    let options = storage.options(SCENE_POSITIONS)?;
    let mut meshes = Meshes::default();
    let total: usize = scene.meshes.iter().map(|mesh| mesh.positions.len()).sum();
    let mut before = 0;
    let bar = FractionBar::new("order meshes");
    for mesh in &scene.meshes {
        let here = mesh.positions.len();
        if here <= coarse_vertices as usize {
            meshes.files.push(None);
        } else {
            let indexed = convert::indexed_mesh(mesh, &scene.materials)?;
            let mut progress =
                |done: f32| bar.set((before as f32 + done * here as f32) / total.max(1) as f32);
            let named =
                |error: &dyn std::fmt::Display| Failure::new(format_args!("mesh \"{}\": {error}", mesh.name));
            let (progressive, _) = pmesh_build::build(&indexed, &BuildOptions::default(), &mut progress)
                .map_err(|error| named(&error))?;
            let file = pmesh_format::encode(&progressive, &options).map_err(|error| named(&error))?;
            let header = reading::mesh_header(Path::new(&mesh.name), &file)?;
            meshes.rounding = meshes.rounding.max(Rounding::of(&header));
            meshes.plain_bytes += convert::plain_bytes(&progressive.full());
            meshes.vertices += progressive.positions.len() as u64;
            meshes.files.push(Some(file));
        }
        before += here;
    }
    bar.finish();
    meshes.seconds = start.elapsed().as_secs_f64();
    Ok(meshes)
}

/// Writes the scene directory.
pub(crate) fn pack(
    scene: &Scene,
    meshes: &Meshes,
    grid: &[u8],
    directory: &Path,
    coarse_vertices: u32,
) -> Result<PackReport, Failure> {
    let input = PackInput { scene, meshes: &meshes.files, grid: Some(grid) };
    ivg_stream::pack(&input, directory, &PackOptions { coarse_vertices }).map_err(Failure::new)
}
