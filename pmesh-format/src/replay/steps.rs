//! From level to level: adding the next vertices, taking the last ones away.

use alloc::boxed::Box;
use alloc::vec::Vec;
use core::ops::Range;

use super::Replay;
use crate::header::PacketEntry;
use crate::lists::{Lists, MOST, Walks};
use crate::room::reserve;

/// What changes from level to level.
#[derive(Clone, Debug, Default)]
pub(super) struct Steps {
    base: u32,
    /// For each level from the base on, how many faces it has.
    face_ends: Vec<u32>,
    /// Which slots switch to each wedge, in parts for some packets each, in order.
    parts: Vec<Lists>,
}

impl Steps {
    /// How many faces a level has.
    pub(super) fn faces_at(&self, level: u32) -> u32 {
        level.checked_sub(self.base).map_or(0, |k| self.face_ends.get(k as usize).copied().unwrap_or(0))
    }

    /// How many levels have at most so many faces.
    pub(super) fn levels_within(&self, faces: u32) -> u32 {
        self.face_ends.partition_point(|&end| end <= faces) as u32
    }

    /// Appends the number of faces of each level that a packet brings.
    fn introduce(&mut self, replay: &Replay, entry: &PacketEntry) {
        // The base counts as brought by its last vertex.
        let first = entry.vertices.start.max(self.base - 1);
        let start = self.face_ends.len();
        let count = (entry.vertices.end - first) as usize;
        let levels = (replay.header.vertex_count - self.base) as usize + 1;
        reserve(&mut self.face_ends, count, levels);
        self.face_ends.resize(start + count, entry.faces.start);
        let ends = &mut self.face_ends[start..];
        let note = |face: u32, last: u32| ends[(last - first) as usize] = face + 1;
        replay.introductions(first, entry.faces.clone(), note);
        let mut most = entry.faces.start;
        for end in ends {
            most = most.max(*end);
            *end = most;
        }
    }
}

impl Replay {
    /// Calls `note` with each of the faces `faces` of a packet and the vertex that introduces it (PMESH-FACE-05): `first`, the first
    /// one of the packet or the last one of the base, or a later one. All packets are at the highest level.
    fn introductions(&self, first: u32, faces: Range<u32>, note: impl FnMut(u32, u32)) {
        if self.attributes().seams {
            self.introduced(first, faces, |wedge| self.wedge_vertices[wedge as usize], note);
        } else {
            self.introduced(first, faces, |wedge| wedge, note);
        }
    }

    #[inline(always)]
    fn introduced(
        &self,
        first: u32,
        faces: Range<u32>,
        vertex_of: impl Fn(u32) -> u32,
        mut note: impl FnMut(u32, u32),
    ) {
        let base = self.base();
        let mut last = first;
        for face in faces {
            let [mut a, mut b, mut c] = self.corners[face as usize].map(&vertex_of);
            loop {
                // The latest of the three goes next; two that meet never part again.
                if b > a {
                    (a, b) = (b, a);
                }
                if c > a {
                    (a, c) = (c, a);
                }
                // From here on there is a vertex that collapses: `last` is the last one of the base at least.
                if a <= last {
                    break;
                }
                let parent = self.parents[(a - base) as usize];
                if parent == b || parent == c {
                    last = a;
                    break;
                }
                a = parent;
            }
            note(face, last);
        }
    }

    /// The finest level with at most `faces` faces, without steps: then the level is the highest.
    pub(super) fn find_level_of_faces(&self, faces: u32) -> u32 {
        let packets = &self.header.packets[..self.packets as usize];
        let packet = packets.partition_point(|entry| entry.faces.end <= faces);
        let Some(entry) = packets.get(packet) else { return self.max_level() };
        // The vertex with which there would be one face too many.
        let first = entry.vertices.start.max(self.base() - 1);
        let mut one_more = first;
        self.introductions(first, entry.faces.start..faces + 1, |_, last| one_more = last);
        one_more.max(self.base())
    }

    /// Finds out how to step through all levels; the level is the highest.
    fn prepare_steps(&mut self) {
        if self.steps.is_some() || self.packets == 0 {
            return;
        }
        let mut steps = Box::new(Steps { base: self.base(), ..Steps::default() });
        for entry in &self.header.packets[..self.packets as usize] {
            steps.introduce(self, entry);
        }
        let wedges = self.first_split_wedge()..self.wedges_of(self.max_level() - 1).end;
        let all = Passed { replay: self, steps: &steps, switched: &[], start: 0, levels: self.base() };
        let mut parts = Vec::new();
        Lists::build(wedges, &all, MOST, &mut parts);
        steps.parts = parts;
        self.steps = Some(steps);
    }

    /// Adds the packet that has just come to what is known of steps, if somebody has stepped.
    pub(super) fn extend_steps(&mut self, entry: &PacketEntry) {
        let Some(mut steps) = self.steps.take() else { return };
        steps.introduce(self, entry);
        let levels = entry.vertices.start + 1;
        let new = Passed {
            replay: self,
            steps: &steps,
            switched: &self.switched,
            start: entry.wedges.start,
            levels,
        };
        let mut parts = Vec::new();
        Lists::build(entry.wedges.clone(), &new, MOST, &mut parts);
        reserve(&mut steps.parts, parts.len(), self.header.packets.len());
        steps.parts.append(&mut parts);
        self.steps = Some(steps);
    }

    /// Adds and takes away vertices until `level` are there, which have all arrived.
    pub(super) fn walk(&mut self, level: u32) {
        if level == self.level {
            return;
        }
        self.prepare_steps();
        let Some(steps) = self.steps.take() else { return };
        self.touched.resize(self.corners.len(), self.header.face_count as usize);
        // Wedges are sorted by vertex, so that those of the vertices in between are these.
        let wedges =
            self.wedges_of(self.level.min(level)).start..self.wedges_of(self.level.max(level) - 1).end;
        if level > self.level {
            for part in &steps.parts {
                self.raise(part, within(&wedges, part));
            }
        } else {
            for part in steps.parts.iter().rev() {
                self.lower(part, within(&wedges, part));
            }
        }
        self.steps = Some(steps);
        self.level = level;
    }

    /// Adds the vertices of these wedges.
    fn raise(&mut self, part: &Lists, wedges: Range<u32>) {
        let corners = self.corners.as_flattened_mut();
        for wedge in wedges {
            for &slot in part.of(wedge) {
                corners[slot as usize] = wedge;
                self.touched.mark(slot / 3);
            }
        }
    }

    /// Takes the vertices of these wedges away.
    fn lower(&mut self, part: &Lists, wedges: Range<u32>) {
        let first = self.first_split_wedge();
        let targets = if self.attributes().seams { &self.wedge_targets } else { &self.parents };
        let corners = self.corners.as_flattened_mut();
        for wedge in wedges.rev() {
            let target = targets[(wedge - first) as usize];
            for &slot in part.of(wedge) {
                corners[slot as usize] = target;
                self.touched.mark(slot / 3);
            }
        }
    }
}

fn within(wedges: &Range<u32>, part: &Lists) -> Range<u32> {
    let all = part.wedges();
    wedges.start.max(all.start)..wedges.end.min(all.end)
}

/// The wedges that corners pass from the highest level down.
struct Passed<'a> {
    replay: &'a Replay,
    steps: &'a Steps,
    /// Slots of earlier faces, of which only the wedges from `start` on count.
    switched: &'a [u32],
    start: u32,
    /// Faces that are introduced from this level on, with all wedges that they pass.
    levels: u32,
}

impl Walks for Passed<'_> {
    fn each(&self, mut visit: impl FnMut(u32, u32)) {
        let Self { replay, steps, switched, start, levels } = *self;
        let (first, targets) = (replay.first_split_wedge(), replay.targets());
        let corners = replay.corners.as_flattened();
        // Wedges of the base go nowhere.
        let mut pass = |slot: u32, floor: u32| {
            let mut wedge = corners[slot as usize];
            while wedge >= floor {
                visit(wedge, slot);
                wedge = targets[(wedge - first) as usize];
            }
        };
        for &slot in switched {
            pass(slot, start);
        }
        let mut face = if levels == replay.base() { 0 } else { steps.faces_at(levels - 1) };
        for level in levels..=replay.max_level() {
            let end = steps.faces_at(level);
            // Those of the level itself are mapped so far that they have no wedge of a later vertex.
            let floor = replay.wedges_of(level - 1).end;
            for slot in 3 * face..3 * end {
                pass(slot, floor);
            }
            face = end;
        }
    }
}

#[cfg(test)]
mod tests;
