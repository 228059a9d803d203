use glam::Vec3;

use super::Material;

/// The ways in which a surface sends light on, each with its share; of the rest that is missing to 1, all is absorbed.
///
/// A surface is a mixture: a share of its area reflects evenly, a share mirrors, a share is glass (as glTF 2.0, appendix B.2,
/// mixes metal, transmission and diffuse reflection). Every colour is in [0, 1] and the shares sum to at most 1, so that
/// no mixture sends on more light than it gets, in any channel.
///
/// Left out: the coat that reflects a few per cent on opaque dielectrics; the albedo is all that they reflect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lobes {
    /// Share that reflects evenly in all directions (Lambert), in [0, 1].
    pub diffuse: f32,
    /// What it reflects, each channel in [0, 1]; multiplied by the albedo texture where there is one.
    pub diffuse_colour: Vec3,
    /// Share that mirrors, in [0, 1].
    pub mirror: f32,
    /// What it mirrors straight on, each channel in [0, 1]; multiplied by the texture if `metallic`.
    pub mirror_colour: Vec3,
    /// Whether the mirror is a metal, which reflects everything at grazing angles; else it is the same at all angles.
    pub metallic: bool,
    /// Width of the mirror lobe: alpha of the GGX distribution, the square of the material's roughness; 0 for a mirror without
    /// blur.
    pub alpha: f32,
    /// Share that is glass, in [0, 1].
    pub glass: f32,
    /// What passes of the light that is not reflected, each channel in [0, 1].
    pub glass_colour: Vec3,
    /// Index of refraction of the glass, >= 1.
    pub refractive_index: f32,
}

/// Roughness below which a mirror is taken as one without blur: its lobe is narrower than about 4 degrees, the width alpha
/// of slopes being the square of roughness (glTF 2.0, appendix B.3).
pub(crate) const SHARP_ROUGHNESS: f32 = 0.25;

impl Material {
    /// How the surface sends light on. Without `mirrors` a metal is a surface that reflects its albedo evenly, and what a
    /// layer would mirror is absorbed; without `glass` what would pass is absorbed.
    #[must_use]
    pub fn lobes(&self, mirrors: bool, glass: bool) -> Lobes {
        let opaque = 1.0 - self.transmission;
        // The albedo is stored with what passes taken off.
        let base = if opaque > 0.0 { (self.albedo / opaque).min(Vec3::ONE) } else { Vec3::ZERO };
        let mirror = match (mirrors, self.metallic) {
            (false, _) => 0.0,
            (true, true) => self.specular,
            // A layer adds to the albedo: both together reflect no more than there is.
            (true, false) => self.specular.min(1.0 - base.max_element()),
        };
        let rest = 1.0 - mirror;
        let diffuse_colour = if self.metallic || rest <= 0.0 { base } else { (base / rest).min(Vec3::ONE) };
        Lobes {
            diffuse: rest * opaque,
            diffuse_colour,
            mirror,
            mirror_colour: self.specular_colour,
            metallic: self.metallic,
            alpha: if self.roughness < SHARP_ROUGHNESS { 0.0 } else { self.roughness * self.roughness },
            glass: if glass { rest * self.transmission } else { 0.0 },
            glass_colour: self.transmission_colour,
            refractive_index: self.refractive_index,
        }
    }
}

impl Lobes {
    /// The most light that is sent on in any channel, as a share, in [0, 1].
    #[must_use]
    pub fn most(&self) -> f32 {
        let mirror = if self.metallic { 1.0 } else { self.mirror_colour.max_element() };
        (self.diffuse * self.diffuse_colour.max_element() + self.mirror * mirror + self.glass).min(1.0)
    }

    /// What is sent on of light from everywhere, linear RGB, each channel in [0, 1], where the albedo texture has the colour
    /// `texture`; that metals reflect more at grazing angles and glass absorbs less is left out.
    #[must_use]
    pub fn mean(&self, texture: Vec3) -> Vec3 {
        let mirror = if self.metallic { self.mirror_colour * texture } else { self.mirror_colour };
        self.diffuse * self.diffuse_colour * texture + self.mirror * mirror + self.glass * self.glass_colour
    }

    /// Whether light is reflected evenly and in no other way.
    #[must_use]
    pub fn is_diffuse(&self) -> bool {
        self.mirror <= 0.0 && self.glass <= 0.0
    }
}

#[cfg(test)]
mod tests;
