//! A vertex comes: which faces of its parent it takes, which it brings, where it is (PMESH-COD-08 to -11).

use alloc::vec::Vec;

use super::cut::Run;
use super::geometry::{Around, Cell, Place, apart, cross, difference, divide, raw};
use super::rans::Coder;
use super::ring::{FEW, MOST, Spoke, order};
use super::rings::{Fan, before, corner};
use super::walk::{Bounds, Source};
use super::{Changes, Fault, LENGTH, SLOTS_A_BYTE, Shape, State, cell_of};
use crate::code::codes;
use crate::header::PacketEntry;

/// What is given with a step of the walk.
#[derive(Clone, Copy)]
pub(super) struct Step<'a, S> {
    pub(super) source: &'a S,
    pub(super) extent: &'a PacketEntry,
    pub(super) bounds: &'a Bounds,
    pub(super) vertex: u32,
    pub(super) parent: u32,
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
        let parent = step.parent;
        let Some((row, count)) = self.rings.few(parent) else { return self.code_many(coder, step, changes) };
        self.look_at(count, step.bounds, changes)?;
        let mut fan = *row;
        for k in 0..FEW {
            fan.outs[k] = if k < count { fan.outs[k] } else { parent };
        }
        self.code_ring(coder, step, changes, &fan, count, true)
    }

    /// Counts faces that are looked at (PMESH-COD-12).
    #[inline(always)]
    fn look_at(&self, count: usize, bounds: &Bounds, changes: &mut Changes) -> Result<(), Fault> {
        changes.looked_at += count as u64;
        if changes.looked_at > bounds.bytes.saturating_mul(SLOTS_A_BYTE) {
            return Err((codes::CODED_WORK, 0));
        }
        Ok(())
    }

    /// The vertices that follow the corner of a slot in its face.
    #[inline(always)]
    fn beside(&self, slot: u32) -> [u32; 2] {
        let back = before(slot);
        let corners = self.corners.as_flattened();
        [corners[corner(before(back))], corners[corner(back)]]
    }

    /// Where faces go round: whether the split is regular, and if so, all of it. `fan`: the faces in order, then any whose out is
    /// the parent; `simple`: no two have the same out.
    #[inline(always)]
    fn code_ring<C: Coder, S: Source, const N: usize>(
        &mut self,
        coder: &mut C,
        step: Step<'_, S>,
        changes: &mut Changes,
        fan: &Fan<N>,
        count: usize,
        simple: bool,
    ) -> Result<(), Fault> {
        let Step { extent, parent, .. } = step;
        let [px, py, pz, shape] = self.points.get(parent);
        let mut at = [[0i32; N]; 3];
        let mut heights = [0i32; N];
        let mut apart = [0i32; N];
        for k in 0..N {
            let [x, y, z, shape] = self.points.get(fan.outs[k]);
            at[0][k] = x - px;
            at[1][k] = y - py;
            at[2][k] = z - pz;
            heights[k] = shape >> 16;
            apart[k] = (x - px).abs() + (y - py).abs() + (z - pz).abs();
        }
        let mut lengths = [[0i32; N]; 3];
        let flat = lengths.as_flattened_mut();
        flat[..N].copy_from_slice(&apart);
        flat[count..count + N].copy_from_slice(&apart);
        let (mut first, mut least) = (0, u32::MAX);
        for k in 0..N {
            let slot = if k < count { fan.slots[k] } else { u32::MAX };
            (first, least) = if slot < least { (k, slot) } else { (first, least) };
        }
        let given = if S::KNOWS { self.given_run(step, fan, count) } else { None };
        let Some(run) = self.models.cuts.code(coder, &lengths, count, first, given)? else {
            return self.code_irregular(coder, step, changes);
        };
        if self.corners.len() + 2 > extent.faces.end as usize {
            return Err((codes::CODED_FACES, 0));
        }
        // Which outs are neighbours, and the edges between the faces of the run.
        let mut known = [0i32; N];
        let (mut all, mut inner) = (0, 0);
        for k in 0..N {
            let behind = if k >= run.first { k - run.first } else { k + count - run.first };
            known[k] = if k < count && behind <= run.count { -1 } else { 0 };
            all += apart[k];
            inner += if k < count && behind >= 1 && behind < run.count { apart[k] } else { 0 };
        }
        let neighbours = run.count as i32 + 2;
        let here = [px, py, pz];
        let around = Around {
            count: neighbours as u32,
            cells: core::array::from_fn(|axis| {
                neighbours * here[axis] + (0..N).map(|k| at[axis][k] & known[k]).sum::<i32>()
            }),
            heights: ((shape >> 16) + (0..N).map(|k| heights[k] & known[k]).sum::<i32>()) as u32,
        };
        let mean = around.mean(here);
        let spreads = core::array::from_fn(|axis| {
            let from = mean[axis] - here[axis];
            let sum = (0..N).map(|k| (at[axis][k] - from).abs() & known[k]).sum::<i32>();
            (from.abs() + sum) as u32
        });
        let mut normal = [0; 3];
        let edge = |k: usize| [0, 1, 2].map(|axis| i64::from(at[axis][k & (N - 1)]));
        let mut k = run.first;
        let mut a = edge(k);
        for _ in 0..run.count {
            k = if k + 1 >= count { 0 } else { k + 1 };
            let b = edge(k);
            let [x, y, z] = cross(a, b);
            normal = [normal[0] + x, normal[1] + y, normal[2] + z];
            a = b;
        }
        let place = Place::new(around, [here, mean], spreads, normal);
        let edges_left = (count + 2 - run.count) as u32;
        let cell = self.code_cell(coder, step, changes, &place, (all - inner) as u32, edges_left)?;
        if changes.recorded {
            let places = |k: usize| fan.slots[..count].iter().filter(|&&slot| slot < fan.slots[k]).count();
            let moved = (0..run.count).fold(0, |all, k| all | 1 << places((run.first + k) % count));
            changes.switch(count, moved);
        }
        self.take_run(step, fan, count, run, simple);
        if changes.recorded {
            changes.introduced.extend_from_slice(&self.corners[self.corners.len() - 2..]);
        }
        self.arrive(step.parent, cell);
        Ok(())
    }

    /// Lets a run of faces switch and adds two others.
    #[inline(always)]
    fn take_run<S: Source, const N: usize>(
        &mut self,
        Step { vertex, parent, .. }: Step<'_, S>,
        fan: &Fan<N>,
        count: usize,
        run: Run,
        simple: bool,
    ) {
        let (mut outs, mut slots) = ([[0u32; N]; 3], [[0u32; N]; 3]);
        for (twice, once) in [(&mut outs, &fan.outs), (&mut slots, &fan.slots)] {
            let flat = twice.as_flattened_mut();
            flat[..N].copy_from_slice(once);
            flat[count..count + N].copy_from_slice(once);
        }
        let (outs, slots) = (outs.as_flattened(), slots.as_flattened());
        let (first, end) = (run.first, run.first + run.count);
        let (from, to) = (outs[first], outs[end]);
        // The new faces (p, x, v) and (p, v, y).
        let face = 4 * self.corners.len() as u32;
        self.corners.extend_from_slice(&[[parent, from, vertex], [parent, vertex, to]]);
        let (start, stop) = (face, face + 4);
        let corners = self.corners.as_flattened_mut();
        for &slot in &slots[first..end] {
            if let Some(corner) = corners.get_mut(corner(slot)) {
                *corner = vertex;
            }
        }
        self.rings.insert(
            from,
            before(slots[if first > 0 { first } else { count } - 1]),
            [start + 1, vertex],
            parent,
        );
        for k in first + 1..end {
            self.rings.turn(outs[k], before(slots[k - 1]), vertex);
        }
        self.rings.insert(to, before(slots[end - 1]), [stop + 2, parent], vertex);
        let (stay, go) = (count - run.count + 2, run.count + 2);
        if simple && N == FEW && stay <= FEW && go <= FEW {
            let (mut stays, mut goes) = (Fan::EMPTY, Fan::EMPTY);
            for (all, [stays, goes], [new, moved]) in [
                (outs, [&mut stays.outs, &mut goes.outs], [[from, vertex], [to, parent]]),
                (slots, [&mut stays.slots, &mut goes.slots], [[start, stop], [stop + 1, start + 2]]),
            ] {
                stays[..2].copy_from_slice(&new);
                stays[2..].copy_from_slice(&all[end..end + FEW - 2]);
                goes.copy_from_slice(&all[first..first + FEW]);
                goes[(go - 2) & (FEW - 1)] = moved[0];
                goes[(go - 1) & (FEW - 1)] = moved[1];
            }
            self.rings.set_few(parent, &stays, stay);
            self.rings.set_few(vertex, &goes, go);
            return;
        }
        let end_of = first + count;
        let mut stays = [alloc::vec![from, vertex], alloc::vec![start, stop]];
        stays[0].extend_from_slice(&outs[end..end_of]);
        stays[1].extend_from_slice(&slots[end..end_of]);
        let mut goes = [outs[first..end].to_vec(), slots[first..end].to_vec()];
        goes[0].extend([to, parent]);
        goes[1].extend([stop + 1, start + 2]);
        for (vertex, [outs, slots]) in [(parent, &mut stays), (vertex, &mut goes)] {
            let round = simple && slots.len() <= MOST;
            if !round {
                slots.sort_unstable();
            }
            self.rings.set(vertex, round.then_some(&outs[..]), slots);
        }
    }

    /// What a writer knows of a cut, if it is regular.
    #[inline(never)]
    fn given_run<S: Source, const N: usize>(
        &self,
        Step { source, vertex, parent, .. }: Step<'_, S>,
        fan: &Fan<N>,
        count: usize,
    ) -> Option<Run> {
        let place = |k: usize| fan.slots[..count].iter().filter(|&&slot| slot < fan.slots[k]).count() as u32;
        let switch = |k: usize| source.switches(vertex, place(k), count as u32);
        let first = (0..count).find(|&k| switch(k) && !switch(if k == 0 { count - 1 } else { k - 1 }))?;
        let run = Run { first, count: (0..count).filter(|&k| switch(k)).count() };
        let end = fan.outs[(first + run.count) % count];
        let faces = source.faces(Some(vertex)).iter().map(|face| face.1);
        let regular = is_regular(run, count, switch)
            && faces.eq([[parent, fan.outs[first], vertex], [parent, vertex, end]]);
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
        let parent = step.parent;
        let count = self.rings.count(parent);
        self.look_at(count, step.bounds, changes)?;
        if let Some((fan, count)) = self.rings.many(parent) {
            let mut fan = *fan;
            fan.outs[count..].fill(parent);
            return self.code_ring(coder, step, changes, &fan, count, true);
        }
        let mut fan = Fan::<MOST> { outs: [parent; MOST], slots: [0; MOST] };
        let slots = self.rings.ascending(parent);
        if count > MOST || !self.ordered(&slots, &mut fan) {
            return self.code_irregular(coder, step, changes);
        }
        let outs = &fan.outs[..count];
        let simple = (1..count).all(|k| !outs[..k].contains(&outs[k]));
        self.code_ring(coder, step, changes, &fan, count, simple)
    }

    /// Puts up to [`MOST`] faces in order; true if they go round.
    fn ordered(&self, slots: &[u32], fan: &mut Fan<MOST>) -> bool {
        let mut spokes = [Spoke::default(); MOST];
        self.spokes(slots, &mut spokes);
        let round = order(&mut spokes, slots.len());
        for (k, spoke) in spokes[..slots.len()].iter().enumerate() {
            fan.outs[k] = spoke.out;
            fan.slots[k] = slots[spoke.place as usize];
        }
        round
    }

    /// The faces in these slots.
    fn spokes(&self, slots: &[u32], to: &mut [Spoke]) {
        for ((place, &slot), to) in (0..).zip(slots).zip(to) {
            let [out, back] = self.beside(slot);
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
    ) -> Result<(), Fault> {
        let Step { source, extent, vertex, parent, .. } = step;
        let slots = self.rings.ascending(parent);
        let count = slots.len();
        let mut spokes = alloc::vec![Spoke::default(); count.max(MOST)];
        self.spokes(&slots, &mut spokes);
        if let (true, Some(few)) = (count > 0 && count <= MOST, spokes.first_chunk_mut()) {
            order(few, count);
        }
        let spokes = &spokes[..count];
        let [px, py, pz, shape] = self.points.get(parent);
        let here = [px, py, pz];
        let points = &self.points;
        let edge = |vertex: u32| difference(cell_of(points.get(vertex)), here);
        let mut neighbours = alloc::vec![here];
        let mut heights = (shape >> 16) as u32;
        let mut normal = [0; 3];
        let mut chosen = alloc::vec![false; count];
        let mut touched = Vec::new();
        let mut before = 0;
        for spoke in spokes {
            let given = source.switches(vertex, spoke.place, count as u32);
            let switches = coder.bit(&mut self.models.switches[before], given);
            before = 1 + usize::from(switches);
            chosen[spoke.place as usize] = switches;
            if switches {
                let [x, y, z] = cross(edge(spoke.out), edge(spoke.back));
                normal = [normal[0] + x, normal[1] + y, normal[2] + z];
                for neighbour in [spoke.out, spoke.back] {
                    let [x, y, z, shape] = points.get(neighbour);
                    if neighbours.len() < MOST_KNOWN && !neighbours.contains(&[x, y, z]) {
                        neighbours.push([x, y, z]);
                        heights += (shape >> 16) as u32;
                    }
                    touched.push(neighbour);
                }
            }
        }
        let all =
            spokes.iter().take(MOST).map(|spoke| apart(cell_of(points.get(spoke.out)), here) as u32).sum();
        let thirds = self.code_thirds(coder, step, spokes, &chosen)?;
        let sum = |value: &dyn Fn(Cell) -> i32| neighbours.iter().map(|&cell| value(cell)).sum::<i32>();
        let cells = core::array::from_fn(|axis| sum(&|cell| cell[axis]));
        let around = Around { count: neighbours.len() as u32, cells, heights };
        let mean = around.mean(here);
        let spreads = core::array::from_fn(|axis| sum(&|cell| (cell[axis] - mean[axis]).abs()) as u32);
        let place = Place::new(around, [here, mean], spreads, normal);
        let cell = self.code_cell(coder, step, changes, &place, all, count as u32 + 1)?;
        if changes.recorded {
            let mask = chosen.iter().rev().fold(0, |mask, &switches| mask << 1 | u32::from(switches));
            if count <= MOST { changes.switch(count, mask) } else { changes.switch_long(&chosen) }
        }
        // From here on nothing is known of the order of any faces there.
        touched.iter().for_each(|&vertex| self.rings.loosen(vertex));
        let (mut stays, mut goes) = (Vec::new(), Vec::new());
        for (&slot, &switches) in slots.iter().zip(&chosen) {
            if switches { goes.push(slot) } else { stays.push(slot) }
        }
        for &slot in &goes {
            self.corners.as_flattened_mut()[corner(slot)] = vertex;
        }
        self.rings.set(parent, None, &stays);
        self.rings.set(vertex, None, &goes);
        let [starts, stops] = &thirds;
        for &third in starts {
            self.introduce([parent, third, vertex], changes);
        }
        for &third in stops {
            self.introduce([parent, vertex, third], changes);
        }
        debug_assert!(self.corners.len() <= extent.faces.end as usize, "faces of {vertex}");
        self.arrive(parent, cell);
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
    fn code_cell<C: Coder, S: Source>(
        &mut self,
        coder: &mut C,
        step: Step<'_, S>,
        changes: &mut Changes,
        place: &Place,
        lengths: u32,
        edges: u32,
    ) -> Result<(Cell, Shape), Fault> {
        let Step { source, bounds, vertex, parent, .. } = step;
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
        let lengths = lengths + apart(cell, place.parent()) as u32;
        let parent_scale = scale(divide(lengths.into(), edges) as u32);
        let new = Shape { scale: parent_scale, height: parent_height as u8, history: history | 1 };
        self.set_shape(parent, new);
        Ok((cell, Shape { scale: scale(place.reach(cell)), height, history }))
    }

    /// Adds the vertex itself, after its faces.
    #[inline(always)]
    fn arrive(&mut self, parent: u32, (cell, shape): (Cell, Shape)) {
        self.parents.push(parent);
        if self.wedged.is_some() {
            self.face_ends.push(self.corners.len() as u32);
        }
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
