//! The .ivg format: irradiance vector grids as bundles that can be streamed in any order.
#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;

mod lattice;

pub use lattice::{Lattice, LatticeError};
