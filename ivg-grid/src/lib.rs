//! The mathematics on a dense irradiance vector grid: reconstruction, interpolation, push-pull, metrics.
//!
//! An [`IrradianceGrid`] holds six irradiance vectors a vertex (one for each hemisphere +x −x +y −y +z −z, three
//! colour channels each) on an [`ivg_format::Lattice`], and knows three different things about every vertex:
//! whether it was *received*, whether light reaches it (*validity*), and whether geometry cuts the way to its
//! neighbours (*blocked edges*).
//!
//! World space is right-handed, in metres; colours are linear RGB with Rec. 709 primaries; an irradiance vector
//! points towards where the light comes from and has the unit W/m².

#![forbid(unsafe_code)]

#[cfg(any(test, feature = "cases"))]
pub mod cases;
mod error;
mod fill;
mod grid;
pub mod integrate;
mod lookup;
mod metrics;
mod pyramid;
mod reconstruct;
pub mod spatial;
mod texture;

pub use error::GridError;
pub use fill::{FillOptions, fill};
pub use grid::{BLOCKED_BITS, DEFAULT_MAX_VERTICES, HemisphereVectors, IrradianceGrid, VALIDITY_FREE};
pub use lookup::SURFACE_BIAS;
pub use metrics::{IrradianceError, relative_rmse};
pub use reconstruct::{Reconstruction, TANGENTIAL_SHARE, reconstruct, reconstruct_signed, three_vector};
pub use spatial::SpatialFilter;
pub use texture::{FLAG_USABLE, INVALID_TEXTURE_WEIGHT, TEXTURE_COUNT};
