//! The mathematics on a dense irradiance vector grid: reconstruction, interpolation, push-pull, metrics.
//!
//! An [`IrradianceGrid`] holds six irradiance vectors a vertex (one for each hemisphere +x −x +y −y +z −z, three
//! colour channels each), or nine spherical harmonics of the radiance for each channel, on an [`ivg_format::Lattice`].
//! It knows three different things about every vertex: whether it was *received*, whether light reaches it (*validity*),
//! and whether geometry cuts the way to its neighbours (*blocked edges*).
//!
//! ```text
//! decoder events ─ accept ─► IrradianceGrid ─ fill ─► every vertex valued ─ irradiance(p, n) ─► W/m²
//!      baker ─ from_parts ─►      │                          └─ texture_layer(t) ─► GPU
//!                                 └─ as_source ─► encoder
//! ```
//!
//! A client that has received one vertex of eight shows a picture already:
//!
//! ```
//! use glam::{DVec3, Vec3};
//! use ivg_format::Lattice;
//! use ivg_grid::{FillOptions, IrradianceGrid, Reconstruction, SpatialFilter, fill};
//!
//! let mut grid = IrradianceGrid::new(Lattice::new([2, 2, 2], [0.0; 3], [1.0; 3])?)?;
//! // Light from above: 2 W/m² on a surface that faces +y.
//! let mut vectors = [[[0.0; 3]; 3]; 6];
//! vectors[2] = [[0.0, 2.0, 0.0]; 3];
//! grid.set(5, &vectors);
//!
//! let filled = fill(&grid, &FillOptions::default());
//! let p = DVec3::new(0.1, 0.2, 0.3);
//! let light = filled.irradiance(p, Vec3::Y, Reconstruction::ThreeVector, SpatialFilter::Trilinear);
//! assert!((light - Vec3::splat(2.0)).abs().max_element() < 1e-5);
//! assert_eq!(filled.irradiance(p, Vec3::NEG_Y, Reconstruction::ThreeVector, SpatialFilter::Trilinear), Vec3::ZERO);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Reading a stream, the grid is made from the header, takes every event, and can be looked at whenever one likes;
//! [`FilledGrid`] computes only what the last events changed:
//!
//! ```
//! use glam::{DVec3, Vec3};
//! use ivg_format::{BufferedDecoder, Event, Limits};
//! use ivg_grid::{FillOptions, FilledGrid, GridError, IrradianceGrid, Reconstruction, SpatialFilter};
//! # use ivg_format::{EncodeOptions, GridSource, Lattice, encode};
//! # let lattice = Lattice::new([5, 5, 5], [0.0; 3], [1.0; 3])?;
//! # let file = encode(&GridSource::new(lattice, &vec![[[[1.0; 3]; 3]; 6]; 125]), &EncodeOptions::default())?;
//!
//! // A dense grid is the application's to allow: here at most 2²⁰ vertices.
//! let limits = Limits { vertices: 1 << 20, ..Limits::default() };
//! let mut decoder = BufferedDecoder::new(limits);
//! let mut light: Option<FilledGrid> = None;
//! for piece in file.chunks(1000) {
//!     decoder.feed(piece, |event| -> Result<(), GridError> {
//!         if let Event::Header(header) = &event {
//!             let quantity = header.encoding.quantity();
//!             let grid = IrradianceGrid::with_limit(header.lattice, quantity, limits.vertices)?;
//!             light = Some(FilledGrid::new(grid, FillOptions::default()));
//!         } else if let Some(light) = &mut light {
//!             light.accept(&event)?;
//!         }
//!         Ok(())
//!     })?;
//!     // Look at any moment: vertices that have not arrived are filled in.
//!     if let (Some(light), Some(header)) = (&mut light, decoder.header()) {
//!         let formula = Reconstruction::for_encoding(header.encoding);
//!         let (p, n) = (DVec3::splat(0.3), Vec3::Y);
//!         println!("{}", light.grid().irradiance(p, n, formula, SpatialFilter::Trilinear));
//!     }
//! }
//! decoder.finish()?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! World space is right-handed, in metres; colours are linear RGB with Rec. 709 primaries; an irradiance vector
//! points towards where the light comes from and has the unit W/m² (or lux, if the file says so).
//!
//! Guarantees: the same grid gives the same bits whatever the order in which its vertices arrived; received values
//! are never altered; filled values and interpolated ones stay in the range of those that they come from; light that
//! geometry keeps apart is never mixed while another vertex can answer.
//!
//! Features: `cases` adds the hard cases that tests and stability reports run; it never changes results.

#![forbid(unsafe_code)]

pub mod alternatives;
mod assemble;
#[cfg(any(test, feature = "cases"))]
pub mod cases;
mod error;
mod fill;
mod filled;
mod grid;
pub mod harmonics;
pub mod importance;
pub mod integrate;
mod lookup;
mod metrics;
mod pyramid;
mod reconstruct;
mod separate;
pub mod spatial;
pub mod texture;
mod values;

pub use error::GridError;
pub use fill::{FillOptions, Smoothing, fill};
pub use filled::FilledGrid;
pub use grid::{BLOCKED_BITS, DEFAULT_MAX_VERTICES, IrradianceGrid, VALIDITY_FREE};
pub use ivg_format::{HemisphereVectors, Quantity, RadianceHarmonics, Values, VertexValues};
pub use lookup::SURFACE_BIAS;
pub use metrics::{IrradianceError, relative_rmse};
pub use reconstruct::{
    Reconstruction, TANGENTIAL_LOSS, reconstruct, reconstruct_signed, tangential_weights, three_vector,
};
pub use separate::SeparateTextures;
pub use spatial::SpatialFilter;
pub use texture::{FLAG_USABLE, INVALID_TEXTURE_WEIGHT, texture_count};
pub use values::GridValues;

/// The example of the repository's README, compiled with this crate's doc tests.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
