//! A frame: direct light with shadows plus indirect light from the grid, on wgpu or on the CPU.
//!
//! ```text
//! RenderScene ──┐
//!               ├─► FramePlan (geometry, lights, shadow map faces, passes: data) ─┬─► cpu: rasteriser, rayon
//! RenderOptions ┘                                                                 └─► gpu: the same passes on wgpu
//!                                                                                          │
//!                                      Image (linear radiance) ─► tonemap ─► DisplayImage ─► png
//! ```
//!
//! A surface of diffuse albedo ρ sends `emission + ρ/π (E_direct + E_indirect)` to the eye. Direct irradiance is a sum
//! over lights, each tested against its shadow map; [`lights`] tells how emissive surfaces become lights. Indirect
//! irradiance is looked up in the grid, which holds irradiance vectors or radiance harmonics. Surfaces are opaque and
//! reflect on both sides, as the baker has them.
//!
//! Both renderers carry out the same [`plan`]; `cpu/` has one file for each shader, with the same functions in the same
//! order of arguments. Their pictures agree within what `tests/gpu.rs` states and derives.
//!
//! `GpuMesh` keeps a progressive mesh on the GPU while its level changes; `GpuRenderer::render_with` draws it beside a
//! scene, and a step from one level to another uploads what it changes.
//!
//! # Features
//!
//! - `gpu` (default): the wgpu renderer.

#![forbid(unsafe_code)]

pub mod background;
pub mod camera;
pub mod compare;
mod cpu;
mod error;
mod geometry;
#[cfg(feature = "gpu")]
mod gpu;
mod image;
pub mod layout;
pub mod lights;
mod options;
pub mod plan;
pub mod png;
mod scene;
pub mod tonemap;
pub mod upload;

pub use cpu::{execute as execute_cpu, render_cpu};
pub use error::{MAX_SIDE, RenderError};
pub use geometry::{Draw, Geometry};
#[cfg(feature = "gpu")]
pub use gpu::{GpuError, GpuMesh, GpuRenderer, INSTALL_SOFTWARE_ADAPTER};
pub use image::{DisplayImage, Image};
pub use options::RenderOptions;
pub use scene::{RenderMesh, RenderScene};
pub use tonemap::{auto_exposure, tonemap};
