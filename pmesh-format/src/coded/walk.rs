//! The walk that writer and reader take together (PMESH-COD-06 to -12).

use alloc::vec::Vec;

use super::cut::Run;
use super::exact::Exact;
use super::geometry::{Cell, Place, cross, difference, raw, squared};
use super::rans::Coder;
use super::ring::{MOST, Spoke, order};
use super::{Changes, Fault, LENGTH, SLOTS_A_BYTE, Shape, State};
use crate::code::codes;
use crate::header::PacketEntry;
use crate::lattice::Lattice;
use crate::slots::Slots;
use crate::storage::Positions;

/// What a writer knows; the reader's knows nothing, and nobody looks at what it says.
pub(super) trait Source {
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
pub(super) struct Nothing;

impl Source for Nothing {
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
        self.cells.reserve(extent.vertices.len());
        self.shapes.reserve(extent.vertices.len());
        let splits = extent.vertices.len();
        changes.counts.reserve(splits);
        changes.masks.reserve(splits);
        changes.shapes.reserve(splits);
        changes.introduced.reserve(extent.faces.len());
        self.slots.resize(end as usize, usize::MAX);
        if extent.vertices.start < self.base {
            self.code_base(coder, source, extent, bounds, changes)?;
        }
        let (mut parent, mut times) = (0u32, 0usize);
        for vertex in extent.vertices.start.max(self.base)..end {
            loop {
                let model = self.parent_context(parent, times);
                if coder.bit(&mut self.models.parents[model], source.parent(vertex) == parent) {
                    break;
                }
                parent += 1;
                times = 0;
                if parent >= vertex {
                    return Err((codes::PARENT, 0));
                }
            }
            times = (times + 1).min(2);
            self.code_split(coder, source, vertex, parent, extent, bounds, changes)?;
            if coder.failed() {
                return Err(LENGTH);
            }
        }
        if self.corners.len() as u32 != extent.faces.end {
            return Err((codes::CODED_FACES, 0));
        }
        self.packets += 1;
        Ok(())
    }

    /// Which model tells whether a vertex is split (once more).
    #[inline(always)]
    fn parent_context(&self, parent: u32, times: usize) -> usize {
        let Shape { scale, split, packet, .. } = self.shapes[parent as usize];
        let history = match (times, split) {
            (0, false) => (self.packets - packet).min(3) as usize,
            (0, true) => {
                if self.packets - packet > 1 {
                    5
                } else {
                    4
                }
            }
            _ => 5 + times,
        };
        let faces = self.slots.of(parent).len().clamp(3, 11) - 3;
        (history * 9 + faces) * 16 + usize::from(scale)
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
            self.cells.push(cell);
            self.shapes.push(Shape { packet: self.packets, ..Shape::default() });
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
    fn introduce(&mut self, corners: [u32; 3], changes: &mut Changes) {
        let face = self.corners.len() as u32;
        for (slot, corner) in (3 * face..).zip(corners) {
            self.slots.push(corner, slot);
        }
        self.corners.push(corners);
        changes.introduced.push(corners);
    }

    /// A vertex: which slots of its parent switch, which faces come, where it is.
    #[expect(clippy::too_many_arguments, reason = "a step of the walk")]
    fn code_split<C: Coder, S: Source>(
        &mut self,
        coder: &mut C,
        source: &S,
        vertex: u32,
        parent: u32,
        extent: &PacketEntry,
        bounds: Bounds,
        changes: &mut Changes,
    ) -> Result<(), Fault> {
        let list = self.slots.of(parent);
        let count = list.len();
        changes.looked_at += count as u64;
        if changes.looked_at > bounds.bytes.saturating_mul(SLOTS_A_BYTE) {
            return Err((codes::CODED_WORK, 0));
        }
        let mut few = [Spoke::default(); MOST];
        let mut many = Vec::new();
        let spoke = |(place, &slot): (usize, &u32)| {
            let (face, corner) = (slot / 3, slot % 3);
            let corners = self.corners[face as usize];
            let out = corners[if corner == 2 { 0 } else { corner as usize + 1 }];
            let back = corners[if corner == 0 { 2 } else { corner as usize - 1 }];
            Spoke { place: place as u32, out, back }
        };
        let (spokes, round) = if count <= MOST {
            for (to, from) in few.iter_mut().zip(list.iter().enumerate().map(spoke)) {
                *to = from;
            }
            let round = order(&mut few, count);
            (&few[..count], round)
        } else {
            many.extend(list.iter().enumerate().map(spoke));
            (&many[..], false)
        };
        let here = self.cells[parent as usize];
        let switch = |k: usize| source.switches(vertex, spokes[k].place, count as u32);
        let faces = source.faces(Some(vertex));
        let mut neighbours = [[0; 3]; MOST + 2];
        let mut known = 1;
        neighbours[0] = here;
        let mut normal = [0i64; 3];
        let mut heights = u32::from(self.shapes[parent as usize].height);
        let mut moved = 0u64;
        let mut lengths = [0u64; MOST];
        let mut all = 0u64;
        for (length, spoke) in lengths.iter_mut().zip(spokes) {
            *length = squared(difference(self.cells[spoke.out as usize], here));
            all += *length;
        }
        let mut run = None;
        if round {
            let found = (0..count).find(|&k| switch(k) && !switch(if k == 0 { count - 1 } else { k - 1 }));
            let first = found.unwrap_or(0);
            let length = (0..count).filter(|&k| switch(k)).count();
            let given = Run { first, count: length };
            let regular = found.is_some() && is_regular(spokes, given, faces, vertex, parent, switch);
            if coder.bit(&mut self.models.regular, regular) {
                run = Some(self.models.cuts.code(coder, &lengths[..count], given));
            }
        }
        if run.is_some() && self.corners.len() + 2 > extent.faces.end as usize {
            return Err((codes::CODED_FACES, 0));
        }
        let mut inner = 0u64;
        let mut chosen = Vec::new();
        let mut thirds = [Vec::new(), Vec::new()];
        let mut ends = None;
        let mut visit = |neighbour: u32, repeated: bool| {
            let cell = self.cells[neighbour as usize];
            if known < neighbours.len() && !(repeated && neighbours[..known].contains(&cell)) {
                neighbours[known] = cell;
                heights += u32::from(self.shapes[neighbour as usize].height);
                known += 1;
            }
        };
        let mut turn = |spoke: &Spoke| {
            let [a, b] = [spoke.out, spoke.back].map(|v| difference(self.cells[v as usize], here));
            let area = cross(a, b);
            normal.iter_mut().zip(area).for_each(|(sum, x)| *sum += x);
        };
        if let Some(run) = run {
            for step in 0..run.count {
                let k = run.first + step;
                let k = if k >= count { k - count } else { k };
                let spoke = &spokes[k];
                moved |= 1 << spoke.place;
                turn(spoke);
                visit(spoke.out, false);
                inner += if step > 0 { lengths[k] } else { 0 };
                if step + 1 == run.count {
                    visit(spoke.back, false);
                    ends = Some([spokes[run.first].out, spoke.back]);
                }
            }
        } else {
            chosen.resize(count, false);
            let mut before = 0;
            for k in 0..count {
                let switches = coder.bit(&mut self.models.switches[before], switch(k));
                before = 1 + usize::from(switches);
                chosen[spokes[k].place as usize] = switches;
                if switches {
                    turn(&spokes[k]);
                    for neighbour in [spokes[k].out, spokes[k].back] {
                        visit(neighbour, true);
                    }
                }
            }
            let mask = |k: usize| chosen[spokes[k].place as usize];
            let expected = [
                (1..count).find(|&k| mask(k) && !mask(k - 1)).map(|k| spokes[k].out),
                (1..count).find(|&k| !mask(k) && mask(k - 1)).map(|k| spokes[k - 1].back),
            ];
            let fallback = [spokes.first().map_or(0, |s| s.out), spokes.last().map_or(0, |s| s.back)];
            for side in 0..2 {
                let mut given = faces.iter().filter(|face| (face.1[2] == vertex) == (side == 0));
                let mut left = given.clone().count();
                let guess = expected[side].unwrap_or(fallback[side]);
                loop {
                    let so_far = thirds[side].len().min(3);
                    let model = (side * 4 + so_far) * 2 + usize::from(expected[side].is_some());
                    if !coder.bit(&mut self.models.faces[model], left > 0) {
                        break;
                    }
                    left = left.saturating_sub(1);
                    let third = given.next().map_or(0, |face| face.1[1 + side]);
                    let third = self.code_third(coder, spokes, guess, third, vertex, parent)?;
                    thirds[side].push(third);
                    let new = thirds.iter().map(Vec::len).sum::<usize>();
                    if coder.failed() {
                        return Err(LENGTH);
                    }
                    if self.corners.len() + new > extent.faces.end as usize {
                        return Err((codes::CODED_FACES, 0));
                    }
                }
            }
        }
        let place = Place::new(&neighbours[..known], here, normal, heights / known as u32);
        let (cell, height) = place.code(coder, &mut self.models.residuals, source.cell(vertex));
        if (0..3).any(|k| cell[k] < 0 || cell[k] as u32 > bounds.top[k]) {
            return Err((codes::POSITION, 0));
        }
        if let Some(exact) = &bounds.exact {
            let position = exact.code(coder, cell, source.position(vertex));
            changes.positions.push(position.ok_or((codes::POSITION, 0))?);
        }
        changes.counts.push(count as u32);
        // From here on nothing fails.
        if count <= MOST {
            for (place, &switches) in chosen.iter().enumerate() {
                moved |= u64::from(switches) << place;
            }
            changes.masks.push(moved as u32);
        } else {
            changes.long.extend_from_slice(&chosen);
        }
        if count <= Slots::SHORT {
            self.slots.split_short(parent, vertex, moved as u32);
        } else if count <= MOST {
            self.slots.split(parent, vertex, |k| moved >> k & 1 == 1);
        } else {
            self.slots.split(parent, vertex, |k| chosen[k]);
        }
        let corners = self.corners.as_flattened_mut();
        for &slot in self.slots.of(vertex) {
            corners[slot as usize] = vertex;
        }
        if let Some([start, stop]) = ends {
            self.introduce([parent, start, vertex], changes);
            self.introduce([parent, vertex, stop], changes);
        }
        let [starts, stops] = &thirds;
        for &third in starts {
            self.introduce([parent, third, vertex], changes);
        }
        for &third in stops {
            self.introduce([parent, vertex, third], changes);
        }
        self.parents.push(parent);
        self.face_ends.push(self.corners.len() as u32);
        self.cells.push(cell);
        let around: u64 = neighbours[..known].iter().map(|&n| squared(difference(n, cell))).sum();
        let old = self.shapes[parent as usize];
        changes.shapes.push((parent, old));
        let parent_height = (u32::from(height) + u32::from(old.height)) / 2;
        let apart = squared(difference(cell, here));
        let left = (count + 1).saturating_sub(run.map_or(0, |run| run.count - 1)).max(1) as u64;
        self.shapes[parent as usize] = Shape {
            scale: scale((all.min(u64::MAX / 2) + apart - inner) / left),
            height: parent_height as u8,
            split: true,
            packet: self.packets,
        };
        let own = Shape { scale: scale(around / known as u64), height, split: false, packet: self.packets };
        self.shapes.push(own);
        Ok(())
    }

    /// The third vertex of a new face.
    fn code_third<C: Coder>(
        &mut self,
        coder: &mut C,
        spokes: &[Spoke],
        guess: u32,
        third: u32,
        vertex: u32,
        parent: u32,
    ) -> Result<u32, Fault> {
        let possible = |third: u32| third < vertex && third != parent;
        if coder.bit(&mut self.models.thirds[0], third == guess) {
            return if possible(guess) { Ok(guess) } else { Err((codes::FACE_VERTICES, 0)) };
        }
        let at = spokes.iter().position(|s| s.out == third || s.back == third);
        let third = if coder.bit(&mut self.models.thirds[1], at.is_some()) {
            let bits = usize::BITS - spokes.len().leading_zeros();
            let place = raw(coder, bits, at.unwrap_or(0) as u32);
            let Some(&spoke) = spokes.get(place as usize) else { return Err((codes::CORNER, 0)) };
            if coder.raw(1, u32::from(spoke.out != third)) == 1 { spoke.back } else { spoke.out }
        } else {
            raw(coder, u32::BITS - vertex.leading_zeros(), third)
        };
        if third >= vertex {
            return Err((codes::CORNER, 0));
        }
        if possible(third) { Ok(third) } else { Err((codes::FACE_VERTICES, 0)) }
    }
}

/// The octave of a distance from its square, 15 at most.
#[inline(always)]
fn scale(squared: u64) -> u8 {
    ((u64::BITS - squared.leading_zeros()).div_ceil(2)).min(15) as u8
}

/// Whether a run of some but not all faces switches, and one face comes at either end, on the neighbours there.
fn is_regular(
    spokes: &[Spoke],
    run: Run,
    faces: &[(u32, [u32; 3], usize)],
    vertex: u32,
    parent: u32,
    switch: impl Fn(usize) -> bool,
) -> bool {
    let count = spokes.len();
    let last = (run.first + run.count.max(1) - 1) % count;
    let whole = (0..run.count).all(|k| switch((run.first + k) % count));
    let ends = [[parent, spokes[run.first].out, vertex], [parent, vertex, spokes[last].back]];
    run.count > 0 && run.count < count && whole && faces.iter().map(|face| face.1).eq(ends)
}
