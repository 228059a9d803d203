//! Whole files: read at once, and as an encoder takes them.

use alloc::vec::Vec;

use ivg_wire::Error;

use super::Replay;
use crate::decode::{Event, decode_all};
use crate::header::Header;
use crate::limits::Limits;
use crate::mesh::Wedges;
use crate::progressive::ProgressiveMesh;
use crate::storage::Mode;

impl Replay {
    /// Reads a whole file and goes to its finest level, without saying what each packet changes.
    ///
    /// # Errors
    ///
    /// The first rule that the file breaks; truncated if it is valid as far as it goes.
    pub fn from_file(bytes: &[u8], limits: &Limits) -> Result<Self, Error> {
        let mut replay = Self::default();
        decode_all(bytes, limits, |event| match event {
            Event::Packet(packet) => replay.take(&packet),
            Event::Header(header) => {
                replay = Self::new(header);
                if header.file_bytes <= bytes.len() as u64 {
                    replay.reserve_all();
                }
                Ok(())
            }
            other => replay.accept(&other).map(drop),
        })?;
        Ok(replay)
    }

    /// Makes room for all packets. They must be there: the directory was checked for packets as long as what they bring.
    fn reserve_all(&mut self) {
        let Header { vertex_count, wedge_count, face_count, base_vertices, attributes, .. } = self.header;
        let [vertices, wedges, faces] = [vertex_count, wedge_count, face_count].map(|count| count as usize);
        let on = |there: bool, count: usize| if there { count } else { 0 };
        self.positions.reserve_exact(vertices);
        self.normals.reserve_exact(on(attributes.normals, wedges));
        self.uvs.reserve_exact(on(attributes.uvs, wedges));
        self.colours.reserve_exact(on(attributes.colours, wedges));
        self.corners.reserve_exact(faces);
        self.materials.reserve_exact(on(attributes.materials, faces));
        self.parents.reserve_exact(vertices - base_vertices as usize);
        self.wedge_ends.reserve_exact(on(attributes.seams, vertices));
        self.wedge_vertices.reserve_exact(on(attributes.seams, wedges));
        self.wedge_targets.reserve_exact(on(attributes.seams, wedges));
        self.descent.reserve(on(self.header.mode == Mode::Raw, wedges));
    }

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
