//! A photon's way from its light until it is absorbed, leaves the scene, or is cut off.

use glam::Vec3;

use crate::accumulate::Sums;
use crate::estimate::{Estimate, Flight};
use crate::sampling::hemisphere;
use crate::sampling::rng::{Purpose, Stream, unit};
use crate::stage::Stage;

/// Reflections whose energy is told apart in [`Books`]; later ones count as the last.
pub(crate) const BOOKED_BOUNCES: usize = 64;

/// Energy of a whole photon in the books, in quanta. Whole numbers, so that they balance exactly and do not depend on
/// who added first.
const ENERGY_QUANTA: f32 = 16_777_216.0;

/// Where the energy went, in quanta of which [`Books::QUANTA`] make the brightest channel of a photon as it is emitted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Books {
    pub(crate) emitted: [i128; 3],
    pub(crate) absorbed: [i128; 3],
    pub(crate) escaped: [i128; 3],
    /// Left over when the largest number of reflections was reached.
    pub(crate) cut: [i128; 3],
    /// Energy, all channels, that flies on after k reflections.
    pub(crate) after_bounces: [i128; BOOKED_BOUNCES],
    /// Rays traced.
    pub(crate) flights: u64,
}

impl Default for Books {
    fn default() -> Self {
        Self {
            emitted: [0; 3],
            absorbed: [0; 3],
            escaped: [0; 3],
            cut: [0; 3],
            after_bounces: [0; BOOKED_BOUNCES],
            flights: 0,
        }
    }
}

impl Books {
    /// Quanta of a whole photon.
    pub(crate) const QUANTA: f64 = ENERGY_QUANTA as f64;

    /// Adds the books of other photons.
    pub(crate) fn merge(&mut self, other: &Self) {
        for c in 0..3 {
            self.emitted[c] += other.emitted[c];
            self.absorbed[c] += other.absorbed[c];
            self.escaped[c] += other.escaped[c];
            self.cut[c] += other.cut[c];
        }
        for (sum, part) in self.after_bounces.iter_mut().zip(&other.after_bounces) {
            *sum += part;
        }
        self.flights += other.flights;
    }
}

/// Traces photons.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tracer<'a> {
    pub(crate) stage: &'a Stage<'a>,
    pub(crate) seed: u64,
    /// Largest number of reflections followed.
    pub(crate) max_bounces: u32,
}

impl Tracer<'_> {
    /// Traces one photon and deposits its flights after the first; of the sky, whose light nobody else adds, the first too.
    ///
    /// Surfaces reflect evenly (Lambert). Russian roulette goes on with the share that the brightest channel keeps, so that
    /// the brightest channel of a photon is never more than it started with.
    #[inline]
    pub(crate) fn trace<E: Estimate>(
        &self,
        photon: u64,
        estimate: &E,
        sums: &mut impl Sums,
        books: &mut Books,
    ) {
        let stream = Stream::new(self.seed, photon);
        let emission = self.stage.emitters.emit(&stream);
        let (mut origin, mut direction, mut power) = (emission.origin, emission.direction, emission.power);
        let mut energy = quanta(power);
        add(&mut books.emitted, energy);
        let mut bounce = 0;
        loop {
            books.after_bounces[(bounce as usize).min(BOOKED_BOUNCES - 1)] += energy.iter().sum::<i128>();
            books.flights += 1;
            let hit = self.stage.accel.closest_hit(origin, direction, f32::MAX);
            if bounce > 0 || emission.deposit_first {
                let length = hit.as_ref().map_or(f32::INFINITY, |hit| hit.distance);
                estimate.deposit(&Flight { origin, direction, length, power }, sums);
            }
            let Some(hit) = hit else {
                add(&mut books.escaped, energy);
                return;
            };
            if bounce == self.max_bounces {
                add(&mut books.cut, energy);
                return;
            }
            bounce += 1;
            let words = stream.words(bounce, Purpose::Reflection);
            let reflected = power * self.stage.surfaces.albedo(&hit);
            let brightest = power.max_element();
            // Below one quantum of the books a photon carries nothing that any sum would notice.
            let kept =
                if brightest > 1.0 / ENERGY_QUANTA { reflected.max_element() / brightest } else { 0.0 };
            if unit(words[0]) >= kept {
                add(&mut books.absorbed, energy);
                return;
            }
            power = (reflected / kept).min(Vec3::splat(brightest));
            let left = quanta(power);
            add(&mut books.absorbed, core::array::from_fn(|c| energy[c] - left[c]));
            energy = left;
            let point = self.stage.surfaces.point(hit.triangle, hit.weights);
            let side = point.facing(-direction);
            origin = point.origin(side);
            direction = hemisphere::cosine(side, [unit(words[1]), unit(words[2])]);
        }
    }
}

fn quanta(power: Vec3) -> [i128; 3] {
    power.to_array().map(|channel| i128::from((channel * ENERGY_QUANTA) as i64))
}

fn add(sum: &mut [i128; 3], part: [i128; 3]) {
    for (sum, part) in sum.iter_mut().zip(part) {
        *sum += part;
    }
}

#[cfg(test)]
mod tests;
