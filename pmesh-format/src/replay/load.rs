//! Taking a packet in: every rule is checked, and nothing is kept of a packet that breaks one.

use alloc::vec::Vec;
use core::ops::Range;

use ivg_wire::{Code, Error};

use super::Replay;
use crate::code::codes;
use crate::packet::{Packet, Varints, code_bits, read_bits};
use crate::wire::{
    COLOUR_BYTES, CORNERS_BYTES, MATERIAL_BYTES, PARENT_BYTES, PacketLayout, UV_BYTES, VECTOR_BYTES,
};

/// What is wrong, and at which byte of the payload.
type Fault = (Code, usize);

impl Replay {
    /// Takes in `packet`, which is the next one; the level is the highest. Afterwards it is the highest again.
    pub(super) fn load(&mut self, packet: &Packet<'_>) -> Result<(), Error> {
        let before = self.level;
        self.try_load(packet).map_err(|(code, at)| {
            // Vertices that were added before the fault go again, then everything that was appended.
            self.walk(before);
            self.truncate(packet);
            packet.error(code, at)
        })
    }

    fn try_load(&mut self, packet: &Packet<'_>) -> Result<(), Fault> {
        let payload = packet.payload();
        // The directory was checked for a payload at least as long as its arrays.
        let layout = packet.layout().filter(|layout| layout.rest <= payload.len());
        let layout = layout.ok_or((codes::SWITCH_LENGTH, 0))?;
        self.load_arrays(payload, &layout)?;
        let entry = packet.entry();
        let mut numbers = Varints::new(payload, layout.rest);
        if self.attributes().seams {
            self.load_wedges(&mut numbers, entry.vertices.clone(), entry.wedges.clone())?;
        }
        let face_ends = self.check_faces(&layout, entry.vertices.clone(), entry.faces.clone())?;
        self.slots.resize(self.positions.len(), self.corners.len());
        self.climb(payload, numbers.at, entry.vertices.clone(), entry.faces.start, &face_ends)
    }

    /// Appends positions, attributes, corners, parents and materials.
    fn load_arrays(&mut self, payload: &[u8], layout: &PacketLayout) -> Result<(), Fault> {
        let [low, high] = self.header.bounds;
        let inside = |p: &[f32; 3]| (0..3).all(|k| low[k] <= p[k] && p[k] <= high[k]);
        let finite = |v: &[f32]| v.iter().all(|x| x.is_finite());
        append(&mut self.positions, payload, &layout.positions, VECTOR_BYTES, floats, |p| {
            if inside(p) { Ok(()) } else { Err(codes::POSITION) }
        })?;
        let attribute = |v: &[f32]| if finite(v) { Ok(()) } else { Err(codes::ATTRIBUTE) };
        append(&mut self.normals, payload, &layout.normals, VECTOR_BYTES, floats, |n| attribute(n))?;
        append(&mut self.uvs, payload, &layout.uvs, UV_BYTES, floats, |t| attribute(t))?;
        append(&mut self.colours, payload, &layout.colours, COLOUR_BYTES, bytes, |_| Ok(()))?;
        append(&mut self.corners, payload, &layout.corners, CORNERS_BYTES, indices, |_| Ok(()))?;
        let mut vertex = self.base() + self.parents.len() as u32;
        append(&mut self.parents, payload, &layout.parents, PARENT_BYTES, number, |&parent| {
            vertex += 1;
            if parent < vertex - 1 { Ok(()) } else { Err(codes::PARENT) }
        })?;
        let material = |b: &[u8]| u16::from_le_bytes(bytes(b));
        append(&mut self.materials, payload, &layout.materials, MATERIAL_BYTES, material, |_| Ok(()))
    }

    /// Reads how many wedges each vertex has, then what the wedges become.
    fn load_wedges(
        &mut self,
        numbers: &mut Varints<'_>,
        vertices: Range<u32>,
        wedges: Range<u32>,
    ) -> Result<(), Fault> {
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

    /// Checks the faces of the packet; for each vertex of it, says how many faces there are with it.
    fn check_faces(
        &self,
        layout: &PacketLayout,
        vertices: Range<u32>,
        faces: Range<u32>,
    ) -> Result<Vec<u32>, Fault> {
        let wedges = self.wedges_of(vertices.end - 1).end;
        // Faces of the base count as introduced by its last vertex.
        let first = vertices.start.max(self.base() - 1);
        let mut introduced = first;
        let mut ends = Vec::with_capacity((vertices.end - first) as usize);
        for face in faces.clone() {
            let at = layout.corners.start + (face - faces.start) as usize * CORNERS_BYTES;
            let corners = self.corners[face as usize];
            if corners.iter().any(|&w| w >= wedges) {
                return Err((codes::CORNER, at));
            }
            let [a, b, c] = corners.map(|w| self.vertex_of(w));
            if a == b || b == c || c == a {
                return Err((codes::FACE_VERTICES, at));
            }
            let last = a.max(b).max(c).max(self.base() - 1);
            if last < introduced {
                return Err((codes::FACE_ORDER, at));
            }
            if let Some(split) = last.checked_sub(self.base()) {
                let parent = self.parents[split as usize];
                if ![a, b, c].contains(&parent) {
                    return Err((codes::FACE_LEVEL, at));
                }
            }
            ends.extend((introduced..last).map(|_| face));
            introduced = last;
        }
        ends.extend((introduced..vertices.end).map(|_| faces.end));
        Ok(ends)
    }

    /// Adds the vertices of the packet one by one. `ends`: the end of the faces of each, the base as a whole being one.
    fn climb(
        &mut self,
        payload: &[u8],
        codes_at: usize,
        vertices: Range<u32>,
        first_face: u32,
        ends: &[u32],
    ) -> Result<(), Fault> {
        let mut ends = ends.iter().copied();
        let mut first_split = vertices.start;
        if vertices.start < self.base() {
            self.base_faces = ends.next().unwrap_or(first_face);
            self.level = self.base();
            first_split = self.base();
            for face in 0..self.base_faces {
                self.enter(face);
            }
        }
        let bytes = &payload[codes_at..];
        let mut bit = 0u64;
        let mut undo = Vec::new();
        for (vertex, end) in (first_split..vertices.end).zip(ends) {
            let wedges = self.wedges_of(vertex);
            let bits = code_bits(wedges.len() as u32);
            let parent = self.parents[(vertex - self.base()) as usize];
            let start = self.switches.len();
            undo.clear();
            let mut slots = core::mem::take(&mut self.slots);
            let read = slots.split(parent, vertex, |slot| {
                let code = read_bits(bytes, bit, bits).ok_or((codes::SWITCH_LENGTH, payload.len()))?;
                if code > 0 {
                    let (face, corner) = ((slot / 3) as usize, (slot % 3) as usize);
                    let present = self.corners[face][corner];
                    match wedges.start.checked_add(code - 1).filter(|w| wedges.contains(w)) {
                        Some(wedge) if self.target(wedge) == present => self.corners[face][corner] = wedge,
                        _ => return Err((codes::SWITCH, codes_at + (bit / 8) as usize)),
                    }
                    undo.push((face, corner, present));
                }
                bit += u64::from(bits);
                self.switches.push(code, bits);
                Ok(code > 0)
            });
            self.slots = slots;
            if let Err(fault) = read {
                for &(face, corner, present) in &undo {
                    self.corners[face][corner] = present;
                }
                self.switches.truncate(start);
                return Err(fault);
            }
            self.switch_at = self.switches.len();
            self.touched.extend(undo.iter().map(|&(face, ..)| face as u32));
            self.face_ends.push(end);
            self.introduce_faces();
        }
        let used = bit.div_ceil(8);
        if used != bytes.len() as u64 {
            return Err((codes::SWITCH_LENGTH, codes_at + used as usize));
        }
        if read_bits(bytes, bit, (used * 8 - bit) as u32) != Some(0) {
            return Err((codes::SWITCH_PADDING, codes_at + (bit / 8) as usize));
        }
        Ok(())
    }

    /// Drops everything that `packet` has appended; the level is one that was there before.
    fn truncate(&mut self, packet: &Packet<'_>) {
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
        self.face_ends.truncate(splits);
        if splits == 0 {
            self.wedge_targets.clear();
        } else {
            let base_wedges = self.wedges_of(self.base()).start as usize;
            self.wedge_targets.truncate(wedges - base_wedges);
        }
        if vertices == 0 {
            self.base_faces = 0;
            self.slots = super::Slots::default();
        } else {
            self.slots.resize(vertices, faces);
        }
        self.switches.truncate(self.switch_at);
    }
}

/// Appends the elements of one array of the payload to `to`, each checked.
fn append<T>(
    to: &mut Vec<T>,
    payload: &[u8],
    range: &Range<usize>,
    size: usize,
    read: impl Fn(&[u8]) -> T,
    mut check: impl FnMut(&T) -> Result<(), Code>,
) -> Result<(), Fault> {
    let array = payload.get(range.clone()).unwrap_or(&[]);
    to.reserve(array.len() / size);
    for (k, element) in array.chunks_exact(size).enumerate() {
        let value = read(element);
        check(&value).map_err(|code| (code, range.start + k * size))?;
        to.push(value);
    }
    Ok(())
}

fn bytes<const N: usize>(from: &[u8]) -> [u8; N] {
    let mut array = [0; N];
    array.copy_from_slice(from);
    array
}

fn number(from: &[u8]) -> u32 {
    u32::from_le_bytes(bytes(from))
}

fn floats<const N: usize>(from: &[u8]) -> [f32; N] {
    core::array::from_fn(|k| f32::from_le_bytes(bytes(&from[4 * k..4 * k + 4])))
}

fn indices(from: &[u8]) -> [u32; 3] {
    core::array::from_fn(|k| number(&from[4 * k..4 * k + 4]))
}

#[cfg(test)]
mod tests;
