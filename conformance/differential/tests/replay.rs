//! What the fuzz targets start from, what they found, and every vector: through both readers, on the stable toolchain, where checksums
//! are compared.

use conformance_differential::{Mistake, ivg_vs_c, ivg_vs_c_with, pmesh_vs_c};
use std::fs;
use std::path::{Path, PathBuf};

/// A comparison of both readers.
type Compare = fn(&[u8]);

/// Both comparisons under the names of their fuzz targets.
const TARGETS: [(&str, Compare); 2] = [("ivg_vs_c", ivg_vs_c), ("pmesh_vs_c", pmesh_vs_c)];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The files in a folder and below, in order; none if there is no such folder.
fn files_below(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.into_iter().flat_map(|path| if path.is_dir() { files_below(&path) } else { vec![path] }).collect()
}

#[test]
fn both_readers_see_the_same_in_every_vector_seed_and_finding() {
    for (name, compare) in TARGETS {
        let format = name.split('_').next().unwrap();
        let vectors = files_below(&root().join("conformance/vectors").join(format));
        assert!(!vectors.is_empty(), "{format} has no vectors");
        let others = ["fuzz/corpus", "conformance/regressions", "fuzz/artifacts"]
            .into_iter()
            .flat_map(|folder| files_below(&root().join(folder).join(name)));
        for file in vectors.into_iter().chain(others) {
            // libtest shows what a failing test printed: the file at fault is the last one named.
            println!("{}", file.display());
            compare(&fs::read(file).unwrap());
        }
    }
}

#[test]
fn every_prefix_is_seen_alike() {
    for (name, compare) in TARGETS {
        let format = name.split('_').next().unwrap();
        let vectors = files_below(&root().join("conformance/vectors").join(format));
        let short = vectors.iter().map(|file| fs::read(file).unwrap()).filter(|data| data.len() <= 1024);
        for data in short.step_by(7) {
            (0..data.len()).for_each(|length| compare(&data[..length]));
        }
    }
}

#[test]
fn a_reader_that_forgets_the_scale_is_found() {
    let vectors = files_below(&root().join("conformance/vectors/ivg"));
    let found = vectors.iter().filter(|file| {
        let data = fs::read(file).unwrap();
        std::panic::catch_unwind(|| ivg_vs_c_with(&data, Mistake::ForgetsTheScale)).is_err()
    });
    assert!(found.count() > 0, "no vector has a scale exponent");
}
