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
