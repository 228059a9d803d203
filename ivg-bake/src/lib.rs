//! Light transport on the CPU: photons traced through a scene into an irradiance vector grid.

#![forbid(unsafe_code)]

mod accel;
mod accumulate;
mod bake;
#[cfg(any(test, feature = "cases"))]
pub mod cases;
mod dual;
mod emit;
mod error;
mod estimate;
mod intersect;
mod monitor;
mod options;
mod overlap;
mod pilot;
pub mod reference;
mod region;
mod sampling;
mod space;
mod stage;
mod surface;
mod trace;
mod validity;
mod workers;

pub use bake::{BakeResult, BakeStats, BakedLight, bake};
pub use error::BakeError;
pub use monitor::{Monitor, Silent};
pub use options::{BakeOptions, Estimator, automatic_bounds, dims_for};
pub use pilot::{PilotReport, pilot};
