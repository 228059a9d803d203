//! The only file that knows where the fields of the specific header lie (`spec/tables/ivg.toml`).

use core::mem::offset_of;
use ivg_wire::{COMMON_HEADER_BYTES, FormatId};
use zerocopy::little_endian::{F64, I16, U16, U32, U64};
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

/// The major version that this crate reads and writes; 0 is a draft (COM-VER-01).
pub const MAJOR: u16 = 0;

/// The format, and the version that this crate reads and writes.
pub(crate) const FORMAT: FormatId = FormatId {
    magic: *b"\x89IVG\r\n\x1A\n",
    major: MAJOR,
    minor: 1,
    header_bytes: HEADER_BYTES as u32,
    features: 0,
};

/// Bytes of the whole header.
pub const HEADER_BYTES: usize = COMMON_HEADER_BYTES + size_of::<Specific>();

const _: () = assert!(HEADER_BYTES == 144 && HEADER_BYTES.is_multiple_of(8));

/// The header's bytes from 56 on.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub(crate) struct Specific {
    pub(crate) dims: [U16; 3],
    pub(crate) encoding: U16,
    pub(crate) origin: [F64; 3],
    pub(crate) step: [F64; 3],
    pub(crate) order: U16,
    pub(crate) scale_exponent: I16,
    pub(crate) vertices_per_slice: U32,
    pub(crate) seed: U64,
    pub(crate) bundle_count: U32,
    pub(crate) validity_records: U32,
    pub(crate) units: u8,
    pub(crate) reserved: [u8; 7],
}

/// Absolute offsets of the fields, for errors and for the test against the specification.
pub(crate) mod at {
    use super::{COMMON_HEADER_BYTES, Specific, offset_of};

    macro_rules! offsets {
        ($($constant:ident = $field:ident;)*) => {
            $(pub(crate) const $constant: u64 = (COMMON_HEADER_BYTES + offset_of!(Specific, $field)) as u64;)*
        };
    }

    offsets! {
        DIMS = dims;
        ENCODING = encoding;
        ORIGIN = origin;
        STEP = step;
        ORDER = order;
        SCALE_EXPONENT = scale_exponent;
        VERTICES_PER_SLICE = vertices_per_slice;
        BUNDLE_COUNT = bundle_count;
        VALIDITY_RECORDS = validity_records;
        UNITS = units;
        RESERVED = reserved;
    }
}

#[cfg(test)]
mod tests;
