//! Coded packets (spec/pmesh.md, section 8): the same things as raw ones, entropy coded.
//!
//! Writer and reader take the same walk over the growing mesh and ask a [`Coder`] for everything that is not known yet: the
//! writer's tells what it is given, the reader's what it finds.

use alloc::boxed::Box;
use alloc::vec::Vec;
use core::ops::Range;

use ivg_wire::Code;

use crate::code::codes;
use crate::header::PacketEntry;

mod attributes;
mod cut;
mod exact;
mod geometry;
mod live;
mod load;
mod models;
mod octahedral;
mod order;
mod points;
mod priors;
mod rans;
mod ring;
mod save;
mod split;
mod walk;
mod wedges;

pub(crate) use attributes::{Given, Plan};
pub(crate) use live::Live;
pub(crate) use order::arranged;
pub(crate) use save::{Known, Saver, cells};

use crate::slots::Slots;
use attributes::{Brought, Wedged};
use cut::Cuts;
use geometry::{Cell, Residuals};
use models::Binary;
use points::{Point, Points};
use rans::Coder;

/// What is wrong with a payload, and at which byte of it.
pub(crate) type Fault = (Code, usize);

/// Slots that are looked at for each byte of a payload, at most (PMESH-COD-12).
const SLOTS_A_BYTE: u64 = 64;

/// The least payload of a coded packet that follows so many vertices (PMESH-COD-12).
pub(crate) fn least_bytes(entry: &PacketEntry) -> u64 {
    let count = |range: &Range<u32>| u64::from(range.end.saturating_sub(range.start));
    8 + (count(&entry.wedges) + count(&entry.faces)) / 4 + u64::from(entry.vertices.start) / 64
}

/// The cell of a point.
#[inline(always)]
fn cell_of([x, y, z, _]: Point) -> Cell {
    [x, y, z]
}

/// What is remembered of a vertex for contexts and changes when it is split (PMESH-COD-05).
#[derive(Clone, Copy, Debug, Default)]
struct Shape {
    /// Octave of its distance from its neighbours.
    scale: u8,
    /// Class of its height above the plane that it was expected in.
    height: u8,
    /// 2 × the packet that brought it, or the last one that split it, + 1 if it has been split.
    history: u32,
}

/// Everything that is learnt.
#[derive(Clone, Debug)]
struct Models {
    /// Whether a vertex is split (once more); by how often it was in this packet, its history, faces and scale.
    parents: [Binary; PARENTS],
    /// Whether a face switches; by what the one before did.
    switches: [Binary; 3],
    /// Whether there is one more new face on this side; by side, how many there are, and whether one is expected.
    faces: [Binary; 2 * 4 * 2],
    /// Whether the third vertex of a new face is the expected one; whether it is a neighbour of the parent.
    thirds: [Binary; 2],
    cuts: Cuts,
    residuals: Residuals,
}

/// Models of parents: of vertices not split in this packet (6 histories), split once, more often; 9 numbers of faces, 16
/// scales.
const PARENTS: usize = 8 * 9 * 16;

impl Models {
    fn new() -> Self {
        let even = Binary::new(1 << 14);
        Self {
            parents: [Binary::new(1 << 13); PARENTS],
            switches: [even; 3],
            faces: core::array::from_fn(|k| {
                Binary::new(if k % 8 == 1 {
                    24_000
                } else if k % 8 == 0 {
                    1 << 14
                } else {
                    4_000
                })
            }),
            thirds: [Binary::new(30_000); 2],
            cuts: Cuts::new(),
            residuals: Residuals::new(),
        }
    }
}

/// What is known after some coded packets: connectivity of the finest level, lattice points, models.
#[derive(Clone, Debug)]
pub(crate) struct State {
    models: Box<Models>,
    packets: u32,
    corners: Vec<[u32; 3]>,
    slots: Slots,
    points: Points,
    /// [`Shape::history`] of each vertex.
    histories: Vec<u32>,
    parents: Vec<u32>,
    /// Faces with each vertex from the base on.
    face_ends: Vec<u32>,
    base: u32,
    /// Where the file has attributes: what is known of wedges.
    wedged: Option<Box<Wedged>>,
}

/// What a packet has changed and brought, for the raw form and for taking it back.
#[derive(Debug, Default)]
struct Changes {
    /// Shapes that were there before, with their vertices.
    shapes: Vec<(u32, Shape)>,
    /// Positions, where they are binary32 numbers.
    positions: Vec<[f32; 3]>,
    /// Whether the next four are kept: for the second pass, where there are attributes.
    recorded: bool,
    /// Faces with their corners as introduced.
    introduced: Vec<[u32; 3]>,
    /// For each vertex from the base on, how many slots its parent had.
    counts: Vec<u32>,
    /// Which of these slots switch, the first of ascending order in bit 0; of parents with few of them.
    masks: Vec<u32>,
    /// The same of parents with many slots, one after the other.
    long: Vec<bool>,
    /// Slots that were looked at.
    looked_at: u64,
    /// What there is of wedges.
    wedges: Brought,
}

impl State {
    /// Before the first packet.
    pub(crate) fn new(base: u32, plan: Option<Plan>) -> Self {
        Self {
            models: Box::new(Models::new()),
            packets: 0,
            corners: Vec::new(),
            slots: Slots::default(),
            points: Points::default(),
            histories: Vec::new(),
            parents: Vec::new(),
            face_ends: Vec::new(),
            base,
            wedged: plan.map(|plan| Box::new(Wedged::new(plan))),
        }
    }

    /// Codes the attributes of a packet whose splits are done.
    fn attributes<C: Coder>(
        &mut self,
        coder: &mut C,
        given: Option<&Given<'_>>,
        extent: &PacketEntry,
        changes: &mut Changes,
    ) -> Result<(), Fault> {
        let Some(mut wedged) = self.wedged.take() else { return Ok(()) };
        let mut brought = core::mem::take(&mut changes.wedges);
        let coded = wedged.packet(coder, given, extent, self, changes, &mut brought);
        changes.wedges = brought;
        self.wedged = Some(wedged);
        coded
    }

    /// Takes back what a packet that begins so has changed, the models excepted.
    fn take_back(&mut self, extent: &PacketEntry, changes: &Changes) {
        if let Some(mut wedged) = self.wedged.take() {
            wedged.take_back(extent, self, &changes.wedges);
            self.wedged = Some(wedged);
        }
        let first = extent.vertices.start.max(self.base);
        for vertex in (first..self.base + self.parents.len() as u32).rev() {
            let split = (vertex - self.base) as usize;
            let before = split.checked_sub(1).map_or(0, |k| self.face_ends[k]);
            let before = before.max(extent.faces.start);
            self.pop_faces(before.min(self.corners.len() as u32));
            let parent = self.parents[split];
            for &slot in self.slots.of(vertex) {
                self.corners.as_flattened_mut()[slot as usize] = parent;
            }
            self.slots.merge(vertex, parent, |_, _| {});
            self.parents.pop();
            self.face_ends.pop();
        }
        self.pop_faces(extent.faces.start);
        for &(vertex, shape) in changes.shapes.iter().rev() {
            self.set_shape(vertex, shape);
        }
        let start = extent.vertices.start as usize;
        self.points.truncate(start);
        self.histories.truncate(start);
        self.slots.resize(start, usize::MAX);
    }

    /// The cell of a vertex.
    #[inline(always)]
    fn cell(&self, vertex: u32) -> Cell {
        cell_of(self.points.get(vertex))
    }

    /// What is remembered of a vertex.
    #[inline(always)]
    fn shape(&self, vertex: u32) -> Shape {
        let [.., packed] = self.points.get(vertex);
        Shape { scale: packed as u8, height: (packed >> 16) as u8, history: self.histories[vertex as usize] }
    }

    #[inline(always)]
    fn set_shape(&mut self, vertex: u32, shape: Shape) {
        self.points.set_shape(vertex, shape);
        self.histories[vertex as usize] = shape.history;
    }

    /// A new vertex.
    #[inline(always)]
    fn push_vertex(&mut self, cell: Cell, shape: Shape) {
        self.points.push(cell, shape);
        self.histories.push(shape.history);
    }

    /// Takes faces away until there are that many.
    fn pop_faces(&mut self, count: u32) {
        while self.corners.len() > count as usize {
            for corner in self.corners.pop().unwrap_or_default() {
                self.slots.pop(corner);
            }
        }
    }
}

const LENGTH: Fault = (codes::CODED_LENGTH, 0);

#[cfg(test)]
mod tests;
