//! Writing coded packets.

use alloc::vec::Vec;

use super::geometry::Cell;
use super::rans::Writer;
use super::walk::{Bounds, Source};
use super::{Changes, Given, Plan, SLOTS_A_BYTE, State, least_bytes};
use crate::header::PacketEntry;
use crate::progressive::ProgressiveMesh;
use crate::storage::Positions;

/// What is written: an arranged mesh with its faces in stored order.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Known<'a> {
    pub(crate) mesh: &'a ProgressiveMesh,
    /// Level of introduction, vertices as mapped there, and index in the mesh of each face.
    pub(crate) faces: &'a [(u32, [u32; 3], usize)],
    /// Switch codes of all vertices, each in descending order of slots, and where those of each lie.
    pub(crate) switches: (&'a [u32], &'a [(usize, usize)]),
    pub(crate) cells: &'a [Cell],
    /// Where there are attributes: what is known of wedges, and how it is stored.
    pub(crate) wedges: Option<(Plan, Given<'a>)>,
}

/// Writes packet after packet.
#[derive(Clone, Debug)]
pub(crate) struct Saver<'a> {
    state: State,
    known: Known<'a>,
    bounds: Bounds,
}

/// The cells of positions in a box.
pub(crate) fn cells(bounds: [[f32; 3]; 2], positions: Positions, all: &[[f32; 3]]) -> Vec<Cell> {
    Bounds::cells(bounds, positions, all)
}

impl<'a> Saver<'a> {
    /// Of positions in that box, stored that way.
    pub(crate) fn new(known: Known<'a>, bounds: [[f32; 3]; 2], positions: Positions) -> Self {
        let bounds = Bounds::new(bounds, positions, u64::MAX);
        Self {
            state: State::new(known.mesh.base_vertices, known.wedges.map(|(plan, _)| plan)),
            known,
            bounds,
        }
    }

    /// The payload of the next packet.
    pub(crate) fn packet(&mut self, extent: &PacketEntry) -> Vec<u8> {
        let mut coder = Writer::default();
        let mut changes = Changes { recorded: self.known.wedges.is_some(), ..Changes::default() };
        let coded = self.state.packet(&mut coder, &self.known, extent, self.bounds, &mut changes);
        let given = self.known.wedges.as_ref().map(|(_, given)| given);
        let coded = coded.and_then(|()| self.state.attributes(&mut coder, given, extent, &mut changes));
        debug_assert_eq!(coded, Ok(()), "a mesh that was checked");
        coder.finish(least_bytes(extent).max(changes.looked_at.div_ceil(SLOTS_A_BYTE)) as usize)
    }
}

impl Source for Known<'_> {
    const KNOWS: bool = true;

    fn parent(&self, vertex: u32) -> u32 {
        self.mesh.collapse[(vertex - self.mesh.base_vertices) as usize]
    }

    fn switches(&self, vertex: u32, place: u32, _: u32) -> bool {
        let (start, end) = self.switches.1[(vertex - self.mesh.base_vertices) as usize];
        self.switches.0[start..end][end - start - 1 - place as usize] > 0
    }

    fn faces(&self, vertex: Option<u32>) -> &[(u32, [u32; 3], usize)] {
        let level = vertex.map_or(self.mesh.base_vertices, |vertex| vertex + 1);
        let start = self.faces.partition_point(|face| face.0 < level);
        let end = start + self.faces[start..].partition_point(|face| face.0 == level);
        &self.faces[start..end]
    }

    fn cell(&self, vertex: u32) -> Cell {
        self.cells[vertex as usize]
    }

    fn position(&self, vertex: u32) -> [f32; 3] {
        self.mesh.positions[vertex as usize]
    }
}
