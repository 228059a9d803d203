//! Raw packets (spec, sections 4 to 7).

use alloc::vec::Vec;
use core::ops::Range;

use super::writer::Writer;
use crate::bits::{Packer, width};
use crate::fano::Shape;
use crate::header::PacketEntry;
use crate::lattice::Lattice;
use crate::lists::{Lists, MOST, Walks};
use crate::packet::write_varint;
use crate::replay::{DEPTHS_A_BYTE, Descendants, Descent};

/// Writes packet after packet.
pub(super) struct RawWriter<'a> {
    writer: &'a Writer<'a>,
    /// Which slots switch to each wedge.
    lists: Vec<Lists>,
    /// Corners of the stored faces, as mapped at the end of the last packet; of those that it has not, as introduced.
    corners: Vec<[u32; 3]>,
    /// What descends from what in the packet at hand.
    descent: Descent,
    /// How many vertices that collapse to try in the next packet at most: twice as many as fitted after one was cut.
    most: u32,
}

/// What a packet says of corners.
struct Switched {
    /// Slots of earlier faces, ascending.
    slots: Vec<u32>,
    /// What they become (PMESH-SWI-06).
    to: Vec<u8>,
    /// The sum of PMESH-SWI-07.
    depths: u64,
}

impl<'a> RawWriter<'a> {
    pub(super) fn new(writer: &'a Writer<'a>) -> Self {
        let corners: Vec<[u32; 3]> = writer.faces.iter().map(|&(_, corners, _)| corners).collect();
        let wedges = writer.first_split_wedge()..writer.mesh.wedges.len() as u32;
        let mut lists = Vec::new();
        Lists::build(wedges, writer, MOST, &mut lists);
        Self { writer, lists, corners, descent: Descent::default(), most: u32::MAX }
    }

    /// The payload of the next packet. One whose corners pass too many wedges (PMESH-SWI-07) is cut in half until they do not.
    pub(super) fn packet(&mut self, entry: &mut PacketEntry) -> Vec<u8> {
        let first = entry.vertices.start.max(self.writer.base());
        let least = entry.vertices.start + 1;
        loop {
            let end = entry.vertices.end.min(first.saturating_add(self.most)).max(least);
            self.writer.end_at(entry, end);
            let switched = self.switch(entry);
            let payload = self.payload(entry, &switched);
            let fits = switched.depths <= DEPTHS_A_BYTE * payload.len() as u64;
            if !fits {
                self.switch_back(entry, &switched.slots);
            }
            self.descent.forget(!fits);
            if fits {
                self.most = self.most.max(1).saturating_mul(2);
                return payload;
            }
            self.most = (end - first) / 2;
        }
    }

    /// The wedges of a packet that become others.
    fn wedges(&self, entry: &PacketEntry) -> Range<u32> {
        entry.wedges.start.max(self.writer.first_split_wedge())..entry.wedges.end
    }

    /// What a wedge becomes.
    fn target(&self, wedge: u32) -> u32 {
        self.writer.mesh.wedge_collapse[(wedge - self.writer.first_split_wedge()) as usize]
    }

    /// Lets the corners of all faces switch to the wedges of a packet.
    fn switch(&mut self, entry: &PacketEntry) -> Switched {
        let wedges = self.wedges(entry);
        let earlier = 3 * entry.faces.start;
        let mut slots = Vec::new();
        for part in &self.lists {
            let all = part.wedges();
            for wedge in wedges.start.max(all.start)..wedges.end.min(all.end) {
                for &slot in part.of(wedge) {
                    self.corners.as_flattened_mut()[slot as usize] = wedge;
                    if slot < earlier {
                        slots.push(slot);
                    }
                }
            }
        }
        slots.sort_unstable();
        slots.dedup();
        let from = (wedges.start - self.writer.first_split_wedge()) as usize;
        let targets = &self.writer.mesh.wedge_collapse[from..from + wedges.len()];
        self.descent.find(wedges.start, targets, !slots.is_empty(), usize::MAX);
        let mut to = Packer::default();
        let mut depths = 0;
        for &slot in &slots {
            let wedge = self.corners.as_flattened()[slot as usize];
            depths += u64::from(self.descent.depth(wedge));
            if let Descendants::Several(group) = self.descent.of(self.descent.root(wedge)) {
                to.push(group.partition_point(|&other| other < wedge) as u32, width(group.len() as u32));
            }
        }
        let new = self.corners[entry.faces.start as usize..entry.faces.end as usize].as_flattened();
        depths += new.iter().map(|&wedge| u64::from(self.descent.depth(wedge))).sum::<u64>();
        Switched { slots, to: to.finish(), depths }
    }

    /// Undoes [`RawWriter::switch`].
    fn switch_back(&mut self, entry: &PacketEntry, slots: &[u32]) {
        for &slot in slots {
            let corner = &mut self.corners.as_flattened_mut()[slot as usize];
            *corner = self.descent.root(*corner);
        }
        let faces = entry.faces.start as usize..entry.faces.end as usize;
        for (corners, (_, introduced, _)) in
            self.corners[faces.clone()].iter_mut().zip(&self.writer.faces[faces])
        {
            *corners = *introduced;
        }
    }

    /// The payload of a packet (PMESH-PKT-02).
    fn payload(&self, entry: &PacketEntry, switched: &Switched) -> Vec<u8> {
        let Writer { mesh, attributes, wedge_starts, .. } = self.writer;
        let vertices = entry.vertices.start as usize..entry.vertices.end as usize;
        let wedges = entry.wedges.start as usize..entry.wedges.end as usize;
        let faces = entry.faces.start as usize..entry.faces.end as usize;
        let base = mesh.base_vertices as usize;
        let splits = vertices.start.max(base) - base..vertices.end - base;
        let mut out = Vec::new();
        out.extend_from_slice(&(switched.slots.len() as u32).to_le_bytes());
        match self.writer.positions.bits() {
            None => floats(&mut out, &mesh.positions[vertices.clone()]),
            Some(bits) => {
                let lattice = Lattice::new(self.writer.bounds, bits);
                points(&mut out, &mesh.positions[vertices.clone()], &lattice);
            }
        }
        if attributes.normals {
            floats(&mut out, &mesh.wedges.normals[wedges.clone()]);
        }
        if attributes.uvs {
            floats(&mut out, &mesh.wedges.uvs[wedges.clone()]);
        }
        if attributes.colours {
            out.extend(mesh.wedges.colours[wedges.clone()].as_flattened());
        }
        for wedge in self.corners[faces.clone()].as_flattened() {
            out.extend_from_slice(&wedge.to_le_bytes());
        }
        if attributes.materials {
            let faces = &self.writer.faces[faces];
            out.extend(faces.iter().flat_map(|&(_, _, i)| mesh.materials[i].to_le_bytes()));
        }
        let mut parents = Packer::default();
        let bits = width(entry.vertices.end);
        mesh.collapse[splits.clone()].iter().for_each(|&parent| parents.push(parent, bits));
        out.extend_from_slice(&parents.finish());
        if attributes.seams {
            for v in vertices {
                write_varint(&mut out, wedge_starts[v + 1] - wedge_starts[v]);
            }
            for v in splits {
                let first_of_parent = wedge_starts[mesh.collapse[v] as usize];
                for wedge in wedge_starts[base + v]..wedge_starts[base + v + 1] {
                    write_varint(&mut out, self.target(wedge) - first_of_parent);
                }
            }
        }
        let shape = Shape::new(switched.slots.len() as u32, 3 * entry.faces.start);
        out.extend_from_slice(&shape.write(&switched.slots));
        out.extend_from_slice(&switched.to);
        out
    }
}

impl Walks for Writer<'_> {
    fn each(&self, mut visit: impl FnMut(u32, u32)) {
        let first = self.first_split_wedge();
        let mut slot = 0;
        for &(level, _, index) in &self.faces {
            // Those that are introduced with the base have no wedge of a later vertex there.
            let floor = self.wedge_starts[level as usize];
            for mut wedge in self.mesh.faces[index] {
                while wedge >= floor {
                    visit(wedge, slot);
                    wedge = self.mesh.wedge_collapse[(wedge - first) as usize];
                }
                slot += 1;
            }
        }
    }
}

fn floats<const N: usize>(out: &mut Vec<u8>, array: &[[f32; N]]) {
    out.reserve(4 * N * array.len());
    for x in array.as_flattened() {
        out.extend_from_slice(&x.to_le_bytes());
    }
}

/// The nearest points of the lattice, four u16 each, the last 0 (PMESH-POS-03).
fn points(out: &mut Vec<u8>, positions: &[[f32; 3]], lattice: &Lattice) {
    for &position in positions {
        // A lattice has at most 16 bits.
        let [x, y, z] = lattice.nearest(position).map(|q| q as u16);
        out.extend([x, y, z, 0].into_iter().flat_map(u16::to_le_bytes));
    }
}

#[cfg(test)]
mod tests;
