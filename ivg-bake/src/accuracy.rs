//! Bakes to an accuracy, and what they say about it.
//!
//! **The error** of a grid is measured at the vertices that light reaches, in the irradiance of surfaces that face along
//! the six axes, three channels: 18 numbers a vertex. For irradiance vectors these are I_d·d; of radiance harmonics they are what
//! the harmonics make of them. The relative error is the root of the sum of squared errors over all vertices and numbers,
//! divided by the root of the sum of squares of the numbers themselves. The truth is the light at the place the vertex looks
//! from, reflected any number of times.
//!
//! **Noise** is measured by comparing batches of photons ([`noise`]), **bias** by path tracing at some vertices
//! ([`probes`]). [`rounds`] traces photons until both together are small enough, with the stated confidence.

use ivg_grid::GridValues;

use crate::trace::Books;

pub(crate) mod gathering;
mod noise;
mod probes;
mod rounds;
mod student;

pub(crate) use self::rounds::run;

/// How often the error of a grid is at most what the report says was reached.
pub const CONFIDENCE: f64 = 0.95;

/// Why a bake to an accuracy ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum EndedBy {
    /// What was asked for is reached.
    Accuracy,
    /// The photons, or paths, allowed are spent.
    Photons,
    /// The [`Monitor`](crate::Monitor) had enough, as when a time is up.
    Monitor,
}

impl EndedBy {
    /// The name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Accuracy => "accuracy",
            Self::Photons => "photons",
            Self::Monitor => "time",
        }
    }
}

/// What a bake to an accuracy says about its error. All errors are relative, 0.02 being 2 %: root mean squares over the
/// vertices that light reaches, of the irradiance of surfaces that face along the axes, three channels, divided by
/// the root mean square of that irradiance.
///
/// The report depends on scene and options alone, unless a time ended the bake.
#[derive(Debug, Clone, PartialEq)]
pub struct AccuracyReport {
    /// The error asked for.
    pub asked: f64,
    /// The error that the grid has at most, with [`CONFIDENCE`]; of noise alone where the bias is not known.
    pub reached: f64,
    /// How much of it is noise: the estimate.
    pub noise: f64,
    /// How much of it is bias: the estimate, 0 where it is less than can be told from noise; `None` if the bake ended before
    /// bias was measured at vertices enough.
    pub bias: Option<f64>,
    /// Why the bake ended.
    pub ended_by: EndedBy,
    /// Batches of photons that the noise was estimated from.
    pub batches: usize,
    /// Times that noise and bias were looked at.
    pub looks: u32,
    /// Vertices that light reaches: those that count.
    pub vertices: usize,
    /// Vertices at which light was gathered to find the bias.
    pub probes: usize,
    /// Vertices that hold gathered light because averaging over their cells is too biased, most of them next to geometry.
    pub gathered_biased: usize,
    /// Vertices that hold gathered light because photons left them too noisy, measured by their own brightness.
    pub gathered_noisy: usize,
    /// Vertices that are too noisy still, since the bake had to end.
    pub noisy: usize,
    /// Paths traced for gathering.
    pub paths: u64,
}

impl AccuracyReport {
    /// Whether the grid is known to be as accurate as was asked for.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.bias.is_some() && self.reached <= self.asked
    }
}

/// What a simulation left: the values of all vertices and figures.
#[derive(Debug)]
pub(crate) struct Simulated {
    pub(crate) values: GridValues,
    pub(crate) books: Books,
    pub(crate) photons: u64,
    /// Paths traced to gather light.
    pub(crate) paths: u64,
    pub(crate) accuracy: Option<AccuracyReport>,
    /// Vertices that have fewer paths than asked for, since the time was up.
    pub(crate) rough: usize,
}

/// What bounds are allowed to be wrong by at look number `look`, from 1: all of them together 1 − [`CONFIDENCE`].
fn beyond(look: u32) -> f64 {
    (1.0 - CONFIDENCE) / (f64::from(look) * f64::from(look + 1))
}

#[cfg(test)]
mod tests;
