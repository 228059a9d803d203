//! What fuzz targets start from, what they found, and every vector: through the oracles, on the stable toolchain.

use conformance::oracles::{ORACLES, Oracle};
use quickcheck::{Arbitrary, Gen, QuickCheck, TestResult, Testable};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

/// The files in a folder and below, in order; none if there is no such folder.
fn files_below(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.into_iter().flat_map(|path| if path.is_dir() { files_below(&path) } else { vec![path] }).collect()
}

fn replay(oracle: fn(&[u8]), file: &Path) {
    // libtest shows what a failing test printed: the file at fault is the last one named.
    println!("{}", file.display());
    oracle(&fs::read(file).unwrap());
}

#[test]
fn seeds_and_findings_of_every_target_pass() {
    for (name, oracle) in ORACLES {
        let seeds = files_below(&root().join("fuzz/corpus").join(name));
        assert!(!seeds.is_empty(), "{name} has no seeds: run `cargo run -p conformance --bin generate`");
        let regressions = files_below(&root().join("conformance/regressions").join(name));
        let artifacts = files_below(&root().join("fuzz/artifacts").join(name));
        seeds.iter().chain(&regressions).chain(&artifacts).for_each(|file| replay(oracle, file));
    }
}

#[test]
fn every_vector_passes_every_oracle_of_its_format() {
    for (name, oracle) in ORACLES {
        let format = name.split('_').next().unwrap();
        let vectors = files_below(&root().join("conformance/vectors").join(format));
        assert!(!vectors.is_empty(), "{format} has no vectors");
        vectors.iter().for_each(|file| replay(oracle, file));
    }
}

/// The property that some bytes pass an oracle.
struct Passes(Oracle);

impl Testable for Passes {
    fn result(&self, generator: &mut Gen) -> TestResult {
        self.0(&Vec::arbitrary(generator));
        TestResult::passed()
    }
}

#[test]
fn any_bytes_pass() {
    for (name, oracle) in ORACLES {
        println!("{name}");
        // The same bytes on every run, so that a failure can be repeated; the fuzzer tries others.
        QuickCheck::new().tests(300).rng(Gen::from_size_and_seed(300, 1)).quickcheck(Passes(oracle));
    }
}

#[test]
fn every_fuzz_target_is_an_oracle_or_belongs_to_another_crate() {
    let targets = files_below(&root().join("fuzz/fuzz_targets"));
    let targets: BTreeSet<String> =
        targets.iter().map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned()).collect();
    let elsewhere = ["ivg_vs_c", "pmesh_vs_c", "planted", "scene_import", "mesh_build", "acc_decode"];
    let known = ORACLES.iter().map(|(name, _)| *name).chain(elsewhere).map(str::to_owned).collect();
    assert_eq!(targets, known);
}
