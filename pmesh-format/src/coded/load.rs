//! Reading a coded packet.

use super::rans::{Coder, Reader};
use super::walk::{Bounds, Nothing};
use super::{Changes, Fault, LENGTH, SLOTS_A_BYTE, State, least_bytes};
use crate::code::codes;
use crate::header::{Header, PacketEntry};
use crate::lattice::Lattice;

impl State {
    /// Reads the symbols of a packet and what must be behind them; what it has changed stands in `changes`, also after an error.
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
        if reader.failed() || !reader.at_end() {
            return Err(LENGTH);
        }
        let needed = least_bytes(extent).max(changes.looked_at.div_ceil(SLOTS_A_BYTE));
        let (at, mut left) = reader.left();
        // Padding is for what has to be long enough, and for nothing else.
        if reader.count_left() > 0 && payload.len() as u64 > needed {
            return Err((codes::CODED_LENGTH, at));
        }
        if left.any(|byte| byte != 0) {
            return Err((codes::CODED_PADDING, at));
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
}
