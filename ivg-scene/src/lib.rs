//! Scenes in memory: import (OBJ, glTF, PLY), checks, lights files, the effect plan, export.
//!
//! Units everywhere: metres, watts, W/m², W/(m² sr), W/sr; colours are linear RGB with Rec. 709 primaries.
//! The world frame is right-handed and is the source file's own frame scaled to metres.
//!
//! This crate knows no rays, no GPU, and none of the streaming formats.

#![forbid(unsafe_code)]

pub mod demo;
pub mod export;
pub mod import;
pub mod lights;

mod camera;
mod check;
mod error;
mod flatten;
mod framing;
mod geometry;
mod light;
mod material;
mod mesh;
pub mod plan;
mod scene;
mod sky;
mod solid;

pub use camera::Camera;
pub use error::SceneError;
#[cfg(feature = "fuzz")]
pub use import::fuzz_scene_import;
pub use light::{Light, LightKind, spot_factor};
pub use material::{Lobes, Material, Texture, TextureFormat};
pub use mesh::Mesh;
pub use plan::{Cost, Effect, EffectPlan, Need, PlanOptions, PlannedEffect};
pub use scene::{FlatScene, Node, Scene, Unsupported};
pub use sky::SkyImage;
pub use solid::Side;
