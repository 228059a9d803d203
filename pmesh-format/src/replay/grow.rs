//! Growing the connectivity vertex by vertex, at the highest level: what the decoder of coded packets works on.
//!
//! For each vertex *v* of a packet, ascending: its position, its parent (from the base on) and its wedges are appended to the
//! arrays; from the base on [`Replay::split`] adds it; then [`Replay::introduce`] adds the faces of its level, those of the
//! base with the base's last vertex.
#![expect(dead_code, reason = "coded packets are not read yet")]

use alloc::vec::Vec;

use super::Replay;
use crate::packet::code_bits;

impl Replay {
    /// The slots (3 × face + corner) whose corners lie on `vertex`, in canonical order: ascending.
    pub(crate) fn gather(&self, vertex: u32, out: &mut Vec<u32>) {
        out.clear();
        self.slots.visit(vertex, |slot| out.push(slot));
        out.reverse();
    }

    /// Adds `vertex`, the one after the highest level, whose parent is `parent`. `codes` has one entry for each slot of the
    /// parent in canonical order: 0 if it stays, k if its corner switches to the k-th wedge of `vertex`. Faces that `vertex`
    /// introduces follow.
    ///
    /// The caller has checked that each wedge collapses back onto the one that the corner has.
    pub(crate) fn split(&mut self, vertex: u32, parent: u32, codes: &[u32]) {
        let wedges = self.wedges_of(vertex);
        let bits = code_bits(wedges.len() as u32);
        let Self { slots, corners, switches, touched, .. } = self;
        let mut codes = codes.iter().rev();
        let _: Result<(), core::convert::Infallible> = slots.split(parent, vertex, |slot| {
            let code = codes.next().copied().unwrap_or(0);
            if code > 0 {
                corners[(slot / 3) as usize][(slot % 3) as usize] = wedges.start + code - 1;
                touched.push(slot / 3);
            }
            switches.push(code, bits);
            Ok(code > 0)
        });
        self.switch_at = self.switches.len();
        self.face_ends.push(self.corners.len() as u32);
        self.level = vertex + 1;
    }

    /// Adds a face of the level that the last vertex brought, with its corners as mapped there.
    pub(crate) fn introduce(&mut self, corners: [u32; 3], material: u16) {
        let face = self.corners.len() as u32;
        self.corners.push(corners);
        if self.attributes().materials {
            self.materials.push(material);
        }
        self.slots.resize(self.positions.len(), self.corners.len());
        *self.face_ends.last_mut().unwrap_or(&mut self.base_faces) = face + 1;
        self.enter(face);
    }
}
