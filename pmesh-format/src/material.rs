//! The `MTRL` chunk: names of the materials.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use alloc::string::String;
use alloc::vec::Vec;

use ivg_wire::{Chunk, Cursor, Error, Part};

use crate::code::codes;

/// The names in the payload of a `MTRL` chunk, by material index.
///
/// # Errors
///
/// Malformed, at the byte where reading stopped, if a name is not UTF-8 or bytes are missing or left over (PMESH-MTRL-02).
pub fn material_names<'a>(chunk: &Chunk<'a>) -> Result<impl Iterator<Item = &'a str> + use<'a>, Error> {
    let part = Part::Chunk(chunk.kind);
    let start = || Cursor::new(chunk.payload, chunk.payload_offset(), part);
    let mut check = start();
    while !check.rest().is_empty() {
        // Running out of bytes inside a chunk that is whole is not a truncation of the file.
        next_name(&mut check).map_err(|error| Error::new(codes::MATERIAL_NAMES, error.offset(), part))?;
    }
    let mut cursor = start();
    Ok(core::iter::from_fn(move || next_name(&mut cursor).ok()))
}

fn next_name<'a>(cursor: &mut Cursor<'a>) -> Result<&'a str, Error> {
    let length = cursor.u16()?;
    let at = cursor.offset();
    let name = cursor.take(usize::from(length))?;
    core::str::from_utf8(name).map_err(|_| Error::new(codes::MATERIAL_NAMES, at, Part::Chunks))
}

/// The payload of a `MTRL` chunk; `None` if a name is longer than 65,535 bytes.
pub(crate) fn write_names(names: &[String]) -> Option<Vec<u8>> {
    let mut out = Vec::new();
    for name in names {
        out.extend_from_slice(&u16::try_from(name.len()).ok()?.to_le_bytes());
        out.extend_from_slice(name.as_bytes());
    }
    Some(out)
}
