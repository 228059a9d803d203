//! Conformance vectors and the oracles that tests and fuzz targets share.

#![forbid(unsafe_code)]

pub mod bounds;
pub mod choices;
pub mod oracles;
