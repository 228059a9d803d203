//! How fine a grid a scene calls for: from the distances between surfaces, from how the light changes along each axis, and from
//! what limits it.

use std::sync::{Mutex, PoisonError};

use glam::DVec3;
use ivg_format::Quantity;
use ivg_scene::{EffectPlan, FlatScene, Scene};

use crate::accumulate::{Sums, Total};
use crate::estimate::{Estimate, Flight};
use crate::options::dims_for;
use crate::ready::Ready;
use crate::tally::run;
use crate::workers::Workers;
use crate::{BakeError, BakeOptions, Estimator, Silent};

mod change;

use self::change::Trial;

/// Photons whose flights are measured.
const FLIGHT_PHOTONS: u64 = 4096;

/// Vertices along the longest axis of the coarse grid on which the change of light is measured.
const TRIAL_LONGEST: u16 = 16;

/// Fewest vertices of that grid along an axis on which the scene has an extent: of fewer, most are the ones at the bounds.
const TRIAL_FEWEST: u16 = 8;

/// Photons of each of the two bakes of that grid.
const TRIAL_PHOTONS: u64 = 1 << 16;

/// Steps of the grid in the middle one of all flights: indirect light changes over distances like those between surfaces, and
/// averaging over a cell of an eighth of them is off by a few per cent.
const STEPS_A_FLIGHT: f64 = 8.0;

/// How much light may change from a vertex to the next, relative to its root mean square. Where it changes evenly, a mean over a
/// cell is right whatever its size; it is what bends that is lost. By the example `brightness` with `--grid auto` pictures of three
/// rooms then are 0.7 % too dark to 2.4 % too bright, and no part of 27 is surely off by more than 10 %; with a tenth, which takes two
/// fifths of the vertices, 1.3 % too dark to 3.5 % too bright, a part of the kitchen by 14 %.
const CHANGE: f64 = 0.07;

/// The smallest and the largest step that the change of light leads to, relative to the one that the flights give: a trial
/// grid shows no detail finer than its own steps, and light that is even there need not be next to surfaces.
const FACTORS: (f64, f64) = (0.5, 2.0);

/// Fewest and most vertices along an axis on which the scene has an extent.
const ALONG: (u16, u16) = (4, 128);

/// Growth of the steps from one try to the next while a limit is exceeded: 2^(1/16).
const COARSER: f64 = 1.044_273_782_427_413_8;

/// What keeps a grid from being finer.
#[derive(Clone, Copy)]
#[expect(missing_debug_implementations, reason = "holds a function")]
pub struct ResolutionLimits<'a> {
    /// The most vertices.
    pub vertices: u64,
    /// The vertices that there is time to look around from before the first photon, if time is short.
    pub prepared: Option<u64>,
    /// The photons that there is time for and the relative noise that they may leave, if time is short. Noise is that of
    /// [`AccuracyReport`](crate::AccuracyReport).
    pub photons: Option<(u64, f64)>,
    /// Whether a file with so many vertices along x, y and z is small enough.
    pub fits: &'a dyn Fn([u16; 3]) -> bool,
}

/// What made a grid coarser than the light calls for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Limited {
    /// The most vertices along an axis.
    Axis,
    /// The most vertices in all.
    Vertices,
    /// The size of the file.
    Size,
    /// The vertices that there is time to look around from.
    Preparation,
    /// The photons that there is time for.
    Photons,
}

impl Limited {
    /// The words for it.
    fn words(self) -> &'static str {
        match self {
            Self::Axis => "an axis has no more vertices",
            Self::Vertices => "a grid has no more vertices",
            Self::Size => "the file is to be no larger",
            Self::Preparation => "a finer one takes longer to prepare than there is time for",
            Self::Photons => "the photons that there is time for leave too much noise on a finer one",
        }
    }
}

/// How fine a grid is to be, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Resolution {
    /// Vertices along x, y and z.
    pub dims: [u16; 3],
    /// Middle length of reflected flights between surfaces \[m\]; 0 if there are none.
    pub flight: f64,
    /// How much the light changes over an eighth of that along x, y and z: root mean square over pairs of neighbours on a
    /// coarse grid, relative to the root mean square of the light.
    pub change: [f64; 3],
    /// Distance of neighbouring vertices along x, y and z \[m\].
    pub step: [f64; 3],
    /// What made it coarser than distances and light call for; `None`: nothing did.
    pub limited: Option<Limited>,
}

impl Resolution {
    /// The reason in words.
    #[must_use]
    pub fn reason(&self) -> String {
        let Self { dims: [nx, ny, nz], flight, change, step, limited } = self;
        if *flight == 0.0 {
            return format!("{nx}x{ny}x{nz}: no light is reflected, the fewest vertices do");
        }
        let [cx, cy, cz] = change.map(|change| format!("{:.1} %", 100.0 * change));
        let [sx, sy, sz] = step.map(|step| format!("{step:.3}"));
        let mut text = format!(
            "{nx}x{ny}x{nz}: half of the reflected light flies {flight:.3} m or more before it meets a surface; over an eighth of \
             that light changes by {cx} along x, {cy} along y, {cz} along z; steps are {sx}, {sy}, {sz} m, "
        );
        if let Some(limited) = limited {
            text += &format!("coarser than the light calls for: {}", limited.words());
        } else {
            text += &format!("over which it changes by about {:.0} %", 100.0 * CHANGE);
            if change.iter().any(|&change| clamped(change) != CHANGE / change) {
                text += ", at least half and at most twice the eighth";
            }
        }
        text
    }
}

/// The step along an axis, relative to the one that the flights give.
fn clamped(change: f64) -> f64 {
    (CHANGE / change.max(f64::MIN_POSITIVE)).clamp(FACTORS.0, FACTORS.1)
}

/// A grid for a scene. The step is an eighth of the distance that light flies between surfaces (the median, measured with
/// 4096 photons), made smaller or larger along each axis, from half to twice, so that light changes by 7 % from a vertex to the next:
/// that is measured on a coarse grid of 16 vertices along the longest axis and 8 or more along the others, with two bakes of 65,536
/// photons, whose noise is independent and drops out of products. An axis has 4 to 128 vertices, and all steps grow until the limits are met.
/// Depends on scene, plan, limits, and on bounds and seed of the options alone.
///
/// # Errors
///
/// As [`bake`](crate::bake()).
pub fn resolution(
    scene: &Scene,
    flat: &FlatScene,
    plan: &EffectPlan,
    options: &BakeOptions,
    limits: &ResolutionLimits<'_>,
) -> Result<Resolution, BakeError> {
    let scene_bounds = || crate::stage::bounds(flat).ok_or(BakeError::Lattice(no_extent()));
    let (min, max): (DVec3, DVec3) = options.bounds.map_or_else(scene_bounds, Ok)?;
    let trial_options = BakeOptions {
        dims: trial_dims(max - min),
        photons: TRIAL_PHOTONS,
        accuracy: None,
        estimator: Estimator::TrackLength,
        quantity: Quantity::Vectors,
        ..options.clone()
    };
    let ready = Ready::new(scene, flat, plan, &trial_options)?;
    let flight = middle_flight(&ready, options.seed, plan.max_bounces)?;
    let trial = if flight > 0.0 { Some(Trial::new(&ready, &trial_options, plan.max_bounces)?) } else { None };
    let eighth = flight / STEPS_A_FLIGHT;
    let change = trial.as_ref().map_or([0.0; 3], |trial| trial.per_metre.map(|change| change * eighth));
    // Automatic bounds lie a step outside on either side.
    let outside = if options.bounds.is_some() { 1.0 } else { 3.0 };
    let lattice = Steps { extent: max - min, outside };
    let mut steps =
        if flight > 0.0 { change.map(|change| eighth * clamped(change)) } else { [f64::INFINITY; 3] };
    let mut limited =
        (0..3).any(|axis| lattice.wanted(axis, steps[axis]) > f64::from(ALONG.1)).then_some(Limited::Axis);
    let noisy = |dims: [u16; 3]| match (limits.photons, &trial) {
        (Some((photons, noise)), Some(trial)) => trial.noise(vertices(dims), photons) > noise,
        _ => false,
    };
    let exceeded = [
        (Limited::Vertices, &(|dims| vertices(dims) > limits.vertices) as &dyn Fn([u16; 3]) -> bool),
        (Limited::Size, &|dims| !(limits.fits)(dims)),
        (Limited::Preparation, &|dims| limits.prepared.is_some_and(|most| vertices(dims) > most)),
        (Limited::Photons, &noisy),
    ];
    let mut dims = lattice.dims(steps);
    for (limit, exceeded) in exceeded {
        while exceeded(dims) && dims != lattice.dims([f64::INFINITY; 3]) {
            steps = steps.map(|step| step * COARSER);
            dims = lattice.dims(steps);
            limited = Some(limit);
        }
    }
    let step = core::array::from_fn(|axis| lattice.extent[axis] / (f64::from(dims[axis]) - outside).max(1.0));
    Ok(Resolution { dims, flight, change, step, limited })
}

/// Vertices of the coarse grid on which the change of light is measured.
fn trial_dims(extent: DVec3) -> [u16; 3] {
    let mut dims = dims_for(DVec3::ZERO, extent, TRIAL_LONGEST);
    for (axis, count) in dims.iter_mut().enumerate() {
        if !is_flat(extent, axis) {
            *count = (*count).max(TRIAL_FEWEST);
        }
    }
    dims
}

fn no_extent() -> ivg_format::LatticeError {
    ivg_format::LatticeError::NotFinite { axis: 0 }
}

fn vertices(dims: [u16; 3]) -> u64 {
    dims.map(u64::from).iter().product()
}

/// From steps to vertices.
struct Steps {
    /// What the scene or the bounds span \[m\].
    extent: DVec3,
    /// Vertices more than steps in that extent.
    outside: f64,
}

impl Steps {
    /// Vertices along an axis for a step \[m\], before any limit.
    fn wanted(&self, axis: usize, step: f64) -> f64 {
        (self.extent[axis] / step + self.outside).round()
    }

    fn dims(&self, steps: [f64; 3]) -> [u16; 3] {
        core::array::from_fn(|axis| {
            if is_flat(self.extent, axis) {
                return 2;
            }
            self.wanted(axis, steps[axis]).clamp(f64::from(ALONG.0), f64::from(ALONG.1)) as u16
        })
    }
}

/// Extents below this share of the longest one count as none, as automatic bounds take them.
const FLAT_SHARE: f64 = 1e-3;

fn is_flat(extent: DVec3, axis: usize) -> bool {
    extent[axis] <= FLAT_SHARE * extent.max_element()
}

/// The median of the lengths of flights between surfaces \[m\]; 0 without any.
fn middle_flight(ready: &Ready<'_>, seed: u64, bounces: u32) -> Result<f64, BakeError> {
    let lengths = Lengths(Mutex::default());
    let workers = Workers { threads: 1, monitor: &Silent, total_photons: FLIGHT_PHOTONS };
    run(&ready.tracer(seed, bounces), &lengths, FLIGHT_PHOTONS, &workers)?;
    let mut lengths = lengths.0.into_inner().unwrap_or_else(PoisonError::into_inner);
    lengths.sort_by(f32::total_cmp);
    Ok(lengths.get(lengths.len() / 2).map_or(0.0, |&l| f64::from(l) / ready.stage.space.scale()))
}

/// Notes how long the flights are that end at a surface.
struct Lengths(Mutex<Vec<f32>>);

impl Estimate for Lengths {
    type Value = ();

    fn sums(&self) -> usize {
        0
    }

    fn deposit(&self, flight: &Flight, _sums: &mut impl Sums) {
        if flight.length.is_finite() {
            self.0.lock().unwrap_or_else(PoisonError::into_inner).push(flight.length);
        }
    }

    fn value(&self, _sums: &Total<'_>, _vertex: usize, _power: f64) {}
}

#[cfg(test)]
mod tests;
