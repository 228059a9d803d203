//! Taking a packet in: every rule is checked, and nothing is kept of a packet that breaks one.

use alloc::boxed::Box;
use alloc::vec::Vec;
use core::ops::Range;

use ivg_wire::{Code, Error};
use zerocopy::FromBytes;
use zerocopy::little_endian::{U16, U32};

use super::Replay;
use crate::attributes::Attributes;
use crate::code::codes;
use crate::coded::{Live, Plan, State};
use crate::lattice::Lattice;
use crate::packet::{Packet, Varints};
use crate::room::reserve;
use crate::storage::Mode;
use crate::wire::{CORNERS_BYTES, PARENT_BYTES, PacketLayout, QUANTISED_BYTES, UV_BYTES, VECTOR_BYTES};

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
        if self.header.mode == Mode::Raw {
            return self.load_payload(packet, packet.payload());
        }
        if self.attributes() == Attributes::default() {
            return self.load_live(packet);
        }
        let new = || Box::new(State::new(self.header.base_vertices, Plan::new(&self.header)));
        let mut coded = self.coded.take().unwrap_or_else(new);
        let read = coded.read(&self.header, packet.entry(), packet.payload());
        self.coded = Some(coded);
        self.load_payload(packet, &read?)
    }

    /// Takes in a coded packet of a mesh without attributes.
    fn load_live(&mut self, packet: &Packet<'_>) -> Result<(), Fault> {
        let entry = packet.entry();
        let base = self.base();
        let mut coded = self.coded.take().unwrap_or_else(|| Box::new(State::new(base, None)));
        let live = Live {
            positions: &mut self.positions,
            corners: &mut self.corners,
            slots: &mut self.slots,
            parents: &mut self.parents,
            face_ends: &mut self.face_ends,
            base_faces: &mut self.base_faces,
            switches: &mut self.switches,
        };
        let read = coded.read_live(&self.header, entry, packet.payload(), live);
        // Nobody asks for what has been learnt when all has arrived.
        if read.is_err() || entry.vertices.end < self.header.vertex_count {
            self.coded = Some(coded);
        }
        read?;
        self.level = entry.vertices.end;
        self.switch_at = self.switches.len();
        self.touched.resize(self.corners.len(), self.header.face_count as usize);
        // Corners only ever switch to later vertices: those that have switched are now at vertices of this packet.
        for vertex in entry.vertices.clone() {
            for face in self.slots.of(vertex).iter().map(|slot| slot / 3).filter(|&f| f < entry.faces.start) {
                self.touched.mark(face);
            }
        }
        Ok(())
    }

    /// Takes in what a packet says, in the form of a raw one.
    fn load_payload(&mut self, packet: &Packet<'_>, payload: &[u8]) -> Result<(), Fault> {
        // The directory was checked for a payload at least as long as its arrays.
        let layout = self.header.layout(packet.entry()).filter(|layout| layout.rest <= payload.len());
        let layout = layout.ok_or((codes::SWITCH_LENGTH, 0))?;
        self.load_arrays(payload, &layout)?;
        let entry = packet.entry();
        let mut numbers = Varints::new(payload, layout.rest);
        if self.attributes().seams {
            self.load_wedges(&mut numbers, entry.vertices.clone(), entry.wedges.clone())?;
        }
        self.load_faces(&layout, entry.vertices.clone(), entry.faces.clone())?;
        self.slots.resize(self.positions.len(), self.header.vertex_count as usize);
        self.touched.resize(self.corners.len(), self.header.face_count as usize);
        self.load_codes(payload, numbers.at, entry.vertices.end)
    }

    /// Appends positions, attributes, corners, parents and materials.
    fn load_arrays(&mut self, payload: &[u8], layout: &PacketLayout) -> Result<(), Fault> {
        let part = |range: &Range<usize>| payload.get(range.clone()).unwrap_or(&[]);
        let vertices = self.positions.len();
        let total = self.header.vertex_count as usize;
        match self.header.positions.bits() {
            None => {
                append(&mut self.positions, elements(part(&layout.positions)), total, floats);
                let [low, high] = self.header.bounds;
                let inside = |p: &[f32; 3]| (0..3).all(|k| (low[k] <= p[k]) & (p[k] <= high[k]));
                check(&self.positions[vertices..], inside)
                    .map_err(|k| (codes::POSITION, layout.positions.start + k * VECTOR_BYTES))?;
            }
            Some(bits) => {
                let lattice = Lattice::new(self.header.bounds, bits);
                let points: &[[U16; 4]] = elements(part(&layout.positions));
                let top = lattice.top();
                let inside =
                    |p: &[U16; 4]| (0..3).all(|k| u32::from(p[k].get()) <= top[k]) & (p[3].get() == 0);
                check(points, inside)
                    .map_err(|k| (codes::POSITION, layout.positions.start + k * QUANTISED_BYTES))?;
                let position = |[x, y, z, _]: [U16; 4]| lattice.position([x, y, z].map(|q| q.get().into()));
                append(&mut self.positions, points, total, position);
                check(&self.positions[vertices..], |p| p.iter().all(|x| x.is_finite()))
                    .map_err(|k| (codes::POSITION, layout.positions.start + k * QUANTISED_BYTES))?;
            }
        }
        let wedges = self.header.wedge_count as usize;
        let (normals, uvs) = (self.normals.len(), self.uvs.len());
        append(&mut self.normals, elements(part(&layout.normals)), wedges, floats);
        check(&self.normals[normals..], |n| n.iter().all(|x| x.is_finite()))
            .map_err(|k| (codes::ATTRIBUTE, layout.normals.start + k * VECTOR_BYTES))?;
        append(&mut self.uvs, elements(part(&layout.uvs)), wedges, floats);
        check(&self.uvs[uvs..], |t| t.iter().all(|x| x.is_finite()))
            .map_err(|k| (codes::ATTRIBUTE, layout.uvs.start + k * UV_BYTES))?;
        append(&mut self.colours, elements(part(&layout.colours)), wedges, |colour: [u8; 4]| colour);
        let faces = self.header.face_count as usize;
        append(&mut self.corners, elements(part(&layout.corners)), faces, |face: [U32; 3]| {
            face.map(U32::get)
        });
        let splits = self.parents.len();
        let base = self.base();
        let first = base + splits as u32;
        append(&mut self.parents, elements(part(&layout.parents)), total - base as usize, U32::get);
        let earlier = (first..).zip(&self.parents[splits..]);
        if !earlier.clone().fold(true, |good, (vertex, &parent)| good & (parent < vertex)) {
            let k = earlier.take_while(|&(vertex, &parent)| parent < vertex).count();
            return Err((codes::PARENT, layout.parents.start + k * PARENT_BYTES));
        }
        append(&mut self.materials, elements(part(&layout.materials)), faces, U16::get);
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

    /// Checks the faces of the packet and notes how many faces there are with each vertex.
    fn load_faces(
        &mut self,
        layout: &PacketLayout,
        vertices: Range<u32>,
        faces: Range<u32>,
    ) -> Result<(), Fault> {
        let wedges = self.wedges_of(vertices.end - 1).end;
        // Faces of the base count as introduced by its last vertex.
        let first = vertices.start.max(self.base() - 1);
        let mut ends = alloc::vec![0; (vertices.end - first) as usize];
        let new = &self.corners[faces.start as usize..];
        let named = new.as_flattened().iter().fold(0, |most, &w| most.max(w)) < wedges || new.is_empty();
        let good = named
            && if self.attributes().seams {
                self.note_faces(faces.start, first, &mut ends, |w| self.wedge_vertices[w as usize])
            } else {
                self.note_faces(faces.start, first, &mut ends, |w| w)
            };
        if !good {
            return Err(self.fault_of_faces(layout, wedges, first, faces));
        }
        let mut end = faces.start;
        for entry in &mut ends {
            end = end.max(*entry);
            *entry = end;
        }
        let mut ends = &ends[..];
        if let (true, Some((&base, rest))) = (vertices.start < self.base(), ends.split_first()) {
            self.base_faces = base;
            ends = rest;
        }
        let splits = self.header.vertex_count - self.base();
        reserve(&mut self.face_ends, ends.len(), splits as usize);
        self.face_ends.extend_from_slice(ends);
        Ok(())
    }

    /// Writes the end of the faces of each vertex from `first` on that has any into `ends`; whether all faces from `face` on
    /// are as they should be. Their corners name wedges that are there.
    fn note_faces(&self, face: u32, first: u32, ends: &mut [u32], vertex_of: impl Fn(u32) -> u32) -> bool {
        let base = self.base();
        let mut good = true;
        let mut introduced = first;
        for (corners, end) in self.corners[face as usize..].iter().zip(face + 1..) {
            let [a, b, c] = corners.map(&vertex_of);
            let last = a.max(b).max(c).max(base - 1);
            good &= (a != b) & (b != c) & (c != a) & (last >= introduced);
            introduced = introduced.max(last);
            ends[(introduced - first) as usize] = end;
            // The base's faces have no vertex that collapses: they are compared with a corner of their own.
            let parent = last.checked_sub(base).map_or(a, |split| self.parents[split as usize]);
            good &= (parent == a) | (parent == b) | (parent == c);
        }
        good
    }

    /// The first rule that a face of the packet breaks: PMESH-FACE-04.
    #[cold]
    fn fault_of_faces(&self, layout: &PacketLayout, wedges: u32, first: u32, faces: Range<u32>) -> Fault {
        let mut introduced = first;
        for face in faces.clone() {
            let at = layout.corners.start + (face - faces.start) as usize * CORNERS_BYTES;
            let corners = self.corners[face as usize];
            if corners.iter().any(|&w| w >= wedges) {
                return (codes::CORNER, at);
            }
            let [a, b, c] = corners.map(|w| self.vertex_of(w));
            if a == b || b == c || c == a {
                return (codes::FACE_VERTICES, at);
            }
            let last = a.max(b).max(c).max(self.base() - 1);
            if last < introduced {
                return (codes::FACE_ORDER, at);
            }
            let parent = last.checked_sub(self.base()).map(|split| self.parents[split as usize]);
            if parent.is_some_and(|parent| ![a, b, c].contains(&parent)) {
                return (codes::FACE_LEVEL, at);
            }
            introduced = last;
        }
        debug_assert!(false, "faces {faces:?} were refused for nothing");
        (codes::FACE_LEVEL, layout.corners.start)
    }

    /// Takes the switch codes, which begin at byte `codes_at`, and adds the vertices of the packet up to `end`.
    fn load_codes(&mut self, payload: &[u8], codes_at: usize, end: u32) -> Result<(), Fault> {
        if self.level < self.base() {
            self.level = self.base();
            let mut slots = core::mem::take(&mut self.slots);
            for face in 0..self.base_faces {
                self.enter(face, &mut slots);
            }
            self.slots = slots;
        }
        let bytes = payload.get(codes_at..).unwrap_or(&[]);
        let start = self.switch_at;
        self.switches.append(bytes);
        self.climb(end).map_err(|(code, at)| {
            let missing = code == codes::SWITCH_LENGTH;
            (code, if missing { payload.len() } else { codes_at + ((at - start) / 8) as usize })
        })?;
        let bits = self.switch_at - start;
        let used = bits.div_ceil(8);
        if used != bytes.len() as u64 {
            return Err((codes::SWITCH_LENGTH, codes_at + used as usize));
        }
        if self.switches.get(self.switch_at, (used * 8 - bits) as u32) != 0 {
            return Err((codes::SWITCH_PADDING, codes_at + (bits / 8) as usize));
        }
        self.switches.truncate(self.switch_at);
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
            self.slots.resize(vertices, vertices);
        }
        self.touched.clear();
        self.touched.resize(faces, faces);
        self.switches.truncate(self.switch_at);
    }
}

/// The elements of an array of the payload; the directory was checked for its length.
fn elements<T: FromBytes + zerocopy::Immutable + zerocopy::KnownLayout>(bytes: &[u8]) -> &[T]
where
    [T]: FromBytes + zerocopy::Immutable + zerocopy::KnownLayout<PointerMetadata = usize>,
{
    <[T]>::ref_from_bytes(bytes).unwrap_or(&[])
}

/// Appends `elements`, each read by `read`, to an array that has `total` in the end.
fn append<T: Copy, U>(to: &mut Vec<U>, elements: &[T], total: usize, read: impl Fn(T) -> U) {
    reserve(to, elements.len(), total);
    to.extend(elements.iter().map(|&element| read(element)));
}

fn floats<const N: usize>(from: [zerocopy::little_endian::F32; N]) -> [f32; N] {
    from.map(zerocopy::little_endian::F32::get)
}

/// Checks every element; the index of the first that is not good. Without branches for each: they are good.
fn check<T>(elements: &[T], good: impl Fn(&T) -> bool) -> Result<(), usize> {
    match elements.iter().fold(true, |all, element| all & good(element)) {
        true => Ok(()),
        false => Err(elements.iter().position(|element| !good(element)).unwrap_or(0)),
    }
}

#[cfg(test)]
mod tests;
