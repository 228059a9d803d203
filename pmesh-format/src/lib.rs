//! The .pmesh format: progressive meshes in the manner of Melax as packets that can be streamed; every vertex count is a
//! level.
//!
//! Vertices stand in order of importance; each from the base on collapses onto an earlier one. Level *n* is the mesh of the
//! first *n* vertices, so all levels share one vertex buffer. Authority: `spec/common.md` and `spec/pmesh.md`, which define
//! every byte and every error; clause ids such as `PMESH-SWI-04` are theirs.
//!
//! ```text
//! header 152 ─ chunks: PDIR (20 a packet), MTRL ─ packet 0 (with the base) ─ packet 1 … packet P−1 ─ end 20
//! ```
//!
//! Besides positions (12 bytes a vertex), attributes (on wedges) and faces (12 bytes each, as they are when the packet is in) a
//! packet holds what makes it a refinement: the parent of each vertex (some 2 bytes) and which corners of earlier faces switch
//! (some 2 bytes a vertex). What changes from level to level is found out from that at the first step.
//!
//! ```
//! use pmesh_format::{EncodeOptions, Limits, ProgressiveMesh, Replay, Wedges, decode_all, encode};
//!
//! // A square of two triangles; its fourth vertex collapses onto the first, and the second triangle goes with it.
//! let square = ProgressiveMesh {
//!     positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
//!     wedges: Wedges { vertices: vec![0, 1, 2, 3], ..Wedges::default() },
//!     base_vertices: 3,
//!     collapse: vec![0],
//!     wedge_collapse: vec![0],
//!     errors: vec![0.5],
//!     faces: vec![[0, 1, 2], [0, 2, 3]],
//!     ..ProgressiveMesh::default()
//! };
//! let file = encode(&square, &EncodeOptions::default())?;
//!
//! let mut replay = Replay::default();
//! decode_all(&file, &Limits::default(), |event| replay.accept(&event).map(drop))?;
//! assert_eq!(replay.indices(), [[0, 1, 2], [0, 2, 3]]);
//! replay.set_level(3)?;
//! assert_eq!(replay.indices(), [[0, 1, 2]]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Guarantees: reading never panics, whatever the bytes; [`Decoder`] allocates nothing but the directory; [`Replay`] holds at
//! most 64 KiB and 64 bytes for each byte received, 2,048 in coded mode (PMESH-LIM-03), and about 1.6 for an ordinary raw file that
//! has been stepped through; a declared count never makes anything allocate; any split of the bytes gives the same events and the
//! same error; a packet that breaks a rule leaves the levels before it as they were. [`Replay::from_file`] reads a whole file at once.
//! [`decode_packet`] reads one packet by its range, [`Header::packet_range`] says where it lies.
//!
//! Features: `std` (default) is only passed on to dependencies; it never changes bytes or results.
#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;
#[cfg(test)]
extern crate std;

mod attributes;
mod bits;
mod code;
mod coded;
mod decode;
mod encode;
mod fano;
mod header;
mod lattice;
mod limits;
mod lists;
mod machine;
mod material;
mod mesh;
mod packet;
mod progressive;
mod replay;
mod room;
mod slots;
mod storage;
#[cfg(test)]
mod tests;
mod wire;

pub use attributes::Attributes;
pub use code::codes;
pub use decode::{BufferedDecoder, Decoder, Event, Pmesh, check, decode_all, decode_packet};
pub use encode::{EncodeError, EncodeOptions, PacketSize, encode};
pub use header::{Header, PacketEntry};
pub use ivg_wire::{Answer, Error, Step, Verdict};
pub use limits::{Limits, MAX_COUNT};
pub use material::material_names;
pub use mesh::{IndexedMesh, LevelFault, Wedges, check_level};
pub use packet::Packet;
pub use progressive::ProgressiveMesh;
pub use replay::{LevelChange, LevelError, Replay};
pub use storage::{Mode, Positions};
pub use wire::{DIRECTORY, HEADER_BYTES, MAJOR, MATERIALS};
