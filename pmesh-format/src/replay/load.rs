//! Taking a packet in: every rule is checked, and nothing is kept of a packet that breaks one.

use alloc::boxed::Box;
use core::ops::Range;

use ivg_wire::Code;
use zerocopy::little_endian::U16;

use super::Replay;
use super::arrays::{append, check, elements, inside};
use crate::bits::{bytes_of, is_padded, numbers};
use crate::code::codes;
use crate::coded::{Live, Plan, State};
use crate::lattice::Lattice;
use crate::packet::{Packet, Varints};
use crate::room::reserve;
use crate::storage::Mode;
use crate::wire::{CORNERS_BYTES, PacketLayout, QUANTISED_BYTES, UV_BYTES, VECTOR_BYTES};

/// What is wrong, and at which byte of the payload.
pub(super) type Fault = (Code, usize);

impl Replay {
    /// Appends `packet`, which is the next one, and switches corners of faces that are there; the level is the highest.
    ///
    /// # Errors
    /// The first rule that the packet breaks. The corners of earlier faces are as they were then; something may have been
    /// appended.
    pub(super) fn load(&mut self, packet: &Packet<'_>) -> Result<(), Fault> {
        self.switched.clear();
        match self.header.mode {
            Mode::Raw => self.load_raw(packet),
            Mode::Coded => self.load_coded(packet),
        }
    }

    fn load_coded(&mut self, packet: &Packet<'_>) -> Result<(), Fault> {
        let new = || Box::new(State::new(self.header.base_vertices, Plan::new(&self.header)));
        let mut coded = self.coded.take().unwrap_or_else(new);
        let live = Live {
            positions: &mut self.positions,
            normals: &mut self.normals,
            uvs: &mut self.uvs,
            colours: &mut self.colours,
            corners: &mut self.corners,
            materials: &mut self.materials,
            parents: &mut self.parents,
            wedge_ends: &mut self.wedge_ends,
            wedge_vertices: &mut self.wedge_vertices,
            wedge_targets: &mut self.wedge_targets,
            switched: &mut self.switched,
        };
        let read = coded.read(&self.header, packet.entry(), packet.payload(), live);
        self.coded = Some(coded);
        read
    }

    fn load_raw(&mut self, packet: &Packet<'_>) -> Result<(), Fault> {
        let (payload, entry) = (packet.payload(), packet.entry());
        // The directory was checked for a payload at least as long as this.
        let layout = self.header.layout(entry).filter(|layout| layout.rest <= payload.len());
        let layout = layout.ok_or((codes::PACKET_LENGTH, 0))?;
        self.load_arrays(payload, &layout)?;
        self.load_parents(payload, &layout)?;
        let mut numbers = Varints::new(payload, layout.rest);
        if self.attributes().seams {
            self.load_wedges(&mut numbers, entry.vertices.clone(), entry.wedges.clone())?;
        }
        self.check_faces(layout.corners.start, entry.wedges.end, entry.faces.start)?;
        self.load_switches(payload, numbers.at, entry)
    }

    /// Appends positions, attributes, corners and materials.
    fn load_arrays(&mut self, payload: &[u8], layout: &PacketLayout) -> Result<(), Fault> {
        let part = |range: &Range<usize>| payload.get(range.clone()).unwrap_or(&[]);
        let vertices = self.positions.len();
        let total = self.header.vertex_count as usize;
        let start = layout.positions.start;
        match self.header.positions.bits() {
            None => {
                append(&mut self.positions, part(&layout.positions), total);
                let (new, bounds) = (&self.positions[vertices..], self.header.bounds);
                if !inside(new, bounds) {
                    let first = new.iter().position(|&position| !inside(&[position], bounds));
                    return Err((codes::POSITION, start + first.unwrap_or(0) * VECTOR_BYTES));
                }
            }
            Some(bits) => {
                let lattice = Lattice::new(self.header.bounds, bits);
                let points: &[[U16; 4]] = elements(part(&layout.positions));
                let top = lattice.top();
                let inside =
                    |p: &[U16; 4]| (0..3).all(|k| u32::from(p[k].get()) <= top[k]) & (p[3].get() == 0);
                check(points, inside).map_err(|k| (codes::POSITION, start + k * QUANTISED_BYTES))?;
                reserve(&mut self.positions, points.len(), total);
                let position = |&[x, y, z, _]: &[U16; 4]| lattice.position([x, y, z].map(|q| q.get().into()));
                self.positions.extend(points.iter().map(position));
                check(&self.positions[vertices..], |p| p.iter().all(|x| x.is_finite()))
                    .map_err(|k| (codes::POSITION, start + k * QUANTISED_BYTES))?;
            }
        }
        let wedges = self.header.wedge_count as usize;
        let (normals, uvs) = (self.normals.len(), self.uvs.len());
        append(&mut self.normals, part(&layout.normals), wedges);
        check(&self.normals[normals..], |n| n.iter().all(|x| x.is_finite()))
            .map_err(|k| (codes::ATTRIBUTE, layout.normals.start + k * VECTOR_BYTES))?;
        append(&mut self.uvs, part(&layout.uvs), wedges);
        check(&self.uvs[uvs..], |t| t.iter().all(|x| x.is_finite()))
            .map_err(|k| (codes::ATTRIBUTE, layout.uvs.start + k * UV_BYTES))?;
        append(&mut self.colours, part(&layout.colours), wedges);
        let faces = self.header.face_count as usize;
        append(&mut self.corners, part(&layout.corners), faces);
        append(&mut self.materials, part(&layout.materials), faces);
        Ok(())
    }

    /// Appends the parents (PMESH-COL-01).
    fn load_parents(&mut self, payload: &[u8], layout: &PacketLayout) -> Result<(), Fault> {
        let bytes = payload.get(layout.parents.clone()).unwrap_or(&[]);
        let (base, splits) = (self.base(), self.parents.len());
        let count = self.positions.len() - base as usize - splits;
        reserve(&mut self.parents, count, (self.header.vertex_count - base) as usize);
        self.parents.extend(numbers(bytes, layout.parent_bits).take(count));
        let bits = u64::from(layout.parent_bits);
        let earlier = (base + splits as u32..).zip(&self.parents[splits..]);
        if !earlier.clone().fold(true, |good, (vertex, &parent)| good & (parent < vertex)) {
            let k = earlier.take_while(|&(vertex, &parent)| parent < vertex).count();
            return Err((codes::PARENT, layout.parents.start + (k as u64 * bits / 8) as usize));
        }
        if !is_padded(bytes, count as u64 * bits) {
            return Err((codes::PACKET_PADDING, layout.parents.end - 1));
        }
        debug_assert_eq!(bytes.len(), bytes_of(count as u64 * bits));
        Ok(())
    }

    /// Reads how many wedges each vertex has, then what the wedges become.
    fn load_wedges(
        &mut self,
        numbers: &mut Varints<'_>,
        vertices: Range<u32>,
        wedges: Range<u32>,
    ) -> Result<(), Fault> {
        let total = self.header.wedge_count as usize;
        reserve(&mut self.wedge_ends, vertices.len(), self.header.vertex_count as usize);
        reserve(&mut self.wedge_vertices, wedges.len(), total);
        let mut end = wedges.start;
        for vertex in vertices.clone() {
            let at = numbers.at;
            let count = numbers.read().map_err(|code| (code, at))?;
            if count == 0 || count > wedges.end - end {
                return Err((codes::WEDGE_COUNT, at));
            }
            self.wedge_vertices.resize((end + count) as usize, vertex);
            end += count;
            self.wedge_ends.push(end);
        }
        if end != wedges.end {
            return Err((codes::WEDGE_COUNT, numbers.at));
        }
        reserve(&mut self.wedge_targets, wedges.len(), total);
        for vertex in vertices.start.max(self.base())..vertices.end {
            let parents = self.wedges_of(self.parents[(vertex - self.base()) as usize]);
            for _ in self.wedges_of(vertex) {
                let at = numbers.at;
                let target = numbers.read().map_err(|code| (code, at))?;
                if target >= parents.len() as u32 {
                    return Err((codes::WEDGE_TARGET, at));
                }
                self.wedge_targets.push(parents.start + target);
            }
        }
        Ok(())
    }

    /// Checks the faces from `first` on, which are stored from byte `start` on: their corners are wedges before `wedges`, on
    /// three vertices (PMESH-FACE-01).
    fn check_faces(&self, start: usize, wedges: u32, first: u32) -> Result<(), Fault> {
        let new = &self.corners[first as usize..];
        let arrived = |face: &[u32; 3]| face.iter().all(|&wedge| wedge < wedges);
        let apart = |[a, b, c]: [u32; 3]| (a != b) & (b != c) & (c != a);
        let apart = |face: &[u32; 3]| {
            if self.attributes().seams {
                apart(face.map(|wedge| self.vertex_of(wedge)))
            } else {
                apart(*face)
            }
        };
        // The highest bit is set where a corner is `wedges` or more, which is at most 2³⁰ and, with a vertex there, at least 1.
        let beyond =
            new.as_flattened().iter().fold(0, |any, &wedge| any | wedge | (wedges - 1).wrapping_sub(wedge));
        if beyond >> 31 == 0 && new.iter().fold(true, |all, face| all & apart(face)) {
            return Ok(());
        }
        let wrong = new.iter().position(|face| !(arrived(face) && apart(face))).unwrap_or(0);
        let code = if arrived(&new[wrong]) { codes::FACE_VERTICES } else { codes::CORNER };
        Err((code, start + wrong * CORNERS_BYTES))
    }

    /// Drops everything that `packet` may have appended.
    pub(super) fn truncate(&mut self, packet: &Packet<'_>) {
        let entry = packet.entry();
        let (vertices, wedges) = (entry.vertices.start as usize, entry.wedges.start as usize);
        let faces = entry.faces.start as usize;
        self.positions.truncate(vertices);
        self.normals.truncate(wedges);
        self.uvs.truncate(wedges);
        self.colours.truncate(wedges);
        self.corners.truncate(faces);
        self.materials.truncate(faces);
        self.wedge_ends.truncate(vertices);
        self.wedge_vertices.truncate(wedges);
        let splits = vertices.saturating_sub(self.base() as usize);
        self.parents.truncate(splits);
        let targets = if vertices == 0 { 0 } else { wedges - self.first_split_wedge() as usize };
        self.wedge_targets.truncate(targets);
    }
}

#[cfg(test)]
mod tests;
