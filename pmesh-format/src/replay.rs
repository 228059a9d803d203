//! The mesh at any level of what has arrived: packets go in, levels come out.
//!
//! A packet says how the mesh is at its end. What happens in between, which corner slots switch to each vertex and which faces
//! it introduces, is found out when somebody steps to another level for the first time; from then on packet by packet.
//! Adding a vertex or taking it away touches these slots and nothing else.

use alloc::boxed::Box;
use alloc::string::String;
use alloc::vec::Vec;
use core::ops::{Range, RangeInclusive};

use ivg_wire::Error;

use crate::attributes::Attributes;
use crate::code::codes;
use crate::coded::State;
use crate::decode::Event;
use crate::header::Header;
use crate::material::material_names;
use crate::mesh::{IndexedMesh, Wedges};
use crate::packet::Packet;
use crate::storage::Mode;
use crate::wire::MATERIALS;

mod arrays;
mod change;
mod descent;
mod levels;
mod load;
mod steps;
mod switch;
mod touched;
mod whole;

pub use change::{LevelChange, LevelError};
pub(crate) use descent::{Descendants, Descent};
use steps::Steps;
pub(crate) use switch::DEPTHS_A_BYTE;
use touched::{Touched, faces_of};

/// A mesh that can be shown at any number of vertices that has arrived.
///
/// Its arrays only ever grow; a level is a prefix of each. The vertex buffer of a graphics processor needs no change but
/// appending, the index buffer those of [`LevelChange::changed`].
#[derive(Clone, Debug, Default)]
pub struct Replay {
    header: Header,
    material_names: Vec<String>,
    /// Packets that are in.
    packets: u32,
    /// The vertex count that the arrays show.
    level: u32,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    colours: Vec<[u8; 4]>,
    /// Wedge indices of the faces: those of the level as mapped there, later ones as introduced.
    corners: Vec<[u32; 3]>,
    materials: Vec<u16>,
    /// Parents of the vertices from the base on.
    parents: Vec<u32>,
    /// Empty where wedge and vertex are the same, as the next two are: the end of each vertex's wedges.
    wedge_ends: Vec<u32>,
    /// The vertex of each wedge.
    wedge_vertices: Vec<u32>,
    /// What each wedge from those of the base on becomes.
    wedge_targets: Vec<u32>,
    /// How to step from level to level; `None` until somebody does.
    steps: Option<Box<Steps>>,
    /// What has been learnt from coded packets.
    coded: Option<Box<State>>,
    /// The slots of earlier faces that the last packet has switched.
    switched: Vec<u32>,
    /// Which wedges of a packet descend from which.
    descent: Descent,
    /// Faces of which a corner has switched since the last report.
    touched: Touched,
}

impl Replay {
    /// For the packets of the file with this header.
    #[must_use]
    pub fn new(header: &Header) -> Self {
        Self { header: header.clone(), ..Self::default() }
    }

    /// Takes whatever a decoder found: starts anew with a header, notes the names of materials, applies packets.
    ///
    /// # Errors
    ///
    /// As [`Replay::apply`]; or the names of the materials cannot be read.
    pub fn accept(&mut self, event: &Event<'_>) -> Result<Option<LevelChange>, Error> {
        match event {
            Event::Header(header) => *self = Self::new(header),
            Event::Chunk(chunk) if chunk.kind == MATERIALS => {
                self.material_names = material_names(chunk)?.map(String::from).collect();
            }
            Event::Packet(packet) => return self.apply(packet).map(Some),
            Event::Chunk(_) | Event::End => {}
        }
        Ok(None)
    }

    /// Takes the next packet and goes to the highest level that it brings.
    ///
    /// # Errors
    ///
    /// The first rule that the packet breaks, with its place in the file; the packet is not the next one of this file. What
    /// has arrived before, and the level, stay as they were.
    pub fn apply(&mut self, packet: &Packet<'_>) -> Result<LevelChange, Error> {
        let from = self.level;
        let faces = self.face_count();
        self.take(packet)?;
        let earlier = packet.entry().faces.start;
        if self.header.mode == Mode::Raw && from == packet.entry().vertices.start {
            // Nothing has changed but what the packet says, in order.
            let changed = faces_of(&self.switched, faces, self.face_count());
            return Ok(LevelChange { from, to: self.level, changed });
        }
        self.touched.resize(earlier as usize, self.header.face_count as usize);
        self.switched.iter().for_each(|slot| self.touched.mark(slot / 3));
        Ok(self.report(from, faces))
    }

    /// Takes in the next packet; the level is the highest then.
    fn take(&mut self, packet: &Packet<'_>) -> Result<(), Error> {
        if packet.index() != self.packets || packet.header().content_id != self.header.content_id {
            return Err(packet.error(codes::PACKET_ORDER, 0));
        }
        let from = self.level;
        self.touched.clear();
        self.walk(self.max_level());
        if let Err((code, at)) = self.load(packet) {
            self.truncate(packet);
            self.walk(from);
            self.touched.clear();
            return Err(packet.error(code, at));
        }
        self.level = packet.entry().vertices.end;
        self.packets += 1;
        self.extend_steps(packet.entry());
        if self.packets == self.header.packet_count() {
            // No packet will need them again.
            self.coded = None;
            self.descent = Descent::default();
        }
        Ok(())
    }

    /// Goes to the level of `level` vertices. Every level is a valid mesh (PMESH-LVL-02), whichever way it is reached; which are
    /// *whole*, and so free of faces on the same vertices wherever the writer kept to PMESH-LVL-03, [`Header::is_whole_level`]
    /// says: all of a raw file, and of a coded one the ends of packets.
    ///
    /// # Errors
    ///
    /// The level is below the coarsest one or above [`Replay::max_level`]; nothing has changed then.
    pub fn set_level(&mut self, level: u32) -> Result<LevelChange, LevelError> {
        let levels = self.levels();
        if !levels.as_ref().is_some_and(|levels| levels.contains(&level)) {
            return Err(LevelError { asked: level, levels });
        }
        let (from, faces) = (self.level, self.face_count());
        self.touched.clear();
        self.walk(level);
        Ok(self.report(from, faces))
    }

    /// The header of the file.
    #[must_use]
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// How many packets are in.
    #[must_use]
    pub fn packets(&self) -> u32 {
        self.packets
    }

    /// The levels that can be shown; `None` before the first packet of a mesh that has any.
    #[must_use]
    pub fn levels(&self) -> Option<RangeInclusive<u32>> {
        let there = self.packets > 0 || self.header.vertex_count == 0;
        there.then(|| self.header.base_vertices..=self.max_level())
    }

    /// The vertex count of the highest level that can be shown; 0 before the first packet.
    #[must_use]
    pub fn max_level(&self) -> u32 {
        self.positions.len() as u32
    }

    /// The vertex count of the level that the arrays show; 0 before the first packet.
    #[must_use]
    pub fn level(&self) -> u32 {
        self.level
    }

    /// Estimated error of the level, or more \[m\]: that of the packet which holds its last vertex (PMESH-DIR-05). Infinite
    /// before the first packet, 0 at the finest level.
    #[must_use]
    pub fn error(&self) -> f32 {
        if self.level == self.header.vertex_count {
            return 0.0;
        }
        let entry = self.header.packet_of_level(self.level).and_then(|k| self.header.packets.get(k as usize));
        entry.map_or(f32::INFINITY, |entry| entry.error)
    }

    /// Positions of the level's vertices relative to [`Header::origin`] \[m\].
    #[must_use]
    pub fn positions(&self) -> &[[f32; 3]] {
        &self.positions[..self.level as usize]
    }

    /// How many wedges the level has.
    #[must_use]
    pub fn wedge_count(&self) -> u32 {
        self.level.checked_sub(1).map_or(0, |last| self.wedges_of(last).end)
    }

    /// Normals of the level's wedges; empty if the file has none.
    #[must_use]
    pub fn normals(&self) -> &[[f32; 3]] {
        prefix(&self.normals, self.wedge_count())
    }

    /// Texture coordinates of the level's wedges; empty if the file has none.
    #[must_use]
    pub fn uvs(&self) -> &[[f32; 2]] {
        prefix(&self.uvs, self.wedge_count())
    }

    /// Colours of the level's wedges; empty if the file has none.
    #[must_use]
    pub fn colours(&self) -> &[[u8; 4]] {
        prefix(&self.colours, self.wedge_count())
    }

    /// The vertex that a wedge of the level belongs to.
    ///
    /// # Panics
    ///
    /// If there is no such wedge.
    #[must_use]
    pub fn wedge_vertex(&self, wedge: u32) -> u32 {
        assert!(wedge < self.wedge_count(), "wedge {wedge} of {}", self.wedge_count());
        self.vertex_of(wedge)
    }

    /// How many faces the level has.
    #[must_use]
    pub fn face_count(&self) -> u32 {
        self.faces_at(self.level)
    }

    /// Wedge indices of the level's faces, in the order of introduction.
    #[must_use]
    pub fn indices(&self) -> &[[u32; 3]] {
        &self.corners[..self.face_count() as usize]
    }

    /// Materials of the level's faces; empty if every face has material 0.
    #[must_use]
    pub fn face_materials(&self) -> &[u16] {
        prefix(&self.materials, self.face_count())
    }

    /// Names of the materials, as far as the file gave them to [`Replay::accept`].
    #[must_use]
    pub fn material_names(&self) -> &[String] {
        &self.material_names
    }

    /// The level as a mesh of its own.
    #[must_use]
    pub fn mesh(&self) -> IndexedMesh {
        IndexedMesh {
            origin: self.header.origin,
            positions: self.positions().to_vec(),
            wedges: Wedges {
                vertices: (0..self.wedge_count()).map(|w| self.vertex_of(w)).collect(),
                normals: self.normals().to_vec(),
                uvs: self.uvs().to_vec(),
                colours: self.colours().to_vec(),
            },
            triangles: self.indices().to_vec(),
            materials: self.face_materials().to_vec(),
            material_names: self.material_names.clone(),
        }
    }

    fn attributes(&self) -> Attributes {
        self.header.attributes
    }

    fn base(&self) -> u32 {
        self.header.base_vertices
    }

    /// The wedges of a vertex that has arrived.
    fn wedges_of(&self, vertex: u32) -> Range<u32> {
        if !self.attributes().seams {
            return vertex..vertex + 1;
        }
        let start = vertex.checked_sub(1).and_then(|before| self.wedge_ends.get(before as usize));
        start.copied().unwrap_or(0)..self.wedge_ends.get(vertex as usize).copied().unwrap_or(0)
    }

    /// The vertex of a wedge that has arrived.
    fn vertex_of(&self, wedge: u32) -> u32 {
        if self.attributes().seams { self.wedge_vertices[wedge as usize] } else { wedge }
    }

    /// The first wedge of a vertex that collapses, once the base has arrived.
    fn first_split_wedge(&self) -> u32 {
        self.wedges_of(self.base()).start
    }

    /// What each wedge from [`Replay::first_split_wedge`] on becomes when its vertex goes.
    fn targets(&self) -> &[u32] {
        if self.attributes().seams { &self.wedge_targets } else { &self.parents }
    }

    fn faces_at(&self, level: u32) -> u32 {
        match &self.steps {
            // Without, the level is the finest, or there is none yet.
            None => self.corners.len() as u32,
            Some(steps) => steps.faces_at(level),
        }
    }

    /// What has changed since the level was `from`, with that many faces.
    fn report(&mut self, from: u32, faces_before: u32) -> LevelChange {
        let faces = self.face_count();
        let changed = self.touched.report(faces_before.min(faces), faces);
        LevelChange { from, to: self.level, changed }
    }
}

fn prefix<T>(array: &[T], count: u32) -> &[T] {
    if array.is_empty() { array } else { &array[..count as usize] }
}

#[cfg(test)]
mod tests;
