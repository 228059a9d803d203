//! What a packet has brought, for the mesh that it is read into, and its withdrawal.

use super::*;
use crate::coded::Live;
use crate::room::reserve;

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

    /// Wedges of the corners of the faces.
    pub(in crate::coded) fn corners_mut(&mut self) -> &mut Vec<[u32; 3]> {
        &mut self.corners
    }

    /// Appends to `mesh` what a packet has brought, but for positions, corners and parents.
    pub(in crate::coded) fn append(&self, header: &Header, extent: &PacketEntry, mesh: &mut Live<'_>) {
        let wedges = extent.wedges.start as usize..extent.wedges.end as usize;
        let total = header.wedge_count as usize;
        let Attributes { normals, uvs, colours, materials, seams } = self.plan.attributes;
        if normals {
            reserve(mesh.normals, wedges.len(), total);
            mesh.normals.extend(self.normals[wedges.clone()].iter().map(|&code| self.plan.normal(code)));
        }
        if uvs {
            reserve(mesh.uvs, wedges.len(), total);
            mesh.uvs.extend(self.uvs[wedges.clone()].iter().map(|&point| self.plan.uv(point)));
        }
        if colours {
            reserve(mesh.colours, wedges.len(), total);
            mesh.colours.extend_from_slice(&self.colours[wedges.clone()]);
        }
        if materials {
            reserve(mesh.materials, extent.faces.len(), header.face_count as usize);
            mesh.materials.extend_from_slice(&self.materials[extent.faces.start as usize..]);
        }
        if seams {
            reserve(mesh.wedge_ends, extent.vertices.len(), header.vertex_count as usize);
            mesh.wedge_ends.extend_from_slice(&self.ends[extent.vertices.start as usize..]);
            reserve(mesh.wedge_vertices, wedges.len(), total);
            mesh.wedge_vertices.extend_from_slice(&self.vertices[wedges.clone()]);
            let first = header.base_vertices.max(extent.vertices.start);
            let first = self.ends[first as usize - 1].max(extent.wedges.start) as usize;
            reserve(mesh.wedge_targets, wedges.end - first, total);
            mesh.wedge_targets.extend_from_slice(&self.targets[first..]);
        }
    }
}
