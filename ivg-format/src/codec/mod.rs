//! The encodings: one file for each way of storing the values of a vertex. Each knows how its payload is laid out, which
//! bytes are forbidden, and how numbers become bytes and back.

pub(crate) mod harmonics;
pub(crate) mod packed;
pub(crate) mod vectors;

use ivg_wire::Code;

/// A rule of an encoding that a payload breaks, and where in the payload.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Broken {
    pub(crate) code: Code,
    pub(crate) at: usize,
}

/// A little-endian number of up to four bytes.
pub(crate) fn number(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |number, &b| number << 8 | u32::from(b))
}
