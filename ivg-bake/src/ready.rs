//! What a bake needs before its first photon: the stage, the lattice with its dual cells, what each vertex sees.

use glam::DVec3;
use ivg_format::{Lattice, Quantity};
use ivg_scene::{EffectPlan, FlatScene, Scene};

use crate::accumulate::MAX_FLIGHTS;
use crate::dual::Boxes;
use crate::stage::{Effects, Stage};
use crate::trace::Tracer;
use crate::validity::Surroundings;
use crate::workers::Workers;
use crate::{BakeError, BakeOptions, Estimator};

/// A scene and a lattice ready for photons.
#[derive(Debug)]
pub(crate) struct Ready<'a> {
    pub(crate) stage: Stage<'a>,
    pub(crate) lattice: Lattice,
    pub(crate) cells: Boxes,
    /// Bake units per metre, squared: from power per square bake unit to W/m².
    pub(crate) per_area: f64,
}

impl<'a> Ready<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        flat: &'a FlatScene,
        plan: &EffectPlan,
        options: &BakeOptions,
    ) -> Result<Self, BakeError> {
        if options.quantity == Quantity::Radiance && !options.estimator.gives_radiance() {
            return Err(BakeError::Quantity { estimator: options.estimator });
        }
        if options.photons == 0 {
            return Err(BakeError::NoPhotons);
        }
        if let Some(asked) = options.accuracy.filter(|asked| !(*asked > 0.0 && *asked < 1.0)) {
            return Err(BakeError::Accuracy { asked });
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
        let stage = stage.with_shadows_of(plan);
        let cells = Boxes::dual_cells(&lattice, thickness, stage.space);
        let per_area = stage.space.scale().powi(2);
        Ok(Self { stage, lattice, cells, per_area })
    }

    /// The most photons that are traced: those of the options, and with an accuracy no more than the sums hold with so many
    /// reflections.
    ///
    /// # Errors
    ///
    /// [`BakeError::TooManyPhotons`] for more photons than that without an accuracy.
    pub(crate) fn photons(options: &BakeOptions, bounces: u32) -> Result<u64, BakeError> {
        let (photons, most) = (options.photons, MAX_FLIGHTS / (u64::from(bounces) + 1));
        if options.accuracy.is_none() && options.estimator != Estimator::Gather && photons > most {
            return Err(BakeError::TooManyPhotons { photons, bounces, most });
        }
        Ok(photons.min(most))
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
