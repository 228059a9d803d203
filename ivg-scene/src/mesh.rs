use std::collections::HashMap;

use glam::{DVec3, Vec2, Vec3};

use crate::geometry::area_weighted_normals;

/// An indexed triangle mesh in its own space.
///
/// Positions are f32 relative to an f64 origin, so that a scene far from its origin keeps its precision.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// The name the scene gives it.
    pub name: String,
    /// What must be added to each position, in mesh space \[m\].
    pub origin: DVec3,
    /// Vertex positions relative to `origin`, in mesh space \[m\].
    pub positions: Vec<Vec3>,
    /// Unit normals, one a vertex, or empty.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, one a vertex, or empty. (0, 0) is the upper left corner of the image.
    pub uvs: Vec<Vec2>,
    /// Colours, one a vertex, or empty: red, green, blue in sRGB, then alpha, linear. They are carried along for whoever
    /// shows them; light is computed from materials alone.
    pub colours: Vec<[u8; 4]>,
    /// Corner indices into `positions`; counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Index into [`Scene::materials`](crate::Scene::materials), one a triangle.
    pub triangle_materials: Vec<u32>,
}

/// Cosine of the angle between the normals of two vertices at one place from which on they are an edge to be seen: 2.6°.
const CREASE_COSINE: f32 = 0.999;

impl Mesh {
    /// Normals to shade with, one a vertex: the mesh's own, or the area-weighted mean of the faces around each vertex.
    ///
    /// # Panics
    ///
    /// If a triangle names a vertex that the mesh does not have.
    #[must_use]
    pub fn shading_normals(&self) -> Vec<Vec3> {
        if self.normals.is_empty() {
            area_weighted_normals(&self.positions, &self.triangles)
        } else {
            self.normals.clone()
        }
    }

    /// Whether vertices at one place have different normals, although the mesh stores none: its faces do not share
    /// vertices along edges that should look sharp. Joining such vertices would round the edges off.
    ///
    /// # Panics
    ///
    /// If a triangle names a vertex that the mesh does not have.
    #[must_use]
    pub fn has_unstored_creases(&self) -> bool {
        if !self.normals.is_empty() {
            return false;
        }
        let normals = self.shading_normals();
        let mut used = vec![false; self.positions.len()];
        self.triangles.as_flattened().iter().for_each(|&vertex| used[vertex as usize] = true);
        let mut first: HashMap<[u32; 3], Vec3> = HashMap::new();
        let places = self.positions.iter().zip(normals).zip(used).filter(|(_, used)| *used);
        places.into_iter().any(|((position, normal), _)| {
            // Adding zero makes one place of 0 and -0.
            let place = (*position + Vec3::ZERO).to_array().map(f32::to_bits);
            first.entry(place).or_insert(normal).dot(normal) < CREASE_COSINE
        })
    }
}

#[cfg(test)]
mod tests;
