//! A photon's way from its light until it is absorbed, leaves the scene, or is cut off.

use glam::Vec3;

use crate::accel::Hit;
use crate::estimate::Flight;
use crate::lobes::{LobeTable, Scattered, Way};
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
    /// Traces one photon and calls `deposit` with its flights after the first; of the sky, whose light nobody else adds, with the first
    /// too.
    ///
    /// Russian roulette goes on with the share that the brightest channel keeps, so that the brightest channel of a photon is
    /// never more than it started with. Scenes whose surfaces reflect evenly and nothing else run code that knows nothing else.
    #[inline]
    pub(crate) fn trace(&self, photon: u64, deposit: &mut impl FnMut(Flight), books: &mut Books) {
        match self.stage.surfaces.lobes() {
            None => self.follow(photon, deposit, books, Reflect),
            Some(lobes) => self.follow(photon, deposit, books, Scatter(lobes)),
        }
    }

    #[inline]
    fn follow(&self, photon: u64, deposit: &mut impl FnMut(Flight), books: &mut Books, meet: impl Meet) {
        let stream = Stream::new(self.seed, photon);
        let emission = self.stage.emitters.emit(&stream);
        let (mut origin, mut direction, mut power) = (emission.origin, emission.direction, emission.power);
        let mut energy = quanta(power);
        add(&mut books.emitted, energy);
        let (mut bounce, mut basic) = (0, 1.0);
        loop {
            books.after_bounces[(bounce as usize).min(BOOKED_BOUNCES - 1)] += energy.iter().sum::<i128>();
            books.flights += 1;
            let hit = self.stage.accel.closest_hit(origin, direction, f32::MAX);
            if bounce > 0 || emission.deposit_first {
                let length = hit.as_ref().map_or(f32::INFINITY, |hit| hit.distance);
                deposit(Flight { origin, direction, length, power: meet.outside(power, basic) });
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
            let (colour, next) = meet.meet(self.stage, &hit, direction, words, (&stream, bounce));
            let reflected = power * colour;
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
            (origin, direction) = meet.leave(self.stage, &hit, direction, words, next, &mut basic);
        }
    }
}

/// What happens to photons where they meet surfaces.
trait Meet: Copy {
    /// What is known about the way on before it is certain that there is one.
    type Next;

    /// What is kept of light that flies along `direction` up to `hit`, each channel in [0, 1].
    fn meet(
        self,
        stage: &Stage<'_>,
        hit: &Hit,
        direction: Vec3,
        words: [u32; 4],
        numbers: (&Stream, u32),
    ) -> (Vec3, Self::Next);

    /// Where it flies on: origin and direction. `basic` is the inverse square of the index of refraction around it, before and
    /// after.
    fn leave(
        self,
        stage: &Stage<'_>,
        hit: &Hit,
        direction: Vec3,
        words: [u32; 4],
        next: Self::Next,
        basic: &mut f32,
    ) -> (Vec3, Vec3);

    /// The power that counts for the grid: inside glass radiance is greater by the square of the index of refraction, and even
    /// light would not look even.
    fn outside(self, power: Vec3, basic: f32) -> Vec3;
}

/// Even reflection (Lambert) and nothing else.
#[derive(Clone, Copy)]
struct Reflect;

impl Meet for Reflect {
    type Next = ();

    #[inline]
    fn meet(self, stage: &Stage<'_>, hit: &Hit, _: Vec3, _: [u32; 4], _: (&Stream, u32)) -> (Vec3, ()) {
        (stage.surfaces.albedo(hit), ())
    }

    #[inline]
    fn leave(
        self,
        stage: &Stage<'_>,
        hit: &Hit,
        direction: Vec3,
        words: [u32; 4],
        (): (),
        _: &mut f32,
    ) -> (Vec3, Vec3) {
        let point = stage.surfaces.point(hit.triangle, hit.weights);
        let side = point.facing(-direction);
        (point.origin(side), hemisphere::cosine(side, [unit(words[1]), unit(words[2])]))
    }

    #[inline]
    fn outside(self, power: Vec3, _: f32) -> Vec3 {
        power
    }
}

/// All that surfaces do.
#[derive(Clone, Copy)]
struct Scatter<'a>(&'a LobeTable);

impl Meet for Scatter<'_> {
    type Next = (Vec3, Scattered);

    #[inline]
    fn meet(
        self,
        stage: &Stage<'_>,
        hit: &Hit,
        direction: Vec3,
        words: [u32; 4],
        numbers: (&Stream, u32),
    ) -> (Vec3, Self::Next) {
        let point = stage.surfaces.point(hit.triangle, hit.weights);
        let scattered = stage.surfaces.scatter(self.0, (hit, &point), direction, words, numbers);
        (scattered.colour, (point.origin(scattered.side), scattered))
    }

    #[inline]
    fn leave(
        self,
        _: &Stage<'_>,
        _: &Hit,
        _: Vec3,
        _: [u32; 4],
        (origin, scattered): Self::Next,
        basic: &mut f32,
    ) -> (Vec3, Vec3) {
        if let Way::Refracted { basic: behind } = scattered.way {
            *basic = behind;
        }
        (origin, scattered.direction)
    }

    #[inline]
    fn outside(self, power: Vec3, basic: f32) -> Vec3 {
        power * basic
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
