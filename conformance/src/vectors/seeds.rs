//! The seeds of the fuzz targets: small accepted vectors for the readers, and bytes that stand for choices for the others.

use super::{Format, Vector};
use ivg_wire::splitmix64;
use std::path::PathBuf;

/// Largest vector that becomes a seed \[bytes\]: fuzzers are slow on long inputs.
const LONGEST: usize = 2048;
/// Lengths of the inputs that stand for choices \[bytes\].
const CHOICE_LENGTHS: [usize; 4] = [8, 64, 300, 1200];

/// Paths relative to the corpus, and contents.
pub(super) fn seeds(vectors: &[Vector]) -> Vec<(PathBuf, Vec<u8>)> {
    let mut seeds = Vec::new();
    for (format, targets) in [
        (Format::Ivg, &["ivg_decode", "ivg_chunks"][..]),
        (Format::Pmesh, &["pmesh_decode", "pmesh_chunks", "pmesh_lod"]),
    ] {
        let short = vectors.iter().filter(|vector| {
            vector.format == format && vector.code.is_none() && vector.bytes.len() <= LONGEST
        });
        for (vector, target) in short.flat_map(|vector| targets.iter().map(move |target| (vector, target))) {
            seeds.push((PathBuf::from(target).join(&vector.name), vector.bytes.clone()));
        }
    }
    for (seed, target) in (0..).zip(["ivg_roundtrip", "pmesh_roundtrip", "mesh_build"]) {
        for length in CHOICE_LENGTHS {
            seeds.push((PathBuf::from(target).join(format!("choices-{length}")), choices(seed, length)));
        }
    }
    seeds
}

/// Bytes without a pattern, the same on every machine.
fn choices(seed: u64, length: usize) -> Vec<u8> {
    (0..).flat_map(|n| splitmix64(seed, n).to_le_bytes()).take(length).collect()
}
