//! Reading a coded packet: what it says in the form of a raw one.

use alloc::vec::Vec;

use super::rans::Reader;
use super::ring::MOST;
use super::walk::{Bounds, Nothing};
use super::{Changes, Fault, LENGTH, SLOTS_A_BYTE, State, least_bytes};
use crate::bits::Bits;
use crate::code::codes;
use crate::header::{Header, PacketEntry};
use crate::lattice::Lattice;

impl State {
    /// Reads the next packet: the payload of a raw packet that says the same.
    ///
    /// # Errors
    /// The first rule that it breaks; nothing has changed then.
    pub(crate) fn read(
        &mut self,
        header: &Header,
        entry: &PacketEntry,
        payload: &[u8],
    ) -> Result<Vec<u8>, Fault> {
        let (models, packets) = (self.models.clone(), self.packets);
        let attributes = self.wedged.as_ref().map(|wedged| wedged.models());
        let mut changes = Changes::default();
        let read = self.read_packet(header, entry, payload, &mut changes);
        if read.is_err() {
            self.take_back(entry, &changes);
            self.models = models;
            self.packets = packets;
            if let (Some(wedged), Some(models)) = (&mut self.wedged, attributes) {
                wedged.set_models(models);
            }
        }
        read.map(|()| self.raw(entry, &changes))
    }

    pub(super) fn read_packet(
        &mut self,
        header: &Header,
        extent: &PacketEntry,
        payload: &[u8],
        changes: &mut Changes,
    ) -> Result<(), Fault> {
        let bounds = Bounds::new(header.bounds, header.positions, payload.len() as u64);
        let mut reader = Reader::new(payload).ok_or(LENGTH)?;
        self.packet(&mut reader, &Nothing, extent, bounds, changes)?;
        self.attributes(&mut reader, None, extent, changes)?;
        if !reader.at_end() {
            return Err(LENGTH);
        }
        let left = reader.left().count();
        let needed = least_bytes(extent).max(changes.looked_at.div_ceil(SLOTS_A_BYTE));
        // Padding is for what has to be long enough, and for nothing else.
        if left > 0 && payload.len() as u64 > needed {
            return Err((codes::CODED_LENGTH, payload.len() - left));
        }
        if reader.left().any(|byte| byte != 0) {
            return Err((codes::CODED_PADDING, payload.len() - left));
        }
        if !self.are_finite(header, extent) {
            return Err((codes::POSITION, 0));
        }
        Ok(())
    }

    /// Whether the positions of a packet are finite (PMESH-POS-04): in a box near the greatest numbers there are, points beyond
    /// its sides may not be.
    fn are_finite(&self, header: &Header, extent: &PacketEntry) -> bool {
        let Some(bits) = header.positions.bits() else { return true };
        let lattice = Lattice::new(header.bounds, bits);
        let finite = |point: [u32; 3]| lattice.position(point).iter().all(|x| x.is_finite());
        let mut brought = extent.vertices.clone();
        finite(lattice.top()) || brought.all(|vertex| finite(self.cell(vertex).map(|x| x as u32)))
    }

    /// What a packet has brought, as the payload of a raw one (PMESH-PKT-02).
    fn raw(&self, extent: &PacketEntry, changes: &Changes) -> Vec<u8> {
        let vertices = extent.vertices.start as usize..extent.vertices.end as usize;
        let splits = changes.counts.len();
        let mut out = Vec::with_capacity(
            8 * vertices.len() + 12 * changes.introduced.len() + 4 * splits + changes.counts.len() + 8,
        );
        for x in changes.positions.as_flattened() {
            out.extend_from_slice(&x.to_le_bytes());
        }
        let quantised = if changes.positions.is_empty() { extent.vertices.clone() } else { 0..0 };
        for vertex in quantised {
            let [x, y, z] = self.cell(vertex).map(|x| (x as u16).to_le_bytes());
            out.extend_from_slice([x, y, z, [0, 0]].as_flattened());
        }
        let wedged = self.wedged.as_deref();
        if let Some(wedged) = wedged {
            wedged.raw_values(extent, &mut out);
        }
        let introduced = wedged.map_or(&changes.introduced[..], |_| changes.wedges.introduced());
        for corner in introduced.as_flattened() {
            out.extend_from_slice(&corner.to_le_bytes());
        }
        for parent in &self.parents[self.parents.len() - splits..] {
            out.extend_from_slice(&parent.to_le_bytes());
        }
        if let Some(wedged) = wedged {
            wedged.raw_tables(extent, self, &mut out);
            if let Some(switches) = wedged.raw_switches(&changes.wedges) {
                out.extend_from_slice(&switches);
                return out;
            }
        }
        let mut bits = Bits::default();
        let (mut masks, mut long) = (changes.masks.iter(), &changes.long[..]);
        for &count in &changes.counts {
            // Codes stand in descending order of slots (PMESH-SWI-01).
            if count as usize <= MOST {
                let mask = masks.next().map_or(0, |mask| mask.reverse_bits());
                bits.push(u64::from(mask.unbounded_shr(u32::BITS - count)), count);
                continue;
            }
            let (now, later) = long.split_at(count as usize);
            now.iter().rev().for_each(|&switches| bits.push(switches.into(), 1));
            long = later;
        }
        out.extend_from_slice(&bits.to_bytes());
        out
    }
}
