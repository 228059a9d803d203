use std::ops::Range;

use glam::{Vec2, Vec3};

use crate::{RenderError, RenderScene};

/// All triangles of a scene, in scene space, ordered by material.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Geometry {
    /// Vertex positions \[m\].
    pub positions: Vec<Vec3>,
    /// Shading normals, unit length or zero, one a vertex.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, one a vertex.
    pub uvs: Vec<Vec2>,
    /// Corner indices, counter-clockwise seen from the front; ordered by material, else as in the scene.
    pub triangles: Vec<[u32; 3]>,
    /// Triangles of one material each, together all triangles.
    pub draws: Vec<Draw>,
    /// Smallest and largest coordinates of all vertices of triangles and of progressive meshes that are drawn with them
    /// \[m\]; both zero without any.
    pub bounds: (Vec3, Vec3),
}

/// Consecutive triangles of one material.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Draw {
    /// Index into the scene's materials.
    pub material: u32,
    /// Range of [`Geometry::triangles`].
    pub triangles: Range<u32>,
}

impl Geometry {
    /// Collects the triangles of a scene that has been checked.
    ///
    /// # Errors
    ///
    /// [`RenderError::TooMany`] if vertices or triangles exceed 32-bit indices.
    pub(crate) fn new(scene: &RenderScene) -> Result<Self, RenderError> {
        let mut geometry = Self::default();
        let mut materials = Vec::new();
        for mesh in &scene.meshes {
            let base = u32::try_from(geometry.positions.len())
                .ok()
                .filter(|base| (*base as usize).saturating_add(mesh.positions.len()) <= u32::MAX as usize);
            let base = base.ok_or_else(|| too_many("vertices", &scene.meshes, |m| m.positions.len()))?;
            let mirrored = mesh.transform.matrix3.determinant() < 0.0;
            let normal_matrix = mesh.normal_matrix() * if mirrored { -1.0 } else { 1.0 };
            geometry.positions.extend(mesh.positions.iter().map(|p| mesh.transform.transform_point3(*p)));
            let normals = mesh.normals_or_computed();
            geometry.normals.extend(normals.iter().map(|n| (normal_matrix * *n).normalize_or_zero()));
            geometry.uvs.extend_from_slice(&mesh.uvs);
            geometry.uvs.resize(geometry.positions.len(), Vec2::ZERO);
            for (corners, material) in mesh.triangles.iter().zip(&mesh.triangle_materials) {
                let [a, b, c] = corners.map(|corner| base + corner);
                geometry.triangles.push(if mirrored { [a, c, b] } else { [a, b, c] });
                materials.push(*material);
            }
        }
        if u32::try_from(geometry.triangles.len()).is_err() {
            return Err(too_many("triangles", &scene.meshes, |m| m.triangles.len()));
        }
        geometry.order_by_material(&materials);
        geometry.bounds = geometry.find_bounds();
        Ok(geometry)
    }

    /// The same with bounds that these boxes lie in too.
    pub(crate) fn containing(mut self, boxes: &[(Vec3, Vec3)]) -> Self {
        let own = (!self.triangles.is_empty()).then_some(self.bounds);
        let all = own.into_iter().chain(boxes.iter().copied());
        self.bounds = all.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or(self.bounds);
        self
    }

    /// Diagonal of the bounds \[m\].
    #[must_use]
    pub fn extent(&self) -> f32 {
        (self.bounds.1 - self.bounds.0).length()
    }

    /// Positions of the corners of a triangle \[m\].
    #[must_use]
    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|corner| self.positions[corner as usize])
    }

    fn order_by_material(&mut self, materials: &[u32]) {
        let mut order: Vec<usize> = (0..materials.len()).collect();
        order.sort_by_key(|triangle| materials[*triangle]);
        for group in order.chunk_by(|a, b| materials[*a] == materials[*b]) {
            let material = materials[group[0]];
            let start = self.draws.last().map_or(0, |draw| draw.triangles.end);
            self.draws.push(Draw { material, triangles: start..start + group.len() as u32 });
        }
        self.triangles = order.iter().map(|triangle| self.triangles[*triangle]).collect();
    }

    fn find_bounds(&self) -> (Vec3, Vec3) {
        let mut corners = self.triangles.as_flattened().iter().map(|corner| self.positions[*corner as usize]);
        let Some(first) = corners.next() else { return (Vec3::ZERO, Vec3::ZERO) };
        corners.fold((first, first), |(low, high), corner| (low.min(corner), high.max(corner)))
    }
}

fn too_many(
    what: &'static str,
    meshes: &[crate::RenderMesh],
    count: impl Fn(&crate::RenderMesh) -> usize,
) -> RenderError {
    RenderError::TooMany { what, count: meshes.iter().map(count).sum(), limit: u32::MAX as usize }
}
