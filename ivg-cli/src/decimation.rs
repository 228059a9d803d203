//! A scene with fewer faces: its meshes at coarser levels of their progressive meshes.

use glam::DAffine3;
use ivg_scene::{Material, Mesh, Node, Scene};
use pmesh_build::BuildOptions;
use pmesh_format::ProgressiveMesh;

use crate::convert;
use crate::failure::Failure;

/// A scene whose meshes are ordered.
///
/// Faces that emit light stay as they are: with them the power of the lights would change. All others of a mesh are one
/// progressive mesh.
#[derive(Debug)]
pub(crate) struct Decimation<'a> {
    scene: &'a Scene,
    /// One a mesh of the scene.
    meshes: Vec<Ordered>,
}

#[derive(Debug)]
struct Ordered {
    /// The faces that emit light.
    emissive: Mesh,
    progressive: ProgressiveMesh,
    /// For each face the level from which on it is there, ascending.
    introduced: Vec<u32>,
    /// For each level from the coarsest on how far its surface is off \[m in the world\], descending; 0 at the end.
    errors: Vec<f64>,
    /// Nodes that place the mesh.
    instances: usize,
}

/// A scene at a level.
#[derive(Debug)]
pub(crate) struct Level {
    pub(crate) scene: Scene,
    /// Faces of all nodes.
    pub(crate) faces: usize,
    /// The largest estimated error of any mesh \[m\].
    pub(crate) error: f64,
}

impl<'a> Decimation<'a> {
    /// Orders the meshes of a scene that passed its checks. `progress` is told the share done.
    pub(crate) fn new(scene: &'a Scene, progress: &mut dyn FnMut(f32)) -> Result<Self, Failure> {
        let total: usize = scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        let mut before = 0;
        let mut meshes = Vec::with_capacity(scene.meshes.len());
        for (index, mesh) in scene.meshes.iter().enumerate() {
            let placed = scene.nodes.iter().filter(|node| node.mesh as usize == index);
            let transforms: Vec<DAffine3> = placed.map(|node| node.transform).collect();
            let here = mesh.triangles.len();
            meshes.push(Ordered::new(mesh, &scene.materials, &transforms, &mut |done| {
                progress((before as f32 + done * here as f32) / total.max(1) as f32);
            })?);
            before += here;
        }
        Ok(Self { scene, meshes })
    }

    /// The finest levels with at most so many faces together, all meshes off by about the same distance; the coarsest ones
    /// if even those have more.
    pub(crate) fn at_most(&self, faces: usize) -> Level {
        let mut errors: Vec<f64> = self.meshes.iter().flat_map(|mesh| mesh.errors.iter().copied()).collect();
        errors.sort_by(f64::total_cmp);
        errors.dedup();
        let count = |levels: &[u32]| -> usize {
            self.meshes.iter().zip(levels).map(|(mesh, &level)| mesh.instances * mesh.faces(level)).sum()
        };
        let levels_of =
            |error: f64| -> Vec<u32> { self.meshes.iter().map(|mesh| mesh.level_of_error(error)).collect() };
        let enough = errors.partition_point(|&error| count(&levels_of(error)) > faces);
        let chosen = errors.get(enough.min(errors.len().saturating_sub(1))).copied().unwrap_or(0.0);
        let mut levels = levels_of(chosen);
        // Many collapses may cost the same; of these no more are made than needed.
        let finer = match enough.checked_sub(1) {
            Some(below) => levels_of(errors[below]),
            None => self.meshes.iter().map(|mesh| mesh.progressive.positions.len() as u32).collect(),
        };
        for index in 0..levels.len() {
            let mesh = &self.meshes[index];
            let left = faces.saturating_sub(count(&levels));
            let allowed = mesh.faces(levels[index]) + left / mesh.instances.max(1);
            levels[index] =
                mesh.level_of_faces(allowed).clamp(levels[index], finer[index].max(levels[index]));
        }
        self.at(&levels, count(&levels))
    }

    fn at(&self, levels: &[u32], faces: usize) -> Level {
        let mut scene = Scene { meshes: Vec::new(), nodes: Vec::new(), ..self.scene.clone() };
        let mut numbers = Vec::with_capacity(levels.len());
        let mut error = 0.0_f64;
        for (mesh, &level) in self.meshes.iter().zip(levels) {
            let name = mesh.emissive.name.clone();
            let coarse = ivg_stream::scene_mesh(&mesh.progressive.level(level), name, u32::from);
            let first = scene.meshes.len() as u32;
            scene
                .meshes
                .extend([mesh.emissive.clone(), coarse].into_iter().filter(|m| !m.triangles.is_empty()));
            numbers.push(first..scene.meshes.len() as u32);
            error = error.max(mesh.error(level));
        }
        for Node { name, mesh, transform } in &self.scene.nodes {
            let parts = numbers[*mesh as usize].clone();
            scene.nodes.extend(parts.map(|mesh| Node { name: name.clone(), mesh, transform: *transform }));
        }
        Level { scene, faces, error }
    }
}

impl Ordered {
    fn new(
        mesh: &Mesh,
        materials: &[Material],
        transforms: &[DAffine3],
        progress: &mut dyn FnMut(f32),
    ) -> Result<Self, Failure> {
        let emits = |material: u32| materials[material as usize].emission != glam::Vec3::ZERO;
        let part = |emissive: bool| {
            let faces = mesh.triangles.iter().zip(&mesh.triangle_materials);
            let (triangles, triangle_materials) =
                faces.filter(|&(_, &material)| emits(material) == emissive).map(|(t, m)| (*t, *m)).unzip();
            Mesh { triangles, triangle_materials, ..mesh.clone() }
        };
        // A mesh that no node places is not worth an order.
        let rest = if transforms.is_empty() { Mesh::default() } else { part(false) };
        let mut indexed = convert::indexed_mesh(&rest, materials)?;
        // Light is baked with the normals of faces: edges that only shading shows are no seams to keep.
        indexed.wedges.normals.clear();
        indexed.wedges.colours.clear();
        let (progressive, _) = pmesh_build::build(&indexed, &BuildOptions::default(), progress)
            .map_err(|error| Failure::new(format_args!("mesh \"{}\": {error}", mesh.name)))?;
        let introduced = progressive.stored_faces().into_iter().map(|(level, ..)| level).collect();
        // The longest axis: exact for rotations and even scales.
        let axes = transforms.iter().flat_map(|t| [t.matrix3.x_axis, t.matrix3.y_axis, t.matrix3.z_axis]);
        let scale = axes.map(|axis| axis.length()).fold(0.0, f64::max);
        let mut errors = vec![0.0_f64];
        for &error in progressive.errors.iter().rev() {
            errors.push((f64::from(error) * scale).max(errors[errors.len() - 1]));
        }
        errors.reverse();
        Ok(Self { emissive: part(true), progressive, introduced, errors, instances: transforms.len() })
    }

    /// Faces at a level.
    fn faces(&self, level: u32) -> usize {
        self.emissive.triangles.len() + self.introduced.partition_point(|&from| from <= level)
    }

    /// How far a level is off \[m\].
    fn error(&self, level: u32) -> f64 {
        self.errors[(level - self.progressive.base_vertices) as usize]
    }

    /// The coarsest level that is off by at most so much \[m\].
    fn level_of_error(&self, error: f64) -> u32 {
        self.progressive.base_vertices + self.errors.partition_point(|&of| of > error) as u32
    }

    /// The finest level of at most so many faces, or the coarsest.
    fn level_of_faces(&self, faces: usize) -> u32 {
        let coarsest = self.progressive.base_vertices;
        let finest = self.progressive.positions.len() as u32;
        match self.introduced.get(faces.saturating_sub(self.emissive.triangles.len())) {
            Some(&beyond) => (beyond - 1).clamp(coarsest, finest),
            None => finest,
        }
    }
}

#[cfg(test)]
mod tests;
