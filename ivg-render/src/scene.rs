//! The scene as it is rendered: plain data, no wgpu.

use glam::{Affine3A, DAffine3, DVec3, Mat3A, Vec2, Vec3};
use ivg_grid::IrradianceGrid;
use ivg_scene::{Camera, FlatScene, Light, LightKind, Material, Scene, SkyImage, Texture};
use pmesh_format::IndexedMesh;

use crate::RenderError;

/// A triangle mesh to be rendered.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RenderMesh {
    /// Vertex positions in the mesh's own space \[m\].
    pub positions: Vec<Vec3>,
    /// Unit normals, one a vertex; empty = the area-weighted mean of the triangles around a vertex.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, one a vertex, (0, 0) in the upper left corner of the image; empty = zero.
    pub uvs: Vec<Vec2>,
    /// Corner indices into `positions`, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Index into [`RenderScene::materials`], one a triangle.
    pub triangle_materials: Vec<u32>,
    /// From the mesh's space to scene space.
    pub transform: Affine3A,
}

/// What a renderer needs: surfaces, lights, a camera, and perhaps baked indirect light.
///
/// Scene space is world space moved by `origin`, so that f32 positions stay precise far from the world's origin.
/// World positions in f64 (camera, lights, grid) are not moved by the caller.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderScene {
    /// World position of the origin of scene space \[m\].
    pub origin: DVec3,
    /// Surfaces, placed in scene space. Emissive triangles are area lights.
    pub meshes: Vec<RenderMesh>,
    /// Materials of the triangles. Surfaces are drawn opaque and diffuse on both sides, with their albedo; what mirrors and
    /// glass do to the light of other surfaces is in the grid.
    pub materials: Vec<Material>,
    /// Images that materials name.
    pub textures: Vec<Texture>,
    /// Lights without a surface.
    pub lights: Vec<Light>,
    /// Radiance behind everything \[W/(m² sr)\]; it lights nothing here, what the sky adds is in the grid.
    pub sky: Option<Vec3>,
    /// Radiance behind everything that differs from direction to direction; adds to `sky`.
    pub sky_image: Option<SkyImage>,
    /// From where the scene is seen.
    pub camera: Camera,
    /// Indirect light, every vertex with a value (see `ivg_grid::fill`).
    pub grid: Option<IrradianceGrid>,
}

impl RenderScene {
    /// The render scene of an imported scene with all its triangles, seen from `camera`, without a grid.
    #[must_use]
    pub fn from_scene(scene: &Scene, flat: &FlatScene, camera: Camera) -> Self {
        let mesh = RenderMesh {
            positions: flat.positions.clone(),
            normals: flat.normals.clone(),
            uvs: flat.uvs.clone(),
            triangles: flat.triangles.clone(),
            triangle_materials: flat.triangle_materials.clone(),
            transform: Affine3A::IDENTITY,
        };
        Self {
            origin: flat.origin,
            meshes: vec![mesh],
            materials: scene.materials.clone(),
            textures: scene.textures.clone(),
            lights: scene.lights.clone(),
            sky: scene.sky,
            sky_image: scene.sky_image.clone(),
            camera,
            grid: None,
        }
    }

    /// Checks everything that rendering relies on.
    ///
    /// # Errors
    ///
    /// The first problem found, naming the mesh, triangle, material or light.
    pub fn check(&self) -> Result<(), RenderError> {
        for (index, mesh) in self.meshes.iter().enumerate() {
            mesh.check(index, self.materials.len())?;
        }
        for texture in &self.textures {
            let texels = u64::from(texture.width) * u64::from(texture.height);
            if texels == 0 || texture.texels.len() as u64 != 3 * texels {
                let problem = "its texels do not fit its size";
                return Err(RenderError::Texture { name: texture.name.clone(), problem });
            }
        }
        for material in &self.materials {
            if !(material.albedo.is_finite() && material.emission.is_finite()) {
                return Err(RenderError::NotFinite { what: format!("material {:?}", material.name) });
            }
            if material.albedo_texture.is_some_and(|texture| texture as usize >= self.textures.len()) {
                let problem = "it names a texture that does not exist";
                return Err(RenderError::Texture { name: material.name.clone(), problem });
            }
        }
        for light in &self.lights {
            if !is_finite(&light.kind) {
                return Err(RenderError::NotFinite { what: format!("light {:?}", light.name) });
            }
        }
        if !self.origin.is_finite() || self.sky.is_some_and(|sky| !sky.is_finite()) {
            return Err(RenderError::NotFinite { what: "the scene's origin or sky".into() });
        }
        if let Some(sky) = &self.sky_image {
            let texels = u64::from(sky.width) * u64::from(sky.height);
            if texels == 0 || sky.texels.len() as u64 != texels {
                let problem = "its texels do not fit its size";
                return Err(RenderError::Texture { name: sky.name.clone(), problem });
            }
            if !(sky.rotation.is_finite() && sky.texels.as_flattened().iter().all(|x| x.is_finite())) {
                return Err(RenderError::NotFinite { what: format!("the sky {:?}", sky.name) });
            }
        }
        if let Some(grid) = &self.grid {
            let missing = (0..grid.vertex_count()).filter(|vertex| !grid.has_value(*vertex)).count();
            if missing > 0 {
                return Err(RenderError::GridNotFilled { missing });
            }
        }
        Ok(())
    }
}

impl RenderMesh {
    /// A mesh at any level of detail, placed in scene space. Its vertices are the wedges of `mesh`.
    ///
    /// `materials` holds the scene's material for each material index of the mesh; an index without one becomes a
    /// material that [`RenderScene::check`] refuses. `transform` leads from mesh space to world space, `origin` is the
    /// world position of the origin of scene space \[m\]; positions are combined with both in f64. Without normals of
    /// its own the mesh gets area-weighted ones, smooth across seams of texture coordinates.
    ///
    /// # Panics
    ///
    /// If a triangle names a wedge, or a wedge a vertex, that does not exist.
    #[must_use]
    pub fn from_indexed(mesh: &IndexedMesh, materials: &[u32], transform: &DAffine3, origin: DVec3) -> Self {
        let wedges = &mesh.wedges;
        let material = |index: u16| materials.get(usize::from(index)).copied().unwrap_or(u32::MAX);
        let normals = if wedges.normals.is_empty() {
            let vertex_of = |wedge: u32| wedges.vertices[wedge as usize];
            let triangles: Vec<[u32; 3]> = mesh.triangles.iter().map(|t| t.map(vertex_of)).collect();
            let positions: Vec<Vec3> = mesh.positions.iter().copied().map(Vec3::from).collect();
            let normals = area_weighted_normals(&positions, &triangles);
            wedges.vertices.iter().map(|vertex| normals[*vertex as usize]).collect()
        } else {
            wedges.normals.iter().copied().map(Vec3::from).collect()
        };
        Self {
            positions: wedges.vertices.iter().map(|vertex| mesh.positions[*vertex as usize].into()).collect(),
            normals,
            uvs: wedges.uvs.iter().copied().map(Vec2::from).collect(),
            triangle_materials: (0..mesh.triangles.len())
                .map(|triangle| material(mesh.materials.get(triangle).copied().unwrap_or(0)))
                .collect(),
            triangles: mesh.triangles.clone(),
            transform: placed(transform, DVec3::from(mesh.origin), origin),
        }
    }

    fn check(&self, mesh: usize, materials: usize) -> Result<(), RenderError> {
        let vertices = self.positions.len();
        for (attribute, found, expected, optional) in [
            ("normals", self.normals.len(), vertices, true),
            ("texture coordinates", self.uvs.len(), vertices, true),
            ("triangle materials", self.triangle_materials.len(), self.triangles.len(), false),
        ] {
            if found != expected && !(optional && found == 0) {
                return Err(RenderError::AttributeCount { mesh, attribute, found, expected });
            }
        }
        for (triangle, corners) in self.triangles.iter().enumerate() {
            let material = self.triangle_materials[triangle];
            if material as usize >= materials {
                let (what, index, count) = ("material", material, materials);
                return Err(RenderError::Index { mesh, triangle, what, index, count });
            }
            if let Some(&index) = corners.iter().find(|corner| **corner as usize >= vertices) {
                return Err(RenderError::Index { mesh, triangle, what: "vertex", index, count: vertices });
            }
        }
        let finite = self.positions.iter().chain(&self.normals).all(|value| value.is_finite())
            && self.uvs.iter().all(|uv| uv.is_finite())
            && self.transform.is_finite();
        if finite { Ok(()) } else { Err(RenderError::NotFinite { what: format!("mesh {mesh}") }) }
    }

    /// Normals in the mesh's space, unit length: the given ones, or the area-weighted mean of the triangles around
    /// each vertex; zero where a vertex has no triangle with an area.
    pub(crate) fn normals_or_computed(&self) -> Vec<Vec3> {
        if !self.normals.is_empty() || self.positions.is_empty() {
            return self.normals.clone();
        }
        area_weighted_normals(&self.positions, &self.triangles)
    }

    /// What maps normals of the mesh's space to scene space (not unit length).
    pub(crate) fn normal_matrix(&self) -> Mat3A {
        normal_matrix(&self.transform)
    }
}

/// From the space of positions that are relative to `mesh_origin` to scene space, whose origin is at `origin`.
pub(crate) fn placed(transform: &DAffine3, mesh_origin: DVec3, origin: DVec3) -> Affine3A {
    let translation = transform.transform_point3(mesh_origin) - origin;
    Affine3A { matrix3: transform.matrix3.as_mat3().into(), translation: translation.as_vec3a() }
}

/// What takes normals along with a transform (not unit length).
pub(crate) fn normal_matrix(transform: &Affine3A) -> Mat3A {
    // The cofactor matrix: the inverse transpose up to a factor, defined for flat transforms too.
    let [x, y, z] = [transform.matrix3.x_axis, transform.matrix3.y_axis, transform.matrix3.z_axis];
    Mat3A::from_cols(y.cross(z), z.cross(x), x.cross(y))
}

/// Unit normals of vertices: the mean of the triangles around each, weighted by area; zero where there is none.
pub(crate) fn area_weighted_normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; positions.len()];
    for corners in triangles {
        let [a, b, c] = corners.map(|corner| positions[corner as usize]);
        let twice_area = (b - a).cross(c - a);
        for corner in corners {
            sums[*corner as usize] += twice_area;
        }
    }
    sums.into_iter().map(Vec3::normalize_or_zero).collect()
}

fn is_finite(kind: &LightKind) -> bool {
    match kind {
        LightKind::Point { position, intensity } => position.is_finite() && intensity.is_finite(),
        LightKind::Spot { position, direction, intensity, inner_angle, outer_angle } => {
            position.is_finite()
                && direction.is_finite()
                && intensity.is_finite()
                && inner_angle.is_finite()
                && outer_angle.is_finite()
        }
        LightKind::Directional { direction, irradiance } => direction.is_finite() && irradiance.is_finite(),
    }
}

#[cfg(test)]
mod tests;
