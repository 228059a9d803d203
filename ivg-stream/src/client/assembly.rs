//! The state of a scene directory: its description, and each file as far as it is in.

use std::collections::HashMap;

use ivg_grid::IrradianceGrid;
use ivg_scene::Scene;
use pmesh_format::{LevelChange, Replay};

use super::contents::{GridContents, MeshContents};
use super::download::{Contents, Download};
use super::options::SceneLimits;
use crate::extensions::FileEntry;
use crate::manifest::{Manifest, level_of_share, nearest_level};
use crate::view::View;

/// What is known of a scene.
#[derive(Debug)]
pub(crate) struct Assembly {
    manifest: Manifest,
    limits: SceneLimits,
    /// One for each distinct file of meshes.
    pub(super) meshes: Vec<Download<MeshContents>>,
    /// For each mesh of the manifest, its file's place in `meshes`.
    mesh_files: Vec<usize>,
    pub(super) grid: Option<Download<GridContents>>,
}

impl Assembly {
    pub(crate) fn new(manifest: Manifest, limits: SceneLimits) -> Self {
        let empty = Manifest { scene: Scene::default(), meshes: Vec::new(), grid: None };
        let mut assembly =
            Self { manifest: empty, limits, meshes: Vec::new(), mesh_files: Vec::new(), grid: None };
        assembly.adopt(manifest);
        assembly
    }

    /// Takes over another description: files stated as before keep what is in, others begin anew. Names those that
    /// had begun and begin anew.
    pub(super) fn adopt(&mut self, manifest: Manifest) -> Vec<String> {
        let mut restarted = Vec::new();
        let mut old: HashMap<String, Download<MeshContents>> =
            self.meshes.drain(..).map(|download| (download.file.uri.clone(), download)).collect();
        let mut places: HashMap<&str, usize> = HashMap::new();
        self.mesh_files.clear();
        for mesh in &manifest.meshes {
            let place = *places.entry(mesh.file.uri.as_str()).or_insert_with(|| {
                self.meshes.push(match old.remove(&mesh.file.uri) {
                    Some(download) => kept(download, &mesh.file, &mut restarted),
                    None => Download::new(mesh.file.clone(), MeshContents::new(self.limits.mesh_counts)),
                });
                self.meshes.len() - 1
            });
            self.mesh_files.push(place);
        }
        let grid = self.grid.take();
        self.grid = manifest.grid.as_ref().map(|file| match grid {
            Some(download) => kept(download, file, &mut restarted),
            None => Download::new(file.clone(), GridContents::new(self.limits.grid_vertices)),
        });
        self.manifest = manifest;
        restarted
    }

    /// Forgets what was received of a file that turned out not to be the stated one (GLT-EXT-04).
    pub(super) fn drop_file(&mut self, file: &FileEntry) {
        for download in self.meshes.iter_mut().filter(|download| download.file == *file) {
            download.restart(file.clone());
        }
        if let Some(download) = self.grid.as_mut().filter(|download| download.file == *file) {
            download.restart(file.clone());
        }
    }

    /// The mesh file with the smallest share of its vertices among those that lack something of `share`; the first
    /// of equals.
    pub(super) fn next_mesh(&self, share: f64) -> Option<usize> {
        let lacking = (0..self.meshes.len()).filter(|&i| !self.meshes[i].has_reached(share));
        lacking.min_by(|&a, &b| self.meshes[a].share().total_cmp(&self.meshes[b].share()))
    }

    /// Share of the vertices of all mesh files together that are in; 1 only once all are whole.
    pub(super) fn geometry_share(&self) -> f64 {
        if self.meshes.iter().all(Download::is_complete) {
            return 1.0;
        }
        let weights = self.meshes.iter().map(|mesh| mesh.contents.vertices().map(|n| (mesh.vertices(), n)));
        // As long as a header is not in, the whole is not known.
        let weights = weights.collect::<Option<Vec<_>>>().unwrap_or_default();
        let (have, total) = weights.iter().fold((0, 0), |(have, total), (h, n)| (have + h, total + n));
        if total > 0 { (have as f64 / total as f64).min(1.0 - f64::EPSILON) } else { 0.0 }
    }

    pub(crate) fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    pub(crate) fn replay(&self, index: usize) -> Option<&Replay> {
        self.meshes[*self.mesh_files.get(index)?].contents.replay()
    }

    pub(crate) fn grid(&mut self) -> Option<&IrradianceGrid> {
        self.grid.as_mut()?.contents.grid()
    }

    pub(crate) fn grid_header(&self) -> Option<&ivg_format::Header> {
        self.grid.as_ref()?.contents.header()
    }

    /// The level of mesh `index` of so large a share of its vertices, or the highest there is if that is lower.
    pub(crate) fn level_at(&self, index: usize, share: f64) -> Option<u32> {
        level_of_share(self.replay(index)?, share)
    }

    /// The coarsest level of mesh `index` that is exact enough for a picture, or the highest there is if that is coarser.
    pub(crate) fn level_for(&self, index: usize, view: &View) -> Option<u32> {
        let (replay, entry) = (self.replay(index)?, self.manifest.meshes.get(index)?);
        let error = view.error_of(entry, replay.header(), &self.manifest.scene);
        nearest_level(replay, replay.level_of_error(error).unwrap_or_default())
    }

    /// Mesh `index` at the level nearest to `to`, and what is different there for whoever has level `from`: everything if
    /// there is no such level.
    pub(crate) fn step(&mut self, index: usize, from: u32, to: u32) -> Option<(&Replay, LevelChange)> {
        let file = *self.mesh_files.get(index)?;
        let replay = self.meshes[file].contents.replay_mut()?;
        let to = nearest_level(replay, to)?;
        let known = replay.set_level(from).is_ok();
        let change = replay.set_level(to).ok()?;
        let faces = 0..replay.face_count();
        let change = if known {
            change
        } else {
            LevelChange { from: 0, to, changed: Some(faces).filter(|f| !f.is_empty()).into_iter().collect() }
        };
        Some((replay, change))
    }

    pub(crate) fn scene_at(&mut self, share: f64) -> Scene {
        self.scene_of(|assembly, index| assembly.level_at(index, share))
    }

    pub(crate) fn scene_for(&mut self, view: &View) -> Scene {
        self.scene_of(|assembly, index| assembly.level_for(index, view))
    }

    /// The scene with each mesh at the level chosen for it; one of which nothing has arrived as in `scene.glb`.
    fn scene_of(&mut self, level: impl Fn(&Self, usize) -> Option<u32>) -> Scene {
        let mut scene = self.manifest.scene.clone();
        for index in 0..self.mesh_files.len() {
            let Some(level) = level(self, index) else { continue };
            if let Some(replay) = self.meshes[self.mesh_files[index]].contents.replay_mut()
                && replay.set_level(level).is_ok()
            {
                self.manifest.meshes[index].put(replay, &mut scene);
            }
        }
        scene
    }
}

/// The download under its new entry, begun anew if the file is not stated as before.
fn kept<C: Contents>(
    mut download: Download<C>,
    file: &FileEntry,
    restarted: &mut Vec<String>,
) -> Download<C> {
    if download.file != *file {
        if download.position() > 0 {
            restarted.push(file.uri.clone());
        }
        download.restart(file.clone());
    }
    download
}

#[cfg(test)]
mod tests;
