//! What a caller decides about a session, and what it is told.

use std::time::Duration;

use super::schedule::{Kind, Schedule};

/// How a scene directory is fetched.
#[derive(Debug, Clone, PartialEq)]
pub struct FetchOptions {
    /// How geometry and light share the connection.
    pub schedule: Schedule,
    /// About how many bytes one request asks for, >= 1: more means fewer round trips, less a finer schedule.
    pub request_bytes: u64,
    /// How many bytes the first request of each file asks for, >= 1; header and directory fit in 4 KiB as a rule.
    pub prefix_bytes: u64,
    /// Longest time until a connection stands.
    pub connect_timeout: Duration,
    /// Longest time without a byte arriving.
    pub stall_timeout: Duration,
    /// How often an attempt that brought nothing new is repeated.
    pub retries: u32,
    /// Waiting time before the first repetition; it doubles each time, up to [`FetchOptions::MOST_BACKOFF`].
    pub backoff: Duration,
    /// How much a scene may ask for.
    pub limits: SceneLimits,
}

/// How much memory a scene directory may ask for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SceneLimits {
    /// Largest `scene.glb` \[bytes\]: it is held in memory whole.
    pub scene_bytes: u64,
    /// Largest number of lattice vertices of the grid: it is held in memory as a dense array of about 220 bytes a
    /// vertex.
    pub grid_vertices: u64,
    /// Largest number of vertices, of wedges, and of faces of one mesh.
    pub mesh_counts: u32,
}

impl Default for SceneLimits {
    /// 256 MiB of `scene.glb`, the largest grid that `ivg-grid` takes by default, and the same for meshes.
    fn default() -> Self {
        Self {
            scene_bytes: 256 << 20,
            grid_vertices: ivg_grid::DEFAULT_MAX_VERTICES,
            mesh_counts: pmesh_format::Limits::default().counts,
        }
    }
}

impl FetchOptions {
    /// The defaults with another schedule.
    #[must_use]
    pub fn with_schedule(schedule: Schedule) -> Self {
        Self { schedule, ..Self::default() }
    }

    /// Longest waiting time between attempts.
    pub const MOST_BACKOFF: Duration = Duration::from_secs(5);

    /// Waiting time after the given number of failures in a row, >= 1.
    pub(super) fn backoff_after(&self, failures: u32) -> Duration {
        self.backoff.saturating_mul(1 << failures.saturating_sub(1).min(16)).min(Self::MOST_BACKOFF)
    }
}

impl Default for FetchOptions {
    /// Alternating requests of 64 KiB, 4 KiB first; 10 s to connect, 20 s of silence, 5 repetitions from 100 ms on.
    fn default() -> Self {
        Self {
            schedule: Schedule::Alternate,
            request_bytes: 64 << 10,
            prefix_bytes: 4 << 10,
            connect_timeout: Duration::from_secs(10),
            stall_timeout: Duration::from_secs(20),
            retries: 5,
            backoff: Duration::from_millis(100),
            limits: SceneLimits::default(),
        }
    }
}

/// How much of a scene is to be fetched, counted in vertices. Values below 0 mean 0, above 1 mean 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Share of each mesh's vertices, in [0, 1]; 0 asks for no byte of a mesh, 1 for the whole files.
    pub geometry: f64,
    /// Share of the grid's vertices, in [0, 1]; 0 asks for no byte of the grid, 1 for the whole file.
    pub light: f64,
}

impl Goal {
    /// Everything.
    pub const ALL: Self = Self { geometry: 1.0, light: 1.0 };

    pub(super) fn of(self, kind: Kind) -> f64 {
        match kind {
            Kind::Geometry => self.geometry,
            Kind::Light => self.light,
        }
    }
}

/// How far a session has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Bytes of `scene.glb` received.
    pub scene_bytes: u64,
    /// Bytes of meshes received; bytes that had to be fetched twice count twice, header fields of HTTP do not count.
    pub geometry_bytes: u64,
    /// Bytes of the grid received, counted in the same way.
    pub light_bytes: u64,
    /// Share of the vertices of all meshes together that are in, in [0, 1]; 1 only once the files are whole.
    pub geometry: f64,
    /// Share of the grid's vertices that are in, in [0, 1]; 1 only once the file is whole.
    pub light: f64,
    /// Time since the session was opened.
    pub elapsed: Duration,
}

/// Something that happened while fetching: a line of a log.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// Time since the session was opened.
    pub elapsed: Duration,
    /// Name of the file in the scene directory.
    pub file: String,
    /// What happened.
    pub what: EventKind,
}

/// What happened to a file.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum EventKind {
    /// `scene.glb` is in.
    Scene {
        /// Its length.
        bytes: u64,
    },
    /// Bytes are asked for.
    Request {
        /// First byte.
        start: u64,
        /// Byte after the last.
        end: u64,
    },
    /// Header and chunks are in and verified.
    Prefix {
        /// Their length.
        bytes: u64,
    },
    /// A record or packet is in and verified.
    Part {
        /// Which one, in file order.
        index: u32,
        /// Its length.
        bytes: u64,
        /// Vertices of the file that are in.
        vertices: u64,
    },
    /// The file is whole, and length and SHA-256 are right.
    Complete,
    /// The connection broke or the server could not answer; it is tried again.
    Broken {
        /// Failures in a row.
        failures: u32,
        /// What went wrong.
        reason: String,
    },
    /// Bytes failed their checksum; they are dropped and asked for again.
    Damaged {
        /// What was found.
        reason: String,
    },
    /// The server gave the same file a new entity tag.
    Retagged,
    /// The file has changed on the server; what was received of it is dropped.
    Restarted,
}

/// Is told what happens, in order.
pub type Observer<'a> = &'a mut (dyn FnMut(&Event) + Send);
