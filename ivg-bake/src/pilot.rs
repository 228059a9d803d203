//! A trial run that measures what a bake will cost and how far light has to be followed.
//!
//! The only place of this crate that reads a clock. What it measures goes into the plan's costs and the report; the one
//! figure that a bake uses, the number of reflections, is counted, not timed.

use std::time::Instant;

use ivg_scene::{Cost, Effect, EffectPlan, FlatScene, Need, Scene};

use crate::accumulate::{Sums, Total};
use crate::bake::Chosen;
use crate::estimate::{Estimate, Flight};
use crate::ready::Ready;
use crate::stage::Effects;
use crate::tally::{Traced, run};
use crate::trace::{BOOKED_BOUNCES, Tracer};
use crate::workers::Workers;
use crate::{BakeError, BakeOptions, Silent};

/// The share of the photons that a pilot traces: one in so many.
const PHOTONS_SHARE: u64 = 100;

/// The fewest photons a pilot traces: enough for energies after each reflection to a few per cent.
const FEWEST_PHOTONS: u64 = 2_000;

/// Share of the cutoff that a pilot leaves to the flights that are cut: it knows their energy from a hundredth of the photons, and
/// some flights pass more of the grid than others.
const CUTOFF_SHARE: f64 = 0.5;

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

/// Traces one in a hundred of the photons that `options` ask for, on one thread, and writes into the plan what each needed
/// effect costs and how many reflections are worth following.
///
/// How costs are found: rays are timed alone, and again with deposits; the difference is what deposits cost. Both are scaled
/// up to all photons. Direct light costs the rays of first flights, counted; the sky costs its share of the photons;
/// textures, mirrors and glass cost the difference between rays with and without them, also where they are left out (a
/// difference that is lost in the noise counts as none); diffuse indirect light costs the rest and the preparation. Shadows cost the bake nothing of their own. The energy share of an effect is the share of all energy in
/// flight that belongs to it (of textures, mirrors and glass: by how much they change the reflected energy).
///
/// Reflections: the fewest after which the energy still to be reflected, summed over all further flights, is at most
/// half of `plan.energy_cutoff` of the emitted and of the reflected energy; at most 63.
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
    let photons = (options.photons / PHOTONS_SHARE).max(FEWEST_PHOTONS.min(options.photons));
    let workers = Workers { threads: 1, monitor: &Silent, total_photons: photons };

    let started = Instant::now();
    let ready = Ready::new(scene, flat, plan, options)?;
    let surroundings = ready.surroundings(options.estimator, &workers)?;
    let preparation_seconds = started.elapsed().as_secs_f64();

    let tracer = ready.tracer(options.seed, MOST_BOUNCES);
    let (rays, ray_time) = timed(|| run(&tracer, &NoDeposits, photons, &workers))?;
    let estimate = Chosen::new(options, ready.cells, &surroundings.regions)?;
    let (_, full_time) = timed(|| estimate.run(&tracer, photons, &workers))?;
    let books = &rays.books;
    let emitted = books.after_bounces[0].max(1) as f64;
    let energy_after_bounces: Vec<f64> = books.after_bounces.iter().map(|&e| e as f64 / emitted).collect();
    if plan.needs(Effect::DiffuseIndirect) {
        plan.max_bounces = bounces_worth_following(&energy_after_bounces, CUTOFF_SHARE * plan.energy_cutoff);
    }

    let scale = options.photons as f64 / photons as f64;
    let report = PilotReport {
        photons,
        flights_per_photon: books.flights as f64 / photons as f64,
        max_bounces: plan.max_bounces,
        preparation_seconds,
        ray_seconds: ray_time * scale,
        deposit_seconds: (full_time - ray_time).max(0.0) * scale,
        energy_by_bounce: energy_after_bounces,
    };
    let in_flight: f64 = report.energy_by_bounce.iter().sum();
    let first_flights = report.ray_seconds / report.flights_per_photon;
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
