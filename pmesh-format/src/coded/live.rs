//! Reading a coded packet into a mesh at its finest level: the decoder works on the lists of the mesh itself, so that nothing
//! is there twice and nothing is walked through again.

use alloc::vec::Vec;
use core::mem::swap;

use super::walk::Bounds;
use super::{Changes, Fault, State};
use crate::bits::Bits;
use crate::code::codes;
use crate::header::{Header, PacketEntry};
use crate::lattice::Lattice;
use crate::room::reserve;
use crate::slots::Slots;

/// A mesh at its finest level whose wedges are its vertices and whose faces all have material 0.
pub(crate) struct Live<'a> {
    pub(crate) positions: &'a mut Vec<[f32; 3]>,
    pub(crate) corners: &'a mut Vec<[u32; 3]>,
    pub(crate) slots: &'a mut Slots,
    pub(crate) parents: &'a mut Vec<u32>,
    /// Faces with each vertex from the base on.
    pub(crate) face_ends: &'a mut Vec<u32>,
    pub(crate) base_faces: &'a mut u32,
    /// Switch codes of all vertices from the base on (PMESH-SWI-01).
    pub(crate) switches: &'a mut Bits,
}

impl State {
    /// Reads the next packet into `mesh`, which those before have been read into.
    ///
    /// # Errors
    /// The first rule that it breaks. Positions and switch codes may be longer then; nothing else has changed.
    pub(crate) fn read_live(
        &mut self,
        header: &Header,
        entry: &PacketEntry,
        payload: &[u8],
        mut mesh: Live<'_>,
    ) -> Result<(), Fault> {
        let total = header.vertex_count as usize;
        let (vertices, faces) = (entry.vertices.len(), entry.faces.len());
        let splits = vertices.saturating_sub(self.base.saturating_sub(entry.vertices.start) as usize);
        self.points.reserve(vertices, total, Bounds::new(header.bounds, header.positions, 0).top);
        reserve(&mut self.histories, vertices, total);
        reserve(mesh.corners, faces, header.face_count as usize);
        reserve(mesh.parents, splits, total - self.base as usize);
        reserve(mesh.face_ends, splits, total - self.base as usize);
        mesh.slots.resize(entry.vertices.end as usize, total);
        let (models, packets) = (self.models.clone(), self.packets);
        let mut changes = Changes { live: Some(core::mem::take(mesh.switches)), ..Changes::default() };
        self.exchange(&mut mesh);
        let read = self
            .read_packet(header, entry, payload, &mut changes)
            .and_then(|()| self.append_positions(header, entry, &changes, mesh.positions));
        if read.is_err() {
            self.take_back(entry, &changes);
            self.models = models;
            self.packets = packets;
        }
        self.exchange(&mut mesh);
        *mesh.switches = changes.live.take().unwrap_or_default();
        read?;
        if entry.vertices.start < self.base {
            *mesh.base_faces = changes.base_faces;
        }
        Ok(())
    }

    /// Exchanges what both the decoder and the mesh need.
    fn exchange(&mut self, mesh: &mut Live<'_>) {
        swap(&mut self.corners, mesh.corners);
        swap(&mut self.slots, mesh.slots);
        swap(&mut self.parents, mesh.parents);
        swap(&mut self.face_ends, mesh.face_ends);
    }

    /// Appends the positions of a packet; they must be finite (PMESH-POS-04).
    fn append_positions(
        &self,
        header: &Header,
        entry: &PacketEntry,
        changes: &Changes,
        positions: &mut Vec<[f32; 3]>,
    ) -> Result<(), Fault> {
        reserve(positions, entry.vertices.len(), header.vertex_count as usize);
        let Some(bits) = header.positions.bits() else {
            positions.extend_from_slice(&changes.positions);
            return Ok(());
        };
        let lattice = Lattice::new(header.bounds, bits);
        let start = positions.len();
        positions.extend(
            entry.vertices.clone().map(|vertex| lattice.position(self.cell(vertex).map(|x| x as u32))),
        );
        let finite = positions[start..].iter().fold(true, |all, p| all & p.iter().all(|x| x.is_finite()));
        if finite { Ok(()) } else { Err((codes::POSITION, 0)) }
    }
}
