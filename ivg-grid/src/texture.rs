//! The grid as three-dimensional textures for a GPU.
//!
//! Eighteen RGBA textures of the lattice's size, texture `t = 3 × hemisphere + channel` (hemispheres +x −x +y −y +z
//! −z, channels R G B): red, green and blue hold x, y and z of that irradiance vector **times a weight**, alpha holds
//! the weight. Interpolating the texture in hardware and dividing by alpha gives the mean of the vertices by weight:
//! invalid vertices drop out of it. The weight is 1 for a valid vertex, [`INVALID_TEXTURE_WEIGHT`] for an invalid one
//! of a filled grid, so that cells without any valid corner still get the filled value, and 0 for a vertex without a
//! value; where alpha is 0 there is no light.
//!
//! Products, not direction and colour, so that hardware filtering interpolates the linear quantity. Scale by
//! [`IrradianceGrid::largest_component`] before rounding to half precision. Hardware filtering cannot respect blocked
//! edges: a shader that must reads [`IrradianceGrid::texture_flags`] and weights the corners itself.

use crate::{HemisphereVectors, IrradianceGrid};

/// Number of textures: six hemispheres of three channels.
pub const TEXTURE_COUNT: usize = 18;

/// Weight of an invalid vertex in a texture of a filled grid: a power of two, exact in half precision, small enough
/// that beside a valid corner the filled value counts a thousandth.
pub const INVALID_TEXTURE_WEIGHT: f32 = 1.0 / 1024.0;

/// Bit 3 of [`IrradianceGrid::texture_flags`]: the vertex is valid and has a value. Bits 0 to 2 are its blocked edges.
pub const FLAG_USABLE: u8 = 0b1000;

impl IrradianceGrid {
    /// Texture `texture` of the eighteen, one texel a vertex in order of the linear index (x fastest): weighted x, y, z
    /// \[W/m²\] and the weight.
    ///
    /// # Panics
    ///
    /// If `texture` is not less than [`TEXTURE_COUNT`].
    #[must_use]
    pub fn texture_layer(&self, texture: usize) -> Vec<[f32; 4]> {
        assert!(texture < TEXTURE_COUNT, "texture {texture} of {TEXTURE_COUNT}");
        let (hemisphere, channel) = (texture / 3, texture % 3);
        let texel = |(index, vectors): (usize, &HemisphereVectors)| {
            let weight = self.texture_weight(index);
            let [x, y, z] = vectors[hemisphere][channel];
            [weight * x, weight * y, weight * z, weight]
        };
        self.vectors().iter().enumerate().map(texel).collect()
    }

    /// All [`TEXTURE_COUNT`] textures in order, made one at a time.
    pub fn texture_layers(&self) -> impl Iterator<Item = Vec<[f32; 4]>> + '_ {
        (0..TEXTURE_COUNT).map(|texture| self.texture_layer(texture))
    }

    /// One byte a vertex in order of the linear index: bits 0 to 2 the blocked edges to the +x, +y, +z neighbour, bit 3
    /// ([`FLAG_USABLE`]) set where the vertex is valid and has a value.
    #[must_use]
    pub fn texture_flags(&self) -> Vec<u8> {
        let usable = |index| self.is_valid(index) && self.has_value(index);
        let flags = |index: usize| self.blocked_edges()[index] | if usable(index) { FLAG_USABLE } else { 0 };
        (0..self.vertex_count()).map(flags).collect()
    }

    fn texture_weight(&self, index: usize) -> f32 {
        match (self.is_valid(index), self.has_value(index)) {
            (true, true) => 1.0,
            (false, true) if self.is_filled() => INVALID_TEXTURE_WEIGHT,
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests;
