//! Finding the collapse order of an indexed mesh: half-edge collapses by quadric cost.
//!
//! A progressive mesh in the manner of Melax (Web3D 2008, section 4) takes away one vertex at a time by moving it onto a
//! neighbour. No vertex ever moves elsewhere, so all levels share one vertex buffer: level *n* uses its first *n*
//! entries. This crate finds the order: always the cheapest collapse that leaves the surface sound; when none is left
//! the rules are relaxed in steps, so that every mesh ends with three vertices.
//!
//! ```
//! use pmesh_build::{BuildOptions, build};
//! use pmesh_format::{IndexedMesh, check_level};
//!
//! // A pyramid over a square.
//! let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 1.0]];
//! let faces = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [0, 3, 2], [0, 2, 1]];
//! let pyramid = IndexedMesh::from_positions(corners, faces);
//!
//! let (progressive, report) = build(&pyramid, &BuildOptions::default(), &mut |_| {}).expect("a sound mesh");
//! assert_eq!((report.vertices, report.base_vertices), (5, 3));
//! for level in 3..=5 {
//!     check_level(&progressive.level(level)).expect("every level is a valid mesh");
//! }
//! ```
//!
//! The result is the same, bit for bit, on every run and every machine: only additions, multiplications, divisions and
//! square roots of f64 are used, and ties go to the vertex that comes first along a curve through the box of the mesh.
//!
//! # Features
//! `fuzz`: the body of a fuzz target as a plain function.
#![forbid(unsafe_code)]

mod attributes;
mod bvh;
mod cost;
mod distance;
mod error;
#[cfg(feature = "fuzz")]
mod fuzz;
mod hausdorff;
mod input;
mod locality;
mod options;
mod order;
mod output;
mod pairing;
mod quadric;
mod queue;
mod rules;
mod surface;
#[cfg(test)]
mod tests;

pub use error::BuildError;
#[cfg(feature = "fuzz")]
pub use fuzz::fuzz_mesh_build;
pub use options::{AttributeWeights, BuildOptions, BuildReport, Cost};
pub use output::build;
