//! How fine a grid a scene calls for.

use std::sync::{Mutex, PoisonError};

use glam::DVec3;
use ivg_scene::{EffectPlan, FlatScene, Scene};

use crate::accumulate::{Sums, Total};
use crate::estimate::{Estimate, Flight};
use crate::options::{automatic_bounds, dims_for};
use crate::stage::{Effects, Stage};
use crate::tally::run;
use crate::trace::Tracer;
use crate::workers::Workers;
use crate::{BakeError, BakeOptions, Silent};

/// Photons whose flights are measured.
const PHOTONS: u64 = 4096;

/// Steps of the grid in the middle one of all flights: indirect light changes over distances like those between surfaces, and
/// averaging over a cell of an eighth of them is off by a few per cent.
const STEPS_A_FLIGHT: f64 = 8.0;

/// Fewest and most vertices along the longest axis.
const LONGEST: (u16, u16) = (8, 128);

/// How fine a grid is to be, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Resolution {
    /// Vertices along x, y and z.
    pub dims: [u16; 3],
    /// Middle length of reflected flights between surfaces \[m\]; 0 if there are none.
    pub flight: f64,
    /// Distance of neighbouring vertices \[m\].
    pub step: f64,
    /// Whether the limits of vertices made it so, and not the flights.
    pub limited: bool,
}

impl Resolution {
    /// The reason in words.
    #[must_use]
    pub fn reason(&self) -> String {
        let Self { dims: [nx, ny, nz], flight, step, limited } = self;
        let why =
            if *limited { "as near to an eighth of that as the limits allow" } else { "an eighth of that" };
        format!(
            "{nx}x{ny}x{nz}: half of the reflected light flies {flight:.3} m or more before it meets a surface; a step of {step:.3} m is {why}"
        )
    }
}

/// A grid for a scene whose step is an eighth of the distance that light flies between surfaces (the median, measured with
/// 4096 photons), cells about cubes, from 8 to 128 vertices along the longest axis and at most `most_vertices` in all. Depends
/// on scene, bounds and seed of the options alone.
///
/// # Errors
///
/// As [`bake`](crate::bake()).
pub fn resolution(
    scene: &Scene,
    flat: &FlatScene,
    plan: &EffectPlan,
    options: &BakeOptions,
    most_vertices: u64,
) -> Result<Resolution, BakeError> {
    let bounds = match options.bounds {
        Some(bounds) => bounds,
        None => crate::stage::bounds(flat).map_or_else(|| automatic_bounds(flat, [LONGEST.0; 3]), Ok)?,
    };
    let (min, max): (DVec3, DVec3) = bounds;
    let stage = Stage::new(scene, flat, Effects::of(plan), Some(bounds))?;
    let tracer = Tracer { stage: &stage, seed: options.seed, max_bounces: plan.max_bounces };
    let lengths = Lengths(Mutex::default());
    run(&tracer, &lengths, PHOTONS, &Workers { threads: 1, monitor: &Silent, total_photons: PHOTONS })?;
    let mut lengths = lengths.0.into_inner().unwrap_or_else(PoisonError::into_inner);
    lengths.sort_by(f32::total_cmp);
    let flight = lengths.get(lengths.len() / 2).map_or(0.0, |&l| f64::from(l) / stage.space.scale());
    let extent = (max - min).max_element();
    // Automatic bounds lie a step outside on either side.
    let outside = if options.bounds.is_some() { 1.0 } else { 3.0 };
    let wanted = if flight > 0.0 { extent / flight * STEPS_A_FLIGHT + outside } else { f64::from(LONGEST.0) };
    let mut longest = wanted.round().clamp(f64::from(LONGEST.0), f64::from(LONGEST.1)) as u16;
    let vertices =
        |longest: u16| -> u64 { dims_for(min, max, longest).iter().map(|&n| u64::from(n)).product() };
    while longest > 2 && vertices(longest) > most_vertices {
        longest -= 1;
    }
    let limited = (f64::from(longest) - wanted).abs() > 0.5;
    let steps = (f64::from(longest) - outside).max(1.0);
    Ok(Resolution { dims: dims_for(min, max, longest), flight, step: extent / steps, limited })
}

/// Notes how long the flights are that end at a surface.
struct Lengths(Mutex<Vec<f32>>);

impl Estimate for Lengths {
    type Value = ();

    fn sums(&self) -> usize {
        0
    }

    fn deposit(&self, flight: &Flight, _sums: &mut impl Sums) {
        if flight.length.is_finite() {
            self.0.lock().unwrap_or_else(PoisonError::into_inner).push(flight.length);
        }
    }

    fn value(&self, _sums: &Total<'_>, _vertex: usize, _power: f64) {}
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::resolution;
    use crate::BakeOptions;
    use crate::cases::{SceneBuilder, plan};

    fn room(size: Vec3, scale: f32) -> super::Resolution {
        let mut builder = SceneBuilder::default();
        let wall = builder.material(0.7, 1.0, false);
        builder.cuboid(Vec3::ZERO, size * scale, wall, true);
        let (scene, flat) = builder.build();
        resolution(&scene, &flat, &plan(&scene, 32), &BakeOptions::default(), 1 << 18).unwrap()
    }

    /// In a cube of 1 m the mean flight is 4 V / A = 2/3 m, the middle one about the same.
    #[test]
    fn steps_are_an_eighth_of_the_flights_between_surfaces() {
        let cube = room(Vec3::ONE, 1.0);
        assert!((0.55..0.8).contains(&cube.flight) && !cube.limited, "{cube:?}");
        let expected = (8.0 / cube.flight + 3.0).round() as u16;
        assert_eq!(cube.dims, [expected; 3], "{cube:?}");
        assert!(
            (cube.step * 8.0 / cube.flight - 1.0).abs() < 0.1 && cube.reason().contains("an eighth of that")
        );
        let large = room(Vec3::ONE, 1024.0);
        assert_eq!(large.dims, cube.dims, "scale does not matter");
    }

    #[test]
    fn long_narrow_rooms_get_many_vertices_one_way_up_to_the_limit() {
        let passage = room(Vec3::new(10.0, 1.0, 1.0), 1.0);
        assert!(passage.dims[0] > 4 * passage.dims[1] && passage.dims[1] == passage.dims[2], "{passage:?}");
        let endless = room(Vec3::new(1000.0, 1.0, 1.0), 1.0);
        assert!(endless.dims[0] == 128 && endless.limited, "{endless:?}");
        assert!(endless.reason().contains("limits"));
    }
}
