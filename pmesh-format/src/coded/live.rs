//! Reading a coded packet into a mesh at its finest level: the decoder works on the arrays of the mesh itself, so that nothing
//! is there twice and nothing is walked through again.

use alloc::vec::Vec;
use core::mem::swap;

use super::walk::Bounds;
use super::{Changes, Fault, State};
use crate::code::codes;
use crate::header::{Header, PacketEntry};
use crate::lattice::Lattice;
use crate::room::reserve;

/// A mesh at its finest level.
pub(crate) struct Live<'a> {
    pub(crate) positions: &'a mut Vec<[f32; 3]>,
    pub(crate) normals: &'a mut Vec<[f32; 3]>,
    pub(crate) uvs: &'a mut Vec<[f32; 2]>,
    pub(crate) colours: &'a mut Vec<[u8; 4]>,
    pub(crate) corners: &'a mut Vec<[u32; 3]>,
    pub(crate) materials: &'a mut Vec<u16>,
    pub(crate) parents: &'a mut Vec<u32>,
    /// Where the file has seams: the end of each vertex's wedges, the vertex of each wedge, what each from those of the base on
    /// becomes.
    pub(crate) wedge_ends: &'a mut Vec<u32>,
    pub(crate) wedge_vertices: &'a mut Vec<u32>,
    pub(crate) wedge_targets: &'a mut Vec<u32>,
    /// The slots of earlier faces that a packet switches, in any order.
    pub(crate) switched: &'a mut Vec<u32>,
}

impl State {
    /// Reads the next packet into `mesh`, which those before have been read into.
    ///
    /// # Errors
    /// The first rule that it breaks. Positions may be longer then; nothing else has changed.
    pub(crate) fn read(
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
        reserve(&mut self.face_ends, splits, total - self.base as usize);
        self.slots.resize(entry.vertices.end as usize, total);
        let (models, packets) = (self.models.clone(), self.packets);
        let attributes = self.wedged.as_ref().map(|wedged| wedged.models());
        let mut changes = Changes { recorded: self.wedged.is_some(), ..Changes::default() };
        self.exchange(&mut mesh);
        let read = self
            .read_packet(header, entry, payload, &mut changes)
            .and_then(|()| self.append_positions(header, entry, &changes, mesh.positions));
        if read.is_err() {
            self.take_back(entry, &changes);
            self.models = models;
            self.packets = packets;
            if let (Some(wedged), Some(models)) = (&mut self.wedged, attributes) {
                wedged.set_models(models);
            }
        }
        self.exchange(&mut mesh);
        read?;
        // Corners only ever switch to later vertices: those that have switched are now at vertices of this packet.
        let earlier = 3 * entry.faces.start;
        for vertex in entry.vertices.clone() {
            for &slot in self.slots.of(vertex).iter().take_while(|&&slot| slot < earlier) {
                mesh.switched.push(slot);
            }
        }
        if let Some(wedged) = &self.wedged {
            wedged.append(header, entry, &mut mesh);
        }
        Ok(())
    }

    /// Exchanges what both the decoder and the mesh need.
    fn exchange(&mut self, mesh: &mut Live<'_>) {
        let corners = match &mut self.wedged {
            Some(wedged) => wedged.corners_mut(),
            None => &mut self.corners,
        };
        swap(corners, mesh.corners);
        swap(&mut self.parents, mesh.parents);
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
