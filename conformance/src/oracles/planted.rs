//! Bugs that are planted in a user of our decoders, each of a kind that the oracles must notice: proof that the fuzzer, from the
//! committed corpus, finds what it is there for. Nothing but the fuzz target `planted` and a test here calls them.

use super::Oracle;
use super::ivg::ivg_decode_for;
use super::pmesh_lod::pmesh_lod_as;
use ivg_format::Event;

/// Each bug under the name by which the environment variable `IVG_PLANTED` chooses it.
pub const PLANTED: [(&str, Oracle); 3] = [
    ("index-without-check", index_without_check),
    ("memory-for-a-declared-count", memory_for_a_declared_count),
    ("wrong-level", wrong_level),
];

/// Generations that a careless application has names for.
const GENERATIONS: [&str; 4] = ["baked", "second", "third", "fourth"];

/// A number of the file is an index.
fn index_without_check(data: &[u8]) {
    ivg_decode_for(data, |event| {
        if let Event::Bundle(bundle) = event {
            std::hint::black_box(GENERATIONS[bundle.generation() as usize]);
        }
    });
}

/// A word for each generation that a record says it has had.
fn memory_for_a_declared_count(data: &[u8]) {
    /// So that the bug is not found by running out of memory.
    const MOST: u32 = 1 << 20;
    ivg_decode_for(data, |event| {
        if let Event::Bundle(bundle) = event {
            std::hint::black_box(vec![0u32; bundle.generation().min(MOST) as usize]);
        }
    });
}

/// The materials of a level are cut to a byte.
fn wrong_level(data: &[u8]) {
    pmesh_lod_as(data, |replay| {
        let mut mesh = replay.mesh();
        mesh.materials.iter_mut().for_each(|material| *material &= 0xFF);
        mesh
    });
}

#[cfg(test)]
mod tests;
