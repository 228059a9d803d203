//! Serving and fetching scene directories: HTTP ranges, scheduling, resuming.
//!
//! ```text
//! scene + .pmesh of each mesh + .ivg ──► pack ──► DIR: scene.glb  light.ivg  dragon.pmesh …
//!                                                          │
//!                                             serve, or any static HTTP/1.1 server
//!                                                          │ ranges: prefix, then records in file order
//!                                                          ▼
//!      scene at any level, grid  ◄── Session ◄── Schedule: geometry and light alternately, in a proportion, one first
//! ```
//!
//! - [`pack()`] writes a scene directory whose `scene.glb` any glTF viewer opens; [`LocalScene`] reads one from disk.
//! - [`serve()`] is a static server with ranges, strong entity tags, and limits on time, size and connections.
//! - [`Session`] fetches step by step towards [`Goal`]s, goes on where a connection broke, verifies every record, and
//!   begins a file anew that has changed on the server. [`Session::grid`] is filled whenever it is looked at; only what has
//!   changed since the last look is computed.
//!
//! Authority: `spec/gltf-extensions.md` and `spec/stream.md`; clause ids such as `STR-CLI-05` are theirs. [`blocking`]
//! has server and session for callers without an asynchronous runtime.
//!
//! ```
//! use ivg_scene::{Mesh, Node, Scene};
//! use ivg_stream::blocking::{Server, Session};
//! use ivg_stream::{FetchOptions, Goal, PackInput, PackOptions, ServerOptions, pack};
//! # use glam::{DAffine3, Vec3};
//! # use pmesh_format::{IndexedMesh, ProgressiveMesh};
//! # let home = tempfile::tempdir()?;
//! # let directory = home.path().join("scene");
//! # let triangle = Mesh {
//! #     name: "triangle".into(),
//! #     positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
//! #     triangles: vec![[0, 1, 2]],
//! #     triangle_materials: vec![0],
//! #     ..Mesh::default()
//! # };
//! # let full = IndexedMesh::from_positions(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
//! # let ordered = ProgressiveMesh {
//! #     positions: full.positions,
//! #     wedges: full.wedges,
//! #     base_vertices: 3,
//! #     faces: full.triangles,
//! #     ..ProgressiveMesh::default()
//! # };
//! # let file = pmesh_format::encode(&ordered, &pmesh_format::EncodeOptions::default())?;
//! # let node = Node { name: "node".into(), mesh: 0, transform: DAffine3::IDENTITY };
//! # let scene = Scene { meshes: vec![triangle], nodes: vec![node], materials: vec![Default::default()], ..Scene::default() };
//! // `scene` has one mesh, `file` is its .pmesh.
//! let input = PackInput { scene: &scene, meshes: &[Some(file)], grid: None };
//! pack(&input, &directory, &PackOptions::default())?;
//!
//! let server = Server::start(&directory, ServerOptions::default())?;
//! let mut log = |event: &ivg_stream::Event| println!("{:?} {}: {:?}", event.elapsed, event.file, event.what);
//! let mut session = Session::open(&server.url(), FetchOptions::default(), &mut log)?;
//! session.fetch_until(Goal { geometry: 0.01, light: 0.25 }, &mut log)?;
//! let first_picture = session.scene_at(0.01);
//! let progress = session.fetch_until(Goal::ALL, &mut log)?;
//! println!("{} bytes of geometry, {} of light", progress.geometry_bytes, progress.light_bytes);
//! assert_eq!(session.scene_at(1.0).meshes[0].positions.len(), 3);
//! server.stop();
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Guarantees: nothing outside the directory is served or read; what a session holds is made of verified records only
//! and, once whole, does not depend on the schedule, the size of requests or interruptions; a directory is packed whole
//! or not at all. Clocks decide when to give up and what the log says, never what is fetched.
#![forbid(unsafe_code)]

pub mod blocking;
mod client;
mod digest;
mod extensions;
mod http;
mod local;
mod manifest;
mod pack;
mod server;
mod view;

pub use blocking::serve_blocking;
pub use client::{
    Event, EventKind, FetchError, FetchOptions, Goal, Kind, Observer, Progress, SceneLimits, Schedule,
    Session, UrlError,
};
pub use extensions::{ExtensionError, FileEntry, IRRADIANCE_GRID, PROGRESSIVE_MESH};
pub use http::media::{MEDIA_TYPE_IVG, MEDIA_TYPE_PMESH};
pub use local::{LoadError, LocalScene};
pub use manifest::{Manifest, ManifestError, MeshEntry, scene_mesh};
pub use pack::{PackError, PackInput, PackOptions, PackReport, pack};
pub use server::{ServeError, ServerHandle, ServerOptions, serve};
pub use view::View;
