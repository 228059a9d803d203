//! A mesh with its collapse order: what an encoder is given, and the slow, obvious way to any level.

use alloc::string::String;
use alloc::vec::Vec;

use crate::mesh::{IndexedMesh, Wedges};

/// A mesh whose vertices stand in order of importance, with the vertex that each collapses onto.
///
/// Taking vertex `v` away (from the last down to [`base_vertices`](Self::base_vertices)) moves every corner on it to
/// `collapse[v - base_vertices]`, an earlier vertex; triangles of which two corners then coincide are gone.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ProgressiveMesh {
    /// What must be added to each position \[m\].
    pub origin: [f64; 3],
    /// Vertex positions relative to the origin \[m\], most important first.
    pub positions: Vec<[f32; 3]>,
    /// Wedges, sorted by vertex; every vertex has at least one.
    pub wedges: Wedges,
    /// Number of vertices that nothing collapses: the coarsest level. 0 only if there are no vertices.
    pub base_vertices: u32,
    /// For each vertex from `base_vertices` on, the earlier vertex that it collapses onto.
    pub collapse: Vec<u32>,
    /// For each wedge of a vertex from `base_vertices` on, the wedge of the parent vertex that it becomes.
    pub wedge_collapse: Vec<u32>,
    /// For each vertex from `base_vertices` on, the estimated error of its collapse \[m\] (spec PMESH-DIR-05).
    pub errors: Vec<f32>,
    /// Corners of the faces of the full mesh (wedge indices), in any order.
    pub faces: Vec<[u32; 3]>,
    /// Index of a material, one a face; empty where every face has material 0.
    pub materials: Vec<u16>,
    /// Names of the materials, by index; may be empty.
    pub material_names: Vec<String>,
}

impl ProgressiveMesh {
    /// The full mesh, faces in the order given.
    pub fn full(&self) -> IndexedMesh {
        IndexedMesh {
            origin: self.origin,
            positions: self.positions.clone(),
            wedges: self.wedges.clone(),
            triangles: self.faces.clone(),
            materials: self.materials.clone(),
            material_names: self.material_names.clone(),
        }
    }

    /// Number of wedges of the coarsest level.
    pub fn base_wedges(&self) -> usize {
        self.wedges.vertices.partition_point(|&v| v < self.base_vertices)
    }

    /// Follows `wedge` down to level `level`: the wedge that stands for it there.
    ///
    /// # Panics
    /// If `level` is below [`base_vertices`](Self::base_vertices) or the tables are not valid.
    pub fn map_wedge(&self, wedge: u32, level: u32) -> u32 {
        let base_wedges = self.base_wedges();
        let mut wedge = wedge;
        while self.wedges.vertices[wedge as usize] >= level {
            wedge = self.wedge_collapse[wedge as usize - base_wedges];
        }
        wedge
    }

    /// The smallest level at which `face` exists, and its corners as mapped there (spec PMESH-DEF-05).
    ///
    /// `None` if two of its corners are the same vertex in the full mesh already.
    ///
    /// # Panics
    /// If the tables are not valid.
    pub fn introduction(&self, face: [u32; 3]) -> Option<(u32, [u32; 3])> {
        let base_wedges = self.base_wedges();
        let mut corners = face;
        let mut vertices = corners.map(|w| self.wedges.vertices[w as usize]);
        if vertices[0] == vertices[1] || vertices[1] == vertices[2] || vertices[2] == vertices[0] {
            return None;
        }
        loop {
            let last = if vertices[0] > vertices[1] && vertices[0] > vertices[2] {
                0
            } else if vertices[1] > vertices[2] {
                1
            } else {
                2
            };
            if vertices[last] < self.base_vertices {
                return Some((self.base_vertices, corners));
            }
            let parent = self.collapse[(vertices[last] - self.base_vertices) as usize];
            if vertices.contains(&parent) {
                return Some((vertices[last] + 1, corners));
            }
            corners[last] = self.wedge_collapse[corners[last] as usize - base_wedges];
            vertices[last] = parent;
        }
    }

    /// The faces in the order in which a file stores them: by level of introduction, ties in the order given; each
    /// with that level and its corners as mapped there (spec PMESH-FACE-06).
    ///
    /// # Panics
    /// If the tables are not valid; [`encode`](crate::encode) checks them first.
    pub fn stored_faces(&self) -> Vec<(u32, [u32; 3], usize)> {
        let mut faces: Vec<_> = (0..self.faces.len())
            .filter_map(|i| self.introduction(self.faces[i]).map(|(level, corners)| (level, corners, i)))
            .collect();
        faces.sort_by_key(|&(level, _, _)| level);
        faces
    }

    /// The mesh at `level` vertices by mapping every face of the full mesh through the tables: slow and obvious, the
    /// oracle of [`Replay`](crate::Replay). A coded file has this level where a packet ends; inside packets its splits are
    /// sorted by parent (PMESH-COD-01, -LVL-06).
    ///
    /// # Panics
    /// If `level` is not in `base_vertices..=positions.len()` or the tables are not valid.
    pub fn level(&self, level: u32) -> IndexedMesh {
        assert!(
            level >= self.base_vertices && level as usize <= self.positions.len(),
            "no such level: {level}"
        );
        let wedge_count = self.wedges.vertices.partition_point(|&v| v < level);
        let stored = self.stored_faces();
        let there = stored.iter().take_while(|&&(introduced, _, _)| introduced <= level);
        let materials = &self.materials;
        IndexedMesh {
            origin: self.origin,
            positions: self.positions[..level as usize].to_vec(),
            wedges: self.wedges.prefix(wedge_count),
            triangles: there
                .clone()
                .map(|&(_, _, i)| self.faces[i].map(|w| self.map_wedge(w, level)))
                .collect(),
            materials: there.filter_map(|&(_, _, i)| materials.get(i).copied()).collect(),
            material_names: self.material_names.clone(),
        }
    }
}

impl Wedges {
    /// The first `count` wedges.
    ///
    /// # Panics
    /// If there are fewer.
    pub fn prefix(&self, count: usize) -> Self {
        Self {
            vertices: self.vertices[..count].to_vec(),
            normals: self.normals.iter().take(count).copied().collect(),
            uvs: self.uvs.iter().take(count).copied().collect(),
            colours: self.colours.iter().take(count).copied().collect(),
        }
    }
}
