//! A trial run that measures what a bake will cost and how far light has to be followed.
//!
//! The only place of this crate that reads a clock. What it measures goes into the plan's costs and the report; the one
//! figure that a bake uses, the number of reflections, is counted, not timed.

use std::time::Instant;

use ivg_format::HemisphereVectors;
use ivg_scene::{Cost, Effect, EffectPlan, FlatScene, Need, Scene};

use crate::accumulate::{Sums, Total};
use crate::bake::Chosen;
use crate::estimate::vertex_gather::{Enough, FEWEST_PATHS};
use crate::estimate::{Estimate, Flight};
use crate::ready::Ready;
use crate::stage::Effects;
use crate::tally::{Traced, run};
use crate::trace::{BOOKED_BOUNCES, Books, Tracer};
use crate::validity::Surroundings;
use crate::workers::Workers;
use crate::{BakeError, BakeOptions, Estimator, Monitor, Silent};

/// The share of the photons that a pilot traces: one in so many.
const PHOTONS_SHARE: u64 = 100;

/// The fewest photons a pilot traces, enough for energies after each reflection to a few per cent, and the most.
const PHOTONS: (u64, u64) = (2_000, 20_000);

/// Share of the cutoff that a pilot leaves to the flights that are cut: it knows their energy from a hundredth of the photons, and
/// some flights pass more of the grid than others.
const CUTOFF_SHARE: f64 = 0.5;

/// Vertices whose paths are timed.
const TIMED_VERTICES: usize = 32;

/// Reflections followed by a pilot, and the most it puts into a plan.
const MOST_BOUNCES: u32 = BOOKED_BOUNCES as u32 - 1;

/// What a pilot found.
#[derive(Debug, Clone, PartialEq)]
pub struct PilotReport {
    /// Photons traced.
    pub photons: u64,
    /// Rays traced for each photon, of one that is followed to the end.
    pub flights_per_photon: f64,
    /// Energy that is in flight after k reflections, as a share of what the lights emit; entry 0 is 1.
    pub energy_by_bounce: Vec<f64>,
    /// Reflections that the plan now follows.
    pub max_bounces: u32,
    /// Expected time of the bake before the first photon: acceleration structure, validity, visible regions
    /// \[s of CPU\].
    pub preparation_seconds: f64,
    /// Expected time of tracing rays for all photons \[s of CPU\].
    pub ray_seconds: f64,
    /// Expected time of depositing their flights \[s of CPU\].
    pub deposit_seconds: f64,
}

impl PilotReport {
    /// Expected time of the whole bake \[s of CPU\].
    #[must_use]
    pub fn total_seconds(&self) -> f64 {
        self.preparation_seconds + self.ray_seconds + self.deposit_seconds
    }
}

/// Traces one in a hundred of the photons that `options` ask for, from 2,000 to 20,000, on one thread, and writes into the plan
/// what each needed effect costs and how many reflections are worth following.
///
/// How costs are found: rays are timed alone, and again with deposits; the difference is what deposits cost. Both are scaled
/// up to all photons. Direct light costs the rays of first flights, counted; the sky costs its share of the photons;
/// textures, mirrors and glass cost the difference between rays with and without them, also where they are left out (a
/// difference that is lost in the noise counts as none); diffuse indirect light costs the rest and the preparation. Shadows cost the bake nothing of their own. The energy share of an effect is the share of all energy in
/// flight that belongs to it (of textures, mirrors and glass: by how much they change the reflected energy).
///
/// [`Estimator::Gather`] traces no photons: its time is that of the paths from 32 of the vertices, scaled up to all, and counts as
/// that of rays; the photons of the pilot tell energies and reflections.
///
/// Reflections: as [`measure_reflections`].
///
/// # Errors
///
/// As [`bake`](crate::bake()).
pub fn pilot(
    scene: &Scene,
    flat: &FlatScene,
    plan: &mut EffectPlan,
    options: &BakeOptions,
) -> Result<PilotReport, BakeError> {
    let photons = trial_photons(options);
    let workers = Workers { threads: 1, monitor: &Silent, total_photons: photons };

    let started = Instant::now();
    let ready = Ready::new(scene, flat, plan, options)?;
    let surroundings = ready.surroundings(options.estimator, &workers)?;
    let preparation_seconds = started.elapsed().as_secs_f64();

    let tracer = ready.tracer(options.seed, MOST_BOUNCES);
    let (rays, ray_time) = timed(|| run(&tracer, &NoDeposits, photons, &workers))?;
    let gathers = options.estimator == Estimator::Gather;
    // Paths take the place of photons.
    let counted = surroundings.validity.iter().filter(|validity| **validity > 0).count() as u64;
    let all = if gathers { u64::from(options.paths).saturating_mul(counted) } else { options.photons };
    let scale = all as f64 / photons as f64;
    let (ray_seconds, deposit_seconds) = if gathers {
        (path_seconds(&ready, &surroundings, options) * all as f64, 0.0)
    } else {
        let estimate = Chosen::new(options, ready.cells, &surroundings.regions)?;
        let (_, full_time) = timed(|| estimate.run(&tracer, photons, &workers))?;
        (ray_time * scale, (full_time - ray_time).max(0.0) * scale)
    };
    let books = &rays.books;
    let energy_by_bounce = energy_after_bounces(books);
    follow_what_is_worth_it(plan, &energy_by_bounce);
    let report = PilotReport {
        photons,
        flights_per_photon: books.flights as f64 / photons as f64,
        max_bounces: plan.max_bounces,
        preparation_seconds,
        ray_seconds,
        deposit_seconds,
        energy_by_bounce,
    };
    let in_flight: f64 = report.energy_by_bounce.iter().sum();
    let first_flights = if gathers { 0.0 } else { report.ray_seconds / report.flights_per_photon };
    let sky_share = ready.stage.emitters.sky_share();
    // The same photons with other effects, rays alone.
    let effects = Effects::of(plan);
    let with = |effects: Effects| {
        let stage = ready.stage.with_effects(scene, flat, effects)?;
        let tracer = Tracer { stage: &stage, ..tracer };
        timed(|| run(&tracer, &NoDeposits, photons, &workers))
    };
    let reflected = |t: &Traced| t.books.after_bounces[1..].iter().sum::<i128>() as f64;
    // Between rays with an effect and without: time, and the change of the reflected energy.
    let difference = |(with, with_time): (&Traced, f64), (without, without_time): (&Traced, f64)| {
        let change = (reflected(with) - reflected(without)).abs() / reflected(without).max(1.0);
        Cost { seconds: (with_time - without_time).max(0.0) * scale, energy_share: change.min(1.0) }
    };
    let mut measured = Vec::new();
    for (effect, other) in [
        (Effect::Textures, Effects { textures: !effects.textures, ..effects }),
        (Effect::Mirrors, Effects { mirrors: !effects.mirrors, ..effects }),
        (Effect::Glass, Effects { glass: !effects.glass, ..effects }),
    ] {
        let (traced, time) = with(other)?;
        let (present, changed) = ((&rays, ray_time), (&traced, time));
        let cost =
            if plan.needs(effect) { difference(present, changed) } else { difference(changed, present) };
        measured.push((effect, cost));
    }
    for planned in &mut plan.effects {
        let known = measured.iter().find(|(effect, _)| *effect == planned.effect).map(|(_, cost)| *cost);
        if planned.need != Need::Needed {
            planned.cost = known.filter(|_| planned.need == Need::NotNeeded);
            continue;
        }
        planned.cost = match planned.effect {
            Effect::DirectLight => Some(Cost { seconds: first_flights, energy_share: 1.0 / in_flight }),
            Effect::DiffuseIndirect => Some(Cost {
                seconds: report.total_seconds() - first_flights,
                energy_share: 1.0 - 1.0 / in_flight,
            }),
            Effect::Sky => Some(Cost {
                seconds: sky_share * (report.ray_seconds + report.deposit_seconds),
                energy_share: sky_share,
            }),
            _ => known.or(planned.cost),
        };
    }
    Ok(report)
}

/// Follows photons until they end, in number as [`pilot`] does, and writes into the plan how many reflections are worth following: the
/// fewest after which the energy still to be reflected, summed over all further flights, is at most half of
/// `plan.energy_cutoff` of the emitted and of the reflected energy; at most 63. That is counted, not timed: the same scene, plan
/// and options give the same number.
///
/// # Errors
///
/// As [`bake`](crate::bake()).
pub fn measure_reflections(
    scene: &Scene,
    flat: &FlatScene,
    plan: &mut EffectPlan,
    options: &BakeOptions,
) -> Result<(), BakeError> {
    let ready = Ready::new(scene, flat, plan, options)?;
    measure(&ready, plan, options, &Silent)
}

/// The same, with what has been made ready.
pub(crate) fn measure(
    ready: &Ready<'_>,
    plan: &mut EffectPlan,
    options: &BakeOptions,
    monitor: &dyn Monitor,
) -> Result<(), BakeError> {
    let photons = trial_photons(options);
    let workers = Workers { threads: options.thread_count(), monitor: &Silent, total_photons: photons };
    if monitor.cancelled() {
        return Err(BakeError::Cancelled { done: 0, total: options.photons });
    }
    let traced = run(&ready.tracer(options.seed, MOST_BOUNCES), &NoDeposits, photons, &workers)?;
    follow_what_is_worth_it(plan, &energy_after_bounces(&traced.books));
    Ok(())
}

/// Photons of a trial run.
fn trial_photons(options: &BakeOptions) -> u64 {
    (options.photons / PHOTONS_SHARE).clamp(PHOTONS.0, PHOTONS.1).min(options.photons)
}

/// Energy that flies on after k reflections, as a share of what the lights emit.
fn energy_after_bounces(books: &Books) -> Vec<f64> {
    let emitted = books.after_bounces[0].max(1) as f64;
    books.after_bounces.iter().map(|&e| e as f64 / emitted).collect()
}

fn follow_what_is_worth_it(plan: &mut EffectPlan, energy_after_bounces: &[f64]) {
    if plan.needs(Effect::DiffuseIndirect) {
        plan.max_bounces = bounces_worth_following(energy_after_bounces, CUTOFF_SHARE * plan.energy_cutoff);
    }
}

/// Time of a path from a vertex, measured at some that light reaches \[s of CPU\].
fn path_seconds(ready: &Ready<'_>, surroundings: &Surroundings, options: &BakeOptions) -> f64 {
    let valid: Vec<usize> =
        (0..ready.cells.len()).filter(|&vertex| surroundings.validity[vertex] > 0).collect();
    let count = valid.len().min(TIMED_VERTICES);
    let started = Instant::now();
    let paths: u64 = (0..count)
        .map(|n| {
            let vertex = valid[n * valid.len() / count];
            let enough = Enough::Paths(FEWEST_PATHS);
            let eye = surroundings.eyes[vertex];
            u64::from(ready.stage.gather::<HemisphereVectors>(eye, vertex, options.seed, enough).paths)
        })
        .sum();
    started.elapsed().as_secs_f64() / paths.max(1) as f64
}

/// The fewest reflections that leave at most `cutoff` of the emitted energy in all flights beyond, and of the reflected energy
/// where that is less: in a dark room the grid holds little, and what is cut is a greater share of it.
fn bounces_worth_following(energy_after_bounces: &[f64], cutoff: f64) -> u32 {
    let reflected: f64 = energy_after_bounces.iter().skip(1).sum();
    let cutoff = cutoff * reflected.min(1.0);
    let mut beyond = 0.0;
    let mut bounces = energy_after_bounces.len().saturating_sub(1);
    while bounces > 1 && beyond + energy_after_bounces[bounces] <= cutoff {
        beyond += energy_after_bounces[bounces];
        bounces -= 1;
    }
    bounces.max(1) as u32
}

fn timed(work: impl FnOnce() -> Result<Traced, BakeError>) -> Result<(Traced, f64), BakeError> {
    let started = Instant::now();
    let traced = work()?;
    Ok((traced, started.elapsed().as_secs_f64()))
}

/// Deposits nothing: what is left is the cost of rays.
struct NoDeposits;

impl Estimate for NoDeposits {
    type Value = ();

    fn sums(&self) -> usize {
        0
    }

    fn deposit(&self, _flight: &Flight, _sums: &mut impl Sums) {}

    fn value(&self, _sums: &Total<'_>, _vertex: usize, _power: f64) {}
}

#[cfg(test)]
mod tests;
