//! The directory of the order `explicit`: how many vertices each bundle has, and where it lies (`spec/ivg.md`, "Order").
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use crate::code::codes;
use crate::order::explicit::INDEX_BYTES;
use alloc::sync::Arc;
use alloc::vec::Vec;
use ivg_wire::{ByteOffset, Chunk, ChunkKind, Code, Error, Part};

/// Type of the chunk that holds the directory: critical, and the first chunk of every file of the order `explicit`
/// (IVG-DIRE-01).
pub const DIRECTORY: ChunkKind = ChunkKind(*b"DIRE");

/// Bytes of an entry: two u32 (IVG-DIRE-02).
const ENTRY_BYTES: usize = 8;

/// What the directory says of each bundle. Cloning it copies a pointer.
///
/// Held as 16 bytes a bundle, twice what is stored: the start of each is known without adding up.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Directory(Arc<[Entry]>);

/// One bundle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Entry {
    /// Number of vertices.
    pub(crate) vertices: u32,
    /// Bytes of the list of vertices.
    pub(crate) index_bytes: u32,
    /// Bytes of all records of bundles before this one.
    pub(crate) start: u64,
}

/// What the entries are judged by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    /// Number of bundles in the header.
    pub(crate) bundles: u32,
    /// Vertices of the lattice that are not corners.
    pub(crate) vertices: u64,
    /// Whether vertices may be in no bundle: where a validity section can say which.
    pub(crate) may_lack: bool,
    /// The most vertices of a bundle.
    pub(crate) per_bundle: u64,
    /// Bytes of the values of a vertex.
    pub(crate) vertex_bytes: u64,
    /// The longest record that the reader takes.
    pub(crate) record_limit: u32,
}

impl Directory {
    /// The directory in a chunk (IVG-DIRE-03).
    pub(crate) fn read(chunk: &Chunk<'_>, bounds: &Bounds) -> Result<Self, Error> {
        let base = chunk.payload_offset().0;
        let fail = |code: Code, at: u64| {
            Err(Error::new(code, ByteOffset(base.saturating_add(at)), Part::Chunk(DIRECTORY)))
        };
        let (entries, rest) = chunk.payload.as_chunks::<ENTRY_BYTES>();
        if !rest.is_empty() || entries.len() as u64 != u64::from(bounds.bundles) {
            return fail(codes::DIRECTORY_ENTRIES, 0);
        }
        let (mut vertices, mut at) = (0u64, 0u64);
        for entry in entries {
            let entry = Entry::parse(entry);
            if let Some((code, field)) = entry.fault(bounds) {
                return fail(code, at.saturating_add(field));
            }
            vertices = vertices.saturating_add(u64::from(entry.vertices));
            if vertices > bounds.vertices {
                return fail(codes::DIRECTORY_VERTICES, at);
            }
            at = at.saturating_add(ENTRY_BYTES as u64);
        }
        if vertices < bounds.vertices && !bounds.may_lack {
            return fail(codes::DIRECTORY_VERTICES, at);
        }
        Ok(Self::of(entries.iter().map(Entry::parse), bounds.vertex_bytes))
    }

    /// The directory of these bundles. Allocates once, for `entries` says how many there are.
    pub(crate) fn of(entries: impl Iterator<Item = Entry>, vertex_bytes: u64) -> Self {
        let mut start = 0u64;
        Self(
            entries
                .map(|entry| {
                    let placed = Entry { start, ..entry };
                    start = start.saturating_add(entry.record_len(vertex_bytes));
                    placed
                })
                .collect(),
        )
    }

    /// Appends the payload of the chunk.
    pub(crate) fn write(&self, out: &mut Vec<u8>) {
        for entry in &*self.0 {
            out.extend_from_slice(&entry.vertices.to_le_bytes());
            out.extend_from_slice(&entry.index_bytes.to_le_bytes());
        }
    }

    /// The entry of bundle `k`, counted from 1.
    pub(crate) fn get(&self, k: u32) -> Option<&Entry> {
        self.0.get(usize::try_from(k.checked_sub(1)?).ok()?)
    }

    /// Bytes of the records of all bundles.
    pub(crate) fn bundle_bytes(&self, vertex_bytes: u64) -> u64 {
        self.0.last().map_or(0, |last| last.start.saturating_add(last.record_len(vertex_bytes)))
    }
}

impl Entry {
    /// An entry whose start is not known yet.
    pub(crate) const fn new(vertices: u32, index_bytes: u32) -> Self {
        Self { vertices, index_bytes, start: 0 }
    }

    fn parse(bytes: &[u8; ENTRY_BYTES]) -> Self {
        let [v0, v1, v2, v3, i0, i1, i2, i3] = *bytes;
        Self::new(u32::from_le_bytes([v0, v1, v2, v3]), u32::from_le_bytes([i0, i1, i2, i3]))
    }

    /// Bytes of the payload.
    pub(crate) fn payload_len(&self, vertex_bytes: u64) -> u64 {
        u64::from(self.vertices).saturating_mul(vertex_bytes).saturating_add(u64::from(self.index_bytes))
    }

    fn record_len(&self, vertex_bytes: u64) -> u64 {
        // Two u32 and a small factor: no overflow.
        ivg_wire::record_len(self.payload_len(vertex_bytes)).unwrap_or(u64::MAX)
    }

    /// What is wrong with the entry alone, and at which of its bytes.
    fn fault(&self, bounds: &Bounds) -> Option<(Code, u64)> {
        let (vertices, index_bytes) = (u64::from(self.vertices), u64::from(self.index_bytes));
        let length = self.record_len(bounds.vertex_bytes);
        if !(1..=bounds.per_bundle).contains(&vertices) {
            Some((codes::DIRECTORY_VERTICES, 0))
        } else if !(vertices..=vertices.saturating_mul(INDEX_BYTES)).contains(&index_bytes) {
            Some((codes::DIRECTORY_INDEX, 4))
        } else if length > u64::from(ivg_wire::Maximum::RECORD_BYTES) {
            Some((codes::RECORD_TOO_LARGE, 0))
        } else if length > u64::from(bounds.record_limit) {
            Some((ivg_wire::codes::LIMIT_RECORD_BYTES, 0))
        } else {
            None
        }
    }
}
