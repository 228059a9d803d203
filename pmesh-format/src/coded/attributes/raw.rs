//! What a packet has brought as the arrays of a raw one, and its withdrawal.

use super::*;

impl Wedged {
    /// Takes back what a packet that begins so has changed, the models excepted; the splits are still in `state`.
    pub(in crate::coded) fn take_back(&mut self, extent: &PacketEntry, state: &State, brought: &Brought) {
        let first = extent.vertices.start.max(state.base);
        for vertex in (first..self.ends.len() as u32).rev() {
            let split = (vertex - state.base) as usize;
            let before = split.checked_sub(1).map_or(self.base_faces, |k| state.face_ends[k]);
            self.pop_faces(before);
            let parent = state.parents[split];
            for &slot in self.slots.of(vertex) {
                let corner = &mut self.corners.as_flattened_mut()[slot as usize];
                *corner = self.targets[*corner as usize];
            }
            self.slots.merge(vertex, parent, |_, _| {});
            self.ends.pop();
        }
        self.pop_faces(extent.faces.start);
        for &(wedge, classes) in brought.classes.iter().rev() {
            self.classes[wedge as usize] = classes;
        }
        let (start, wedges) = (extent.vertices.start as usize, extent.wedges.start as usize);
        self.ends.truncate(start);
        self.vertices.truncate(wedges);
        self.targets.truncate(wedges);
        self.classes.truncate(wedges);
        self.normals.truncate(wedges);
        self.uvs.truncate(wedges);
        self.colours.truncate(wedges);
        self.materials.truncate(extent.faces.start as usize);
        self.slots.resize(start, usize::MAX);
    }

    /// Takes faces away until there are that many.
    fn pop_faces(&mut self, count: u32) {
        while self.corners.len() > count as usize {
            for corner in self.corners.pop().unwrap_or_default() {
                self.slots.pop(self.vertices[corner as usize]);
            }
        }
    }

    /// Values of the wedges of a packet as a raw one has them (PMESH-PKT-02).
    pub(in crate::coded) fn raw_values(&self, extent: &PacketEntry, out: &mut Vec<u8>) {
        let wedges = extent.wedges.start as usize..extent.wedges.end as usize;
        let Attributes { normals, uvs, colours, .. } = self.plan.attributes;
        if normals {
            for &code in &self.normals[wedges.clone()] {
                out.extend(self.plan.normal(code).into_iter().flat_map(f32::to_le_bytes));
            }
        }
        if uvs {
            for &point in &self.uvs[wedges.clone()] {
                out.extend(self.plan.uv(point).into_iter().flat_map(f32::to_le_bytes));
            }
        }
        if colours {
            out.extend_from_slice(self.colours[wedges].as_flattened());
        }
    }

    /// Materials, wedge counts and wedge targets of a packet as a raw one has them.
    pub(in crate::coded) fn raw_tables(&self, extent: &PacketEntry, state: &State, out: &mut Vec<u8>) {
        let Attributes { materials, seams, .. } = self.plan.attributes;
        if materials {
            let faces = extent.faces.start as usize..extent.faces.end as usize;
            out.extend(self.materials[faces].iter().flat_map(|material| material.to_le_bytes()));
        }
        if seams {
            for vertex in extent.vertices.clone() {
                write_varint(out, self.wedges_of(vertex).len() as u32);
            }
            for vertex in extent.vertices.start.max(state.base)..extent.vertices.end {
                let first = self.wedges_of(state.parents[(vertex - state.base) as usize]).start;
                for wedge in self.wedges_of(vertex) {
                    write_varint(out, self.targets[wedge as usize] - first);
                }
            }
        }
    }

    /// Switch codes of a packet with seams, as a raw one has them.
    pub(in crate::coded) fn raw_switches(&self, brought: &Brought) -> Option<Vec<u8>> {
        self.plan.attributes.seams.then(|| brought.switches.to_bytes())
    }
}
