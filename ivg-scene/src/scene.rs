use glam::{DAffine3, DVec3, Vec2, Vec3};

use crate::{Camera, Light, Material, Mesh, SkyImage, Texture};

/// A scene as imported: meshes placed by nodes, materials, lights, perhaps a camera.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    /// Usually the file name without folder and extension.
    pub name: String,
    /// Meshes, each in its own space.
    pub meshes: Vec<Mesh>,
    /// Where meshes stand in the world.
    pub nodes: Vec<Node>,
    /// Materials; never empty if there is a triangle.
    pub materials: Vec<Material>,
    /// Images that materials name.
    pub textures: Vec<Texture>,
    /// Lights without a surface.
    pub lights: Vec<Light>,
    /// Radiance that arrives from everywhere outside the scene, linear RGB \[W/(m² sr)\].
    pub sky: Option<Vec3>,
    /// Radiance from outside that differs from direction to direction; adds to `sky`.
    pub sky_image: Option<SkyImage>,
    /// The camera the scene or its lights file names.
    pub camera: Option<Camera>,
    /// What the file asks for and this release cannot do.
    pub unsupported: Vec<Unsupported>,
    /// What was assumed, repaired or left out while reading, one sentence each.
    pub warnings: Vec<String>,
}

impl Scene {
    /// Mean radiance from outside over all directions \[W/(m² sr)\]: what is behind everything where a sky has to be one
    /// colour. `None` without a sky.
    #[must_use]
    pub fn mean_sky(&self) -> Option<Vec3> {
        match (self.sky, &self.sky_image) {
            (sky, Some(image)) => Some(sky.unwrap_or(Vec3::ZERO) + image.mean()),
            (sky, None) => sky,
        }
    }
}

/// A mesh placed in the world.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// The name the scene gives it.
    pub name: String,
    /// Index into [`Scene::meshes`].
    pub mesh: u32,
    /// From mesh space to world space \[m\].
    pub transform: DAffine3,
}

/// An effect that a scene asks for and this release does not simulate.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unsupported {
    /// The object, material or file part that asks for it.
    pub object: String,
    /// What it asks for, and what is done instead.
    pub what: String,
}

/// All triangles of a scene in one array, in world space relative to an f64 origin: what baker and renderer
/// work on.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FlatScene {
    /// World position of the local origin \[m\].
    pub origin: DVec3,
    /// Vertex positions relative to `origin` \[m\].
    pub positions: Vec<Vec3>,
    /// Shading normals, unit length, one a vertex; area-weighted face normals where the mesh has none.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, one a vertex; zero where the mesh has none.
    pub uvs: Vec<Vec2>,
    /// Colours as those of [`Mesh`], one a vertex, white where the mesh has none; empty if no mesh has any.
    pub colours: Vec<[u8; 4]>,
    /// Corner indices into `positions`.
    pub triangles: Vec<[u32; 3]>,
    /// Index into [`Scene::materials`], one a triangle.
    pub triangle_materials: Vec<u32>,
    /// First triangle of each node of [`Scene::nodes`], and at the end the triangle count.
    pub node_starts: Vec<u32>,
}
