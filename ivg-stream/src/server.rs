//! A static HTTP/1.1 server for scene directories: what `spec/stream.md` asks of any server, and no more.
//!
//! Every connection is bounded in time: a request head must arrive within [`ServerOptions::header_timeout`], and
//! each 64 KiB of an answer must be taken within [`ServerOptions::request_timeout`].

mod body;
mod connection;
mod files;
mod respond;

use std::future::Future;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use tokio::net::TcpListener;
use tokio::sync::{Semaphore, watch};
use tokio::task::{JoinHandle, JoinSet};

/// How a scene directory is served.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ServerOptions {
    /// Where to listen; port 0 takes a free one.
    pub address: SocketAddr,
    /// Connections served at a time, >= 1; more wait in the listen queue of the operating system.
    pub max_connections: usize,
    /// Longest time from the first moment of waiting for a request to the end of its head, > 0. Idle connections
    /// are closed after it too.
    pub header_timeout: Duration,
    /// Longest time that one piece of an answer (64 KiB) may take, > 0: a client slower than this is dropped.
    pub request_timeout: Duration,
    /// Longest request head \[bytes\], >= [`ServerOptions::LEAST_HEADER_BYTES`].
    pub max_header_bytes: usize,
    /// Whether pages of other origins may read the files (CORS), with entity tag and ranges.
    pub cors: bool,
    /// After a stop: how long answers under way may take to end.
    pub stop_timeout: Duration,
}

impl ServerOptions {
    /// Least value of [`ServerOptions::max_header_bytes`] \[bytes\]: the smallest buffer hyper accepts.
    pub const LEAST_HEADER_BYTES: usize = 8192;
}

impl Default for ServerOptions {
    /// Loopback, a free port, 256 connections, 10 s for a head, 30 s for a piece, 16 KiB of head, CORS.
    fn default() -> Self {
        Self {
            address: SocketAddr::from(([127, 0, 0, 1], 0)),
            max_connections: 256,
            header_timeout: Duration::from_secs(10),
            request_timeout: Duration::from_secs(30),
            max_header_bytes: 16 * 1024,
            cors: true,
            stop_timeout: Duration::from_secs(5),
        }
    }
}

/// Why a server could not start.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ServeError {
    /// The directory cannot be read or is none.
    #[error("cannot serve {path}: {source}")]
    Directory {
        /// The directory as given.
        path: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// The address cannot be listened on.
    #[error("cannot listen on {address}: {source}; choose another address or port 0 for a free one")]
    Listen {
        /// The address as given.
        address: SocketAddr,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// No thread can be started.
    #[error("cannot start a runtime: {0}")]
    Runtime(std::io::Error),
    /// An option is outside its range.
    #[error("server option {option} must be at least {least}")]
    Option {
        /// Name of the field of [`ServerOptions`].
        option: &'static str,
        /// The least value allowed.
        least: usize,
    },
}

/// A server that runs.
#[derive(Debug)]
pub struct ServerHandle {
    /// Where it listens; the port is the real one.
    pub address: SocketAddr,
    /// Ends when the server has stopped and all its connections are closed.
    pub join: JoinHandle<()>,
}

/// What all connections of a server share.
#[derive(Debug)]
struct Shared {
    files: files::Files,
    options: ServerOptions,
}

/// Serves the files below `directory` until `shutdown` completes; then refuses new connections and lets answers
/// under way end.
///
/// Only regular files below the directory are reachable; symbolic links that lead outside, names beginning with
/// a dot, and directories are not.
///
/// # Errors
/// [`ServeError`] if the directory cannot be read, the address not be listened on, or an option is out of range.
///
/// # Panics
/// If called outside a tokio runtime.
pub async fn serve(
    directory: &Path,
    options: ServerOptions,
    shutdown: impl Future<Output = ()> + Send + 'static,
) -> Result<ServerHandle, ServeError> {
    check(&options)?;
    let files = files::Files::open(directory)
        .map_err(|source| ServeError::Directory { path: directory.to_owned(), source })?;
    let in_listen = |source| ServeError::Listen { address: options.address, source };
    let listener = TcpListener::bind(options.address).await.map_err(in_listen)?;
    let address = listener.local_addr().map_err(in_listen)?;
    let shared = Arc::new(Shared { files, options });
    Ok(ServerHandle { address, join: tokio::spawn(accept(listener, shared, shutdown)) })
}

fn check(options: &ServerOptions) -> Result<(), ServeError> {
    let least = |option, value: usize, least| {
        if value < least { Err(ServeError::Option { option, least }) } else { Ok(()) }
    };
    least("max_connections", options.max_connections, 1)?;
    least("header_timeout", usize::from(!options.header_timeout.is_zero()), 1)?;
    least("request_timeout", usize::from(!options.request_timeout.is_zero()), 1)?;
    least("max_header_bytes", options.max_header_bytes, ServerOptions::LEAST_HEADER_BYTES)
}

async fn accept(listener: TcpListener, shared: Arc<Shared>, shutdown: impl Future<Output = ()>) {
    /// Waiting time after a failed accept: such failures (no file descriptors left) do not go away at once.
    const AFTER_FAILURE: Duration = Duration::from_millis(50);
    let slots = Arc::new(Semaphore::new(shared.options.max_connections.min(Semaphore::MAX_PERMITS)));
    let (stop, stopping) = watch::channel(false);
    let mut connections = JoinSet::new();
    let accepting = async {
        loop {
            let Ok(slot) = Arc::clone(&slots).acquire_owned().await else { return };
            match listener.accept().await {
                Ok((stream, _)) => {
                    let (shared, stopping) = (Arc::clone(&shared), stopping.clone());
                    connections.spawn(async move {
                        connection::run(stream, shared, stopping).await;
                        drop(slot);
                    });
                }
                Err(_) => tokio::time::sleep(AFTER_FAILURE).await,
            }
            while connections.try_join_next().is_some() {}
        }
    };
    tokio::select! {
        () = shutdown => {}
        () = accepting => {}
    }
    drop(listener);
    stop.send_replace(true);
    let all_closed = async { while connections.join_next().await.is_some() {} };
    // What has not ended by now is cut off when the set is dropped.
    let _ended = tokio::time::timeout(shared.options.stop_timeout, all_closed).await;
}
