//! A session: one scene directory, fetched step by step towards goals.

use ivg_grid::IrradianceGrid;
use ivg_scene::Scene;
use pmesh_format::{LevelChange, Replay};
use sha2::{Digest, Sha256};

use super::assembly::Assembly;
use super::download::Download;
use super::error::FetchError;
use super::link::{Link, Outcome};
use super::options::{EventKind, FetchOptions, Goal, Observer, Progress};
use super::schedule::{Kind, Scheduler};
use super::url::SceneUrl;
use crate::manifest::Manifest;
use crate::view::View;

/// A scene directory on its way in.
///
/// [`Session::fetch_until`] may be called again and again with growing goals; what has arrived can be looked at in
/// between and is the same for every schedule once all of it is in (`spec/stream.md`, STR-STATE-04).
#[derive(Debug)]
pub struct Session {
    link: Link,
    assembly: Assembly,
    scene_digest: [u8; 32],
    scene_bytes: u64,
    scheduler: Scheduler,
}

impl Session {
    /// Fetches `scene.glb` and prepares for the files it names; no byte of those is asked for yet.
    ///
    /// # Errors
    /// [`FetchError`] if the URL is none of a scene directory, the server cannot be reached, or `scene.glb` cannot
    /// be used.
    ///
    /// # Panics
    /// If called outside a tokio runtime with time and network enabled.
    pub async fn open(
        url: &str,
        options: FetchOptions,
        mut observer: Observer<'_>,
    ) -> Result<Self, FetchError> {
        let url: SceneUrl = url.parse()?;
        let scheduler = Scheduler::new(options.schedule);
        let mut link = Link::new(url, options);
        let (glb, scene_bytes) = link.scene(&mut observer).await?;
        let assembly = Assembly::new(Manifest::from_glb(&glb)?, link.options.limits);
        Ok(Self { link, assembly, scene_digest: Sha256::digest(&glb).into(), scene_bytes, scheduler })
    }

    /// Fetches until `goal` is reached, and not much more: the request that reaches it is the last.
    ///
    /// If the scene changes on the server meanwhile, [`Session::manifest`] is another one afterwards.
    ///
    /// # Errors
    /// [`FetchError`] if the goal cannot be reached. What has arrived stays, and calling again goes on from there.
    pub async fn fetch_until(
        &mut self,
        goal: Goal,
        mut observer: Observer<'_>,
    ) -> Result<Progress, FetchError> {
        // How often the scene was found not to fit its files; bounded, so that a server that changes all the time
        // cannot keep a client for ever.
        let mut changes = 0;
        loop {
            let mesh = self.assembly.next_mesh(goal.geometry);
            let light_wanted = self.assembly.grid.as_ref().is_some_and(|grid| !grid.has_reached(goal.light));
            let Some(kind) = self.scheduler.next(mesh.is_some(), light_wanted) else {
                return Ok(self.progress());
            };
            let mut received = 0;
            let (outcome, file) = match (kind, mesh, &mut self.assembly.grid) {
                (Kind::Geometry, Some(mesh), _) => {
                    let download = &mut self.assembly.meshes[mesh];
                    let outcome =
                        self.link.advance(download, goal.of(kind), &mut received, &mut observer).await;
                    (outcome, download.file.clone())
                }
                (Kind::Light, _, Some(grid)) => {
                    let outcome = self.link.advance(grid, goal.of(kind), &mut received, &mut observer).await;
                    (outcome, grid.file.clone())
                }
                // The scheduler gives only what is wanted.
                _ => return Ok(self.progress()),
            };
            self.scheduler.note(kind, received);
            let (what, is_final) = match outcome? {
                Outcome::Done => continue,
                Outcome::Changed(what) => (what, false),
                Outcome::Mismatch => ("its SHA-256 is not the stated one".to_owned(), true),
            };
            changes += 1;
            let reloaded = self.reload(&mut observer).await?;
            if is_final && !reloaded {
                self.assembly.drop_file(&file);
            }
            let given_up = changes > self.link.options.retries;
            if given_up || (is_final && !reloaded) {
                return Err(FetchError::Inconsistent { file: file.uri, what });
            }
            if !reloaded {
                let failure = EventKind::Broken { failures: changes, reason: what };
                self.link.tell(&mut observer, &file.uri, failure);
                tokio::time::sleep(self.link.options.backoff_after(changes)).await;
            }
        }
    }

    /// Fetches `scene.glb` again; whether it states other files than before (STR-CLI-09).
    async fn reload(&mut self, observer: &mut Observer<'_>) -> Result<bool, FetchError> {
        let (glb, received) = self.link.scene(observer).await?;
        self.scene_bytes += received;
        let digest: [u8; 32] = Sha256::digest(&glb).into();
        if digest == self.scene_digest {
            return Ok(false);
        }
        let manifest = Manifest::from_glb(&glb)?;
        self.scene_digest = digest;
        for file in self.assembly.adopt(manifest) {
            self.link.tell(observer, &file, EventKind::Restarted);
        }
        Ok(true)
    }

    /// What `scene.glb` says, with its coarse meshes.
    #[must_use]
    pub fn manifest(&self) -> &Manifest {
        self.assembly.manifest()
    }

    /// What has arrived of mesh `index` of [`Manifest::meshes`]; `None` before its first packet.
    #[must_use]
    pub fn replay(&self, index: usize) -> Option<&Replay> {
        self.assembly.replay(index)
    }

    /// The grid as far as it has arrived, filled: every vertex has a value, and
    /// [`is_received`](IrradianceGrid::is_received) tells whose has arrived. `None` before its first record and in scenes
    /// without a grid.
    ///
    /// Filling is done here and only for what has changed since the last call: after a request the vertices that depend
    /// on it, and nothing for a session that nobody looks at. The result does not depend on how often it was asked for.
    #[must_use]
    pub fn grid(&mut self) -> Option<&IrradianceGrid> {
        self.assembly.grid()
    }

    /// The header of the grid's file: its encoding decides which reconstruction is the most accurate
    /// (`ivg_grid::Reconstruction::for_encoding`), its units what the numbers measure. `None` before it has arrived and in
    /// scenes without a grid.
    #[must_use]
    pub fn grid_header(&self) -> Option<&ivg_format::Header> {
        self.assembly.grid_header()
    }

    /// The level of mesh `index` of [`Manifest::meshes`] that has `share` of its vertices, in \[0, 1\], or the highest that has
    /// arrived if that is lower; `None` before its first packet. Of a coded mesh it is the finest that the packet of these
    /// vertices brings: levels inside coded packets are valid meshes, but not whole (PMESH-LVL-06).
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

    /// The scene with each mesh at the level of `share` of its vertices, in [0, 1] (see [`Session::level_at`]), or the highest
    /// level that has arrived if that is lower; meshes of which nothing has arrived as in `scene.glb`.
    #[must_use]
    pub fn scene_at(&mut self, share: f64) -> Scene {
        self.assembly.scene_at(share)
    }

    /// The scene with each mesh at its coarsest level that is exact enough for a picture, by the errors stored in its file, or
    /// the highest level that has arrived if that is coarser; meshes of which nothing has arrived as in `scene.glb`.
    #[must_use]
    pub fn scene_for(&mut self, view: &View) -> Scene {
        self.assembly.scene_for(view)
    }

    /// How far the session has come.
    #[must_use]
    pub fn progress(&self) -> Progress {
        Progress {
            scene_bytes: self.scene_bytes,
            geometry_bytes: self.scheduler.bytes(Kind::Geometry),
            light_bytes: self.scheduler.bytes(Kind::Light),
            geometry: self.assembly.geometry_share(),
            light: self.assembly.grid.as_ref().map_or(1.0, Download::share),
            elapsed: self.link.elapsed(),
        }
    }
}
