//! The mesh with its collapse order, as an encoder takes it.

use alloc::vec::Vec;

use super::Replay;
use crate::mesh::Wedges;
use crate::progressive::ProgressiveMesh;

impl Replay {
    /// The mesh with its collapse order, to be written in another way; `None` until all packets are in. The level stays.
    ///
    /// Each error is that of the packet: the file has no others.
    #[must_use]
    pub fn progressive_mesh(&mut self) -> Option<ProgressiveMesh> {
        if self.packets < self.header.packet_count() {
            return None;
        }
        let level = self.level;
        self.walk(self.max_level());
        let wedges = Wedges {
            vertices: (0..self.wedge_count()).map(|wedge| self.vertex_of(wedge)).collect(),
            normals: self.normals.clone(),
            uvs: self.uvs.clone(),
            colours: self.colours.clone(),
        };
        let base = self.base();
        let mut errors = Vec::with_capacity(self.parents.len());
        for entry in &self.header.packets {
            // The coarsest level of a packet has one vertex of it and lacks the next (PMESH-DIR-05).
            let end = entry.vertices.end.saturating_add(1).min(self.max_level());
            errors.resize(end.saturating_sub(base) as usize, entry.error);
        }
        let mesh = ProgressiveMesh {
            origin: self.header.origin,
            positions: self.positions.clone(),
            wedges,
            base_vertices: base,
            collapse: self.parents.clone(),
            wedge_collapse: if self.attributes().seams {
                self.wedge_targets.clone()
            } else {
                self.parents.clone()
            },
            errors,
            faces: self.corners.clone(),
            materials: self.materials.clone(),
            material_names: self.material_names.clone(),
        };
        self.walk(level);
        Some(mesh)
    }
}

#[cfg(test)]
mod tests;
