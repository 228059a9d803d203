//! The grid as three-dimensional textures for a GPU.
//!
//! RGBA textures of the lattice's size. Of irradiance vectors there are eighteen, texture `t = 3 × hemisphere + channel`
//! (hemispheres +x −x +y −y +z −z, channels R G B): red, green and blue hold x, y and z of that irradiance vector **times
//! a weight**, alpha holds the weight. Of radiance harmonics there are nine, texture `t = 3 × group + channel`: red, green
//! and blue hold coefficients 3 × group, and the two after it, of that channel, times the weight.
//! Interpolating the texture in hardware and dividing by alpha gives the mean of the vertices by weight:
//! invalid vertices drop out of it. The weight is 1 for a valid vertex, [`INVALID_TEXTURE_WEIGHT`] for an invalid one
//! of a filled grid, so that cells without any valid corner still get the filled value, and 0 for a vertex without a
//! value; where alpha is 0 there is no light.
//!
//! Products, not direction and colour, so that hardware filtering interpolates the linear quantity. Scale by
//! [`IrradianceGrid::largest_component`] before rounding to half precision. Hardware filtering cannot respect blocked
//! edges: a shader that must reads [`IrradianceGrid::texture_flags`] and weights the corners itself.

use ivg_format::{Quantity, Values};

use crate::IrradianceGrid;

/// Number of textures of a grid: for irradiance vectors six hemispheres of three channels, for radiance harmonics three
/// groups of coefficients of three channels.
#[must_use]
pub const fn texture_count(quantity: Quantity) -> usize {
    match quantity {
        Quantity::Vectors => 18,
        Quantity::Radiance => 9,
    }
}

/// Weight of an invalid vertex in a texture of a filled grid: a power of two, exact in half precision, small enough
/// that beside a valid corner the filled value counts a thousandth.
pub const INVALID_TEXTURE_WEIGHT: f32 = 1.0 / 1024.0;

/// Bit 3 of [`IrradianceGrid::texture_flags`]: the vertex is valid and has a value. Bits 0 to 2 are its blocked edges.
pub const FLAG_USABLE: u8 = 0b1000;

impl IrradianceGrid {
    /// Texture `texture` of [`texture_count`], one texel a vertex in order of the linear index (x fastest): three weighted
    /// numbers \[W/m² or W/(m² sr)\] and the weight.
    ///
    /// # Panics
    ///
    /// If `texture` is not less than [`texture_count`].
    #[must_use]
    pub fn texture_layer(&self, texture: usize) -> Vec<[f32; 4]> {
        let count = texture_count(self.quantity());
        assert!(texture < count, "texture {texture} of {count}");
        let (group, channel) = (texture / 3, texture % 3);
        let texel = |index: usize| {
            let weight = self.texture_weight(index);
            let [x, y, z] = match self.values() {
                Values::Vectors(vectors) => vectors[index][group][channel],
                Values::Radiance(radiance) => {
                    let first = 3 * group;
                    std::array::from_fn(|n| radiance[index][channel][first + n])
                }
            };
            [weight * x, weight * y, weight * z, weight]
        };
        (0..self.vertex_count()).map(texel).collect()
    }

    /// All [`texture_count`] textures in order, made one at a time.
    pub fn texture_layers(&self) -> impl Iterator<Item = Vec<[f32; 4]>> + '_ {
        (0..texture_count(self.quantity())).map(|texture| self.texture_layer(texture))
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
