//! Levels of detail for a picture: as coarse as its pixels allow.

use glam::{DAffine3, DMat3, DVec3};
use ivg_scene::{Camera, Scene};
use pmesh_format::Header;

use crate::manifest::MeshEntry;

/// From where a scene is looked at, and how exact its meshes must be there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Where the picture is taken from.
    pub camera: Camera,
    /// Rows of the picture \[pixels\].
    pub height: u32,
    /// How far a surface may be from where it belongs \[pixels\]: in the middle of the picture, at the nearest point of the
    /// mesh's bounding box.
    pub pixels: f32,
}

impl View {
    /// How far off a mesh may be in its own space \[m\], wherever the scene has it; infinite where it is nowhere.
    pub(crate) fn error_of(&self, entry: &MeshEntry, header: &Header, scene: &Scene) -> f32 {
        let placed = scene.nodes.iter().filter(|node| node.mesh as usize == entry.mesh);
        let origin = DVec3::from_array(header.origin) - DVec3::from_array(entry.origin);
        let errors = placed.map(|node| self.error_at(&node.transform, origin, header.bounds));
        errors.fold(f64::INFINITY, f64::min) as f32
    }

    /// As [`View::error_of`], of a box with this transform.
    fn error_at(&self, transform: &DAffine3, origin: DVec3, [low, high]: [[f32; 3]; 2]) -> f64 {
        let [low, high] = [low, high].map(|corner| origin + DVec3::from(corner.map(f64::from)));
        let corner = |k: u32| {
            let pick = |axis: u32, low: f64, high: f64| if k >> axis & 1 == 0 { low } else { high };
            let inside = DVec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z));
            transform.transform_point3(inside)
        };
        let (mut least, mut greatest) = (corner(0), corner(0));
        for corner in (1..8).map(corner) {
            least = least.min(corner);
            greatest = greatest.max(corner);
        }
        let nearest = self.camera.eye.clamp(least, greatest);
        let pixel = 2.0 * (0.5 * f64::from(self.camera.vertical_fov)).tan() / f64::from(self.height.max(1));
        f64::from(self.pixels) * pixel * nearest.distance(self.camera.eye) / stretch(&transform.matrix3)
    }
}

/// By how much a matrix lengthens a vector at the most; more than that by a factor of at most √3 where it shears.
///
/// The square of the greatest singular value of A is the greatest eigenvalue of AᵀA, which no row sum of |AᵀA| is below; for
/// rotations with scales along the axes AᵀA is diagonal, and the row sums are the eigenvalues.
fn stretch(matrix: &DMat3) -> f64 {
    let squares = matrix.transpose() * *matrix;
    let sums = [squares.x_axis, squares.y_axis, squares.z_axis].map(|column| column.abs().element_sum());
    sums.into_iter().fold(0.0, f64::max).sqrt()
}

#[cfg(test)]
mod tests;
