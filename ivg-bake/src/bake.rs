use glam::DVec3;
use ivg_format::Quantity;
use ivg_grid::{GridValues, IrradianceGrid};
use ivg_scene::{EffectPlan, FlatScene, Scene};

use crate::accuracy::{self, AccuracyReport, Simulated, gathering};
use crate::dual::Boxes;
use crate::estimate::Estimate;
use crate::estimate::face_crossing::FaceCrossing;
use crate::estimate::held::{Held, Linear};
use crate::estimate::track_length::{RadianceTracks, VectorTracks};
use crate::pilot;
use crate::ready::Ready;
use crate::region::Regions;
use crate::stage::Effects;
use crate::tally::{self, Photons, Tally, Traced};
use crate::trace::{Books, Tracer};
use crate::validity::Surroundings;
use crate::workers::Workers;
use crate::{BakeError, BakeOptions, BakeStage, Estimator, Monitor};

/// A baked grid and what the bake has to say about it.
#[derive(Debug, Clone, PartialEq)]
pub struct BakeResult {
    /// Indirect light as the quantity asked for, validity and blocked edges; every vertex is received. An invalid vertex has
    /// values of zero, which mean nothing.
    pub grid: IrradianceGrid,
    /// Figures of the bake.
    pub stats: BakeStats,
    /// How accurate the grid is, if an accuracy was asked for.
    pub accuracy: Option<AccuracyReport>,
}

/// Figures of a bake. They depend on the scene and the options alone, not on time or threads, unless the monitor ended it.
/// [`Estimator::Gather`] traces no photons: its flights and watts are 0.
#[derive(Debug, Clone, PartialEq)]
pub struct BakeStats {
    /// Photons traced.
    pub photons: u64,
    /// Paths traced to gather light at vertices.
    pub paths: u64,
    /// Vertices that [`Estimator::Gather`] traced fewer paths for than asked for, since the monitor had enough.
    pub rough_vertices: usize,
    /// Straight flights of photons between surfaces: rays traced for them.
    pub flights: u64,
    /// Power that all lights emit \[W\], linear RGB, as the photons sampled it.
    pub emitted: DVec3,
    /// Power absorbed by surfaces \[W\].
    pub absorbed: DVec3,
    /// Power that left the scene \[W\].
    pub escaped: DVec3,
    /// Power left in photons that reached the largest number of reflections \[W\].
    pub cut: DVec3,
    /// Vertices that light reaches.
    pub valid_vertices: usize,
    /// Edges between neighbours that geometry cuts.
    pub blocked_edges: usize,
    /// The lights whose light is in the grid.
    pub lights: Vec<BakedLight>,
}

/// A light whose light is in a grid.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BakedLight {
    /// Name of the light, of the emissive material, or `sky`.
    pub name: String,
    /// Whether its direct light is in the grid as well as what surfaces reflect of it. True for the sky, which a client
    /// has no other way to draw light from; false for all others.
    pub direct: bool,
}

/// Bakes the indirect light of a scene.
///
/// Photons leave the lights in proportion to their power and are traced until they are absorbed, leave the scene or have
/// been reflected `plan.max_bounces` times; their flights are deposited in the grid by the estimator of the options. First
/// flights are left out, except the sky's: direct light is the client's work. Only effects that the plan needs are
/// simulated. With [`Estimator::Gather`] every vertex is path traced instead.
///
/// With an accuracy in the options, photons are traced in rounds until noise and bias together are small enough
/// ([`AccuracyReport`]), and vertices for which that would take too long are path traced. Vertices that are not hold what a
/// bake of as many photons gives, bit for bit.
///
/// For one release and target the result depends only on scene, plan and options, whatever the number of threads, unless
/// [`Monitor::enough`] ends the bake.
///
/// # Errors
///
/// A [`BakeError`] for a scene without light, for numbers and indices that cannot be used, for a lattice that is not
/// possible, for counts that could overflow, and when the monitor cancels.
pub fn bake(
    scene: &Scene,
    flat: &FlatScene,
    plan: &EffectPlan,
    options: &BakeOptions,
    monitor: &dyn Monitor,
) -> Result<BakeResult, BakeError> {
    monitor.stage(BakeStage::Preparation);
    let ready = Ready::new(scene, flat, plan, options)?;
    bake_ready(scene, flat, &ready, plan, options, monitor)
}

/// As [`bake`], after as many reflections as are worth following have been written into the plan
/// ([`measure_reflections`](crate::measure_reflections)): the scene is made ready once for both.
///
/// # Errors
///
/// As [`bake`].
pub fn bake_measured(
    scene: &Scene,
    flat: &FlatScene,
    plan: &mut EffectPlan,
    options: &BakeOptions,
    monitor: &dyn Monitor,
) -> Result<BakeResult, BakeError> {
    monitor.stage(BakeStage::Preparation);
    let ready = Ready::new(scene, flat, plan, options)?;
    pilot::measure(&ready, plan, options, monitor)?;
    bake_ready(scene, flat, &ready, plan, options, monitor)
}

fn bake_ready(
    scene: &Scene,
    flat: &FlatScene,
    ready: &Ready<'_>,
    plan: &EffectPlan,
    options: &BakeOptions,
    monitor: &dyn Monitor,
) -> Result<BakeResult, BakeError> {
    let photons = Ready::photons(options, plan.max_bounces)?;
    let workers = Workers { threads: options.thread_count(), monitor, total_photons: photons };
    let surroundings = ready.surroundings(options.estimator, &workers)?;
    let tracer = ready.tracer(options.seed, plan.max_bounces);
    let job = Job { options, ready, surroundings: &surroundings, tracer, workers, photons };
    let simulated = match (options.estimator, options.quantity) {
        (Estimator::Gather, Quantity::Vectors) => gathering::run::<ivg_format::HemisphereVectors>(&job)?,
        (Estimator::Gather, Quantity::Radiance) => gathering::run::<ivg_format::RadianceHarmonics>(&job)?,
        _ => Chosen::new(options, ready.cells, &surroundings.regions)?.simulate(&job)?,
    };
    let Simulated { values, books, photons, paths, accuracy, rough } = simulated;
    let unit = ready.stage.emitters.total_power() / photons.max(1) as f64;
    let watts = |quanta: [i128; 3]| DVec3::from(quanta.map(|q| q as f64)) * (unit / Books::QUANTA);
    let Surroundings { validity, blocked_edges, .. } = surroundings;
    let grid = IrradianceGrid::from_parts(ready.lattice, values, validity, blocked_edges)?;
    let stats = BakeStats {
        photons,
        paths,
        rough_vertices: rough,
        flights: books.flights,
        emitted: watts(books.emitted),
        absorbed: watts(books.absorbed),
        escaped: watts(books.escaped),
        cut: watts(books.cut),
        valid_vertices: grid.valid_count(),
        blocked_edges: grid.blocked_edge_count(),
        lights: lights(scene, flat, Effects::of(plan)),
    };
    Ok(BakeResult { grid, stats, accuracy })
}

/// A bake on its way: all that simulating light needs.
pub(crate) struct Job<'a> {
    pub(crate) options: &'a BakeOptions,
    pub(crate) ready: &'a Ready<'a>,
    pub(crate) surroundings: &'a Surroundings,
    pub(crate) tracer: Tracer<'a>,
    pub(crate) workers: Workers<'a>,
    /// The most photons.
    pub(crate) photons: u64,
}

impl Job<'_> {
    pub(crate) fn seed(&self) -> u64 {
        self.options.seed
    }

    /// What all photons together carry \[W\], for lengths in bake units.
    pub(crate) fn power(&self) -> f64 {
        self.ready.stage.emitters.total_power() * self.ready.per_area
    }

    /// Makes means over cells the light where the vertices look from. Means over faces are left as they are.
    pub(crate) fn carry<T: Linear>(&self, means: &mut [T]) -> Result<(), BakeError> {
        if self.options.estimator != Estimator::TrackLength {
            return Ok(());
        }
        self.surroundings.centring.apply(means, &self.workers)
    }

    /// The vertices that light reaches.
    pub(crate) fn counted(&self) -> impl Iterator<Item = usize> {
        let validity = self.surroundings.validity.iter().enumerate();
        validity.filter(|(_, validity)| **validity > 0).map(|(vertex, _)| vertex)
    }
}

/// Traces the photons of a job, all or until the monitor has enough.
fn all_photons<E: Estimate<Value: Held>>(job: &Job<'_>, estimate: &E) -> Result<Simulated, BakeError>
where
    GridValues: From<Vec<E::Value>>,
{
    job.workers.monitor.stage(BakeStage::Photons);
    let mut tally = Tally::new(&job.tracer, estimate, job.workers.threads);
    let mut next = 0;
    while next < job.photons && (next == 0 || !job.workers.monitor.enough()) {
        let last = tally::stretch(next, job.photons, 1);
        tally.trace(Photons::all(next, last), &job.workers)?;
        next = last;
    }
    let Traced { sums, books, photons } = tally.finish();
    let power = job.power() / photons as f64;
    let mut values = estimate.values(sums, job.ready.cells.len(), power);
    job.carry(&mut values)?;
    Ok(Simulated { values: values.into(), books, photons, paths: 0, accuracy: None, rough: 0 })
}

/// The estimator of the options.
#[derive(Debug)]
pub(crate) enum Chosen<'a> {
    Vectors(VectorTracks<'a>),
    Radiance(RadianceTracks<'a>),
    Faces(FaceCrossing<'a>),
}

impl<'a> Chosen<'a> {
    pub(crate) fn new(options: &BakeOptions, cells: Boxes, regions: &'a Regions) -> Result<Self, BakeError> {
        Ok(match (options.quantity, options.estimator) {
            (Quantity::Vectors, Estimator::TrackLength) => Self::Vectors(VectorTracks::new(cells, regions)),
            (Quantity::Radiance, Estimator::TrackLength) => {
                Self::Radiance(RadianceTracks::new(cells, regions))
            }
            (Quantity::Vectors, Estimator::FaceCrossing) => {
                Self::Faces(FaceCrossing::unbiased(cells, regions))
            }
            (Quantity::Vectors, Estimator::FaceCrossingRr6983) => {
                Self::Faces(FaceCrossing::as_printed(cells))
            }
            (_, estimator) => return Err(BakeError::Quantity { estimator }),
        })
    }

    /// Traces `photons` photons on all threads.
    pub(crate) fn run(
        &self,
        tracer: &Tracer<'_>,
        photons: u64,
        workers: &Workers<'_>,
    ) -> Result<Traced, BakeError> {
        match self {
            Self::Vectors(estimate) => tally::run(tracer, estimate, photons, workers),
            Self::Radiance(estimate) => tally::run(tracer, estimate, photons, workers),
            Self::Faces(estimate) => tally::run(tracer, estimate, photons, workers),
        }
    }

    /// Simulates the light of a job.
    fn simulate(&self, job: &Job<'_>) -> Result<Simulated, BakeError> {
        fn go<E: Estimate<Value: Held>>(job: &Job<'_>, estimate: &E) -> Result<Simulated, BakeError>
        where
            GridValues: From<Vec<E::Value>>,
        {
            match job.options.accuracy {
                Some(asked) => accuracy::run(job, estimate, asked),
                None => all_photons(job, estimate),
            }
        }
        match self {
            Self::Vectors(estimate) => go(job, estimate),
            Self::Radiance(estimate) => go(job, estimate),
            Self::Faces(estimate) => go(job, estimate),
        }
    }
}

/// The lights of a scene: emissive materials in use, lights without a surface, the sky.
pub(crate) fn lights(scene: &Scene, flat: &FlatScene, effects: Effects) -> Vec<BakedLight> {
    let mut used = vec![false; scene.materials.len()];
    flat.triangle_materials.iter().for_each(|&material| used[material as usize] = true);
    let emissive =
        scene.materials.iter().zip(used).filter(|(m, used)| *used && m.emission != glam::Vec3::ZERO);
    let surfaces = emissive.map(|(material, _)| BakedLight { name: material.name.clone(), direct: false });
    let placed = scene.lights.iter().map(|light| BakedLight { name: light.name.clone(), direct: false });
    let sky =
        (effects.sky && scene.mean_sky().is_some()).then(|| BakedLight { name: "sky".into(), direct: true });
    surfaces.chain(placed).chain(sky).collect()
}

#[cfg(test)]
mod tests;
