//! A scene directory on disk, read whole.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use ivg_grid::IrradianceGrid;
use ivg_scene::Scene;
use pmesh_format::{LevelChange, Replay};

use crate::client::{Assembly, FileReader, SCENE_FILE, SceneLimits};
use crate::manifest::{Manifest, ManifestError};
use crate::view::View;

/// A scene directory that has been read and verified whole: what a [`Session`](crate::Session) holds once
/// everything has arrived.
#[derive(Debug)]
pub struct LocalScene {
    assembly: Assembly,
}

/// Why a scene directory cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// A file cannot be read.
    #[error("cannot read {path}: {source}")]
    Read {
        /// Which file.
        path: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },
    /// `scene.glb` cannot be used.
    #[error("{path}: {source}")]
    Scene {
        /// Which file.
        path: PathBuf,
        /// What is wrong with it.
        source: ManifestError,
    },
    /// A file is not valid, not within the limits, or not the one that `scene.glb` states.
    #[error("{path}: {reason}")]
    Content {
        /// Which file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}

impl LocalScene {
    /// Reads a scene directory, or the one that a `scene.glb` lies in.
    ///
    /// # Errors
    /// [`LoadError`] naming the file.
    pub fn open(path: &Path, limits: SceneLimits) -> Result<Self, LoadError> {
        let directory = match path.file_name() {
            Some(name) if name == SCENE_FILE => path.parent().unwrap_or(Path::new("")),
            _ => path,
        };
        let glb_path = directory.join(SCENE_FILE);
        let glb = read_limited(&glb_path, limits.scene_bytes)?;
        let manifest =
            Manifest::from_glb(&glb).map_err(|source| LoadError::Scene { path: glb_path, source })?;
        let mut assembly = Assembly::new(manifest, limits);
        for mut reader in assembly.readers() {
            let path = directory.join(reader.uri());
            stream(directory, &path, &mut reader)?;
            reader.finish().map_err(|reason| LoadError::Content { path, reason })?;
        }
        Ok(Self { assembly })
    }

    /// What `scene.glb` says, with its coarse meshes.
    #[must_use]
    pub fn manifest(&self) -> &Manifest {
        self.assembly.manifest()
    }

    /// Mesh `index` of [`Manifest::meshes`] at all its levels.
    #[must_use]
    pub fn replay(&self, index: usize) -> Option<&Replay> {
        self.assembly.replay(index)
    }

    /// The grid, if the scene has one, filled: vertices inside geometry have a value too. The first call fills it.
    #[must_use]
    pub fn grid(&mut self) -> Option<&IrradianceGrid> {
        self.assembly.grid()
    }

    /// The header of the grid's file, if the scene has one: its encoding decides which reconstruction is the most accurate
    /// (`ivg_grid::Reconstruction::for_encoding`), its units what the numbers measure.
    #[must_use]
    pub fn grid_header(&self) -> Option<&ivg_format::Header> {
        self.assembly.grid_header()
    }

    /// The level of mesh `index` of [`Manifest::meshes`] that has `share` of its vertices, in \[0, 1\], or the highest that has
    /// arrived if that is lower; `None` before its first packet. Of a coded mesh it is the finest that the packet of these
    /// vertices brings, which is whole (PMESH-LVL-06).
    #[must_use]
    pub fn level_at(&self, index: usize, share: f64) -> Option<u32> {
        self.assembly.level_at(index, share)
    }

    /// The coarsest level of mesh `index` of [`Manifest::meshes`] that is exact enough for a picture, by the errors stored in
    /// its file, or the highest that has arrived if that is coarser; `None` before its first packet.
    #[must_use]
    pub fn level_for(&self, index: usize, view: &View) -> Option<u32> {
        self.assembly.level_for(index, view)
    }

    /// Goes to level `to` of mesh `index` of [`Manifest::meshes`], or the nearest that has arrived; what is different there for
    /// a copy of its buffers that holds level `from`. A copy that holds nothing is at level 0: all faces are different then.
    /// `None` before the first packet.
    ///
    /// What the level was before, and what has arrived since, makes no difference.
    pub fn step(&mut self, index: usize, from: u32, to: u32) -> Option<(&Replay, LevelChange)> {
        self.assembly.step(index, from, to)
    }

    /// The scene with each mesh at the level of `share` of its vertices, in [0, 1].
    #[must_use]
    pub fn scene_at(&mut self, share: f64) -> Scene {
        self.assembly.scene_at(share)
    }

    /// The scene with each mesh at its coarsest level that is exact enough for a picture, by the errors stored in its file.
    #[must_use]
    pub fn scene_for(&mut self, view: &View) -> Scene {
        self.assembly.scene_for(view)
    }
}

fn read_limited(path: &Path, most: u64) -> Result<Vec<u8>, LoadError> {
    let failed = |source| LoadError::Read { path: path.to_owned(), source };
    let mut bytes = Vec::new();
    File::open(path).map_err(failed)?.take(most.saturating_add(1)).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > most {
        let reason = format!("larger than {most} bytes, the limit set");
        return Err(LoadError::Content { path: path.to_owned(), reason });
    }
    Ok(bytes)
}

/// Reads a file piece by piece; a link out of the directory is not followed (GLT-URI-03).
fn stream(directory: &Path, path: &Path, reader: &mut FileReader<'_>) -> Result<(), LoadError> {
    const PIECE_BYTES: usize = 1 << 20;
    let failed = |source| LoadError::Read { path: path.to_owned(), source };
    let inside = path.canonicalize().map_err(failed)?.starts_with(directory.canonicalize().map_err(failed)?);
    if !inside {
        let reason = "is a link out of the scene directory".to_owned();
        return Err(LoadError::Content { path: path.to_owned(), reason });
    }
    let mut file = File::open(path).map_err(failed)?;
    let mut piece = vec![0; PIECE_BYTES];
    loop {
        match file.read(&mut piece) {
            Ok(0) => return Ok(()),
            Ok(length) => reader
                .feed(&piece[..length])
                .map_err(|reason| LoadError::Content { path: path.to_owned(), reason })?,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(failed(error)),
        }
    }
}
