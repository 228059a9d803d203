//! Paths where surfaces mirror or let light through.

use core::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::{Known, MOST_BOUNCES, kept};
use crate::accel::Hit;
use crate::lobes::{LobeTable, Scattered, Way};
use crate::sampling::rng::{Purpose, Stream, unit};
use crate::stage::Stage;

impl Stage<'_> {
    /// As [`Stage::radiance`]. Lights are sampled where light is reflected evenly or by facets, and past panes; what a light
    /// emits counts where a path meets it after a mirror or a solid of glass, from where it was not sampled. Radiance is that
    /// outside of glass, so that refraction does not change it.
    pub(super) fn radiance_of_mixtures(
        &self,
        lobes: &LobeTable,
        (mut origin, mut direction): (Vec3, Vec3),
        stream: &Stream,
        direct: bool,
        known: Option<&Known<'_>>,
    ) -> DVec3 {
        let (mut radiance, mut throughput) = (DVec3::ZERO, DVec3::ONE);
        // Whether lights were sampled at the last surface that turned the path.
        let mut sampled = false;
        // How far the path has come since a surface reflected it evenly; there lights that are near were not sampled.
        let mut flown = f32::INFINITY;
        for bounce in 1..=MOST_BOUNCES {
            let Some(hit) = self.accel.closest_hit(origin, direction, f32::MAX) else {
                let image = if sampled { Vec3::ZERO } else { self.emitters.sky_image(direction) };
                return radiance + throughput * (self.emitters.sky() + image).as_dvec3();
            };
            let point = self.surfaces.point(hit.triangle, hit.weights);
            flown += hit.distance;
            let seen = if bounce == 1 { direct } else { !sampled || flown < self.emitters.near() };
            if seen {
                let emission = self.surfaces.emission(hit.triangle, point.normal, -direction);
                radiance += throughput * emission.as_dvec3();
            }
            let words = stream.words(bounce, Purpose::Reflection);
            // In the order that even reflection alone uses them.
            let turned = [words[2], words[0], words[1], words[3]];
            let scattered = self.surfaces.scatter(lobes, (&hit, &point), direction, turned, (stream, bounce));
            origin = point.origin(scattered.side);
            let end = Known::ends(known, bounce, hit.distance).filter(|_| scattered.way == Way::Even);
            let numbers = (stream, bounce);
            let surface = (&hit, point.facing(-direction));
            radiance +=
                throughput * self.direct_at(lobes, surface, direction, (&scattered, end.is_none()), numbers);
            throughput *= scattered.colour.as_dvec3();
            if let Some(known) = end {
                return radiance + throughput * (known.irradiance)(origin, scattered.side).as_dvec3() / PI;
            }
            if throughput.max_element() <= 0.0 {
                return radiance;
            }
            let kept = kept(bounce, f64::from(scattered.colour.max_element()));
            if f64::from(unit(words[2])) >= kept {
                return radiance;
            }
            throughput /= kept;
            (sampled, flown) = match scattered.way {
                Way::Even => (true, 0.0),
                Way::Facets { .. } => (true, f32::INFINITY),
                Way::Mirror | Way::Refracted { .. } => (false, f32::INFINITY),
                Way::Straight => (sampled, flown),
            };
            direction = scattered.direction;
        }
        radiance
    }

    /// One sample of the radiance that a surface reflects of light straight from a light, without the sky: by what `scattered`
    /// has chosen, and by its facets; even reflection without what a path that `goes_on` meets by chance, as [`Stage::direct`].
    fn direct_at(
        &self,
        lobes: &LobeTable,
        (hit, side): (&Hit, Vec3),
        direction: Vec3,
        (scattered, goes_on): (&Scattered, bool),
        (stream, step): (&Stream, u32),
    ) -> DVec3 {
        let point = self.surfaces.point(hit.triangle, hit.weights);
        let origin = point.origin(side);
        let Some(light) = self.emitters.arrive(origin, stream, step) else { return DVec3::ZERO };
        let cos = side.dot(light.direction);
        if cos <= 0.0 {
            return DVec3::ZERO;
        }
        let numbers = (stream, step);
        let even = match scattered.way {
            Way::Even if goes_on && light.near || !goes_on && light.from_sky => 0.0,
            Way::Even => 1.0,
            Way::Facets { again: true } => {
                self.surfaces.reflected_again(lobes, hit, (side, light.direction), numbers)
            }
            _ => 0.0,
        };
        let reflected = scattered.colour.as_dvec3() * (f64::from(even * cos) / PI)
            + self.surfaces.reflected_by_facets(lobes, hit, side, (light.direction, -direction)).as_dvec3();
        if reflected == DVec3::ZERO {
            return DVec3::ZERO;
        }
        let passed = self.passed(lobes, origin, light.direction, light.distance);
        light.irradiance.as_dvec3() * reflected * passed.as_dvec3()
    }
}
