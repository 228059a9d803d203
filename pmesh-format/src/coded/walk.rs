//! The walk that writer and reader take together (PMESH-COD-06 to -12).

use alloc::vec::Vec;

use super::exact::Exact;
use super::geometry::{Cell, raw};
use super::points::Points;
use super::rans::Coder;
use super::split::Step;
use super::{Changes, Fault, LENGTH, Shape, State};
use crate::code::codes;
use crate::header::PacketEntry;
use crate::lattice::Lattice;
use crate::machine::fetch;
use crate::storage::Positions;

/// Vertices whose parents are found at a time (PMESH-COD-07): a power of two.
const BATCH: usize = 64;

/// How many splits ahead what they need of vertices is fetched; of faces twice as many.
const AHEAD: usize = 3;

/// Vertices of which not all that is known fits into the caches next to a core: some 70 bytes each.
const MANY: usize = 1 << 15;

/// What a writer knows; the reader's knows nothing, and nobody looks at what it says.
pub(super) trait Source: Copy {
    /// Whether it is a writer's.
    const KNOWS: bool;
    fn parent(&self, vertex: u32) -> u32;
    /// Whether the slot in that place of the parent's list switches.
    fn switches(&self, vertex: u32, place: u32, count: u32) -> bool;
    /// The faces that a vertex introduces, or those of the base: the parent first; those that have the new vertex third
    /// before those that have it second.
    fn faces(&self, vertex: Option<u32>) -> &[(u32, [u32; 3], usize)];
    fn cell(&self, vertex: u32) -> Cell;
    fn position(&self, vertex: u32) -> [f32; 3];
}

/// The reader's.
#[derive(Clone, Copy)]
pub(super) struct Nothing;

impl Source for Nothing {
    const KNOWS: bool = false;
    fn parent(&self, _: u32) -> u32 {
        0
    }
    fn switches(&self, _: u32, _: u32, _: u32) -> bool {
        false
    }
    fn faces(&self, _: Option<u32>) -> &[(u32, [u32; 3], usize)] {
        &[]
    }
    fn cell(&self, _: u32) -> Cell {
        [0; 3]
    }
    fn position(&self, _: u32) -> [f32; 3] {
        [0.0; 3]
    }
}

/// What bounds a packet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    /// The greatest lattice coordinates.
    pub(super) top: [u32; 3],
    /// Where positions are binary32 numbers: what they are in their cells.
    pub(super) exact: Option<Exact>,
    /// Bytes of the payload; of no effect for the writer.
    pub(super) bytes: u64,
}

impl Bounds {
    /// For positions in that box, stored that way.
    pub(super) fn new(bounds: [[f32; 3]; 2], positions: Positions, bytes: u64) -> Self {
        match positions.bits() {
            Some(bits) => Self { top: Lattice::new(bounds, bits).top(), exact: None, bytes },
            None => {
                let exact = Exact::new(bounds);
                Self { top: exact.top(), exact: Some(exact), bytes }
            }
        }
    }

    /// The cell of a position.
    pub(super) fn cells(bounds: [[f32; 3]; 2], positions: Positions, all: &[[f32; 3]]) -> Vec<Cell> {
        if let Some(bits) = positions.bits() {
            let lattice = Lattice::new(bounds, bits);
            return all.iter().map(|&p| lattice.nearest(p).map(|x| x as i32)).collect();
        }
        let exact = Exact::new(bounds);
        all.iter().map(|&p| exact.cell(p)).collect()
    }
}

impl State {
    /// Codes a packet; what it has changed stands in `changes`, also after an error.
    pub(super) fn packet<C: Coder, S: Source>(
        &mut self,
        coder: &mut C,
        source: &S,
        extent: &PacketEntry,
        bounds: Bounds,
        changes: &mut Changes,
    ) -> Result<(), Fault> {
        let end = extent.vertices.end;
        self.points.reserve(extent.vertices.len(), usize::MAX, bounds.top);
        self.histories.reserve(extent.vertices.len());
        let splits = extent.vertices.len();
        changes.shapes.reserve(splits);
        if changes.recorded {
            changes.counts.reserve(splits);
            changes.masks.reserve(splits);
            changes.introduced.reserve(extent.faces.len());
        }
        self.slots.resize(end as usize, usize::MAX);
        if extent.vertices.start < self.base {
            self.code_base(coder, source, extent, bounds, changes)?;
        }
        let mut place = (0, 0);
        let mut vertex = extent.vertices.start.max(self.base);
        let mut parents = [0u32; BATCH];
        while vertex < end {
            // The parents of several vertices, then these.
            let most = BATCH.min((end - vertex) as usize);
            let found = self.code_parents(coder, source, vertex, &mut place, &mut parents[..most]);
            if found == 0 {
                return Err((codes::PARENT, 0));
            }
            // Few vertices are near anyway.
            let fetched = if end as usize >= MANY { &parents[..found] } else { &[] };
            fetched.iter().take(2 * AHEAD).for_each(|&parent| self.fetch_faces(parent));
            fetched.iter().take(AHEAD).for_each(|&parent| self.fetch_neighbours(parent));
            for (k, &parent) in parents[..found].iter().enumerate() {
                if let Some(&later) = fetched.get(k + 2 * AHEAD) {
                    self.fetch_faces(later);
                }
                if let Some(&later) = fetched.get(k + AHEAD) {
                    self.fetch_neighbours(later);
                }
                let step = Step { source, extent, bounds: &bounds, vertex, parent };
                self.code_split(coder, step, changes)?;
                if coder.failed() {
                    return Err(LENGTH);
                }
                vertex += 1;
            }
        }
        if self.corners.len() as u32 != extent.faces.end {
            return Err((codes::CODED_FACES, 0));
        }
        self.packets += 1;
        Ok(())
    }

    /// Has the corners of the faces at a vertex brought near, where these are few.
    #[inline(always)]
    fn fetch_faces(&self, vertex: u32) {
        for &slot in self.slots.few(vertex) {
            if let Some(corner) = self.corners.as_flattened().get(slot as usize) {
                fetch(corner);
            }
        }
    }

    /// Has what a split of that vertex needs of its neighbours brought near, where these are few.
    #[inline(always)]
    fn fetch_neighbours(&self, vertex: u32) {
        for &slot in self.slots.few(vertex) {
            let next = if slot % 3 == 2 { slot.wrapping_sub(2) } else { slot.wrapping_add(1) };
            if let Some(&neighbour) = self.corners.as_flattened().get(next as usize) {
                self.points.fetch(neighbour);
                self.slots.fetch(neighbour);
            }
        }
    }

    /// Asks whether vertices are split, from one on that has been split so many times, until there are no more before `vertex`
    /// or all `parents` of the vertices from there on are found; how many are.
    #[inline(never)]
    fn code_parents<C: Coder, S: Source>(
        &mut self,
        coder: &mut C,
        source: &S,
        vertex: u32,
        place: &mut (usize, usize),
        parents: &mut [u32],
    ) -> usize {
        // What is in use all the time: no vertex comes meanwhile.
        let (mut inner, (mut parent, mut times)) = (core::mem::take(coder), *place);
        let count = vertex as usize;
        let (points, histories) = (self.points.few(count), &self.histories[..count]);
        let (slots, models) = (&self.slots, &mut self.models.parents);
        let mut found = 0;
        while found < parents.len() && parent < count {
            let history = histories[parent];
            let packets = self.packets - (history >> 1);
            let history = match times {
                0 if history & 1 == 0 => packets.min(3) as usize,
                0 => 4 + usize::from(packets > 1),
                _ => 5 + times,
            };
            let faces = slots.count(parent as u32).clamp(3, 11) - 3;
            let model = (history * 9 + faces) * 16 + Points::scale(points[parent]);
            let splits = S::KNOWS && source.parent(vertex + found as u32) == parent as u32;
            if inner.bit(&mut models[model], splits) {
                parents[found] = parent as u32;
                found += 1;
                times = (times + 1).min(2);
            } else {
                parent += 1;
                times = 0;
            }
        }
        (*coder, *place) = (inner, (parent, times));
        found
    }

    /// The vertices and faces of the base.
    fn code_base<C: Coder, S: Source>(
        &mut self,
        coder: &mut C,
        source: &S,
        extent: &PacketEntry,
        bounds: Bounds,
        changes: &mut Changes,
    ) -> Result<(), Fault> {
        let bits = |top: u32| u32::BITS - top.leading_zeros();
        for vertex in 0..self.base {
            let cell = source.cell(vertex);
            let cell: [u32; 3] = core::array::from_fn(|k| raw(coder, bits(bounds.top[k]), cell[k] as u32));
            if (0..3).any(|k| cell[k] > bounds.top[k]) {
                return Err((codes::POSITION, 0));
            }
            let cell = cell.map(|x| x as i32);
            if let Some(exact) = &bounds.exact {
                let position = exact.code(coder, cell, source.position(vertex));
                changes.positions.push(position.ok_or((codes::POSITION, 0))?);
            }
            self.push_vertex(cell, Shape { history: 2 * self.packets, ..Shape::default() });
            if coder.failed() {
                return Err(LENGTH);
            }
        }
        let faces = source.faces(None);
        let count = raw(coder, 32, faces.len() as u32);
        if count > extent.faces.end {
            return Err((codes::CODED_FACES, 0));
        }
        for k in 0..count as usize {
            let known = faces.get(k).map_or([0; 3], |&(_, corners, _)| corners);
            let corners = known.map(|corner| raw(coder, bits(self.base - 1), corner));
            let [a, b, c] = corners;
            if coder.failed() {
                return Err(LENGTH);
            }
            if corners.iter().any(|&corner| corner >= self.base) {
                return Err((codes::CORNER, 0));
            }
            if a == b || b == c || c == a {
                return Err((codes::FACE_VERTICES, 0));
            }
            self.introduce(corners, changes);
        }
        Ok(())
    }

    #[inline(always)]
    pub(super) fn introduce(&mut self, corners: [u32; 3], changes: &mut Changes) {
        let face = self.corners.len() as u32;
        for (slot, corner) in (3 * face..).zip(corners) {
            self.slots.push(corner, slot);
        }
        self.corners.push(corners);
        if changes.recorded {
            changes.introduced.push(corners);
        }
    }
}
