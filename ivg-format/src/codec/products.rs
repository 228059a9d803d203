//! A shared direction times a colour: what the packed and the pair encodings have in common (IVG-PACK-05).

use super::{HEMISPHERES, Pairs};
use crate::values::HemisphereVectors;

/// Vertices that are read at once.
const VERTICES: usize = 16;

/// Directions and scaled colours of `N` hemispheres, one array for each component.
pub(super) struct Chunk<const N: usize> {
    pub(super) direction: [[f32; N]; 3],
    pub(super) colour: [[f32; N]; 3],
}

/// A checked payload of directions and colours.
pub(super) trait Source {
    /// Fills the chunk with the `N` hemispheres from `first` on, counted over all vertices.
    fn load<const N: usize>(&self, first: usize, chunk: &mut Chunk<N>);
}

impl<const N: usize> Chunk<N> {
    fn load(source: &impl Source, first: usize) -> Self {
        let mut chunk = Self { direction: [[0.0; N]; 3], colour: [[0.0; N]; 3] };
        source.load(first, &mut chunk);
        chunk
    }

    /// Each product, rounded once to binary32.
    fn multiply(&self, out: &mut [[[f32; 3]; 3]]) {
        let [dx, dy, dz] = &self.direction;
        let [red, green, blue] = &self.colour;
        let directions = dx.iter().zip(dy).zip(dz);
        let colours = red.iter().zip(green).zip(blue);
        for ((vectors, ((&x, &y), &z)), ((&r, &g), &b)) in out.iter_mut().zip(directions).zip(colours) {
            *vectors = [[r * x, r * y, r * z], [g * x, g * y, g * z], [b * x, b * y, b * z]];
        }
    }
}

/// The irradiance vectors of the vertices from `first` on.
pub(super) fn read(source: &impl Source, first: usize, out: &mut [HemisphereVectors]) {
    let mut at = first * HEMISPHERES;
    let (chunks, rest) = out.as_chunks_mut::<VERTICES>();
    for vertices in chunks {
        Chunk::<{ VERTICES * HEMISPHERES }>::load(source, at).multiply(vertices.as_flattened_mut());
        at += VERTICES * HEMISPHERES;
    }
    for vertex in rest {
        Chunk::<HEMISPHERES>::load(source, at).multiply(vertex);
        at += HEMISPHERES;
    }
}

/// Direction and colour of each hemisphere of vertex `n`.
pub(super) fn pairs(source: &impl Source, n: usize) -> Pairs {
    let Chunk { direction, colour } = Chunk::<HEMISPHERES>::load(source, n * HEMISPHERES);
    core::array::from_fn(|h| (direction.each_ref().map(|c| c[h]), colour.each_ref().map(|c| c[h])))
}

#[cfg(test)]
mod tests;
