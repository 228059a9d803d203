//! The rays of a bake by themselves: the flights of photons, and trees that find what they hit. For measuring.
//!
//! Everything is in bake space: coordinates centred on the scene and scaled so that neither tree nor triangle test loses
//! digits.

use glam::Vec3;
use ivg_scene::{EffectPlan, FlatScene, Scene};

use crate::accel::{BinaryTree, Build, TraceScene};
use crate::estimate::Flight;
use crate::ready::Ready;
use crate::trace::Books;
use crate::{BakeError, BakeOptions};

/// A ray \[bake units\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3,
    /// Where it goes; unit length.
    pub direction: Vec3,
}

/// Flights of photons and the triangles that they fly between.
#[derive(Clone, Debug, PartialEq)]
pub struct Flights {
    /// The corners of all triangles of the scene.
    pub triangles: Vec<[Vec3; 3]>,
    /// Flights after the first of each photon, in the order that a thread traces them.
    pub rays: Vec<Ray>,
}

/// The closest hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Index of the triangle.
    pub triangle: u32,
    /// Distance \[bake units\].
    pub distance: f32,
}

/// How long a tree may take to build: a preset of the crate that builds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// Quickly built.
    Fast,
    /// What bakes use.
    Medium,
    /// Slowly built.
    VerySlow,
}

/// The kind of a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Two children a node.
    Binary,
    /// Eight children a node with compressed boxes: what bakes use.
    Wide,
}

/// A tree over triangles.
pub struct Tree(Built);

impl core::fmt::Debug for Tree {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Tree").finish_non_exhaustive()
    }
}

enum Built {
    Binary(TraceScene<BinaryTree>),
    Wide(TraceScene),
}

impl Tree {
    /// Builds a tree on one thread. With [`Kind::Wide`] and [`Preset::Medium`] it is the tree of bakes.
    ///
    /// # Errors
    ///
    /// [`BakeError::TreeTooDeep`].
    pub fn new(triangles: &[[Vec3; 3]], kind: Kind, preset: Preset) -> Result<Self, BakeError> {
        let build = match preset {
            Preset::Fast => Build::Fast,
            Preset::Medium => Build::Medium,
            Preset::VerySlow => Build::VerySlow,
        };
        Ok(Self(match kind {
            Kind::Binary => Built::Binary(TraceScene::built(triangles, build)?),
            Kind::Wide => Built::Wide(TraceScene::built(triangles, build)?),
        }))
    }

    /// The closest hit of each ray, as bakes ask for it: watertight, at any distance above 0.
    #[must_use]
    pub fn closest_hits(&self, rays: &[Ray]) -> Vec<Option<Found>> {
        match &self.0 {
            Built::Binary(scene) => hits(rays, |ray| scene.closest_hit(ray.origin, ray.direction, f32::MAX)),
            Built::Wide(scene) => hits(rays, |ray| scene.closest_hit(ray.origin, ray.direction, f32::MAX)),
        }
    }
}

fn hits(rays: &[Ray], closest: impl Fn(&Ray) -> Option<crate::accel::Hit>) -> Vec<Option<Found>> {
    let found = |hit: crate::accel::Hit| Found { triangle: hit.triangle, distance: hit.distance };
    rays.iter().map(|ray| closest(ray).map(found)).collect()
}

/// The first flights after the first of the photons of a bake: `most` at most, of `options.photons` photons.
///
/// # Errors
///
/// As [`crate::bake()`].
pub fn flights(
    scene: &Scene,
    flat: &FlatScene,
    plan: &EffectPlan,
    options: &BakeOptions,
    most: usize,
) -> Result<Flights, BakeError> {
    let ready = Ready::new(scene, flat, plan, options)?;
    let tracer = ready.tracer(options.seed, plan.max_bounces);
    let (mut rays, mut books) = (Vec::new(), Books::default());
    for photon in 0..options.photons {
        let mut keep = |flight: Flight| rays.push(Ray { origin: flight.origin, direction: flight.direction });
        tracer.trace(photon, &mut keep, &mut books);
        if rays.len() >= most {
            break;
        }
    }
    rays.truncate(most);
    Ok(Flights { triangles: ready.stage.surfaces.triangles().to_vec(), rays })
}

#[cfg(test)]
mod tests;
