//! A second reader of `.pmesh` packets, written from `spec/pmesh.md` alone: slow and obvious, plain vectors, no list that is kept up
//! to date. It shares nothing with [`pmesh_format`] but the header and the packet directory, and says of a packet that breaks a
//! rule which one, and at which byte.

mod coded;
mod lattice;
mod raw;
mod starts;
#[cfg(test)]
mod tests;

use pmesh_format::{Header, IndexedMesh, Mode, Wedges};
use std::collections::BTreeMap;

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

/// What the packets say.
#[derive(Debug, Clone, Default)]
struct Tables {
    packets: usize,
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
    /// The faces of each level from the base on, with their corners as mapped there.
    levels: BTreeMap<usize, Vec<[usize; 3]>>,
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
            Mode::Coded => {
                let raw = coded.read(self.header, entry, payload)?;
                // Of coded packets everything is reported at their beginning (PMESH-COD-06).
                raw::take(&mut tables, self.header, entry, &raw).map_err(|fault| Fault { at: 0, ..fault })?;
            }
        }
        tables.packets += 1;
        self.tables = tables;
        self.coded = coded;
        Ok(())
    }

    /// The vertex counts that there are levels of.
    #[must_use]
    pub fn levels(&self) -> Vec<u32> {
        self.tables.levels.keys().map(|&level| level as u32).collect()
    }

    /// The mesh of that many vertices, without the names of materials; `None` if it is not there.
    #[must_use]
    pub fn level(&self, level: u32) -> Option<IndexedMesh> {
        let tables = &self.tables;
        let faces = tables.levels.get(&(level as usize))?;
        let wedges = tables.owners.iter().filter(|&&owner| owner < level as usize).count();
        let number = |n: &usize| *n as u32;
        Some(IndexedMesh {
            origin: self.header.origin,
            positions: tables.positions[..level as usize].to_vec(),
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
