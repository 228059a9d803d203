//! The space that rays are traced in.
//!
//! World coordinates are moved to the middle of scene and lattice and scaled by a power of two, so that the longest
//! extent lies in [2048, 4096). A scene in millimetres, in kilometres, or far from the origin is then the same to
//! every tolerance below, bit for bit if the scale is a power of two; and lengths near 1e-4, below which the
//! acceleration structure culls boxes whatever the ray says, are half a step of f32 at the scene's edge.

use glam::{DVec3, Vec3};

/// The exponent of the power of two that the longest extent is scaled to or above.
const EXTENT_EXPONENT: i32 = 11;

/// The map from world space \[m\] to bake space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Space {
    centre: DVec3,
    scale: f64,
}

impl Space {
    /// The space for everything between two corners in world space \[m\].
    pub(crate) fn new(min: DVec3, max: DVec3) -> Self {
        let extent = (max - min).max_element();
        let exponent = if extent > 0.0 { EXTENT_EXPONENT - libm::ilogb(extent) } else { 0 };
        Self { centre: (min + max) * 0.5, scale: libm::scalbn(1.0, exponent) }
    }

    /// Bake units per metre: a power of two.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// A world position in bake space.
    pub(crate) fn to_bake(self, world: DVec3) -> Vec3 {
        ((world - self.centre) * self.scale).as_vec3()
    }

    /// A position in bake space in world space \[m\].
    pub(crate) fn to_world(self, bake: Vec3) -> DVec3 {
        bake.as_dvec3() / self.scale + self.centre
    }
}

#[cfg(test)]
mod tests;
