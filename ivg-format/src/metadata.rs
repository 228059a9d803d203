//! The two chunks of this format: `LITE`, the lights whose light is in the grid, and `META`, free key–value
//! pairs.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use crate::code::codes;
use alloc::vec::Vec;
use ivg_wire::{Chunk, ChunkKind, Cursor, Error, Part};

/// Type of the chunk that lists the lights.
pub const LIGHTS: ChunkKind = ChunkKind(*b"LITE");

/// Type of the chunk of key–value pairs.
pub const METADATA: ChunkKind = ChunkKind(*b"META");

/// Bit 0 of a light's flags: its direct light is in the grid too.
const DIRECT: u8 = 1;

/// A light whose indirect light is in the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BakedLight<'a> {
    /// Its name in the scene, as far as it has one.
    pub name: &'a str,
    /// Whether its direct light is in the grid too. If not, a renderer adds direct light itself.
    pub direct_included: bool,
}

/// The lights in the payload of a `LITE` chunk.
///
/// # Errors
///
/// Malformed, at the byte where reading stopped, if a name is not UTF-8 or bytes are missing or left over;
/// unsupported if a reserved bit or byte is set (IVG-LITE-02).
pub fn lights<'a>(chunk: &Chunk<'a>) -> Result<impl Iterator<Item = BakedLight<'a>> + use<'a>, Error> {
    let mut check = start(chunk);
    let count = check.u32().map_err(|e| malformed(&e))?;
    for _ in 0..count {
        next_light(&mut check)?;
    }
    if !check.rest().is_empty() {
        return Err(Error::new(codes::LIGHTS, check.offset(), Part::Chunk(LIGHTS)));
    }
    let mut cursor = start(chunk);
    // Skips the count; everything behind it has just been read once.
    let _ = cursor.u32();
    Ok((0..count).map_while(move |_| next_light(&mut cursor).ok()))
}

fn start<'a>(chunk: &Chunk<'a>) -> Cursor<'a> {
    Cursor::new(chunk.payload, chunk.payload_offset(), Part::Chunk(chunk.kind))
}

/// Running out of bytes inside a chunk that is whole is not a truncation of the file.
fn malformed(error: &Error) -> Error {
    Error::new(codes::LIGHTS, error.offset(), error.part())
}

fn next_light<'a>(cursor: &mut Cursor<'a>) -> Result<BakedLight<'a>, Error> {
    let at = cursor.offset();
    let [flags, reserved] = cursor.array().map_err(|e| malformed(&e))?;
    if flags & !DIRECT != 0 || reserved != 0 {
        return Err(Error::new(ivg_wire::codes::RESERVED, at, Part::Chunk(LIGHTS)));
    }
    let length = cursor.u16().map_err(|e| malformed(&e))?;
    let name_at = cursor.offset();
    let name = cursor.take(usize::from(length)).map_err(|e| malformed(&e))?;
    let name =
        core::str::from_utf8(name).map_err(|_| Error::new(codes::LIGHTS, name_at, Part::Chunk(LIGHTS)))?;
    Ok(BakedLight { name, direct_included: flags & DIRECT != 0 })
}

/// The pairs in the payload of a `META` chunk.
///
/// # Errors
///
/// Malformed, at the payload's beginning, if it is not UTF-8, does not end in a line feed, or a line is not
/// `key=value` with a key of lower-case letters, digits, `-` and `_` (IVG-META-02).
pub fn metadata<'a>(chunk: &Chunk<'a>) -> Result<impl Iterator<Item = (&'a str, &'a str)> + use<'a>, Error> {
    let error = Error::new(codes::METADATA, chunk.payload_offset(), Part::Chunk(METADATA));
    let text = core::str::from_utf8(chunk.payload).map_err(|_| error)?;
    if !text.is_empty() && !text.ends_with('\n') {
        return Err(error);
    }
    let pairs = text.split_terminator('\n').map(|line| line.split_once('='));
    if pairs.clone().all(|pair| pair.is_some_and(|(key, value)| is_pair(key, value))) {
        Ok(pairs.flatten())
    } else {
        Err(error)
    }
}

/// Whether a pair can stand in a `META` chunk.
pub(crate) fn is_pair(key: &str, value: &str) -> bool {
    let allowed = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-' || b == b'_';
    !key.is_empty() && key.bytes().all(allowed) && !value.contains('\n')
}

/// The payload of a `LITE` chunk; the caller has checked that no name is longer than 65,535 bytes.
pub(crate) fn write_lights(lights: &[BakedLight<'_>]) -> Vec<u8> {
    let mut out = Vec::new();
    out.extend_from_slice(&(lights.len() as u32).to_le_bytes());
    for light in lights {
        out.extend_from_slice(&[if light.direct_included { DIRECT } else { 0 }, 0]);
        out.extend_from_slice(&(light.name.len() as u16).to_le_bytes());
        out.extend_from_slice(light.name.as_bytes());
    }
    out
}

/// The payload of a `META` chunk; the caller has checked [`is_pair`].
pub(crate) fn write_metadata(pairs: &[(&str, &str)]) -> Vec<u8> {
    let mut out = Vec::new();
    for (key, value) in pairs {
        for part in [key, "=", value, "\n"] {
            out.extend_from_slice(part.as_bytes());
        }
    }
    out
}
