//! Growing the connectivity vertex by vertex, at the highest level: what the decoder of coded packets works on.
//!
//! For each vertex *v* of a packet, ascending: its position, its parent (from the base on) and its wedges are appended to the
//! arrays; from the base on [`Replay::split`] adds it; then [`Replay::introduce`] adds the faces of its level, those of the
//! base with the base's last vertex.
#![expect(dead_code, reason = "coded packets are not read yet")]

use alloc::vec::Vec;

use super::Replay;
use crate::packet::code_bits;
use crate::slots::Slots;

impl Replay {
    /// The slots (3 × face + corner) whose corners lie on `vertex`, ascending.
    pub(crate) fn slots_of(&self, vertex: u32) -> &[u32] {
        self.slots.of(vertex)
    }

    /// The slots of `vertex`, ascending, copied.
    pub(crate) fn gather(&self, vertex: u32, out: &mut Vec<u32>) {
        out.clear();
        out.extend_from_slice(self.slots.of(vertex));
    }

    /// Adds `vertex`, the one after the highest level, whose parent is `parent`. `codes` has one entry for each slot of the
    /// parent, ascending: 0 if it stays, k if its corner switches to the k-th wedge of `vertex`. Faces that `vertex`
    /// introduces follow.
    ///
    /// The caller has checked that each wedge collapses back onto the one that the corner has.
    pub(crate) fn split(&mut self, vertex: u32, parent: u32, codes: &[u32]) {
        let wedges = self.wedges_of(vertex);
        let bits = code_bits(wedges.len() as u32);
        // Kept in the order of raw packets: descending (PMESH-SWI-01).
        for &code in codes.iter().rev() {
            self.switches.push(code.into(), bits);
        }
        self.switch_at = self.switches.len();
        self.slots.resize(self.positions.len(), self.header.vertex_count as usize);
        let corners = self.corners.as_flattened_mut();
        for (&slot, &code) in self.slots.of(parent).iter().zip(codes).filter(|(_, code)| **code > 0) {
            corners[slot as usize] = wedges.start + code - 1;
            self.touched.mark(slot / 3);
        }
        if codes.len() <= Slots::SHORT {
            let chosen = codes.iter().rev().fold(0, |chosen, &code| chosen << 1 | u32::from(code > 0));
            self.slots.split_short(parent, vertex, chosen);
        } else {
            self.slots.split(parent, vertex, |k| codes[k] > 0);
        }
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
        self.slots.resize(self.positions.len(), self.header.vertex_count as usize);
        self.touched.resize(self.corners.len(), self.header.face_count as usize);
        *self.face_ends.last_mut().unwrap_or(&mut self.base_faces) = face + 1;
        for (corner, wedge) in (0..).zip(corners) {
            let vertex = self.vertex_of(wedge);
            self.slots.push(vertex, 3 * face + corner);
        }
    }
}
