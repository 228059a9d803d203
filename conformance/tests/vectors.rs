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
    assert!(total < 1_000_000, "{total} bytes");
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
    let vectors = vectors();
    let tables: Vec<_> = vectors.iter().filter_map(|vector| Some((vector, prefix_rows(vector)?))).collect();
    assert_eq!(tables.len(), 5);
    for (vector, rows) in tables {
        let mut next = 0;
        for row in rows {
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

#[test]
fn accepted_grids_have_a_hash_of_their_light() {
    let text = conformance::vectors::manifest(&vectors());
    let manifest: serde_json::Value = serde_json::from_str(&text).unwrap();
    let mut hashes = BTreeSet::new();
    for entry in manifest["vectors"].as_array().unwrap() {
        let [id, verdict] = ["id", "verdict"].map(|key| entry[key].as_str().unwrap());
        let expected = id.starts_with("ivg/") && verdict == "ok";
        assert_eq!(entry["values"].as_str().map(str::len), expected.then_some(64), "{id}");
        hashes.extend(entry["values"].as_str());
    }
    // Grids of different light; some vectors differ from another in metadata or version alone.
    assert!(hashes.len() >= 12, "{}", hashes.len());
    // One vertex of vectors, by hand: its index, then the numbers as they are stored.
    let one = vectors().into_iter().find(|vector| vector.name == "0001-one-vertex").unwrap();
    let record = 144 + 8;
    let bytes = [&0u64.to_le_bytes()[..], &one.bytes[record..record + 216]].concat();
    let digest = <sha2::Sha256 as sha2::Digest>::digest(&bytes);
    let by_hand: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
    assert!(hashes.contains(by_hand.as_str()), "{by_hand}");
}

/// The second reader shows the levels of which the manifest has hashes.
#[test]
fn accepted_meshes_have_hashes_of_their_levels() {
    let vectors = vectors();
    let text = conformance::vectors::manifest(&vectors);
    let manifest: serde_json::Value = serde_json::from_str(&text).unwrap();
    let mut hashes = BTreeSet::new();
    for (entry, vector) in manifest["vectors"].as_array().unwrap().iter().zip(&vectors) {
        let expected = vector.format == Format::Pmesh && vector.code.is_none();
        let listed = entry["levels"].as_array().map(Vec::as_slice).unwrap_or_default();
        assert_eq!(!listed.is_empty(), expected, "{}", vector.file());
        if !expected {
            continue;
        }
        let Ok(pmesh_format::Step::Consumed(_, header)) =
            pmesh_format::Header::read(&vector.bytes, &pmesh_format::Limits::default())
        else {
            panic!("{}: no header", vector.file())
        };
        let mut reference = conformance::reference::Reference::new(&header);
        for k in 0..header.packet_count() {
            let range = header.packet_range(k);
            let bytes = &vector.bytes[range.start as usize..range.end as usize];
            reference.take(pmesh_format::decode_packet(&header, k, bytes).unwrap().payload()).unwrap();
        }
        for listed in listed {
            let level = u32::try_from(listed["level"].as_u64().unwrap()).unwrap();
            let mesh = reference.level(level).unwrap_or_default();
            let bytes = conformance::vectors::levels::level_bytes(&mesh);
            let digest = <sha2::Sha256 as sha2::Digest>::digest(&bytes);
            let hash: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
            assert_eq!(listed["sha256"].as_str(), Some(hash.as_str()), "{}, level {level}", vector.file());
            hashes.insert(hash);
        }
    }
    assert!(hashes.len() >= 12, "{}", hashes.len());
    // One triangle, by hand: three counts, three positions, whose wedges are, one face.
    let triangle = vectors.iter().find(|vector| vector.name == "0002-triangle").unwrap();
    let numbers: [u32; 18] = [3, 3, 1, 0, 0, 0, 0x3F80_0000, 0, 0, 0, 0x3F80_0000, 0, 0, 1, 2, 0, 1, 2];
    let by_hand: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
    let digest = <sha2::Sha256 as sha2::Digest>::digest(&by_hand);
    let by_hand: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
    assert!(hashes.contains(&by_hand), "{}: {by_hand}", triangle.file());
}
