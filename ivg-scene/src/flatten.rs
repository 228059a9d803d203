//! One array of triangles in world space.

use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3};

use crate::geometry::{area_vector, area_weighted_normals, snapped_origin, unit_or};
use crate::{FlatScene, Material, Scene};

impl Scene {
    /// Bounding box of all placed triangles in world space \[m\]: (least, greatest) corner. Both are zero for a scene
    /// without triangles.
    #[must_use]
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let mut bounds = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for node in &self.nodes {
            let Some(mesh) = self.meshes.get(node.mesh as usize) else { continue };
            for &i in mesh.triangles.iter().flatten() {
                let Some(p) = mesh.positions.get(i as usize) else { continue };
                let world = node.transform.transform_point3(mesh.origin + p.as_dvec3());
                bounds = (bounds.0.min(world), bounds.1.max(world));
            }
        }
        if bounds.0.cmple(bounds.1).all() { bounds } else { (DVec3::ZERO, DVec3::ZERO) }
    }

    /// How many triangles all nodes place together.
    #[must_use]
    pub fn triangle_count(&self) -> u64 {
        self.nodes
            .iter()
            .filter_map(|n| self.meshes.get(n.mesh as usize))
            .map(|m| m.triangles.len() as u64)
            .sum()
    }

    /// All triangles of all nodes in world space.
    ///
    /// Transforms are applied in f64, and positions are stored relative to an origin near the middle, so that neither a
    /// distant scene nor a distant node loses precision. A mirroring transform swaps two corners of each triangle, so
    /// that the front stays the front. Vertices keep their order; those that no triangle names are kept too.
    ///
    /// # Panics
    ///
    /// Panics if [`Scene::check`] would fail on an index, or above 2^32 vertices.
    #[must_use]
    pub fn flatten(&self) -> FlatScene {
        let (min, max) = self.bounds();
        let mut flat = FlatScene { origin: snapped_origin(min, max), ..FlatScene::default() };
        let with_colours = self.nodes.iter().any(|n| !self.meshes[n.mesh as usize].colours.is_empty());
        for node in &self.nodes {
            flat.node_starts.push(flat.triangles.len() as u32);
            let mesh = &self.meshes[node.mesh as usize];
            let base = u32::try_from(flat.positions.len()).expect("at most 2^32 vertices");
            let transform = Placement::new(node.transform);
            let corners = |t: &[u32; 3]| if transform.mirrored { [t[0], t[2], t[1]] } else { *t };

            let positions: Vec<Vec3> = mesh
                .positions
                .iter()
                .map(|p| {
                    (transform.matrix.transform_point3(mesh.origin + p.as_dvec3()) - flat.origin).as_vec3()
                })
                .collect();
            match transform.normals {
                Some(matrix) if !mesh.normals.is_empty() => {
                    flat.normals.extend(mesh.normals.iter().map(|n| unit_or(matrix * n.as_dvec3(), Vec3::Z)));
                }
                _ => {
                    let triangles: Vec<[u32; 3]> = mesh.triangles.iter().map(corners).collect();
                    flat.normals.extend(area_weighted_normals(&positions, &triangles));
                }
            }
            if mesh.uvs.is_empty() {
                flat.uvs.extend(std::iter::repeat_n(Vec2::ZERO, positions.len()));
            } else {
                flat.uvs.extend_from_slice(&mesh.uvs);
            }
            if with_colours {
                flat.colours.extend_from_slice(&mesh.colours);
                flat.colours.resize(flat.positions.len() + positions.len(), [u8::MAX; 4]);
            }
            flat.positions.extend(positions);
            flat.triangles.extend(mesh.triangles.iter().map(|t| corners(t).map(|i| base + i)));
            flat.triangle_materials.extend_from_slice(&mesh.triangle_materials);
        }
        flat.node_starts.push(flat.triangles.len() as u32);
        flat
    }
}

/// A node transform with what follows from it.
struct Placement {
    matrix: DAffine3,
    /// Takes normals along; `None` if the transform flattens space, so that only faces tell the normal.
    normals: Option<DMat3>,
    mirrored: bool,
}

impl Placement {
    fn new(matrix: DAffine3) -> Self {
        let determinant = matrix.matrix3.determinant();
        let inverse = matrix.matrix3.inverse();
        let regular = determinant != 0.0 && inverse.is_finite();
        Self { matrix, normals: regular.then(|| inverse.transpose()), mirrored: determinant < 0.0 }
    }
}

impl FlatScene {
    /// Corner positions of a triangle relative to [`FlatScene::origin`] \[m\].
    ///
    /// # Panics
    ///
    /// Panics if `triangle` is out of range.
    #[must_use]
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|i| self.positions[i as usize])
    }

    /// Area of a triangle \[m²\], computed in f64.
    ///
    /// # Panics
    ///
    /// Panics if `triangle` is out of range.
    #[must_use]
    pub fn area(&self, triangle: usize) -> f64 {
        0.5 * area_vector(self.corners(triangle)).length()
    }

    /// Unit normal of the front of a triangle's plane; zero for a triangle without area.
    ///
    /// # Panics
    ///
    /// Panics if `triangle` is out of range.
    #[must_use]
    pub fn geometric_normal(&self, triangle: usize) -> Vec3 {
        unit_or(area_vector(self.corners(triangle)), Vec3::ZERO)
    }

    /// The material of a triangle.
    ///
    /// # Panics
    ///
    /// Panics if `triangle` or its material is out of range.
    #[must_use]
    pub fn material<'a>(&self, scene: &'a Scene, triangle: usize) -> &'a Material {
        &scene.materials[self.triangle_materials[triangle] as usize]
    }

    /// Power that each emissive triangle radiates \[W\], linear RGB, with its index, in order of index; triangles that
    /// emit nothing or have no area are left out.
    pub fn emitters<'a>(&'a self, scene: &'a Scene) -> impl Iterator<Item = (usize, DVec3)> + 'a {
        (0..self.triangles.len()).filter_map(|t| {
            let material = self.material(scene, t);
            if material.emission == Vec3::ZERO {
                return None;
            }
            let power = material.emitted_power(self.area(t));
            (power != DVec3::ZERO).then_some((t, power))
        })
    }
}

#[cfg(test)]
mod tests;
