//! The validity section: which vertices light can reach, and which ways between neighbours geometry blocks.
//!
//! Received, valid and blocked are three different things: a vertex may have arrived and lie inside a wall.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use crate::code::codes;
use crate::header::{Header, RecordId, VALIDITY_BLOCK};
use ivg_wire::{ByteOffset, Error, Part};

/// Validity and blocked edges of up to 4096 vertices, consecutive in linear index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValidityBlock<'a> {
    header: &'a Header,
    id: RecordId,
    generation: u32,
    first: u64,
    validity: &'a [u8],
    edges: &'a [u8],
}

impl<'a> ValidityBlock<'a> {
    /// Splits and checks a payload whose length is the one that the header gives.
    pub(crate) fn check(
        header: &'a Header,
        j: u32,
        generation: u32,
        payload: &'a [u8],
        offset: ByteOffset,
    ) -> Result<Self, Error> {
        let id = RecordId::Validity(j);
        let fail = |code, at: usize| {
            let at = ByteOffset(offset.0.saturating_add(at as u64));
            Err(Error::new(code, at, Part::Record(id.stored())))
        };
        let count = header.record_vertices(id) as usize;
        let Some((validity, edges)) = payload.split_at_checked(count) else {
            return fail(ivg_wire::codes::RECORD_LENGTH, 0);
        };
        let first = u64::from(j).saturating_mul(VALIDITY_BLOCK);
        let block = Self { header, id, generation, first, validity, edges };
        let used = count.saturating_mul(3) % 8;
        if let Some(&last) = edges.last().filter(|_| used != 0)
            && last >> used != 0
        {
            return fail(codes::UNUSED_BITS, payload.len().saturating_sub(1));
        }
        let last = header.lattice.dims.map(|n| n.saturating_sub(1));
        for n in 0..count {
            let blocked = block.blocked_edges(n);
            if blocked == 0 {
                continue;
            }
            let coords = header.lattice.coords(first.saturating_add(n as u64));
            let outward = (0..3u8).zip(coords).zip(last).any(|((axis, at), end)| {
                at == end && blocked.checked_shr(u32::from(axis)).is_some_and(|bits| bits & 1 != 0)
            });
            if outward {
                return fail(codes::EDGE_OUTSIDE, count.saturating_add(n.saturating_mul(3) / 8));
            }
        }
        Ok(block)
    }

    /// The header of the file.
    #[must_use]
    pub const fn header(&self) -> &'a Header {
        self.header
    }

    /// Which record this is.
    #[must_use]
    pub const fn id(&self) -> RecordId {
        self.id
    }

    /// The record's generation: of two with one id, the higher counts.
    #[must_use]
    pub const fn generation(&self) -> u32 {
        self.generation
    }

    /// Linear index of the block's first vertex.
    #[must_use]
    pub const fn first_vertex(&self) -> u64 {
        self.first
    }

    /// Number of vertices.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.validity.len()
    }

    /// Whether the block has no vertex; a file has no such block.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.validity.is_empty()
    }

    /// Validity of each vertex: 0 inside geometry … 255 all free.
    #[must_use]
    pub const fn validity(&self) -> &'a [u8] {
        self.validity
    }

    /// Blocked edges of vertex `n` of the block: bit 0, 1, 2 set where geometry cuts the way to the neighbour
    /// in +x, +y, +z. 0 beyond the block's end.
    #[must_use]
    pub fn blocked_edges(&self, n: usize) -> u8 {
        let bit = n.saturating_mul(3);
        let byte = |at: usize| u16::from(self.edges.get(at).copied().unwrap_or(0));
        let pair = byte(bit / 8) | byte((bit / 8).saturating_add(1)) << 8;
        ((pair >> (bit % 8)) & 7) as u8
    }
}

/// The payload of the validity record for the vertices of `range`.
pub(crate) fn write(
    out: &mut alloc::vec::Vec<u8>,
    vertices: core::ops::Range<usize>,
    validity: Option<&[u8]>,
    blocked_edges: Option<&[u8]>,
) {
    match validity.and_then(|all| all.get(vertices.clone())) {
        Some(block) => out.extend_from_slice(block),
        None => out.resize(out.len().saturating_add(vertices.len()), u8::MAX),
    }
    let start = out.len();
    out.resize(start.saturating_add(vertices.len().saturating_mul(3).div_ceil(8)), 0);
    let Some(blocked) = blocked_edges.and_then(|all| all.get(vertices)) else { return };
    for (n, &bits) in blocked.iter().enumerate() {
        let bit = n.saturating_mul(3);
        let [low, high] = (u16::from(bits & 7) << (bit % 8)).to_le_bytes();
        let at = start.saturating_add(bit / 8);
        for (place, value) in [(at, low), (at.saturating_add(1), high)] {
            if let Some(byte) = out.get_mut(place) {
                *byte |= value;
            }
        }
    }
}
