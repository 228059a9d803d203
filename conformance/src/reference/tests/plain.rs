//! A writer of raw packets as plain as the reader: everything from the direct mapping of a mesh.

use crate::vectors::parts::{Parts, bits_for, packed};
use pmesh_format::{Header, IndexedMesh, PacketEntry, ProgressiveMesh};

/// The mesh, whose positions are binary32, at its finest level, and what its wedges become.
pub(super) struct Plain<'a> {
    header: &'a Header,
    mesh: &'a ProgressiveMesh,
    finest: IndexedMesh,
}

impl<'a> Plain<'a> {
    pub(super) fn new(header: &'a Header, mesh: &'a ProgressiveMesh) -> Self {
        Self { header, mesh, finest: mesh.level(header.vertex_count) }
    }

    fn owner(&self, wedge: u32) -> u32 {
        self.finest.wedges.vertices[wedge as usize]
    }

    fn first_wedge(&self, vertex: u32) -> u32 {
        self.finest.wedges.vertices.partition_point(|&owner| owner < vertex) as u32
    }

    fn becomes(&self, wedge: u32) -> u32 {
        self.mesh.wedge_collapse[(wedge - self.first_wedge(self.header.base_vertices)) as usize]
    }

    fn mapped(&self, mut wedge: u32, level: u32) -> u32 {
        while self.owner(wedge) >= level {
            wedge = self.becomes(wedge);
        }
        wedge
    }

    /// The payload of a packet.
    pub(super) fn payload(&self, entry: &PacketEntry) -> Vec<u8> {
        let (header, finest) = (self.header, &self.finest);
        let (start, end) = (entry.vertices.start, entry.vertices.end);
        let wedges = entry.wedges.start as usize..entry.wedges.end as usize;
        let faces = entry.faces.start as usize..entry.faces.end as usize;
        let floats = |numbers: &[f32]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
        let mut arrays = floats(finest.positions[start as usize..end as usize].as_flattened());
        if header.attributes.normals {
            arrays.extend(floats(finest.wedges.normals[wedges.clone()].as_flattened()));
        }
        if header.attributes.uvs {
            arrays.extend(floats(finest.wedges.uvs[wedges.clone()].as_flattened()));
        }
        if header.attributes.colours {
            arrays.extend(finest.wedges.colours[wedges].as_flattened());
        }
        let at = |face: usize, level: u32| finest.triangles[face].map(|wedge| self.mapped(wedge, level));
        let splits = start.max(header.base_vertices)..end;
        let parents = splits.clone().map(|v| self.mesh.collapse[(v - header.base_vertices) as usize]);
        let own = |v: u32| self.first_wedge(v)..self.first_wedge(v + 1);
        let target = |w: u32| self.becomes(w) - self.first_wedge(self.owner(self.becomes(w)));
        let has_seams = header.attributes.seams;
        let mut slots = Vec::new();
        let mut switch_to = Vec::new();
        for slot in 0..3 * entry.faces.start {
            let wedge = |level| at((slot / 3) as usize, level)[(slot % 3) as usize];
            if start > 0 && wedge(start) != wedge(end) {
                slots.push(slot);
                let descend: Vec<u32> =
                    entry.wedges.clone().filter(|&w| self.mapped(w, start) == wedge(start)).collect();
                let number = descend.iter().position(|&w| w == wedge(end)).expect("it descends");
                let width = bits_for(descend.len() as u32);
                switch_to.extend((0..width).map(|bit| number as u32 >> bit & 1));
            }
        }
        let parts = Parts {
            switch_count: slots.len() as u32,
            arrays,
            corners: faces.clone().map(|face| at(face, end)).collect(),
            materials: finest.materials.get(faces).unwrap_or_default().to_vec(),
            parents: parents.collect(),
            parent_bits: bits_for(end),
            wedge_counts: if has_seams {
                (start..end).map(|v| own(v).len() as u32).collect()
            } else {
                vec![]
            },
            wedge_targets: if has_seams { splits.flat_map(own).map(target).collect() } else { vec![] },
            slots,
            of: 3 * entry.faces.start,
            switch_to: packed(&switch_to, 1),
        };
        let payload = parts.payload();
        let mut header = header.clone();
        header.packets[0].clone_from(entry);
        assert_eq!(Parts::read(&header, 0, &payload), parts);
        payload
    }
}
