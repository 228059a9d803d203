//! The server and the client for callers without an asynchronous runtime.

use std::net::SocketAddr;
use std::path::Path;

use ivg_grid::IrradianceGrid;
use ivg_scene::Scene;
use pmesh_format::{LevelChange, Replay};
use tokio::runtime::Runtime;
use tokio::sync::oneshot;

use crate::client::{FetchError, FetchOptions, Goal, Observer, Progress};
use crate::manifest::Manifest;
use crate::server::{self, ServeError, ServerHandle, ServerOptions};
use crate::view::View;

/// A server on threads of its own.
///
/// Dropping it stops it at once; [`Server::stop`] lets answers under way end.
#[derive(Debug)]
pub struct Server {
    runtime: Runtime,
    handle: ServerHandle,
    stop: oneshot::Sender<()>,
}

impl Server {
    /// Serves the files below `directory`.
    ///
    /// # Errors
    /// As [`serve`](crate::serve()), and [`ServeError::Runtime`] if no thread can be started.
    pub fn start(directory: &Path, options: ServerOptions) -> Result<Self, ServeError> {
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(2)
            .enable_all()
            .build()
            .map_err(ServeError::Runtime)?;
        let (stop, stopped) = oneshot::channel();
        let until = async move {
            if stopped.await.is_err() {
                // The server was dropped without a word; its runtime ends it.
                std::future::pending::<()>().await;
            }
        };
        let handle = runtime.block_on(server::serve(directory, options, until))?;
        Ok(Self { runtime, handle, stop })
    }

    /// Where it listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.handle.address
    }

    /// The URL of the directory it serves.
    #[must_use]
    pub fn url(&self) -> String {
        format!("http://{}/", self.handle.address)
    }

    /// Refuses new connections, lets answers under way end, and returns when all are closed or
    /// [`ServerOptions::stop_timeout`] is over.
    pub fn stop(self) {
        // Fails only if the server has ended already.
        let _gone = self.stop.send(());
        let _ended = self.runtime.block_on(self.handle.join);
    }
}

/// Serves the files below `directory` until the process is interrupted (Ctrl-C), then stops as [`Server::stop`]
/// does. `ready` is told the address once the server listens.
///
/// # Errors
/// As [`Server::start`]; [`ServeError::Runtime`] also if the interrupt cannot be waited for.
pub fn serve_blocking(
    directory: &Path,
    options: &ServerOptions,
    ready: impl FnOnce(SocketAddr),
) -> Result<(), ServeError> {
    let server = Server::start(directory, options.clone())?;
    ready(server.address());
    let outcome = server.runtime.block_on(tokio::signal::ctrl_c());
    server.stop();
    outcome.map_err(ServeError::Runtime)
}

/// A [`client::Session`](crate::Session) on a runtime of its own.
#[derive(Debug)]
pub struct Session {
    // Declared before the runtime so that it is dropped first.
    session: crate::client::Session,
    runtime: Runtime,
}

impl Session {
    /// As [`crate::Session::open`].
    ///
    /// # Errors
    /// As [`crate::Session::open`], and [`FetchError::Runtime`] if no runtime can be had.
    pub fn open(url: &str, options: FetchOptions, observer: Observer<'_>) -> Result<Self, FetchError> {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .map_err(FetchError::Runtime)?;
        let session = runtime.block_on(crate::client::Session::open(url, options, observer))?;
        Ok(Self { session, runtime })
    }

    /// As [`crate::Session::fetch_until`].
    ///
    /// # Errors
    /// As [`crate::Session::fetch_until`].
    pub fn fetch_until(&mut self, goal: Goal, observer: Observer<'_>) -> Result<Progress, FetchError> {
        self.runtime.block_on(self.session.fetch_until(goal, observer))
    }

    /// As [`crate::Session::manifest`].
    #[must_use]
    pub fn manifest(&self) -> &Manifest {
        self.session.manifest()
    }

    /// As [`crate::Session::replay`].
    #[must_use]
    pub fn replay(&self, index: usize) -> Option<&Replay> {
        self.session.replay(index)
    }

    /// As [`crate::Session::grid`].
    #[must_use]
    pub fn grid(&mut self) -> Option<&IrradianceGrid> {
        self.session.grid()
    }

    /// As [`crate::Session::grid_header`].
    #[must_use]
    pub fn grid_header(&self) -> Option<&ivg_format::Header> {
        self.session.grid_header()
    }

    /// As [`crate::Session::level_at`].
    #[must_use]
    pub fn level_at(&self, index: usize, share: f64) -> Option<u32> {
        self.session.level_at(index, share)
    }

    /// As [`crate::Session::level_for`].
    #[must_use]
    pub fn level_for(&self, index: usize, view: &View) -> Option<u32> {
        self.session.level_for(index, view)
    }

    /// As [`crate::Session::step`].
    pub fn step(&mut self, index: usize, from: u32, to: u32) -> Option<(&Replay, LevelChange)> {
        self.session.step(index, from, to)
    }

    /// As [`crate::Session::scene_at`].
    #[must_use]
    pub fn scene_at(&mut self, share: f64) -> Scene {
        self.session.scene_at(share)
    }

    /// As [`crate::Session::scene_for`].
    #[must_use]
    pub fn scene_for(&mut self, view: &View) -> Scene {
        self.session.scene_for(view)
    }

    /// As [`crate::Session::progress`].
    #[must_use]
    pub fn progress(&self) -> Progress {
        self.session.progress()
    }
}
