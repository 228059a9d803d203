//! A second reader of `.pmesh` packets, written from `spec/pmesh.md` alone: slow and obvious, plain vectors, no list that is kept up
//! to date. It shares nothing with [`pmesh_format`] but the header and the packet directory, and says of a packet that breaks a
//! rule which one, and at which byte.

mod coded;
mod lattice;
mod numbers;
mod raw;
mod starts;
mod switches;
#[cfg(test)]
mod tests;

use pmesh_format::{Header, IndexedMesh, Mode, PacketEntry, Wedges};
use std::collections::BTreeMap;

pub use coded::{Asked, LAST_STATES, payload_of};

/// A rule that a packet breaks: its code in `spec/tables/errors.toml`, and the byte of the payload at which it is reported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fault {
    /// The code.
    pub code: u16,
    /// The byte of the payload.
    pub at: usize,
}

/// The mesh at every level of the packets that have been taken.
#[derive(Debug, Clone)]
pub struct Reference<'a> {
    header: &'a Header,
    tables: Tables,
    coded: coded::Coded,
}

/// What the packets say. Packets of either mode leave the same here.
#[derive(Debug, Clone, Default)]
struct Tables {
    packets: usize,
    /// Vertices that are there.
    vertices: usize,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    colours: Vec<[u8; 4]>,
    /// The vertex of each wedge.
    owners: Vec<usize>,
    /// What each vertex, and each wedge, from the base on collapses onto.
    parents: BTreeMap<usize, usize>,
    targets: BTreeMap<usize, usize>,
    materials: Vec<u16>,
    /// The corners of the faces at the finest level that is there.
    corners: Vec<[usize; 3]>,
    /// The level from which on each face is there (PMESH-FACE-05).
    from: Vec<usize>,
}

impl Tables {
    /// A wedge mapped at a level (PMESH-DEF-04).
    fn mapped(&self, mut wedge: usize, level: usize) -> usize {
        while self.owners[wedge] >= level {
            wedge = self.targets[&wedge];
        }
        wedge
    }

    /// Whether the corners of a face, mapped at a level, lie on three vertices.
    fn is_face(&self, face: [usize; 3], level: usize) -> bool {
        let [a, b, c] = face.map(|wedge| self.owners[self.mapped(wedge, level)]);
        a != b && b != c && c != a
    }

    /// The wedges of a vertex.
    fn wedges_of(&self, vertex: usize) -> Vec<usize> {
        (0..self.owners.len()).filter(|&w| self.owners[w] == vertex).collect()
    }

    /// PMESH-FACE-05: from which level on the faces of the packet that came last are there.
    fn introduce(&mut self, header: &Header, entry: &PacketEntry) {
        let start = entry.vertices.start as usize;
        let mut level = if start == 0 { header.base_vertices as usize } else { start + 1 };
        for face in self.from.len()..self.corners.len() {
            // Corners that lie on three vertices at a level do so at all above it.
            while !self.is_face(self.corners[face], level) {
                level += 1;
            }
            self.from.push(level);
        }
    }
}

impl<'a> Reference<'a> {
    /// For the packets of the file with this header.
    #[must_use]
    pub fn new(header: &'a Header) -> Self {
        Self { header, tables: Tables::default(), coded: coded::Coded::new() }
    }

    /// Takes the payload of the next packet.
    ///
    /// # Errors
    ///
    /// The rule that it breaks; nothing has changed then.
    ///
    /// # Panics
    ///
    /// If there is no further packet, or the payload has another length than the directory says.
    pub fn take(&mut self, payload: &[u8]) -> Result<(), Fault> {
        let entry = &self.header.packets[self.tables.packets];
        assert_eq!(payload.len(), entry.payload_bytes as usize, "the directory says how long it is");
        let mut tables = self.tables.clone();
        let mut coded = self.coded.clone();
        match self.header.mode {
            Mode::Raw => raw::take(&mut tables, self.header, entry, payload)?,
            Mode::Coded => coded.take(&mut tables, self.header, entry, payload)?,
        }
        tables.introduce(self.header, entry);
        tables.vertices = entry.vertices.end as usize;
        tables.packets += 1;
        self.tables = tables;
        self.coded = coded;
        Ok(())
    }

    /// What reading `payload`, that of the next packet of a coded file, asks, and the answers; at `Some`, these instead, the greatest
    /// there is where one is too great, and 0 when they end. And the code of what is wrong with them, as far as symbols go.
    ///
    /// # Panics
    ///
    /// If there is no further packet, or the payload has less than 8 bytes.
    #[must_use]
    pub fn asked(&self, payload: &[u8], answers: Option<Vec<i64>>) -> (Vec<Asked>, Option<u16>) {
        let entry = &self.header.packets[self.tables.packets];
        let (asked, fault) = self.coded.clone().asked(self.header, entry, payload, answers);
        (asked, fault.map(|fault| fault.code))
    }

    /// The vertex counts that there are levels of.
    #[must_use]
    pub fn levels(&self) -> Vec<u32> {
        if self.tables.packets == 0 {
            return Vec::new();
        }
        (self.header.base_vertices..=self.tables.vertices as u32).collect()
    }

    /// The mesh of that many vertices, without the names of materials; `None` if it is not there.
    #[must_use]
    pub fn level(&self, level: u32) -> Option<IndexedMesh> {
        if !self.levels().contains(&level) {
            return None;
        }
        let tables = &self.tables;
        let vertices = level as usize;
        let wedges = tables.owners.iter().filter(|&&owner| owner < vertices).count();
        let faces: Vec<[usize; 3]> = tables
            .corners
            .iter()
            .zip(&tables.from)
            .filter(|&(_, &from)| from <= vertices)
            .map(|(face, _)| face.map(|wedge| tables.mapped(wedge, vertices)))
            .collect();
        let number = |n: &usize| *n as u32;
        Some(IndexedMesh {
            origin: self.header.origin,
            positions: tables.positions[..vertices].to_vec(),
            wedges: Wedges {
                vertices: tables.owners[..wedges].iter().map(number).collect(),
                normals: tables.normals.iter().take(wedges).copied().collect(),
                uvs: tables.uvs.iter().take(wedges).copied().collect(),
                colours: tables.colours.iter().take(wedges).copied().collect(),
            },
            triangles: faces.iter().map(|face| face.map(|w| w as u32)).collect(),
            materials: tables.materials.iter().take(faces.len()).copied().collect(),
            material_names: Vec::new(),
        })
    }
}
