use std::f64::consts::PI;

use glam::{DVec3, Vec3};

/// A light that is not simply an emissive surface of the scene's geometry.
///
/// Emissive surfaces are found through [`Material::emission`](crate::Material::emission). A rectangle from a
/// lights file is turned into an emissive mesh when it is read, so that baker and renderer see one kind of area
/// light only.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    /// The name the scene gives it, or a generated one such as `light 2`.
    pub name: String,
    /// What kind of light it is and its strength.
    pub kind: LightKind,
}

/// Kinds of light without a surface. Directions are unit length and world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// Radiates evenly in all directions from one point.
    Point {
        /// World position \[m\].
        position: DVec3,
        /// Radiant intensity, linear RGB \[W/sr\].
        intensity: Vec3,
    },
    /// Radiates into a cone, as `KHR_lights_punctual` defines it.
    Spot {
        /// World position \[m\].
        position: DVec3,
        /// Axis of the cone, unit length, away from the light.
        direction: Vec3,
        /// Radiant intensity on the axis, linear RGB \[W/sr\].
        intensity: Vec3,
        /// Half angle up to which the intensity is full \[rad\].
        inner_angle: f32,
        /// Half angle from which on nothing is emitted \[rad\]; in (`inner_angle`, pi/2].
        outer_angle: f32,
    },
    /// Parallel light from infinitely far away.
    Directional {
        /// The way the light travels, unit length.
        direction: Vec3,
        /// Irradiance on a surface facing the light, linear RGB \[W/m²\].
        irradiance: Vec3,
    },
}

impl Light {
    /// Power that the light radiates \[W\], linear RGB; `None` for a directional light, whose power depends on what it
    /// shines on.
    ///
    /// A spot's intensity falls off as `KHR_lights_punctual` recommends: with the square of
    /// (cos angle - cos outer) / (cos inner - cos outer), see [`spot_factor`].
    #[must_use]
    pub fn power(&self) -> Option<DVec3> {
        match self.kind {
            LightKind::Point { intensity, .. } => Some(4.0 * PI * intensity.as_dvec3()),
            LightKind::Spot { intensity, inner_angle, outer_angle, .. } => {
                let (inner, outer) = (f64::from(inner_angle).cos(), f64::from(outer_angle).cos());
                // Full inside the inner cone, and the mean of a squared ramp (one third) over the rest.
                let solid_angle = 2.0 * PI * ((1.0 - inner) + (inner - outer).max(0.0) / 3.0);
                Some(solid_angle * intensity.as_dvec3())
            }
            LightKind::Directional { .. } => None,
        }
    }
}

/// Share of its axial intensity that a spot radiates in a direction, in [0, 1].
///
/// `cos_angle` is the cosine of the angle between the direction and the axis; the angles are half angles \[rad\].
#[must_use]
pub fn spot_factor(cos_angle: f32, inner_angle: f32, outer_angle: f32) -> f32 {
    let (inner, outer) = (inner_angle.cos(), outer_angle.cos());
    if cos_angle >= inner {
        return 1.0;
    }
    let ramp = ((cos_angle - outer) / (inner - outer)).clamp(0.0, 1.0);
    ramp * ramp
}

#[cfg(test)]
mod tests;
