//! The .pmesh format: Melax progressive meshes as packets, every vertex count a level.
#![cfg_attr(not(any(feature = "std", test)), no_std)]
#![forbid(unsafe_code)]

extern crate alloc;

mod mesh;
mod progressive;

pub use mesh::{IndexedMesh, LevelFault, Wedges, check_level};
pub use progressive::ProgressiveMesh;

/// The greatest number of vertices, of wedges and of faces (spec PMESH-LIM-01): corner slots are numbered in 32 bits.
pub const MAX_COUNT: u32 = 1 << 30;
