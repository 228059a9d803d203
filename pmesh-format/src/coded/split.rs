//! A vertex comes: which faces of its parent it takes, which it brings, where it is (PMESH-COD-08 to -11).

use alloc::vec::Vec;

use super::cut::Run;
use super::geometry::{Cell, Place, apart, cross, difference, divide, raw};
use super::rans::Coder;
use super::ring::{FEW, MOST, Spoke, order, round, search};
use super::walk::{Bounds, Source};
use super::{Changes, Fault, LENGTH, Point, SLOTS_A_BYTE, Shape, State, cell_of};
use crate::code::codes;
use crate::header::PacketEntry;
use crate::slots::Slots;

/// What is given with a step of the walk.
#[derive(Clone, Copy)]
pub(super) struct Step<'a, S> {
    pub(super) source: &'a S,
    pub(super) extent: &'a PacketEntry,
    pub(super) bounds: &'a Bounds,
    pub(super) vertex: u32,
    pub(super) parent: u32,
}

/// Which of the parent's faces switch.
#[derive(Clone, Copy)]
enum Moved<'a> {
    /// A bit for each slot, the first in bit 0; of [`MOST`] at most.
    Mask(u32),
    /// An entry for each slot.
    Long(&'a [bool]),
}

/// The neighbours of a new vertex that are looked at: the parent first.
struct Neighbours<const N: usize> {
    points: [Point; N],
    count: usize,
    sum: Point,
    /// The sum of the normals of the faces that switch.
    normal: [i64; 3],
}

impl<const N: usize> Neighbours<N> {
    #[inline(always)]
    fn new(parent: Point) -> Self {
        let mut points = [[0; 4]; N];
        points[0] = parent;
        Self { points, count: 1, sum: parent, normal: [0; 3] }
    }

    #[inline(always)]
    fn add(&mut self, point: Point) {
        if let Some(to) = self.points.get_mut(self.count) {
            *to = point;
            self.count += 1;
            self.sum.iter_mut().zip(point).for_each(|(sum, x)| *sum += x);
        }
    }

    /// Adds a face, by the edges from the parent.
    #[inline(always)]
    fn turn(&mut self, a: [i64; 3], b: [i64; 3]) {
        self.normal.iter_mut().zip(cross(a, b)).for_each(|(sum, x)| *sum = sum.wrapping_add(x));
    }

    fn known(&self) -> &[Point] {
        &self.points[..self.count.min(N)]
    }
}

impl State {
    /// A vertex: which slots of its parent switch, which faces come, where it is.
    #[inline(always)]
    pub(super) fn code_split<C: Coder, S: Source>(
        &mut self,
        coder: &mut C,
        step: Step<'_, S>,
        changes: &mut Changes,
    ) -> Result<(), Fault> {
        let count = self.slots.count(step.parent);
        changes.looked_at += count as u64;
        if changes.looked_at > step.bounds.bytes.saturating_mul(SLOTS_A_BYTE) {
            return Err((codes::CODED_WORK, 0));
        }
        match count {
            2..=FEW => self.code_few(coder, step, changes, count),
            _ => self.code_many(coder, step, changes),
        }
    }

    /// The vertices that follow another in the face of one of its slots.
    #[inline(always)]
    fn beside(&self, vertex: u32, slot: u32) -> [u32; 2] {
        // Its corners are different, so that there is no need to ask which of them the slot is.
        let [a, b, c] = self.corners.get(slot as usize / 3).copied().unwrap_or_default();
        if a == vertex {
            [b, c]
        } else if b == vertex {
            [c, a]
        } else {
            [a, b]
        }
    }

    /// With so few faces that none of the steps needs to know how many exactly.
    #[inline(always)]
    fn code_few<C: Coder, S: Source>(
        &mut self,
        coder: &mut C,
        step: Step<'_, S>,
        changes: &mut Changes,
        count: usize,
    ) -> Result<(), Fault> {
        // What is left over is of no face; nothing follows it.
        let (mut outs, mut backs) = ([u32::MAX; FEW], [0; FEW]);
        for (k, &slot) in self.slots.few(step.parent).iter().enumerate() {
            let [out, back] = self.beside(step.parent, slot);
            outs[k] = if k < count { out } else { u32::MAX };
            backs[k] = back;
        }
        let Some(order) = round(&outs, &backs, count) else {
            return self.code_many(coder, step, changes);
        };
        let mut ring = [0; FEW];
        for (k, to) in ring.iter_mut().enumerate() {
            let at = if k < count { order[k] } else { order[0] };
            *to = outs[usize::from(at) & (FEW - 1)];
        }
        let place = |k: usize| u32::from(order[k & (FEW - 1)]);
        self.code_ring::<_, _, FEW, { FEW + 2 }>(coder, step, changes, &ring, count, place)
    }

    /// Where faces go round: whether the split is regular, and if so, all of it. `ring`: the out of each face in order, then any
    /// vertex that there is; `M`: the most neighbours; `place`: where the slot of each stands among those of the parent.
    #[inline(always)]
    fn code_ring<C: Coder, S: Source, const N: usize, const M: usize>(
        &mut self,
        coder: &mut C,
        step: Step<'_, S>,
        changes: &mut Changes,
        ring: &[u32; N],
        count: usize,
        place: impl Fn(usize) -> u32,
    ) -> Result<(), Fault> {
        let Step { extent, vertex, parent, .. } = step;
        let from = self.points.get(parent);
        let here = cell_of(from);
        let mut points = [from; N];
        let mut lengths = [0i32; N];
        for k in 0..if N == FEW { N } else { count } {
            points[k] = self.points.get(ring[k]);
            lengths[k] = if k < count { apart(cell_of(points[k]), here) } else { 0 };
        }
        let wrap = |k: usize| if k >= count { k - count } else { k };
        let out = |k: usize| ring[k & (N - 1)];
        let given = if S::KNOWS { self.given_run(step, ring, count, &place) } else { None };
        // Once more from the first on, so that a run that goes beyond the last is none of its own kind.
        let mut again = [[0i32; N]; 3];
        let flat = again.as_flattened_mut();
        flat[..N].copy_from_slice(&lengths);
        flat[count..count + N].copy_from_slice(&lengths);
        let upto = if N == FEW { N } else { count };
        let run =
            self.models.cuts.code::<_, N>(coder, [&lengths[..upto], again.as_flattened()], count, given)?;
        let Some(run) = run else { return self.code_irregular(coder, step, changes, true) };
        if self.corners.len() + 2 > extent.faces.end as usize {
            return Err((codes::CODED_FACES, 0));
        }
        let mut neighbours = Neighbours::<M>::new(from);
        let (mut moved, mut inner) = (0u32, 0);
        let mut k = run.first & (N - 1);
        neighbours.add(points[k]);
        let mut edge = difference(cell_of(points[k]), here);
        for nth in 0..run.count {
            moved |= 1 << place(k);
            inner += if nth > 0 { lengths[k] } else { 0 };
            let next = wrap(k + 1) & (N - 1);
            let following = difference(cell_of(points[next]), here);
            neighbours.turn(edge, following);
            neighbours.add(points[next]);
            edge = following;
            k = next;
        }
        let all = lengths.iter().sum::<i32>();
        let edges_left = (count + 2 - run.count) as u32;
        let cell = self.code_cell(coder, step, changes, &neighbours, (all - inner) as u32, edges_left)?;
        self.take(step, count, Moved::Mask(moved), changes);
        self.introduce([parent, out(run.first), vertex], changes);
        self.introduce([parent, vertex, out(k)], changes);
        self.arrive(cell);
        Ok(())
    }

    /// What a writer knows of a cut, if it is regular.
    #[inline(never)]
    fn given_run<S: Source>(
        &self,
        Step { source, vertex, parent, .. }: Step<'_, S>,
        ring: &[u32],
        count: usize,
        place: &impl Fn(usize) -> u32,
    ) -> Option<Run> {
        let switch = |k: usize| source.switches(vertex, place(k), count as u32);
        let first = (0..count).find(|&k| switch(k) && !switch(if k == 0 { count - 1 } else { k - 1 }))?;
        let run = Run { first, count: (0..count).filter(|&k| switch(k)).count() };
        let end = ring[(first + run.count) % count];
        let faces = source.faces(Some(vertex)).iter().map(|face| face.1);
        let regular = is_regular(run, count, switch)
            && faces.eq([[parent, ring[first], vertex], [parent, vertex, end]]);
        regular.then_some(run)
    }

    /// With any number of faces.
    #[inline(never)]
    fn code_many<C: Coder, S: Source>(
        &mut self,
        coder: &mut C,
        step: Step<'_, S>,
        changes: &mut Changes,
    ) -> Result<(), Fault> {
        let count = self.slots.count(step.parent);
        if count > MOST {
            return self.code_irregular(coder, step, changes, false);
        }
        let (mut outs, mut backs) = ([u32::MAX; MOST], [0; MOST]);
        for (k, &slot) in self.slots.of(step.parent).iter().enumerate().take(MOST) {
            [outs[k], backs[k]] = self.beside(step.parent, slot);
        }
        let Some(order) = round(&outs, &backs, count).or_else(|| search(&outs, &backs, count)) else {
            return self.code_irregular(coder, step, changes, false);
        };
        let mut ring = [step.parent; MOST];
        for (to, &at) in ring.iter_mut().zip(&order).take(count) {
            *to = outs[usize::from(at) & (MOST - 1)];
        }
        let place = |k: usize| u32::from(order[k & (MOST - 1)]);
        self.code_ring::<_, _, MOST, MOST_KNOWN>(coder, step, changes, &ring, count, place)
    }

    /// The faces of a vertex, as its slots stand.
    fn spokes(&self, vertex: u32, to: &mut [Spoke]) {
        for ((place, &slot), to) in (0..).zip(self.slots.of(vertex)).zip(to) {
            let [out, back] = self.beside(vertex, slot);
            *to = Spoke { place, out, back };
        }
    }

    /// With faces that do not go round, or other ones that switch, or others that come.
    #[cold]
    #[inline(never)]
    fn code_irregular<C: Coder, S: Source>(
        &mut self,
        coder: &mut C,
        step: Step<'_, S>,
        changes: &mut Changes,
        round: bool,
    ) -> Result<(), Fault> {
        let Step { source, extent, vertex, parent, .. } = step;
        let count = self.slots.count(parent);
        let mut spokes = alloc::vec![Spoke::default(); count.max(MOST)];
        self.spokes(parent, &mut spokes);
        if let (true, Some(few)) = (count <= MOST, spokes.first_chunk_mut()) {
            let again = order(few, count);
            debug_assert!(again || !round, "the faces of {parent}");
        }
        let spokes = &spokes[..count];
        let from = self.points.get(parent);
        let here = cell_of(from);
        let points = &self.points;
        let edge = |vertex: u32| difference(cell_of(points.get(vertex)), here);
        let mut neighbours = Neighbours::<MOST_KNOWN>::new(from);
        let mut chosen = alloc::vec![false; count];
        let mut before = 0;
        for spoke in spokes {
            let given = source.switches(vertex, spoke.place, count as u32);
            let switches = coder.bit(&mut self.models.switches[before], given);
            before = 1 + usize::from(switches);
            chosen[spoke.place as usize] = switches;
            if switches {
                neighbours.turn(edge(spoke.out), edge(spoke.back));
                for neighbour in [spoke.out, spoke.back] {
                    let point = points.get(neighbour);
                    if !neighbours.known().iter().any(|&known| cell_of(known) == cell_of(point)) {
                        neighbours.add(point);
                    }
                }
            }
        }
        let all =
            spokes.iter().take(MOST).map(|spoke| apart(cell_of(points.get(spoke.out)), here) as u32).sum();
        let thirds = self.code_thirds(coder, step, spokes, &chosen)?;
        let cell = self.code_cell(coder, step, changes, &neighbours, all, count as u32 + 1)?;
        let mask = chosen.iter().rev().fold(0, |mask, &switches| mask << 1 | u32::from(switches));
        let moved = if count <= MOST { Moved::Mask(mask) } else { Moved::Long(&chosen) };
        self.take(step, count, moved, changes);
        let [starts, stops] = &thirds;
        for &third in starts {
            self.introduce([parent, third, vertex], changes);
        }
        for &third in stops {
            self.introduce([parent, vertex, third], changes);
        }
        debug_assert!(self.corners.len() <= extent.faces.end as usize, "faces of {vertex}");
        self.arrive(cell);
        Ok(())
    }

    /// The third vertices of new faces on either side.
    fn code_thirds<C: Coder, S: Source>(
        &mut self,
        coder: &mut C,
        step: Step<'_, S>,
        spokes: &[Spoke],
        chosen: &[bool],
    ) -> Result<[Vec<u32>; 2], Fault> {
        let Step { source, extent, vertex, parent, .. } = step;
        let faces = source.faces(Some(vertex));
        let count = spokes.len();
        let mask = |k: usize| chosen[spokes[k].place as usize];
        let expected = [
            (1..count).find(|&k| mask(k) && !mask(k - 1)).map(|k| spokes[k].out),
            (1..count).find(|&k| !mask(k) && mask(k - 1)).map(|k| spokes[k - 1].back),
        ];
        let fallback = [spokes.first().map_or(0, |s| s.out), spokes.last().map_or(0, |s| s.back)];
        let mut thirds = [Vec::new(), Vec::new()];
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
        Ok(thirds)
    }

    /// Where the vertex is, and what its parent's shape becomes. `lengths`: the sum of those of the edges that the parent
    /// keeps; `edges`: how many it has in the end.
    #[inline(always)]
    fn code_cell<C: Coder, S: Source, const M: usize>(
        &mut self,
        coder: &mut C,
        step: Step<'_, S>,
        changes: &mut Changes,
        neighbours: &Neighbours<M>,
        lengths: u32,
        edges: u32,
    ) -> Result<(Cell, Shape), Fault> {
        let Step { source, bounds, vertex, parent, .. } = step;
        let known = neighbours.known();
        let here = cell_of(known[0]);
        let place = Place::new(known, neighbours.sum, here, neighbours.normal);
        let (cell, height) = place.code(coder, &mut self.models.residuals, source.cell(vertex));
        if (0..3).any(|k| cell[k] < 0 || cell[k] as u32 > bounds.top[k]) {
            return Err((codes::POSITION, 0));
        }
        if let Some(exact) = &bounds.exact {
            let position = exact.code(coder, cell, source.position(vertex));
            changes.positions.push(position.ok_or((codes::POSITION, 0))?);
        }
        // From here on nothing fails.
        let old = self.shape(parent);
        changes.shapes.push((parent, old));
        let parent_height = (u32::from(height) + u32::from(old.height)) / 2;
        let history = 2 * self.packets;
        let parent_scale = scale(divide(lengths + apart(cell, here) as u32, edges));
        let new = Shape { scale: parent_scale, height: parent_height as u8, history: history | 1 };
        self.set_shape(parent, new);
        Ok((cell, Shape { scale: scale(place.reach(cell)), height, history }))
    }

    /// Lets slots of the parent switch.
    #[inline(always)]
    fn take<S: Source>(&mut self, step: Step<'_, S>, count: usize, moved: Moved<'_>, changes: &mut Changes) {
        let Step { vertex, parent, .. } = step;
        if changes.recorded {
            changes.counts.push(count as u32);
            match moved {
                Moved::Mask(moved) => changes.masks.push(moved),
                Moved::Long(chosen) => changes.long.extend_from_slice(chosen),
            }
        }
        match moved {
            Moved::Mask(moved) => {
                if count <= Slots::SHORT {
                    self.slots.split_short(parent, vertex, moved);
                } else {
                    self.slots.split(parent, vertex, |k| moved >> k & 1 == 1);
                }
            }
            Moved::Long(chosen) => self.slots.split(parent, vertex, |k| chosen[k]),
        }
        let corners = self.corners.as_flattened_mut();
        for &slot in self.slots.of(vertex) {
            corners[slot as usize] = vertex;
        }
        self.parents.push(parent);
    }

    /// Adds the vertex itself, after its faces.
    #[inline(always)]
    fn arrive(&mut self, (cell, shape): (Cell, Shape)) {
        self.face_ends.push(self.corners.len() as u32);
        self.push_vertex(cell, shape);
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

/// The most neighbours that are looked at (PMESH-COD-10).
const MOST_KNOWN: usize = MOST + 2;

/// The octave of a distance, 15 at most.
#[inline(always)]
fn scale(distance: u32) -> u8 {
    (u32::BITS - distance.leading_zeros()).min(15) as u8
}

/// Whether a run of some but not all faces switches.
fn is_regular(run: Run, count: usize, switch: impl Fn(usize) -> bool) -> bool {
    run.count > 0 && run.count < count && (0..run.count).all(|k| switch((run.first + k) % count))
}
