use glam::{DVec3, Vec2, Vec3};

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
    /// Corner indices into `positions`; counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Index into [`Scene::materials`](crate::Scene::materials), one a triangle.
    pub triangle_materials: Vec<u32>,
}
