//! The fast mode of the papers: directions and colours filtered apart.
//!
//! Web3D 2008 (section 3.3) puts the directions of the packed vectors into one texture and their colours into another, lets the
//! graphics hardware interpolate both, and multiplies. That is two fetches a hemisphere instead of three (of products), but
//! the mean of products is not the product of means: where directions differ between vertices the result is off. The
//! example `accuracy` of the baker prints by how much.
//!
//! Nothing here looks at validity or blocked edges: hardware filters all eight corners. So every vertex needs a
//! direction, which is why the textures are made of a filled grid: what [`fill`](crate::fill()) gives an invalid vertex is its
//! neighbours' light, and with it their direction.

use glam::{DVec3, Vec3};
use ivg_format::Lattice;

use crate::spatial::locate;
use crate::{HemisphereVectors, IrradianceGrid, Reconstruction, reconstruct};

/// The largest ratio of a colour component to the length of its vector (IVG-PACK-04).
const LARGEST_RATIO: f32 = 1.5;

/// A direction and a colour for each hemisphere of each vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct SeparateTextures {
    lattice: Lattice,
    /// Unit length; zero where there is no light.
    directions: Vec<[Vec3; 6]>,
    /// \[W/m²\].
    colours: Vec<[Vec3; 6]>,
}

impl SeparateTextures {
    /// Packs the vectors of a grid; one that is not [filled](crate::fill()) is dark where nothing has arrived.
    ///
    /// The vectors of a packed encoding become the direction and the colour that they were decoded from, but for rounding.
    ///
    /// # Panics
    ///
    /// If the grid holds radiance harmonics.
    #[must_use]
    pub fn new(grid: &IrradianceGrid) -> Self {
        let packed = |vectors: &HemisphereVectors| -> [(Vec3, Vec3); 6] {
            std::array::from_fn(|hemisphere| pack(&vectors[hemisphere], hemisphere))
        };
        let (directions, colours) =
            grid.vectors().iter().map(packed).map(|both| (both.map(|b| b.0), both.map(|b| b.1))).unzip();
        Self { lattice: *grid.lattice(), directions, colours }
    }

    /// The irradiance \[W/m²\] at point `p` \[m\] of a surface with unit normal `n`: directions and colours interpolated
    /// linearly, each for itself, multiplied, then [`Reconstruction::ThreeVector`].
    #[must_use]
    pub fn irradiance(&self, p: DVec3, n: Vec3) -> Vec3 {
        let mut directions = [Vec3::ZERO; 6];
        let mut colours = [Vec3::ZERO; 6];
        let located: [(u16, f64); 3] = std::array::from_fn(|axis| {
            let (origin, step) = (self.lattice.origin[axis], self.lattice.step[axis]);
            locate(p[axis], origin, step, self.lattice.dims[axis] - 1)
        });
        for corner in 0..8 {
            let mut weight = 1.0;
            let [i, j, k] = std::array::from_fn(|axis| {
                let (base, fraction) = located[axis];
                let above = corner >> axis & 1;
                weight *= if above == 1 { fraction } else { 1.0 - fraction };
                (base + above).min(self.lattice.dims[axis] - 1)
            });
            let vertex = self.lattice.index(i, j, k) as usize;
            for hemisphere in 0..6 {
                directions[hemisphere] += self.directions[vertex][hemisphere] * weight as f32;
                colours[hemisphere] += self.colours[vertex][hemisphere] * weight as f32;
            }
        }
        let vectors = std::array::from_fn(|h| colours[h].to_array().map(|c| (directions[h] * c).to_array()));
        reconstruct(Reconstruction::ThreeVector, &vectors, n)
    }
}

/// The direction and the colour \[W/m²\] of a hemisphere's vectors, as Web3D 2008 packs them (section 3.3): the direction of
/// their sum, and the colour that keeps the components along the axis, capped as in the packed encodings (IVG-PACK-04).
fn pack(vectors: &[[f32; 3]; 3], hemisphere: usize) -> (Vec3, Vec3) {
    let vectors = vectors.map(Vec3::from);
    let Some(direction) = vectors.into_iter().sum::<Vec3>().try_normalize() else {
        return (Vec3::ZERO, Vec3::ZERO);
    };
    let axis = hemisphere / 2;
    let colour = vectors.map(|vector| {
        let kept = vector[axis] / direction[axis];
        if kept > 0.0 { kept.min(LARGEST_RATIO * vector.length()) } else { 0.0 }
    });
    (direction, colour.into())
}

#[cfg(test)]
mod tests;
