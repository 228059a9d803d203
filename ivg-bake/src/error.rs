use ivg_format::LatticeError;
use ivg_grid::GridError;

use crate::{AccumulatorError, Estimator};

/// Why a scene cannot be baked.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BakeError {
    /// Nothing in the scene emits light.
    #[error("the scene has no light: add one with --lights FILE.toml")]
    NoLight,
    /// A photon count of zero.
    #[error("at least one photon is needed, 0 were asked for")]
    NoPhotons,
    /// Fewer photons than noise can be estimated from.
    #[error("{photons} photons are too few to tell how accurate a grid is; at least {least} are needed")]
    FewPhotons {
        /// The most photons allowed.
        photons: u64,
        /// The fewest needed.
        least: u64,
    },
    /// An accuracy that is not a share above zero.
    #[error(
        "an accuracy of {asked} cannot be reached; give a relative error above 0 and below 1, such as 0.02"
    )]
    Accuracy {
        /// The relative error asked for.
        asked: f64,
    },
    /// What accumulators do not hold.
    #[error("only bakes by photons with the estimator {} can be divided or resumed, without an accuracy", Estimator::TrackLength.name())]
    NotAccumulated,
    /// An accumulator that cannot be used here.
    #[error(transparent)]
    Accumulator(#[from] AccumulatorError),
    /// More photons than the sums are proven to hold.
    #[error("{photons} photons with up to {bounces} reflections could overflow the sums; at most {most} fit")]
    TooManyPhotons {
        /// Photons asked for.
        photons: u64,
        /// Largest number of reflections of the plan.
        bounces: u32,
        /// The most photons that fit with that many reflections.
        most: u64,
    },
    /// An estimator that gives irradiance vectors only, asked for radiance harmonics.
    #[error(
        "{} gives irradiance vectors only; radiance harmonics need the estimator {}",
        .estimator.name(), Estimator::TrackLength.name()
    )]
    Quantity {
        /// The estimator asked for.
        estimator: Estimator,
    },
    /// The bounds or vertex counts do not make a lattice.
    #[error("the grid is not possible: {0}")]
    Lattice(#[from] LatticeError),
    /// The bounds given reach far beyond the scene.
    #[error(
        "the bounds reach more than 10,000 times the scene's diagonal from it; give --bounds in metres, near the scene"
    )]
    FarBounds,
    /// The grid cannot be held.
    #[error("the grid cannot be held: {0}")]
    Grid(#[from] GridError),
    /// A number of the scene is NaN or infinite, or a colour is negative.
    #[error("{object}: {what} is not a usable number ({value})")]
    BadNumber {
        /// The material, light or vertex that has it.
        object: String,
        /// Which of its numbers.
        what: &'static str,
        /// The number as text.
        value: String,
    },
    /// A triangle names a vertex or a material that the scene does not have.
    #[error("triangle {triangle} names {what} {index}, which the scene does not have")]
    BadIndex {
        /// Index of the triangle.
        triangle: usize,
        /// `vertex`, `material` or `texture`.
        what: &'static str,
        /// The index out of range.
        index: u32,
    },
    /// Triangles nested so deep that the acceleration structure cannot be traversed.
    #[error(
        "the scene's triangles are nested too deep for the acceleration structure; simplify the geometry"
    )]
    TreeTooDeep,
    /// The monitor asked to stop.
    #[error("cancelled after {done} of {total} photons")]
    Cancelled {
        /// Photons traced.
        done: u64,
        /// Photons asked for.
        total: u64,
    },
}
