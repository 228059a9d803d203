//! Attributes of coded packets: after the splits of a packet the same way is gone once more, with wedges (PMESH-COD-13 to -17).

mod hand_over;
mod values;

use alloc::boxed::Box;
use alloc::vec::Vec;
use core::ops::Range;

use super::geometry::{CONTEXTS, class, cross, difference, raw, residual};
use super::models::{Binary, Symbols};
use super::octahedral::{Code, Octahedral};
use super::priors::HEIGHTS;
use super::rans::Coder;
use super::ring::MOST as SHORT;
use super::wedges::{MOST, Weights};
use super::{Changes, Fault, LENGTH, State};
use crate::attributes::Attributes;
use crate::code::codes;
use crate::header::{Header, PacketEntry};
use crate::lattice::Lattice;
use crate::slots::Slots;

/// Slots of a vertex among which a face beside a new one is looked for.
const BESIDE_MOST: usize = 32;

/// The class that the residuals of wedges of the base are said to have.
const FIRST_CLASS: u8 = 12;

/// Models of whether a value is as expected: 8 classes of four each, neighbours that are alike or not.
const EXACT: usize = 16;

/// Bits of whole numbers behind the point in the mean of normals.
const NORMAL_SHIFT: u32 = 4;

/// Bits of a colour's channel, of a material.
const COLOUR_BITS: u32 = 8;
const MATERIAL_BITS: u32 = 16;

/// What a writer knows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Given<'a> {
    /// First wedge of each vertex, and the end.
    pub(crate) wedge_starts: &'a [u32],
    /// What each wedge from those of the base on becomes.
    pub(crate) targets: &'a [u32],
    /// Switch codes of all vertices, each in descending order of slots, and where those of each lie.
    pub(crate) switches: (&'a [u32], &'a [(usize, usize)]),
    /// Level of introduction, corners as mapped there, and index in `materials` of each face.
    pub(crate) faces: &'a [(u32, [u32; 3], usize)],
    pub(crate) materials: &'a [u16],
    pub(crate) normals: &'a [Code],
    pub(crate) uvs: &'a [[i32; 2]],
    pub(crate) colours: &'a [[u8; 4]],
}

/// How attributes are stored.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan {
    pub(super) attributes: Attributes,
    pub(super) octahedral: Octahedral,
    /// Of texture coordinates; the third axis has no extent.
    pub(super) lattice: Lattice,
}

impl Plan {
    /// That of a file; `None` if it has no attributes.
    pub(crate) fn new(header: &Header) -> Option<Self> {
        let [low, high] = header.uv_bounds.map(|[u, v]| [u, v, 0.0]);
        (header.attributes != Attributes::default()).then(|| Self {
            attributes: header.attributes,
            octahedral: Octahedral::new(header.normal_bits),
            lattice: Lattice::new([low, high], header.uv_bits.max(1)),
        })
    }

    /// The nearest code of each normal.
    pub(crate) fn normals(&self, normals: &[[f32; 3]]) -> Vec<Code> {
        normals.iter().map(|&normal| self.octahedral.nearest(normal)).collect()
    }

    /// The nearest point of each pair of texture coordinates whose coordinates are finite.
    pub(crate) fn uvs(&self, uvs: &[[f32; 2]]) -> Vec<[i32; 2]> {
        let nearest = |&[u, v]: &[f32; 2]| {
            let [u, v, _] = self.lattice.nearest([u, v, 0.0]);
            [u as i32, v as i32]
        };
        uvs.iter().map(nearest).collect()
    }

    /// The normal of a code.
    pub(crate) fn normal(&self, code: Code) -> [f32; 3] {
        self.octahedral.direction(code)
    }

    /// The texture coordinates of a point.
    pub(crate) fn uv(&self, [u, v]: [i32; 2]) -> [f32; 2] {
        let [u, v, _] = self.lattice.position([u as u32, v as u32, 0]);
        [u, v]
    }
}

/// What is learnt of attributes.
#[derive(Clone, Debug)]
pub(super) struct Models {
    /// Whether a vertex has one more wedge; by how many are expected, and how many there are.
    more: [Binary; 16],
    /// Whether a wedge becomes the one expected; of those for which one is, and of others.
    targets: [Binary; 2],
    /// Whether a corner switches to the wedge of the one before.
    same: Binary,
    /// Whether a corner of a new face has the wedge expected; by corner, and whether there is a face beside it.
    corners: [Binary; 6],
    /// Whether a new face has the material of the face beside it on the parent's side, on its own.
    materials: [Binary; 2],
    /// Whether a normal, texture coordinates, a colour are as expected; by class, and whether all neighbours are alike.
    exact: [[Binary; EXACT]; 3],
    normals: [Symbols; CONTEXTS],
    uvs: [Symbols; CONTEXTS],
    /// Of green, of red and blue, of alpha.
    colours: [[Symbols; CONTEXTS]; 3],
}

impl Models {
    fn new() -> Self {
        let (likely, unlikely) = (Binary::new(30_000), Binary::new(2_768));
        let values = HEIGHTS.map(Symbols::new);
        Self {
            more: core::array::from_fn(|k| if k % 4 < k / 4 { likely } else { unlikely }),
            targets: [likely; 2],
            same: likely,
            corners: [likely; 6],
            materials: [likely; 2],
            exact: [[Binary::new(1 << 14); EXACT]; 3],
            normals: values,
            uvs: values,
            colours: [values; 3],
        }
    }
}

/// What is known of wedges after some packets.
#[derive(Clone, Debug)]
pub(super) struct Wedged {
    plan: Plan,
    models: Box<Models>,
    /// Wedges of the corners of the faces.
    corners: Vec<[u32; 3]>,
    /// Faces of the base.
    base_faces: u32,
    slots: Slots,
    /// The end of each vertex's wedges.
    ends: Vec<u32>,
    /// The vertex of each wedge, what it becomes (0 for those of the base), and the classes of its residuals.
    vertices: Vec<u32>,
    targets: Vec<u32>,
    classes: Vec<[u8; 3]>,
    normals: Vec<Code>,
    uvs: Vec<[i32; 2]>,
    colours: Vec<[u8; 4]>,
    materials: Vec<u16>,
    /// Faces at a vertex: its wedge, the two that follow.
    around: Vec<[u32; 3]>,
}

/// What a packet has brought and changed.
#[derive(Debug, Default)]
pub(super) struct Brought {
    /// Classes that were there before, with their wedges.
    classes: Vec<(u32, [u8; 3])>,
}

/// What a step needs beside wedges.
struct Step<'a, C> {
    coder: &'a mut C,
    given: Option<&'a Given<'a>>,
    extent: &'a PacketEntry,
    state: &'a State,
    brought: &'a mut Brought,
}

impl Wedged {
    /// Before the first packet.
    pub(super) fn new(plan: Plan) -> Self {
        Self {
            plan,
            models: Box::new(Models::new()),
            corners: Vec::new(),
            base_faces: 0,
            slots: Slots::default(),
            ends: Vec::new(),
            vertices: Vec::new(),
            targets: Vec::new(),
            classes: Vec::new(),
            normals: Vec::new(),
            uvs: Vec::new(),
            colours: Vec::new(),
            materials: Vec::new(),
            around: Vec::new(),
        }
    }

    pub(super) fn models(&self) -> Box<Models> {
        self.models.clone()
    }

    pub(super) fn set_models(&mut self, models: Box<Models>) {
        self.models = models;
    }

    fn wedges_of(&self, vertex: u32) -> Range<u32> {
        let start = vertex.checked_sub(1).and_then(|before| self.ends.get(before as usize));
        start.copied().unwrap_or(0)..self.ends.get(vertex as usize).copied().unwrap_or(0)
    }

    /// Codes the attributes of a packet whose splits stand in `state` and `changes`.
    pub(super) fn packet<C: Coder>(
        &mut self,
        coder: &mut C,
        given: Option<&Given<'_>>,
        extent: &PacketEntry,
        state: &State,
        changes: &Changes,
        brought: &mut Brought,
    ) -> Result<(), Fault> {
        self.slots.resize(extent.vertices.end as usize, usize::MAX);
        let mut step = Step { coder, given, extent, state, brought };
        let first = extent.vertices.start.max(state.base);
        let mut face = extent.faces.start;
        let introduced = |face: u32| changes.introduced[(face - extent.faces.start) as usize];
        if extent.vertices.start < state.base {
            let of_base = |face: &&[u32; 3]| face.iter().all(|&vertex| vertex < state.base);
            self.base_faces = changes.introduced.iter().take_while(of_base).count() as u32;
            self.code_base(&mut step, state.base, (0..self.base_faces).map(introduced))?;
            face = self.base_faces;
        }
        let (mut masks, mut long) = (changes.masks.iter(), &changes.long[..]);
        for (vertex, &count) in (first..).zip(&changes.counts) {
            let split = (vertex - state.base) as usize;
            let parent = state.parents[split];
            let count = count as usize;
            if count <= SHORT {
                let mask = masks.next().copied().unwrap_or(0);
                self.code_split(&mut step, vertex, parent, |k| mask >> k & 1 == 1)?;
            } else {
                let (now, later) = long.split_at(count);
                long = later;
                self.code_split(&mut step, vertex, parent, |k| now[k])?;
            }
            let end = state.face_ends[split];
            for face in face..end {
                self.code_face(&mut step, vertex, parent, introduced(face))?;
            }
            face = end;
            self.code_values(&mut step, vertex)?;
            if step.coder.failed() {
                return Err(LENGTH);
            }
        }
        if self.vertices.len() as u32 != extent.wedges.end {
            return Err((codes::WEDGE_COUNT, 0));
        }
        Ok(())
    }

    /// Wedges and values of the base.
    fn code_base<C: Coder>(
        &mut self,
        step: &mut Step<'_, C>,
        base: u32,
        faces: impl Iterator<Item = [u32; 3]>,
    ) -> Result<(), Fault> {
        for vertex in 0..base {
            let count = self.code_count(step, vertex, 1)?;
            let end = self.vertices.len() + count as usize;
            self.vertices.resize(end, vertex);
            self.targets.resize(end, 0);
            self.ends.push(end as u32);
            if step.coder.failed() {
                return Err(LENGTH);
            }
        }
        for vertices in faces {
            let mut corners = [0; 3];
            let known = step.given.map(|given| given.faces[self.corners.len()]);
            for (corner, vertex) in vertices.into_iter().enumerate() {
                let wedges = self.wedges_of(vertex);
                let known = known.map_or(0, |face| face.1[corner] - wedges.start);
                let place = raw(step.coder, bits(wedges.len() as u32 - 1), known);
                if place >= wedges.len() as u32 {
                    return Err((codes::CORNER, 0));
                }
                corners[corner] = wedges.start + place;
            }
            if self.plan.attributes.materials {
                let known = self.known_material(step);
                self.materials.push(step.coder.raw(MATERIAL_BITS, known.into()) as u16);
            }
            self.introduce(corners, vertices);
            if step.coder.failed() {
                return Err(LENGTH);
            }
        }
        for wedge in 0..self.vertices.len() {
            self.code_first_values(step, wedge)?;
            if step.coder.failed() {
                return Err(LENGTH);
            }
        }
        Ok(())
    }

    fn known_material<C: Coder>(&self, step: &Step<'_, C>) -> u16 {
        let index = step.given.map(|given| (given, given.faces[self.corners.len()].2));
        index.and_then(|(given, index)| given.materials.get(index).copied()).unwrap_or(0)
    }

    /// How many wedges a vertex has.
    fn code_count<C: Coder>(
        &mut self,
        step: &mut Step<'_, C>,
        vertex: u32,
        expected: usize,
    ) -> Result<u32, Fault> {
        let left = step.extent.wedges.end - self.vertices.len() as u32;
        let known = step
            .given
            .map_or(1, |given| given.wedge_starts[vertex as usize + 1] - given.wedge_starts[vertex as usize]);
        let mut count = 1;
        if self.plan.attributes.seams {
            loop {
                let model = 4 * (expected.clamp(1, 4) - 1) + (count as usize).min(4) - 1;
                if count > left || !step.coder.bit(&mut self.models.more[model], count < known) {
                    break;
                }
                count += 1;
            }
        }
        if count > left { Err((codes::WEDGE_COUNT, 0)) } else { Ok(count) }
    }

    /// A vertex: its wedges, what they become, and to which of them corners of the parent switch.
    fn code_split<C: Coder>(
        &mut self,
        step: &mut Step<'_, C>,
        vertex: u32,
        parent: u32,
        switches: impl Fn(usize) -> bool,
    ) -> Result<(), Fault> {
        let parents = self.wedges_of(parent);
        let first = self.vertices.len() as u32;
        let mut had: Vec<u32> = Vec::new();
        if parents.len() > 1 {
            let corners = self.corners.as_flattened();
            let list = self.slots.of(parent).iter().enumerate();
            had.extend(list.filter(|&(k, _)| switches(k)).map(|(_, &slot)| corners[slot as usize]));
            had.sort_unstable();
            had.dedup();
        }
        let count = self.code_count(step, vertex, had.len())?;
        // Wedges of the vertex by what they become.
        let mut by_target: Vec<(u32, u32)> = Vec::new();
        for k in 0..count {
            let wedge = first + k;
            let mut target = parents.start;
            if parents.len() > 1 {
                let guess = had.get(k as usize).or(had.last()).copied().unwrap_or(parents.start);
                let model = usize::from(k as usize >= had.len());
                let known = step
                    .given
                    .map_or(0, |given| given.targets[(wedge - given.wedge_starts[given.base()]) as usize]);
                target = guess;
                if !step.coder.bit(&mut self.models.targets[model], known == guess) {
                    let place = known.wrapping_sub(parents.start);
                    target = raw(step.coder, bits(parents.len() as u32 - 1), place);
                    if target >= parents.len() as u32 {
                        return Err((codes::WEDGE_TARGET, 0));
                    }
                    target += parents.start;
                }
            }
            by_target.push((target, wedge));
        }
        let targets: Vec<u32> = by_target.iter().map(|&(target, _)| target).collect();
        by_target.sort_unstable();
        let list = self.slots.of(parent);
        let corners = self.corners.as_flattened();
        let mut chosen: Vec<u32> = Vec::new();
        if self.plan.attributes.seams {
            chosen.resize(list.len(), 0);
        }
        let mut before = first;
        for (k, &slot) in list.iter().enumerate() {
            if chosen.is_empty() || !switches(k) {
                continue;
            }
            let had = corners[slot as usize];
            let from = by_target.partition_point(|&(target, _)| target < had);
            let end = from + by_target[from..].partition_point(|&(target, _)| target == had);
            let candidates = &by_target[from..end];
            let Some(&(_, mut wedge)) = candidates.first() else { return Err((codes::SWITCH, 0)) };
            if candidates.len() > 1 {
                let known = step.given.map_or(0, |given| {
                    let (start, end) = given.switches.1[vertex as usize - given.base()];
                    first + given.switches.0[start..end][end - start - 1 - k] - 1
                });
                if candidates.iter().any(|&(_, wedge)| wedge == before) {
                    wedge = before;
                }
                if !step.coder.bit(&mut self.models.same, known == wedge) {
                    let place = candidates.partition_point(|&(_, wedge)| wedge < known) as u32;
                    let place = raw(step.coder, bits(candidates.len() as u32 - 1), place);
                    wedge = candidates.get(place as usize).ok_or((codes::SWITCH, 0))?.1;
                }
                before = wedge;
            }
            chosen[k] = wedge - first + 1;
        }
        // From here on nothing fails.
        self.slots.split(parent, vertex, switches);
        let list = self.slots.of(vertex);
        let mut wedges = chosen.iter().filter(|&&code| code > 0).map(|code| first + code - 1);
        for &slot in list {
            self.corners.as_flattened_mut()[slot as usize] = wedges.next().unwrap_or(first);
        }
        self.vertices.resize((first + count) as usize, vertex);
        self.targets.extend(targets);
        self.ends.push(first + count);
        Ok(())
    }

    /// A face that a vertex introduces, the parent first.
    fn code_face<C: Coder>(
        &mut self,
        step: &mut Step<'_, C>,
        vertex: u32,
        parent: u32,
        vertices: [u32; 3],
    ) -> Result<(), Fault> {
        let turned = vertices[2] != vertex;
        let third = vertices[if turned { 2 } else { 1 }];
        let among = [parent, vertex, third];
        let several = among.map(|vertex| self.wedges_of(vertex).len() > 1);
        let materials = self.plan.attributes.materials;
        let mut corners = among.map(|vertex| self.wedges_of(vertex).start);
        if materials || several.contains(&true) {
            let beside = [parent, vertex].map(|vertex| self.beside(vertex, third));
            // Where the parent has another wedge than the face beside it, a seam lies between them.
            let mut apart = false;
            for k in (0..3).filter(|&k| several[k]) {
                let wedges = self.wedges_of(among[k]);
                let own = beside[usize::from(k == 1)];
                let from = if k == 2 {
                    let [first, second] = if apart { [beside[1], beside[0]] } else { beside };
                    first.or(second)
                } else {
                    own
                };
                let found = from.map(|face| self.corners[face as usize]);
                let found = found.and_then(|corners| corners.into_iter().find(|w| wedges.contains(w)));
                let guess = found.unwrap_or(wedges.start);
                let known = step.given.map_or(0, |given| {
                    let at = if turned { [0, 1, 2] } else { [0, 2, 1] };
                    given.faces[self.corners.len()].1[at[k]]
                });
                corners[k] = guess;
                let model = 2 * k + usize::from(found.is_some());
                if !step.coder.bit(&mut self.models.corners[model], known == guess) {
                    let place = known.wrapping_sub(wedges.start);
                    let place = raw(step.coder, bits(wedges.len() as u32 - 1), place);
                    if place >= wedges.len() as u32 {
                        return Err((codes::CORNER, 0));
                    }
                    corners[k] = wedges.start + place;
                    apart |= k == 0;
                }
            }
            if materials {
                let material = self.code_material(step, beside);
                self.materials.push(material);
            }
        }
        let [p, v, x] = corners;
        let corners = if turned { [p, v, x] } else { [p, x, v] };
        self.introduce(corners, vertices);
        if step.coder.failed() { Err(LENGTH) } else { Ok(()) }
    }

    /// The first of the faces at a vertex, of the first few, that has a corner on another vertex too.
    fn beside(&self, vertex: u32, other: u32) -> Option<u32> {
        let wedges = self.wedges_of(other);
        let faces = self.slots.of(vertex).iter().take(BESIDE_MOST).map(|slot| slot / 3);
        faces.into_iter().find(|&face| self.corners[face as usize].iter().any(|w| wedges.contains(w)))
    }

    /// The material of a new face.
    fn code_material<C: Coder>(&mut self, step: &mut Step<'_, C>, beside: [Option<u32>; 2]) -> u16 {
        let known = self.known_material(step);
        let last = self.materials.last().copied().unwrap_or(0);
        let [first, second] =
            beside.map(|face| face.and_then(|face| self.materials.get(face as usize)).copied());
        let guess = first.or(second).unwrap_or(last);
        if step.coder.bit(&mut self.models.materials[0], known == guess) {
            return guess;
        }
        let other = second.filter(|&other| other != guess);
        if let Some(other) = other
            && step.coder.bit(&mut self.models.materials[1], known == other)
        {
            return other;
        }
        step.coder.raw(MATERIAL_BITS, known.into()) as u16
    }

    fn introduce(&mut self, corners: [u32; 3], vertices: [u32; 3]) {
        let face = self.corners.len() as u32;
        for (slot, vertex) in (3 * face..).zip(vertices) {
            self.slots.push(vertex, slot);
        }
        self.corners.push(corners);
    }
}

impl Given<'_> {
    /// The first vertex that collapses.
    fn base(&self) -> usize {
        self.wedge_starts.len() - 1 - self.switches.1.len()
    }
}

/// Bits of a number that is at most `most`.
fn bits(most: u32) -> u32 {
    u32::BITS - most.leading_zeros()
}

#[cfg(test)]
mod tests;
