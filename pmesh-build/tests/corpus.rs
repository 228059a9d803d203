//! The seeds of the fuzz target `mesh_build`, and what it found on this machine, through the body of the target.
#![cfg(feature = "fuzz")]

use std::fs;
use std::path::{Path, PathBuf};

fn inputs(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().join(folder).join("mesh_build");
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    entries.map(|entry| entry.unwrap().path()).collect()
}

#[test]
fn seeds_and_findings_pass() {
    let seeds = inputs("fuzz/corpus");
    assert!(!seeds.is_empty(), "no seeds");
    for file in seeds.into_iter().chain(inputs("fuzz/artifacts")) {
        println!("{}", file.display());
        pmesh_build::fuzz_mesh_build(&fs::read(file).unwrap());
    }
}
