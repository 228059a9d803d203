//! The committed vectors are those that the generator makes, and the decoders say of each what it says.

use conformance::oracles::stream::{End, Transcript};
use conformance::oracles::{ivg, pmesh};
use conformance::vectors::{Format, GENERATED_FOLDERS, Vector, generated_files, prefix_rows, vectors};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

fn read(vector: &Vector, length: usize) -> Transcript {
    match vector.format {
        Format::Ivg => ivg::read(&vector.bytes[..length]),
        Format::Pmesh => pmesh::read(&vector.bytes[..length]),
    }
}

#[test]
fn the_generator_makes_the_committed_files() {
    let made: BTreeMap<PathBuf, Vec<u8>> = generated_files().into_iter().collect();
    let mut committed = BTreeMap::new();
    for folder in GENERATED_FOLDERS {
        collect(Path::new(folder), &mut committed);
    }
    let again = "run `cargo run -p conformance --bin generate` and look at what changed";
    let missing: Vec<_> = made.keys().filter(|path| !committed.contains_key(*path)).collect();
    let stale: Vec<_> = committed.keys().filter(|path| !made.contains_key(*path)).collect();
    assert!(missing.is_empty() && stale.is_empty(), "missing {missing:?}, stale {stale:?}: {again}");
    for (path, bytes) in &made {
        assert!(committed[path] == *bytes, "{}: {again}", path.display());
    }
}

fn collect(folder: &Path, files: &mut BTreeMap<PathBuf, Vec<u8>>) {
    for entry in fs::read_dir(root().join(folder)).unwrap() {
        let path = folder.join(entry.unwrap().file_name());
        if root().join(&path).is_dir() {
            collect(&path, files);
        } else {
            files.insert(path.clone(), fs::read(root().join(&path)).unwrap());
        }
    }
}

#[test]
fn the_tree_stays_small() {
    let files = generated_files();
    let total: usize = files.iter().map(|(_, bytes)| bytes.len()).sum();
    assert!(total < 5_000_000, "{total} bytes");
    let too_large = files.iter().find(|(path, bytes)| path.starts_with("fuzz/corpus") && bytes.len() > 4096);
    assert!(too_large.is_none(), "a seed of more than 4 KiB: {:?}", too_large.map(|(path, _)| path));
}

#[test]
fn every_vector_has_its_verdict_and_code() {
    let mut wrong = Vec::new();
    for vector in vectors() {
        let end = read(&vector, vector.bytes.len()).end;
        let code = match end {
            End::Refused(error) => Some(error.code()),
            End::Complete | End::NeedMore => None,
        };
        if (end.verdict(), code) != (vector.verdict, vector.code) {
            wrong.push(format!("{}: {} {:?}, found {end:?}", vector.file(), vector.verdict, vector.code));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn files_to_refuse_have_a_code_and_an_accepted_twin() {
    let vectors = vectors();
    let names: BTreeSet<(Format, &str)> =
        vectors.iter().map(|vector| (vector.format, vector.name.as_str())).collect();
    assert_eq!(names.len(), vectors.len(), "two vectors have one name");
    for vector in &vectors {
        let refused = vector.code.is_some();
        assert_eq!(vector.name.starts_with("x-"), refused, "{}", vector.file());
        assert_eq!(vector.twin.is_some(), refused, "{}", vector.file());
        if let Some(twin) = vector.twin {
            assert!(!twin.starts_with("x-") && names.contains(&(vector.format, twin)), "{}", vector.file());
            let twin =
                vectors.iter().find(|other| other.format == vector.format && other.name == twin).unwrap();
            assert_ne!(twin.bytes, vector.bytes, "{}", vector.file());
        }
    }
}

#[test]
fn every_prefix_of_every_accepted_vector_needs_more() {
    for vector in vectors().iter().filter(|vector| vector.code.is_none()) {
        let whole = read(vector, vector.bytes.len());
        for length in 0..vector.bytes.len() {
            let prefix = read(vector, length);
            assert_eq!(prefix.end, End::NeedMore, "{} cut to {length} bytes", vector.file());
            assert!(whole.events.starts_with(&prefix.events), "{} cut to {length} bytes", vector.file());
        }
    }
}

#[test]
fn prefix_tables_say_how_much_is_known_after_every_byte() {
    for vector in vectors().iter().filter(|vector| vector.code.is_none() && vector.bytes.len() <= 4096) {
        let mut next = 0;
        for row in prefix_rows(vector) {
            assert_eq!(row.from, next, "{}: the table has a gap", vector.file());
            next = row.to + 1;
            for length in row.from..=row.to {
                let prefix = read(vector, length);
                assert_eq!(
                    (prefix.end.verdict(), prefix.records),
                    (row.verdict, row.records),
                    "{} cut to {length} bytes",
                    vector.file()
                );
            }
        }
        assert_eq!(next, vector.bytes.len() + 1, "{}: the table ends early", vector.file());
    }
}

/// Codes without a vector, each with the reason.
const WITHOUT_VECTOR: [(u16, &str); 3] = [
    (109, "65,536 chunks: our limit of 1024 comes first"),
    (113, "a record that is fetched alone: a file has no place for more bytes than a record has"),
    (514, "a packet that is applied out of turn: a file in order cannot say that"),
];

#[test]
fn every_error_code_has_a_vector() {
    let table = fs::read_to_string(root().join("spec/tables/errors.toml")).unwrap();
    let table: toml::Table = table.parse().unwrap();
    let rows = table["error"].as_array().unwrap();
    let vectors = vectors();
    let mut wrong = Vec::new();
    for row in rows.iter().filter(|row| row["verdict"].as_str() != Some("need-more")) {
        let code = u16::try_from(row["code"].as_integer().unwrap()).unwrap();
        let count = vectors.iter().filter(|vector| vector.code == Some(code)).count();
        let excepted = WITHOUT_VECTOR.iter().any(|(without, _)| *without == code);
        if (count == 0) != excepted {
            wrong.push(format!("{code} {}: {count} vectors", row["name"]));
        }
    }
    assert!(rows.len() > 30, "the table was not read");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
