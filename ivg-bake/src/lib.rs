//! Light transport on the CPU: photons traced through a scene into an irradiance vector grid.
//!
//! ```text
//! scene, plan ─► stage (bake space, tree of triangles, lights)
//!                  │
//!                  ├─► validity, region   what each vertex of the lattice sees, and whether light reaches it
//!                  │
//!                  └─► emit ─► trace ─► estimate ─► accumulate ─► centring ─► IrradianceGrid
//!                      photons  flights  deposits   exact sums    to the vertex
//! ```
//!
//! [`bake()`] makes a grid, [`pilot()`] measures what that will cost, [`reference::Oracle`] is the slow path tracer that
//! everything is compared with.
//!
//! Units: metres, watts, W/m², W/(m² sr); colours are linear RGB with Rec. 709 primaries; world space is right-handed. What
//! an irradiance vector is, is said in `spec/ivg.md`: the integral over a hemisphere of radiance times direction, pointing to
//! where the light comes from.
//!
//! Surfaces reflect evenly, mirror (sharply or through facets), and let light through, as [`ivg_scene::Lobes`] mixes them; where
//! the plan needs neither mirrors nor glass, the code that traces photons knows of neither.
//!
//! # Guarantees
//!
//! * For one release and target the result depends on scene, plan and options alone: random numbers are a function of
//!   (seed, photon, reflection), and deposits are added as integers, so neither the number of threads nor their order matters.
//! * The energy books balance: emitted = absorbed + escaped + cut off, exactly.
//! * A scene far from its origin, in millimetres or in kilometres, gives the same grid.
//! * Unusable input is an error that names it.
//!
//! # Limits
//!
//! * Light that changes within a step of the grid is averaged: the shade between a lamp and the ceiling close above it is missing,
//!   and so is most light on the side of a thin wall where a lamp set into it has the lesser part. How bright pictures are depends on
//!   the resolution; the example `brightness` measures it. Mean of baked over path-traced irradiance of what pictures show, and how
//!   far the worst of 27 parts of the scene is off:
//!
//!   | scene | vertices | mean | worst part |
//!   |---|---|---|---|
//!   | kitchen, 5.6 m | 16 × 16 × 16 | 1.038 | 13 % |
//!   | | 24 × 20 × 24 | 1.029 | 9 % |
//!   | | 32 × 32 × 32 | 1.017 | 8 % |
//!   | | 48 × 24 × 48 | 1.012 | 6 % |
//!   | | automatic: 35 × 15 × 30 | 1.024 | 10 % |
//!   | hotel room, 10 m, a lamp through a wall | 34 × 7 × 42 | 0.986 | 15 % |
//!   | | 48 × 16 × 72 | 0.992 | 11 % |
//!   | | 64 × 32 × 96 | 0.996 | 6 % |
//!   | | automatic: 51 × 16 × 63 | 0.993 | 12 % |
//!   | bunny in a box | automatic: 34 × 30 × 36 | 1.001 | 3 % |
//!
//!   It is what lies between vertices that is off, not their light: in the hotel's worst part at 34 × 7 × 42 the ratio is 0.85,
//!   and 0.84 if every vertex is path traced ([`Estimator::Gather`]).
//!   Steps of a tenth of a metre to a fifth keep the mean of rooms within 2 %, and the worst part within about 10 % (some parts hold so
//!   few places that it is known to a few per cent only). The automatic resolution ([`resolution()`]) is a little coarser.
//! * Where no light at all arrives, vertices are invalid, as inside of geometry, and lookups take what has been filled in from around:
//!   the outside of a closed room's wall, and the inside of a closed room without any light beside a lit one, are shown with light of
//!   the lit room.
//! * Photons, and the lights that paths sample, are shared out by power alone. Where one closed room has lamps a hundred times as
//!   strong as another's, few reach the dim one: it is noisy, and below a thousandth many of its vertices count as unlit. The error
//!   that a bake reports is that of the whole grid.
//!
//! # Example
//!
//! ```
//! use glam::{DAffine3, DVec3, Vec3};
//! use ivg_bake::{BakeOptions, Silent, bake};
//! use ivg_scene::{Effect, EffectPlan, Light, LightKind, Material, Mesh, Need, Node, PlannedEffect, Scene};
//!
//! let floor = Mesh {
//!     positions: vec![Vec3::ZERO, Vec3::Z, Vec3::X],
//!     triangles: vec![[0, 1, 2]],
//!     triangle_materials: vec![0],
//!     ..Mesh::default()
//! };
//! let scene = Scene {
//!     meshes: vec![floor],
//!     nodes: vec![Node { name: "floor".into(), mesh: 0, transform: DAffine3::IDENTITY }],
//!     materials: vec![Material::default()],
//!     lights: vec![Light {
//!         name: "lamp".into(),
//!         kind: LightKind::Point { position: DVec3::new(0.3, 0.5, 0.3), intensity: Vec3::ONE },
//!     }],
//!     ..Scene::default()
//! };
//! let plan = EffectPlan {
//!     effects: vec![PlannedEffect {
//!         effect: Effect::DiffuseIndirect,
//!         need: Need::Needed,
//!         reason: "a floor under a lamp".into(),
//!         cost: None,
//!     }],
//!     max_bounces: 4,
//!     energy_cutoff: 0.01,
//! };
//! let options = BakeOptions {
//!     dims: [4; 3],
//!     bounds: Some((DVec3::new(0.0, 0.1, 0.0), DVec3::ONE)),
//!     photons: 10_000,
//!     ..BakeOptions::default()
//! };
//! let result = bake(&scene, &scene.flatten(), &plan, &options, &Silent)?;
//! // The floor reflects half of what falls on it, upwards: seen from above, light comes from −y.
//! let vectors = result.grid.vectors()[0];
//! assert!(vectors[3][1][1] < 0.0 && vectors[2][1] == [0.0; 3]);
//! # Ok::<(), ivg_bake::BakeError>(())
//! ```
//!
//! # Features
//!
//! `cases` adds the module `cases`: the hard cases as functions; `rays` adds the module `rays`, which measures how fast rays find
//! what they hit; `fuzz` adds what fuzz targets call. None changes a result.

#![forbid(unsafe_code)]

mod accel;
mod accumulate;
mod accumulator;
mod accuracy;
mod bake;
#[cfg(any(test, feature = "cases"))]
pub mod cases;
mod centring;
mod dual;
mod emit;
mod error;
mod estimate;
mod intersect;
mod lobes;
mod monitor;
mod options;
mod overlap;
mod pilot;
#[cfg(any(test, feature = "rays"))]
pub mod rays;
mod ready;
pub mod reference;
mod region;
mod resolution;
mod sampling;
mod space;
mod stage;
mod surface;
mod tally;
mod trace;
mod validity;
mod workers;

#[cfg(any(test, feature = "fuzz"))]
pub use accumulator::fuzz_accumulator;
pub use accumulator::{Accumulator, AccumulatorError, Shard, accumulate};
pub use accuracy::{AccuracyReport, CONFIDENCE, EndedBy};
pub use bake::{BakeResult, BakeStats, BakedLight, bake, bake_measured};
pub use error::BakeError;
pub use monitor::{BakeStage, Monitor, Silent};
pub use options::{BakeOptions, Estimator, automatic_bounds, dims_for};
pub use pilot::{PilotReport, measure_reflections, pilot};
pub use resolution::{Limited, Resolution, ResolutionLimits, resolution};
