//! The only file that knows where the fields of the specific header, of a directory entry and of a packet lie
//! (`spec/tables/pmesh.toml`).
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use core::mem::offset_of;
use core::ops::Range;

use ivg_wire::{COMMON_HEADER_BYTES, ChunkKind, FormatId};
use zerocopy::little_endian::{F32, F64, U16, U32};
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

use crate::attributes::Attributes;
use crate::bits::width;
use crate::storage::Positions;

/// The major version that this crate reads and writes; 0 is a draft (COM-VER-01).
pub const MAJOR: u16 = 0;

/// The format, and the version that this crate reads and writes.
pub(crate) const FORMAT: FormatId = FormatId {
    magic: *b"\x89PMS\r\n\x1A\n",
    major: MAJOR,
    minor: 2,
    header_bytes: HEADER_BYTES as u32,
    features: 0,
};

/// Bytes of the whole header.
pub const HEADER_BYTES: usize = COMMON_HEADER_BYTES + size_of::<Specific>();

const _: () = assert!(HEADER_BYTES == 152 && HEADER_BYTES.is_multiple_of(8));

/// Type of the chunk that holds the packet directory.
pub const DIRECTORY: ChunkKind = ChunkKind(*b"PDIR");

/// Type of the chunk that holds the names of the materials.
pub const MATERIALS: ChunkKind = ChunkKind(*b"MTRL");

/// The header's bytes from 56 on.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub(crate) struct Specific {
    pub(crate) vertex_count: U32,
    pub(crate) wedge_count: U32,
    pub(crate) face_count: U32,
    pub(crate) base_vertices: U32,
    pub(crate) packet_count: U32,
    pub(crate) mode: u8,
    pub(crate) positions: u8,
    pub(crate) attributes: U16,
    pub(crate) origin: [F64; 3],
    pub(crate) bounds_min: [F32; 3],
    pub(crate) bounds_max: [F32; 3],
    pub(crate) normal_bits: u8,
    pub(crate) uv_bits: u8,
    pub(crate) reserved: U16,
    pub(crate) uv_min: [F32; 2],
    pub(crate) uv_max: [F32; 2],
    pub(crate) reserved_end: U32,
}

/// One entry of the packet directory.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub(crate) struct Entry {
    pub(crate) end_vertex: U32,
    pub(crate) end_wedge: U32,
    pub(crate) end_face: U32,
    pub(crate) payload_bytes: U32,
    pub(crate) error: F32,
}

/// Bytes of a directory entry.
pub(crate) const ENTRY_BYTES: usize = size_of::<Entry>();

const _: () = assert!(ENTRY_BYTES == 20);

/// Offsets of the fields, absolute for the header, within the entry for the directory: for errors and for the test
/// against the specification.
pub(crate) mod at {
    use super::{COMMON_HEADER_BYTES, Entry, Specific, offset_of};

    macro_rules! offsets {
        ($all:ident, $of:ty, $base:expr; $($constant:ident = $field:ident;)*) => {
            $(pub(crate) const $constant: u64 = ($base + offset_of!($of, $field)) as u64;)*
            /// Every field and its offset.
            #[cfg(test)]
            pub(crate) const $all: &[(&str, u64)] = &[$((stringify!($field), $constant)),*];
        };
    }

    offsets! { HEADER, Specific, COMMON_HEADER_BYTES;
        VERTEX_COUNT = vertex_count;
        WEDGE_COUNT = wedge_count;
        FACE_COUNT = face_count;
        BASE_VERTICES = base_vertices;
        PACKET_COUNT = packet_count;
        MODE = mode;
        POSITIONS = positions;
        ATTRIBUTES = attributes;
        ORIGIN = origin;
        BOUNDS_MIN = bounds_min;
        BOUNDS_MAX = bounds_max;
        NORMAL_BITS = normal_bits;
        UV_BITS = uv_bits;
        RESERVED = reserved;
        UV_MIN = uv_min;
        UV_MAX = uv_max;
        RESERVED_END = reserved_end;
    }

    offsets! { ENTRY, Entry, 0;
        END_VERTEX = end_vertex;
        END_WEDGE = end_wedge;
        END_FACE = end_face;
        PAYLOAD_BYTES = payload_bytes;
        ERROR = error;
    }
}

/// How many of each thing a packet holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PacketCounts {
    pub(crate) vertices: u32,
    pub(crate) wedges: u32,
    pub(crate) faces: u32,
    /// Vertices that collapse: those from the base on.
    pub(crate) splits: u32,
    /// Vertices of this and all earlier packets.
    pub(crate) end_vertex: u32,
}

/// Where the parts of a raw packet lie in its payload whose lengths follow from the directory (PMESH-PKT-02).
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PacketLayout {
    pub(crate) switch_count: Range<usize>,
    pub(crate) positions: Range<usize>,
    pub(crate) normals: Range<usize>,
    pub(crate) uvs: Range<usize>,
    pub(crate) colours: Range<usize>,
    pub(crate) corners: Range<usize>,
    pub(crate) materials: Range<usize>,
    /// Packed, so many bits each.
    pub(crate) parents: Range<usize>,
    pub(crate) parent_bits: u32,
    /// Numbers of variable length, then switches, begin here.
    pub(crate) rest: usize,
}

/// Bytes of an element of each array: one u32, three binary32 numbers or four u16, two binary32 numbers, four bytes, three u32,
/// one u16.
pub(crate) const COUNT_BYTES: usize = 4;
pub(crate) const VECTOR_BYTES: usize = 12;
pub(crate) const QUANTISED_BYTES: usize = 8;
pub(crate) const UV_BYTES: usize = 8;
pub(crate) const COLOUR_BYTES: usize = 4;
pub(crate) const CORNERS_BYTES: usize = 12;
pub(crate) const MATERIAL_BYTES: usize = 2;

impl PacketLayout {
    /// The layout; `None` if it does not fit in the address space.
    pub(crate) fn new(counts: PacketCounts, attributes: Attributes, positions: Positions) -> Option<Self> {
        let mut end = 0usize;
        let mut array = |present: bool, count: u32, bytes: usize| {
            let start = end;
            if present {
                end = usize::try_from(count).ok()?.checked_mul(bytes)?.checked_add(start)?;
            }
            Some(start..end)
        };
        let position_bytes = if positions == Positions::F32 { VECTOR_BYTES } else { QUANTISED_BYTES };
        let PacketCounts { vertices, wedges, faces, splits, end_vertex } = counts;
        let parent_bits = width(end_vertex);
        Some(Self {
            switch_count: array(true, 1, COUNT_BYTES)?,
            positions: array(true, vertices, position_bytes)?,
            normals: array(attributes.normals, wedges, VECTOR_BYTES)?,
            uvs: array(attributes.uvs, wedges, UV_BYTES)?,
            colours: array(attributes.colours, wedges, COLOUR_BYTES)?,
            corners: array(true, faces, CORNERS_BYTES)?,
            materials: array(attributes.materials, faces, MATERIAL_BYTES)?,
            parents: {
                let bits = u64::from(splits).checked_mul(parent_bits.into())?;
                let bytes = u32::try_from(bits.div_ceil(8)).ok()?;
                array(true, bytes, 1)?
            },
            parent_bits,
            rest: end,
        })
    }
}

#[cfg(test)]
mod tests;
