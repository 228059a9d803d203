//! What must hold for any bytes: the bodies of the fuzz targets, which tests on the stable toolchain call too. Each function
//! takes bytes, returns nothing, and panics when something does not hold.

pub mod fields;
pub mod ivg;
mod ivg_roundtrip;
mod planted;
pub mod pmesh;
mod pmesh_lod;
mod pmesh_packets;
mod pmesh_roundtrip;
pub mod stream;

pub use fields::{edited, ivg_fields, pmesh_fields};
pub use ivg::{ivg_chunks, ivg_decode};
pub use ivg_roundtrip::ivg_roundtrip;
pub use planted::PLANTED;
pub use pmesh::{pmesh_chunks, pmesh_decode};
pub use pmesh_lod::pmesh_lod;
pub use pmesh_packets::pmesh_packets;
pub use pmesh_roundtrip::pmesh_roundtrip;

use std::hash::{DefaultHasher, Hash, Hasher};

/// A function that any bytes must pass.
pub type Oracle = fn(&[u8]);

/// Every oracle here under the name of its fuzz target, which begins with the name of its format.
pub const ORACLES: [(&str, Oracle); 10] = [
    ("ivg_decode", ivg_decode),
    ("ivg_chunks", ivg_chunks),
    ("ivg_fields", ivg_fields),
    ("ivg_roundtrip", ivg_roundtrip),
    ("pmesh_decode", pmesh_decode),
    ("pmesh_chunks", pmesh_chunks),
    ("pmesh_lod", pmesh_lod),
    ("pmesh_fields", pmesh_fields),
    ("pmesh_packets", pmesh_packets),
    ("pmesh_roundtrip", pmesh_roundtrip),
];

/// A hash of anything; the same for equal values within one run.
fn digest(value: impl Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    value.hash(&mut hasher);
    hasher.finish()
}

/// These bytes of the file, if all of them are there.
fn slice(data: &[u8], start: u64, end: u64) -> Option<&[u8]> {
    data.get(usize::try_from(start).ok()?..usize::try_from(end).ok()?)
}

/// The lengths of the pieces in which a stream arrives, chosen by the last bytes of the input so that its beginning stays a
/// file. Short pieces are likelier than long ones.
fn pieces(data: &[u8]) -> impl Iterator<Item = usize> + '_ {
    let choices = &data[data.len() - data.len().min(PIECE_CHOICES)..];
    choices.iter().cycle().take(data.len()).map(|&byte| match byte {
        0..0xC0 => usize::from(byte % 16),
        _ => usize::from(byte),
    })
}

/// How many bytes of the input choose the lengths of pieces.
const PIECE_CHOICES: usize = 8;
