//! Irradiance gathered at points by path tracing: slow, unbiased, without averaging over cells. The oracle of every
//! other estimator.

use core::f64::consts::PI;

use glam::{DVec3, Vec3};

use crate::sampling::hemisphere;
use crate::sampling::rng::{Purpose, Stream};
use crate::stage::Stage;

mod mixtures;

/// Shortest path after which Russian roulette may end it.
const SURE_BOUNCES: u32 = 3;

/// Reflections after which a path ends whatever it carries: only between surfaces of albedo 1 does one get this far.
const MOST_BOUNCES: u32 = 4096;

/// Reflections after which Russian roulette ends paths that surfaces alone would not end: one goes on with a probability of at most [`MOST_KEPT`], and carries so
/// much more.
const LONG_BOUNCES: u32 = 64;

/// Largest probability of going on after [`LONG_BOUNCES`]. Between sheets of albedo 1 a path then lasts 64 reflections more on
/// average, in which its weight grows e-fold, and not thousands.
const MOST_KEPT: f64 = 1.0 - 1.0 / 64.0;

/// The probability of going on after the `bounce`th reflection, by a surface whose brightest channel keeps `share`. What goes on is
/// divided by it, so that the mean stays what it is (J. Arvo, D. Kirk, "Particle transport and image synthesis", 1990).
fn kept(bounce: u32, share: f64) -> f64 {
    match bounce {
        0..=SURE_BOUNCES => 1.0,
        _ if bounce <= LONG_BOUNCES => share.min(1.0),
        _ => share.min(MOST_KEPT),
    }
}

/// A mean and its standard error, of an array of numbers.
#[derive(Clone, Debug)]
pub(crate) struct Mean<const N: usize> {
    sum: [f64; N],
    squares: [f64; N],
    count: u64,
}

impl<const N: usize> Default for Mean<N> {
    fn default() -> Self {
        Self { sum: [0.0; N], squares: [0.0; N], count: 0 }
    }
}

impl<const N: usize> Mean<N> {
    /// Adds a sample.
    pub(crate) fn add(&mut self, sample: &[f64; N]) {
        for ((sum, squares), x) in self.sum.iter_mut().zip(&mut self.squares).zip(sample) {
            *sum += x;
            *squares += x * x;
        }
        self.count += 1;
    }

    /// The mean.
    pub(crate) fn mean(&self) -> [f64; N] {
        self.sum.map(|sum| sum / self.count as f64)
    }

    /// The standard error of the mean; needs two samples.
    pub(crate) fn standard_error(&self) -> [f64; N] {
        let count = self.count as f64;
        core::array::from_fn(|n| {
            let mean = self.sum[n] / count;
            ((self.squares[n] / count - mean * mean).max(0.0) / (count - 1.0)).sqrt()
        })
    }
}

/// Sums of an array of numbers whose length is known when the program runs, kept in a few batches.
///
/// A batch is a set of paths whose first directions are spread evenly (and turned at random), which makes its mean far better
/// than that of as many independent paths. Batches are independent of each other, so the spread of their means tells the
/// standard error.
#[derive(Clone, Debug)]
pub(crate) struct Batches {
    numbers: usize,
    /// Means of the finished batches, one after the other.
    means: Vec<f64>,
}

impl Batches {
    /// For arrays of `numbers` numbers.
    pub(crate) fn new(numbers: usize) -> Self {
        Self { numbers, means: Vec::new() }
    }

    /// Adds a batch of `count` samples; `sample` adds the one of its index to the sums it is given.
    pub(crate) fn add(&mut self, count: u32, mut sample: impl FnMut(u32, &mut [f64])) {
        let mut sums = vec![0.0; self.numbers];
        (0..count).for_each(|index| sample(index, &mut sums));
        self.means.extend(sums.iter().map(|sum| sum / f64::from(count)));
    }

    /// The mean.
    pub(crate) fn mean(&self) -> Vec<f64> {
        let batches = (self.means.len() / self.numbers) as f64;
        let mut mean = vec![0.0; self.numbers];
        for batch in self.means.chunks_exact(self.numbers) {
            mean.iter_mut().zip(batch).for_each(|(mean, x)| *mean += x / batches);
        }
        mean
    }

    /// The standard error of the mean; needs two batches.
    pub(crate) fn standard_error(&self) -> Vec<f64> {
        let batches = (self.means.len() / self.numbers) as f64;
        let mut squares = vec![0.0; self.numbers];
        let mean = self.mean();
        for batch in self.means.chunks_exact(self.numbers) {
            for ((square, x), mean) in squares.iter_mut().zip(batch).zip(&mean) {
                *square += (x - mean).powi(2) / (batches * (batches - 1.0));
            }
        }
        squares.into_iter().map(f64::sqrt).collect()
    }
}

/// Light from elsewhere in place of the rest of a path (final gathering, RR-6983): what a path would find beyond its second
/// surface or a later one.
pub(crate) struct Known<'a> {
    /// Indirect irradiance of a surface at a point of bake space with a unit normal, light of the sky included \[W/m²\].
    pub(crate) irradiance: &'a (dyn Fn(Vec3, Vec3) -> Vec3 + Sync),
    /// A flight shorter than this does not end a path: in a corner an error of one surface's light would show on the other
    /// \[bake units\].
    pub(crate) shortest_flight: f32,
}

impl<'a> Known<'a> {
    /// What ends a path that has reached its `bounce`th surface by a flight of that length, if something does.
    fn ends(known: Option<&'a Self>, bounce: u32, flight: f32) -> Option<&'a Self> {
        known.filter(|known| bounce > 1 && flight >= known.shortest_flight)
    }
}

impl Stage<'_> {
    /// One sample of the indirect irradiance vectors at a point of bake space, `[hemisphere][rgb][xyz]` flattened \[W/m²\]:
    /// a direction even over the sphere, of the light along it all but the emission of the first surface.
    pub(crate) fn sample_vectors(&self, point: Vec3, stream: &Stream) -> [f64; 54] {
        let u = stream.uniforms(0, Purpose::Gather);
        let direction = hemisphere::sphere([u[0], u[1]]);
        let radiance = self.radiance(point, direction, stream, false).to_array();
        let w = (direction.as_dvec3() * (4.0 * PI)).to_array();
        core::array::from_fn(|n| {
            let (hemisphere, channel, component) = (n / 9, n / 3 % 3, n % 3);
            let axis = w[hemisphere / 2];
            let inside = if hemisphere % 2 == 0 { axis > 0.0 } else { axis < 0.0 };
            if inside { radiance[channel] * w[component] } else { 0.0 }
        })
    }

    /// The radiance of one path of a batch of `count` from a point of bake space \[W/(m² sr)\], and where it comes from.
    ///
    /// The first directions of a batch are a Fibonacci lattice; `turn`, two uniform numbers, moves it so that each path by
    /// itself is even over the sphere.
    pub(crate) fn sample_even(
        &self,
        point: Vec3,
        (path, count): (u32, u32),
        turn: [f32; 2],
        stream: &Stream,
    ) -> (DVec3, DVec3) {
        // The golden ratio's fraction: successive directions never line up.
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let polar = (f64::from(path) + f64::from(turn[0])) / f64::from(count);
        let round = (f64::from(path) * GOLDEN + f64::from(turn[1])).fract();
        let direction = hemisphere::sphere([polar as f32, round as f32]);
        (direction.as_dvec3(), self.radiance(point, direction, stream, false))
    }

    /// One sample of the indirect irradiance of a surface with unit `normal` at a point of bake space \[W/m²\].
    pub(crate) fn sample_irradiance(&self, point: Vec3, normal: Vec3, stream: &Stream) -> DVec3 {
        let u = stream.uniforms(0, Purpose::Gather);
        self.radiance(point, hemisphere::cosine(normal, [u[0], u[1]]), stream, false) * PI
    }

    /// One sample of the radiance that arrives at `origin` from `direction` \[W/(m² sr)\]. Without `direct`, what the first
    /// surface emits is left out (the sky is not).
    pub(crate) fn radiance(&self, origin: Vec3, direction: Vec3, stream: &Stream, direct: bool) -> DVec3 {
        self.radiance_until(origin, direction, stream, direct, None)
    }

    /// As [`Stage::radiance`]; where light is `known`, paths end.
    pub(crate) fn radiance_until(
        &self,
        origin: Vec3,
        direction: Vec3,
        stream: &Stream,
        direct: bool,
        known: Option<&Known<'_>>,
    ) -> DVec3 {
        if let Some(lobes) = self.surfaces.lobes() {
            return self.radiance_of_mixtures(lobes, (origin, direction), stream, direct, known);
        }
        let (mut origin, mut direction) = (origin, direction);
        let (mut radiance, mut throughput) = (DVec3::ZERO, DVec3::ONE);
        for bounce in 1..=MOST_BOUNCES {
            let Some(hit) = self.accel.closest_hit(origin, direction, f32::MAX) else {
                // Later on the image of a sky has been sampled.
                let image = if bounce == 1 { self.emitters.sky_image(direction) } else { Vec3::ZERO };
                return radiance + throughput * (self.emitters.sky() + image).as_dvec3();
            };
            let point = self.surfaces.point(hit.triangle, hit.weights);
            // Later on lights have been sampled, but for those that are near.
            let seen = if bounce == 1 { direct } else { hit.distance < self.emitters.near() };
            if seen {
                let emission = self.surfaces.emission(hit.triangle, point.normal, -direction);
                radiance += throughput * emission.as_dvec3();
            }
            let albedo = self.surfaces.albedo(&hit).as_dvec3();
            let side = point.facing(-direction);
            origin = point.origin(side);
            throughput *= albedo;
            if throughput.max_element() <= 0.0 {
                return radiance;
            }
            let end = Known::ends(known, bounce, hit.distance);
            radiance += throughput * self.direct(origin, side, (stream, bounce), end.is_none()) / PI;
            if let Some(known) = end {
                return radiance + throughput * (known.irradiance)(origin, side).as_dvec3() / PI;
            }
            let u = stream.uniforms(bounce, Purpose::Reflection);
            let kept = kept(bounce, albedo.max_element());
            if f64::from(u[2]) >= kept {
                return radiance;
            }
            throughput /= kept;
            direction = hemisphere::cosine(side, [u[0], u[1]]);
        }
        radiance
    }

    /// One sample of the direct irradiance of a surface with unit normal `side`, without an even sky: of a path that
    /// `goes_on` without surfaces that are near, which it meets by chance; of another without the image of a sky, which is in what is
    /// known \[W/m²\].
    fn direct(&self, origin: Vec3, side: Vec3, (stream, step): (&Stream, u32), goes_on: bool) -> DVec3 {
        let Some(light) = self.emitters.arrive(origin, stream, step) else { return DVec3::ZERO };
        let cos = side.dot(light.direction);
        if cos <= 0.0
            || if goes_on { light.near } else { light.from_sky }
            || self.is_shadowed(origin, light.direction, light.distance)
        {
            return DVec3::ZERO;
        }
        light.irradiance.as_dvec3() * f64::from(cos)
    }
}

#[cfg(test)]
mod tests;
