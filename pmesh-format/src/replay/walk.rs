//! From level to level: adding the next vertex, taking the last one away.

use ivg_wire::Code;

use super::Replay;
use crate::code::codes;
use crate::packet::code_bits;
use crate::slots::Slots;

/// What is wrong with the switch codes, and at which bit of all of them.
pub(super) type SwitchFault = (Code, u64);

impl Replay {
    /// Adds and takes away vertices until `level` are there; all of it has arrived and been checked. To level 0 only before
    /// the first packet.
    pub(super) fn walk(&mut self, level: u32) {
        let climbed = self.climb(level);
        debug_assert_eq!(climbed, Ok(()), "switch codes that were checked when the packet came");
        while self.level > level.max(self.base()) {
            self.lower();
        }
        self.level = level;
    }

    /// Adds the next vertices until `level` are there; from the base on.
    ///
    /// # Errors
    /// The first rule that a switch code breaks. The vertices before that of the code are there then.
    pub(super) fn climb(&mut self, level: u32) -> Result<(), SwitchFault> {
        if self.level >= level {
            return Ok(());
        }
        if self.attributes().seams { self.climb_with_seams(level) } else { self.climb_without_seams(level) }
    }

    /// Where wedge and vertex are the same: a code is one bit, and the corner is that on the parent.
    fn climb_without_seams(&mut self, level: u32) -> Result<(), SwitchFault> {
        let base = self.base();
        let mut face = self.face_count();
        let Self { slots, corners, parents, face_ends, switches, touched, .. } = self;
        let corners = corners.as_flattened_mut();
        for vertex in self.level..level {
            let split = (vertex - base) as usize;
            let parent = parents[split];
            let len = slots.of(parent).len();
            let at = self.switch_at;
            self.switch_at += len as u64;
            if self.switch_at > switches.len() {
                self.switch_at = at;
                self.level = vertex;
                return Err((codes::SWITCH_LENGTH, at));
            }
            let mut switch = |slot: u32| {
                corners[slot as usize] = vertex;
                touched.mark(slot / 3);
            };
            // Codes come in descending order of slots.
            if len <= Slots::SHORT {
                let code = switches.get(at, len as u32).reverse_bits();
                let chosen = code.unbounded_shr(u32::BITS - len as u32);
                slots.split_short(parent, vertex, chosen).iter().for_each(|&slot| switch(slot));
            } else {
                slots.split(parent, vertex, |k| switches.get(at + (len - 1 - k) as u64, 1) == 1);
                slots.of(vertex).iter().for_each(|&slot| switch(slot));
            }
            let end = face_ends[split];
            for slot in 3 * face..3 * end {
                slots.push(corners[slot as usize], slot);
            }
            face = end;
        }
        self.level = level;
        Ok(())
    }

    fn climb_with_seams(&mut self, level: u32) -> Result<(), SwitchFault> {
        let mut slots = core::mem::take(&mut self.slots);
        let result = (self.level..level).try_for_each(|vertex| {
            self.raise(vertex, &mut slots)?;
            self.level = vertex + 1;
            for face in self.faces_at(vertex)..self.faces_at(vertex + 1) {
                self.enter(face, &mut slots);
            }
            Ok(())
        });
        self.slots = slots;
        result
    }

    /// Lets the slots of the parent of `vertex` switch; checks all codes first.
    fn raise(&mut self, vertex: u32, slots: &mut Slots) -> Result<(), SwitchFault> {
        let wedges = self.wedges_of(vertex);
        let bits = code_bits(wedges.len() as u32);
        let parent = self.parents[(vertex - self.base()) as usize];
        let list = slots.of(parent);
        let mut at = self.switch_at;
        for &slot in list.iter().rev() {
            if at + u64::from(bits) > self.switches.len() {
                return Err((codes::SWITCH_LENGTH, at));
            }
            let code = self.switches.get(at, bits);
            let present = self.corners.as_flattened()[slot as usize];
            if code > wedges.len() as u32 || (code > 0 && self.target(wedges.start + code - 1) != present) {
                return Err((codes::SWITCH, at));
            }
            at += u64::from(bits);
        }
        let last = at;
        let code_of = |switches: &crate::bits::Bits, k: usize| {
            switches.get(last - (k as u64 + 1) * u64::from(bits), bits)
        };
        let corners = self.corners.as_flattened_mut();
        for (k, &slot) in list.iter().enumerate() {
            let code = code_of(&self.switches, k);
            if code > 0 {
                corners[slot as usize] = wedges.start + code - 1;
                self.touched.mark(slot / 3);
            }
        }
        slots.split(parent, vertex, |k| code_of(&self.switches, k) > 0);
        self.switch_at = at;
        Ok(())
    }

    /// Takes the last vertex away.
    fn lower(&mut self) {
        let vertex = self.level - 1;
        let mut slots = core::mem::take(&mut self.slots);
        for face in (self.faces_at(vertex)..self.faces_at(vertex + 1)).rev() {
            for corner in self.corners[face as usize] {
                slots.pop(self.vertex_of(corner));
            }
        }
        let parent = self.parents[(vertex - self.base()) as usize];
        let bits = code_bits(self.wedges_of(vertex).len() as u32);
        let count = slots.of(vertex).len() + slots.of(parent).len();
        let seams = self.attributes().seams;
        for &slot in slots.of(vertex) {
            let corner = self.corners.as_flattened()[slot as usize];
            self.corners.as_flattened_mut()[slot as usize] = if seams { self.target(corner) } else { parent };
            self.touched.mark(slot / 3);
        }
        slots.merge(vertex, parent, |_, _| {});
        self.slots = slots;
        self.switch_at -= count as u64 * u64::from(bits);
        self.level = vertex;
    }

    /// Puts the slots of a new face into the lists of its vertices.
    pub(super) fn enter(&self, face: u32, slots: &mut Slots) {
        for (corner, wedge) in (0..).zip(self.corners[face as usize]) {
            slots.push(self.vertex_of(wedge), 3 * face + corner);
        }
    }
}
