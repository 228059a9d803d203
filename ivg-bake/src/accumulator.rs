//! Sums of a bake that has not ended, or of a part of one: what an accumulator file holds (`spec/accumulator.md`).
//!
//! A bake's sums are integers, so that photons can be divided among processes (shards) or traced one after the other
//! (resuming), and give the same grid, bit for bit. [`Accumulator::finish`] needs neither scene nor rays.

use glam::DVec3;
use ivg_format::{HemisphereVectors, Lattice, Quantity, RadianceHarmonics};
use ivg_grid::{GridValues, IrradianceGrid};
use ivg_scene::{EffectPlan, FlatScene, Scene};

use crate::accumulate::Total;
use crate::bake::lights;
use crate::centring::{Centring, Place};
use crate::estimate::Estimate;
use crate::estimate::held::Held;
use crate::estimate::track_length::{self, RadianceTracks, VectorTracks};
use crate::ready::Ready;
use crate::region::SUB_CELLS;
use crate::stage::Effects;
use crate::tally::{PHOTONS_A_PIECE, Photons, Tally, stretch};
use crate::trace::Books;
use crate::workers::Workers;
use crate::{
    BakeError, BakeOptions, BakeResult, BakeStage, BakeStats, BakedLight, Estimator, Monitor, Silent,
};

mod digest;
mod file;

pub use file::AccumulatorError;
#[cfg(any(test, feature = "fuzz"))]
pub use file::fuzz_accumulator;

/// Which part of the photons: number `index` of `count`, from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// From 1 to `count`.
    pub index: u32,
    /// At least 1.
    pub count: u32,
}

impl Shard {
    /// All photons.
    pub const ALL: Self = Self { index: 1, count: 1 };
}

/// Sums of some of the photons of a bake, and all that is needed to make a grid of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Accumulator {
    head: Head,
    lights: Vec<BakedLight>,
    books: Books,
    vertices: Vec<Vertex>,
    sums: Vec<i64>,
}

/// What a bake knows about a vertex before its first photon.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Vertex {
    place: Place,
    validity: u8,
    blocked_edges: u8,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Head {
    /// The release and target that made the sums.
    release: u64,
    /// Scene, plan and options, but for seed, photons and threads.
    scene: u64,
    seed: u64,
    /// Photons of the whole bake.
    photons: u64,
    /// All photons of the shard below this number have been traced.
    traced: u64,
    shard: Shard,
    max_bounces: u32,
    quantity: Quantity,
    dims: [u16; 3],
    first: [f64; 3],
    last: [f64; 3],
    /// Power that the photons share \[W\].
    power: f64,
    /// Bake units per metre, squared.
    per_area: f64,
    /// Bake units a quantum.
    quantum: f64,
    /// Volume of a dual cell in cubic bake units.
    volume: f64,
}

impl Head {
    /// What people can tell bakes apart by.
    fn in_words(&self) -> [(&'static str, String); 6] {
        [
            ("numbers of vertices", self.dims.map(|count| count.to_string()).join("x")),
            ("quantities", self.quantity.name().to_owned()),
            ("first vertices [m]", format!("{:?}", self.first)),
            ("last vertices [m]", format!("{:?}", self.last)),
            ("numbers of reflections", self.max_bounces.to_string()),
            ("powers of the lights [W]", self.power.to_string()),
        ]
    }
}

/// Traces the photons of a shard, or those that `from` still lacks, and gives `save` the sums now and then.
///
/// The monitor can end it early: the sums can be resumed. A bake that is whole can be resumed with more photons.
///
/// # Errors
///
/// As [`bake`](crate::bake()); [`BakeError::NotAccumulated`] for other estimators than [`Estimator::TrackLength`] and with
/// an accuracy; [`BakeError::Accumulator`] if `from` belongs to another release, scene, plan, seed, options or shard.
pub fn accumulate(
    scene: &Scene,
    flat: &FlatScene,
    plan: &EffectPlan,
    options: &BakeOptions,
    (shard, from): (Shard, Option<Accumulator>),
    monitor: &dyn Monitor,
    save: &mut dyn FnMut(&Accumulator),
) -> Result<Accumulator, BakeError> {
    if options.estimator != Estimator::TrackLength || options.accuracy.is_some() {
        return Err(BakeError::NotAccumulated);
    }
    if shard.index == 0 || shard.index > shard.count {
        return Err(AccumulatorError::Shard { index: shard.index, count: shard.count }.into());
    }
    monitor.stage(BakeStage::Preparation);
    let ready = Ready::new(scene, flat, plan, options)?;
    let photons = Ready::photons(options, plan.max_bounces)?;
    let workers = Workers { threads: options.thread_count(), monitor, total_photons: photons };
    let surroundings = ready.surroundings(options.estimator, &workers)?;
    let vertices = (0..ready.cells.len())
        .map(|vertex| {
            let (validity, blocked_edges) =
                (surroundings.validity[vertex], surroundings.blocked_edges[vertex]);
            Vertex { place: surroundings.centring.places[vertex], validity, blocked_edges }
        })
        .collect();
    let (first, last) = options.first_and_last(flat)?;
    let head = Head {
        release: digest::release(),
        scene: digest::scene(scene, flat, plan, options),
        seed: options.seed,
        photons,
        traced: 0,
        shard,
        max_bounces: plan.max_bounces,
        quantity: options.quantity,
        dims: options.dims,
        first: first.to_array(),
        last: last.to_array(),
        power: ready.stage.emitters.total_power(),
        per_area: ready.per_area,
        quantum: track_length::quantum(&ready.cells),
        volume: ready.cells.volume(),
    };
    let lights = lights(scene, flat, Effects::of(plan));
    let start = Accumulator { head, lights, books: Books::default(), vertices, sums: Vec::new() };
    let tracer = ready.tracer(options.seed, plan.max_bounces);
    match options.quantity {
        Quantity::Vectors => {
            let estimate = VectorTracks::new(ready.cells, &surroundings.regions);
            start.trace(Tally::new(&tracer, &estimate, workers.threads), from, &workers, save)
        }
        Quantity::Radiance => {
            let estimate = RadianceTracks::new(ready.cells, &surroundings.regions);
            start.trace(Tally::new(&tracer, &estimate, workers.threads), from, &workers, save)
        }
    }
}

impl Accumulator {
    fn trace<E: Estimate<Value: Held>>(
        mut self,
        mut tally: Tally<'_, E>,
        from: Option<Self>,
        workers: &Workers<'_>,
        save: &mut dyn FnMut(&Self),
    ) -> Result<Self, BakeError> {
        if let Some(from) = from {
            self.check_resumed(&from)?;
            self.head.traced = from.head.traced;
            tally.resume(from.sums, from.books);
        }
        workers.monitor.stage(BakeStage::Photons);
        let Head { photons, shard, .. } = self.head;
        while self.head.traced < photons {
            let first = self.head.traced;
            let last = stretch(first, photons, u64::from(shard.count));
            let (share, of) = (u64::from(shard.index - 1), u64::from(shard.count));
            tally.trace(Photons { first, last, share, of }, workers)?;
            self.head.traced = last;
            if last < photons {
                (self.sums, self.books) = tally.copy();
                save(&self);
                self.sums = Vec::new();
                if workers.monitor.enough() {
                    break;
                }
            }
        }
        let traced = tally.finish();
        (self.sums, self.books) = (traced.sums, traced.books);
        Ok(self)
    }

    /// Whether the sums of `from` can be gone on with.
    fn check_resumed(&self, from: &Self) -> Result<(), AccumulatorError> {
        self.check_same(from)?;
        let (own, other) = (self.head.shard, from.head.shard);
        if own != other {
            return Err(AccumulatorError::OtherShard { index: other.index, count: other.count });
        }
        // Pieces are dealt in turn, so that a whole bake can be gone on with; a part ends inside a stretch of its own.
        let whole_pieces = from.head.traced.is_multiple_of(PHOTONS_A_PIECE);
        if from.head.traced > self.head.photons || (own.count > 1 && !whole_pieces) {
            return Err(AccumulatorError::TooFar { traced: from.head.traced, photons: self.head.photons });
        }
        Ok(())
    }

    /// Whether two accumulators belong to the same bake, whatever photons they have.
    ///
    /// # Errors
    ///
    /// An [`AccumulatorError`] that names the first of these that differs: release, seed, grid, what is stored, reflections,
    /// lights, scene.
    pub fn check_same(&self, other: &Self) -> Result<(), AccumulatorError> {
        let (a, b) = (&self.head, &other.head);
        if a.release != b.release {
            return Err(AccumulatorError::Release);
        }
        if a.seed != b.seed {
            return Err(AccumulatorError::Seed { seeds: [a.seed, b.seed] });
        }
        // The scene's number depends on these too, but does not tell which it is.
        for ((what, ours), (_, theirs)) in a.in_words().into_iter().zip(b.in_words()) {
            if ours != theirs {
                return Err(AccumulatorError::Differs { what, values: Box::new([ours, theirs]) });
            }
        }
        let same_bits = |x: [f64; 4], y: [f64; 4]| x.map(f64::to_bits) == y.map(f64::to_bits);
        let [x, y] = [a, b].map(|h| [h.power, h.per_area, h.quantum, h.volume]);
        if a.scene != b.scene || !same_bits(x, y) || self.vertices != other.vertices {
            return Err(AccumulatorError::Scene);
        }
        Ok(())
    }

    /// Makes the photons traced so far all there are: those of a bake that was ended early.
    pub fn end_here(&mut self) {
        self.head.photons = self.head.traced.max(1);
    }

    /// Which part of the photons these sums are of.
    #[must_use]
    pub fn shard(&self) -> Shard {
        self.head.shard
    }

    /// Photons of the whole bake.
    #[must_use]
    pub fn photons(&self) -> u64 {
        self.head.photons
    }

    /// Seed, and the largest number of reflections.
    #[must_use]
    pub fn seed_and_bounces(&self) -> (u64, u32) {
        (self.head.seed, self.head.max_bounces)
    }

    /// What the vertices will hold.
    #[must_use]
    pub fn quantity(&self) -> Quantity {
        self.head.quantity
    }

    /// Whether all photons of its shard have been traced.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.head.traced == self.head.photons
    }

    /// Adds up all shards of a bake, in any order: the sums of an undivided one.
    ///
    /// # Errors
    ///
    /// An [`AccumulatorError`] that names what differs: release, scene and options, seed, photons; or the shards that are
    /// missing, there twice, or not complete.
    pub fn merge(parts: Vec<Self>) -> Result<Self, AccumulatorError> {
        let mut parts = parts.into_iter();
        let mut whole = parts.next().ok_or(AccumulatorError::Missing { index: 1, count: 1 })?;
        let count = whole.head.shard.count;
        let mut there = vec![whole.head.shard.index];
        whole.check_complete()?;
        for part in parts {
            whole.check_same(&part)?;
            part.check_complete()?;
            if (part.head.photons, part.head.shard.count) != (whole.head.photons, count) {
                let photons = [whole.head.photons, part.head.photons];
                return Err(AccumulatorError::Division { photons, counts: [count, part.head.shard.count] });
            }
            let index = part.head.shard.index;
            if there.contains(&index) {
                return Err(AccumulatorError::Twice { index, count });
            }
            there.push(index);
            whole.books.merge(&part.books);
            whole.sums.iter_mut().zip(&part.sums).for_each(|(sum, part)| *sum = sum.wrapping_add(*part));
        }
        if let Some(index) = (1..=count).find(|index| !there.contains(index)) {
            return Err(AccumulatorError::Missing { index, count });
        }
        whole.head.shard = Shard::ALL;
        Ok(whole)
    }

    fn check_complete(&self) -> Result<(), AccumulatorError> {
        let Head { traced, photons, shard, .. } = self.head;
        if self.is_complete() {
            return Ok(());
        }
        Err(AccumulatorError::Incomplete { index: shard.index, traced, photons })
    }

    /// The grid of all photons.
    ///
    /// # Errors
    ///
    /// [`BakeError::Accumulator`] for a part of the photons, [`BakeError::Lattice`] and [`BakeError::Grid`] for a file that
    /// no bake wrote.
    pub fn finish(self) -> Result<BakeResult, BakeError> {
        let whole = Self::merge(vec![self])?;
        let Head { photons, power, per_area, quantum, volume, quantity, dims, first, last, .. } = whole.head;
        let each = power * per_area / photons as f64;
        let total = Total::of(&whole.sums);
        let count = whole.vertices.len();
        let scale = |vertex: usize| {
            let share = f64::from(whole.vertices[vertex].place.cells) / f64::from(SUB_CELLS);
            (share > 0.0).then(|| each * quantum / (volume * share))
        };
        let places = whole.vertices.iter().map(|vertex| vertex.place).collect();
        let centring = Centring { places, count: dims.map(usize::from) };
        let workers = Workers { threads: 1, monitor: &Silent, total_photons: photons };
        let values: GridValues = match quantity {
            Quantity::Vectors => {
                let value = |v: usize| {
                    scale(v).map_or(HemisphereVectors::default(), |scale| {
                        track_length::vectors_of(&total, count, v, scale)
                    })
                };
                let mut values: Vec<_> = (0..count).map(value).collect();
                centring.apply(&mut values, &workers)?;
                values.into()
            }
            Quantity::Radiance => {
                let value = |v: usize| {
                    scale(v).map_or(RadianceHarmonics::default(), |scale| {
                        track_length::radiance_of(&total, v, scale)
                    })
                };
                let mut values: Vec<_> = (0..count).map(value).collect();
                centring.apply(&mut values, &workers)?;
                values.into()
            }
        };
        let validity = whole.vertices.iter().map(|vertex| vertex.validity).collect();
        let blocked = whole.vertices.iter().map(|vertex| vertex.blocked_edges).collect();
        let lattice = Lattice::new(dims, first, last)?;
        let grid = IrradianceGrid::from_parts(lattice, values, validity, blocked)?;
        let unit = power / photons as f64 / Books::QUANTA;
        let watts = |quanta: [i128; 3]| DVec3::from(quanta.map(|q| q as f64)) * unit;
        let stats = BakeStats {
            photons,
            paths: 0,
            rough_vertices: 0,
            flights: whole.books.flights,
            emitted: watts(whole.books.emitted),
            absorbed: watts(whole.books.absorbed),
            escaped: watts(whole.books.escaped),
            cut: watts(whole.books.cut),
            valid_vertices: grid.valid_count(),
            blocked_edges: grid.blocked_edge_count(),
            lights: whole.lights,
        };
        Ok(BakeResult { grid, stats, accuracy: None })
    }
}

#[cfg(test)]
mod tests;
