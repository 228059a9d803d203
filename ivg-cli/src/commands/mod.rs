//! One file for each command: arguments in, library calls, a table or JSON out.

pub(crate) mod bake;
pub(crate) mod check;
pub(crate) mod conformance;
pub(crate) mod demo;
pub(crate) mod extract;
pub(crate) mod fetch;
pub(crate) mod info;
pub(crate) mod merge;
pub(crate) mod mesh;
pub(crate) mod pack;
pub(crate) mod plan;
pub(crate) mod recode;
pub(crate) mod render;
pub(crate) mod robustness;
pub(crate) mod sample;
pub(crate) mod serve;
