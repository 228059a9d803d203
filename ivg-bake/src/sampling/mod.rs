//! Random numbers and the distributions drawn from them: pure functions, each with its density.

pub(crate) mod hemisphere;
pub(crate) mod light;
pub(crate) mod rng;
pub(crate) mod sky;
