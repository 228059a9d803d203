use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;
use ivg_format::{Lattice, Quantity};
use ivg_grid::{GridValues, IrradianceGrid};
use ivg_scene::{EffectPlan, FlatScene, Scene};

use crate::accumulate::{MAX_FLIGHTS, Store};
use crate::dual::Boxes;
use crate::estimate::Estimate;
use crate::estimate::face_crossing::FaceCrossing;
use crate::estimate::track_length::{RadianceTracks, VectorTracks};
use crate::region::Regions;
use crate::stage::{Effects, Stage};
use crate::trace::{Books, Tracer};
use crate::validity::Surroundings;
use crate::workers::Workers;
use crate::{BakeError, BakeOptions, Estimator, Monitor};

/// A baked grid and what the bake has to say about it.
#[derive(Debug, Clone, PartialEq)]
pub struct BakeResult {
    /// Indirect light as the quantity asked for, validity and blocked edges; every vertex is received. An invalid vertex has
    /// values of zero, which mean nothing.
    pub grid: IrradianceGrid,
    /// Figures of the bake.
    pub stats: BakeStats,
}

/// Figures of a bake. They depend on the scene and the options alone, not on time or threads.
#[derive(Debug, Clone, PartialEq)]
pub struct BakeStats {
    /// Photons traced.
    pub photons: u64,
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

/// Photons that a thread takes at a time.
const PHOTONS_A_PIECE: u64 = 2048;

/// Bakes the indirect light of a scene.
///
/// Photons leave the lights in proportion to their power and are traced until they are absorbed, leave the scene or have
/// been reflected `plan.max_bounces` times; their flights are deposited in the grid by the estimator of the options. First
/// flights are left out, except the sky's: direct light is the client's work. Only effects that the plan needs are
/// simulated.
///
/// For one release and target the result depends only on scene, plan and options, whatever the number of threads.
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
    let ready = Ready::new(scene, flat, plan, options)?;
    let workers = Workers { threads: options.thread_count(), monitor, total_photons: options.photons };
    let surroundings = ready.surroundings(options.estimator, &workers)?;
    let tracer = ready.tracer(options.seed, plan.max_bounces);
    let power = tracer.stage.emitters.total_power() / options.photons as f64;
    let estimate = Chosen::new(options, ready.cells, &surroundings.regions)?;
    let Traced { sums, books } = estimate.run(&tracer, options.photons, &workers)?;
    let values = estimate.values(&sums, ready.cells.len(), power * ready.per_area);
    let grid =
        IrradianceGrid::from_parts(ready.lattice, values, surroundings.validity, surroundings.blocked_edges)?;
    let watts = |quanta: [i128; 3]| DVec3::from(quanta.map(|q| q as f64)) * (power / Books::QUANTA);
    let stats = BakeStats {
        photons: options.photons,
        flights: books.flights,
        emitted: watts(books.emitted),
        absorbed: watts(books.absorbed),
        escaped: watts(books.escaped),
        cut: watts(books.cut),
        valid_vertices: grid.valid_count(),
        blocked_edges: grid.blocked_edge_count(),
        lights: lights(scene, flat, Effects::of(plan)),
    };
    Ok(BakeResult { grid, stats })
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
            (Quantity::Radiance, estimator) => return Err(BakeError::Quantity { estimator }),
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
            Self::Vectors(estimate) => run(tracer, estimate, photons, workers),
            Self::Radiance(estimate) => run(tracer, estimate, photons, workers),
            Self::Faces(estimate) => run(tracer, estimate, photons, workers),
        }
    }

    /// The values of `count` vertices from all sums; `power` as in [`Estimate::value`].
    fn values(&self, sums: &[i64], count: usize, power: f64) -> GridValues {
        fn all<E: Estimate>(estimate: &E, sums: &[i64], count: usize, power: f64) -> Vec<E::Value> {
            (0..count).map(|vertex| estimate.value(sums, vertex, power)).collect()
        }
        match self {
            Self::Vectors(estimate) => all(estimate, sums, count, power).into(),
            Self::Radiance(estimate) => all(estimate, sums, count, power).into(),
            Self::Faces(estimate) => all(estimate, sums, count, power).into(),
        }
    }
}

/// A scene and a lattice ready for photons.
#[derive(Debug)]
pub(crate) struct Ready<'a> {
    pub(crate) stage: Stage<'a>,
    pub(crate) lattice: Lattice,
    pub(crate) cells: Boxes,
    /// Bake units per metre, squared: from power per square bake unit to W/m².
    per_area: f64,
}

impl<'a> Ready<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        flat: &'a FlatScene,
        plan: &EffectPlan,
        options: &BakeOptions,
    ) -> Result<Self, BakeError> {
        let (photons, bounces) = (options.photons, plan.max_bounces);
        let most = MAX_FLIGHTS / (u64::from(bounces) + 1);
        if options.quantity == Quantity::Radiance && options.estimator != Estimator::TrackLength {
            return Err(BakeError::Quantity { estimator: options.estimator });
        }
        if photons == 0 {
            return Err(BakeError::NoPhotons);
        }
        if photons > most {
            return Err(BakeError::TooManyPhotons { photons, bounces, most });
        }
        let (min, max) = options.first_and_last(flat)?;
        let lattice = Lattice::new(options.dims, min.to_array(), max.to_array())?;
        // Refuses a lattice that cannot be held before anything of its size is allocated.
        ivg_grid_limit(&lattice)?;
        let thickness = options.thickness(&lattice, min, max);
        let half = DVec3::from_array(core::array::from_fn(|a| {
            0.5 * if lattice.step[a] > 0.0 { lattice.step[a] } else { thickness[a] }
        }));
        let (first, last) = (DVec3::from(lattice.origin), DVec3::from(last_vertex(&lattice)));
        let stage = Stage::new(scene, flat, Effects::of(plan), Some((first - half, last + half)))?;
        let cells = Boxes::dual_cells(&lattice, thickness, stage.space);
        let per_area = stage.space.scale().powi(2);
        Ok(Self { stage, lattice, cells, per_area })
    }

    /// What each vertex sees; for the estimator as printed, which knows no geometry, everything.
    pub(crate) fn surroundings(
        &self,
        estimator: Estimator,
        workers: &Workers<'_>,
    ) -> Result<Surroundings, BakeError> {
        match estimator {
            Estimator::FaceCrossingRr6983 => Ok(Surroundings::open(&self.cells)),
            _ => Surroundings::new(&self.stage, &self.cells, workers),
        }
    }

    pub(crate) fn tracer(&self, seed: u64, max_bounces: u32) -> Tracer<'_> {
        Tracer { stage: &self.stage, seed, max_bounces }
    }
}

/// The most vertices that a bake holds: a lattice of 256³.
fn ivg_grid_limit(lattice: &Lattice) -> Result<(), BakeError> {
    let (vertices, limit) = (lattice.vertex_count(), ivg_grid::DEFAULT_MAX_VERTICES);
    if vertices > limit {
        return Err(ivg_grid::GridError::TooManyVertices { vertices, limit }.into());
    }
    Ok(())
}

fn last_vertex(lattice: &Lattice) -> [f64; 3] {
    let [i, j, k] = lattice.dims.map(|n| n - 1);
    lattice.position(i, j, k)
}

/// What tracing left.
#[derive(Debug)]
pub(crate) struct Traced {
    sums: Vec<i64>,
    /// Where the energy went.
    pub(crate) books: Books,
}

/// Traces `photons` photons on all threads.
pub(crate) fn run(
    tracer: &Tracer<'_>,
    estimate: &impl Estimate,
    photons: u64,
    workers: &Workers<'_>,
) -> Result<Traced, BakeError> {
    let store = Store::new(estimate.sums(), workers.threads);
    let books = Mutex::new(Books::default());
    let done = AtomicU64::new(0);
    workers.run(photons.div_ceil(PHOTONS_A_PIECE), &done, |take| {
        let mut own = Books::default();
        let mut trace = |sums: &mut dyn FnMut(u64, &mut Books)| {
            while let Some(piece) = take() {
                let first = piece * PHOTONS_A_PIECE;
                let last = (first + PHOTONS_A_PIECE).min(photons);
                (first..last).for_each(|photon| sums(photon, &mut own));
                let done = done.fetch_add(last - first, Ordering::Relaxed) + (last - first);
                workers.monitor.progress(done, photons);
            }
        };
        match &store {
            Store::Private { len, total } => {
                let mut sums = Store::private(*len);
                trace(&mut |photon, books| tracer.trace(photon, estimate, &mut sums, books));
                Store::merge(total, &sums);
            }
            Store::Shared(cells) => {
                let mut sums = Store::view(cells);
                trace(&mut |photon, books| tracer.trace(photon, estimate, &mut sums, books));
            }
        }
        books.lock().unwrap_or_else(std::sync::PoisonError::into_inner).merge(&own);
    })?;
    let books = books.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    Ok(Traced { sums: store.into_sums(), books })
}

/// The lights of a scene: emissive materials in use, lights without a surface, the sky.
fn lights(scene: &Scene, flat: &FlatScene, effects: Effects) -> Vec<BakedLight> {
    let mut used = vec![false; scene.materials.len()];
    flat.triangle_materials.iter().for_each(|&material| used[material as usize] = true);
    let emissive =
        scene.materials.iter().zip(used).filter(|(m, used)| *used && m.emission != glam::Vec3::ZERO);
    let surfaces = emissive.map(|(material, _)| BakedLight { name: material.name.clone(), direct: false });
    let placed = scene.lights.iter().map(|light| BakedLight { name: light.name.clone(), direct: false });
    let sky = (effects.sky && scene.sky.is_some()).then(|| BakedLight { name: "sky".into(), direct: true });
    surfaces.chain(placed).chain(sky).collect()
}

#[cfg(test)]
mod tests;
