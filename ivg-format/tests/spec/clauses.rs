//! The clauses: where they are defined, whom they bind, which tests show that they hold.

use super::document::{cited, defined, listed};
use super::{read, repository, rows};
use std::collections::BTreeSet;
use std::path::PathBuf;

const DOCUMENTS: [&str; 2] = ["common.md", "ivg.md"];

#[test]
fn every_clause_is_listed_with_the_parties_it_binds() {
    let listed = listed("clauses");
    assert_eq!(listed, defined(&DOCUMENTS), "spec/tables/clauses.toml against the documents");
    let known = ["writer", "reader", "validator", "evaluator", "definition"];
    assert!(listed.values().flatten().all(|party| known.contains(&party.as_str())));
}

/// The source files below the folders of this name in every crate.
fn sources(name: &str) -> Vec<PathBuf> {
    let mut found = vec![];
    let crates = std::fs::read_dir(repository("")).unwrap().map(|entry| entry.unwrap().path().join(name));
    let mut folders: Vec<PathBuf> = crates.filter(|folder| folder.is_dir()).collect();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                found.push(path);
            }
        }
    }
    found
}

#[test]
fn every_clause_that_is_cited_exists() {
    let defined = defined(&DOCUMENTS);
    let mut texts: Vec<(String, String)> = [sources("src"), sources("tests")]
        .concat()
        .into_iter()
        .map(|path| (path.display().to_string(), std::fs::read_to_string(path).unwrap()))
        .collect();
    assert!(texts.len() > 100, "the sources were not found");
    for table in ["clauses", "common", "errors", "ivg", "limits", "orders", "registry"] {
        texts.push((format!("tables/{table}.toml"), read(&format!("tables/{table}.toml"))));
    }
    for document in ["common", "ivg", "pmesh", "stream", "gltf-extensions", "media-types", "CHANGELOG"] {
        texts.push((format!("{document}.md"), read(&format!("{document}.md"))));
    }
    for (name, text) in texts {
        for id in cited(&text, &["COM", "IVG"]) {
            assert!(defined.contains_key(&id), "{name}: {id} is not defined");
        }
    }
}

/// Whether a source has a test of this name: a function marked as one, or a property of `quickcheck!`.
fn has_test(source: &str, name: &str) -> bool {
    let lines: Vec<&str> = source.lines().collect();
    let Some(at) = lines.iter().position(|line| line.trim_start().starts_with(&format!("fn {name}("))) else {
        return false;
    };
    let attributes = lines[..at].iter().rev().take_while(|line| line.trim_start().starts_with("#["));
    let is_marked = attributes.clone().any(|line| line.trim() == "#[test]")
        || attributes.clone().any(|line| line.trim().starts_with("#[quickcheck"));
    // A block of properties begins and ends at the margin.
    let margin = lines[..at].iter().rev().find(|line| !line.starts_with([' ', '\n']) && !line.is_empty());
    let is_property = lines[at].starts_with("    ") && margin.is_some_and(|line| *line == "quickcheck! {");
    is_marked || is_property
}

/// What a clause names as its tests, each of which must exist.
pub(super) fn check_test(name: &str) -> Result<(), String> {
    match name.split_once("::") {
        Some((file, function)) => {
            let source =
                std::fs::read_to_string(repository(file)).map_err(|error| format!("{file}: {error}"))?;
            has_test(&source, function).then_some(()).ok_or(format!("{file} has no test {function}"))
        }
        None => {
            let vector = name.strip_prefix("conformance/vectors/").ok_or(format!("{name} is no test"))?;
            let manifest = std::fs::read_to_string(repository("conformance/vectors/manifest.json")).unwrap();
            let listed = manifest.contains(&format!("\"file\": \"{vector}\""));
            listed.then_some(()).ok_or(format!("the manifest of the vectors has no {vector}"))
        }
    }
}

/// The clauses of all formats.
fn all_clauses() -> Vec<toml::Table> {
    ["clauses", "clauses-pmesh", "clauses-accumulator"]
        .into_iter()
        .flat_map(|table| rows(table, "clause"))
        .collect()
}

/// The tests that a clause names.
fn tests_of(clause: &toml::Table) -> Vec<&str> {
    let tests = clause.get("tests").and_then(|tests| tests.as_array());
    tests.into_iter().flatten().map(|test| test.as_str().unwrap()).collect()
}

#[test]
fn every_clause_names_tests_that_exist() {
    let mut wrong = vec![];
    let mut untestable = vec![];
    for row in all_clauses() {
        let id = row["id"].as_str().unwrap();
        let tests = tests_of(&row);
        match row.get("untestable").map(|why| why.as_str().unwrap()) {
            Some(why) if tests.is_empty() && why.len() > 20 => untestable.push(id.to_owned()),
            Some(_) => wrong.push(format!("{id}: has both tests and none, or no reason why there is none")),
            None if tests.is_empty() => wrong.push(format!("{id}: names no test")),
            None => {}
        }
        let names: BTreeSet<&str> = tests.iter().copied().collect();
        if names.len() != tests.len() {
            wrong.push(format!("{id}: names a test twice"));
        }
        wrong.extend(
            names.into_iter().filter_map(|name| check_test(name).err()).map(|why| format!("{id}: {why}")),
        );
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(untestable.len() <= 6, "that is too many without a test: {untestable:?}");
}

#[test]
fn a_test_that_does_not_exist_is_found_missing() {
    let source =
        "#[test]\nfn marked() {}\nfn helper() {}\nquickcheck! {\n    fn property(x: u8) -> bool {\n}\n";
    let found = ["marked", "helper", "property", "absent"].map(|name| has_test(source, name));
    assert_eq!(found, [true, false, true, false]);
    let missing = ["ivg-format/tests/none.rs::f", "conformance/vectors/ivg/none.ivg", "a sentence"];
    assert!(missing.into_iter().all(|name| check_test(name).is_err()));
}

/// Codes of which no vector can be made, and why: as in `conformance/tests/vectors.rs`.
const WITHOUT_VECTOR: [i64; 3] = [
    // 65,536 chunks: our own limit comes first.
    109, // A record that is fetched alone: a file has no place for more bytes than a record has.
    113, // What a replay is given, not what a file is.
    514,
];

#[test]
fn the_clause_of_every_error_names_a_vector_with_that_error() {
    let clauses = all_clauses();
    let mut wrong = vec![];
    for row in rows("errors", "error") {
        let (code, clause) = (row["code"].as_integer().unwrap(), row["clause"].as_str().unwrap());
        if row["verdict"].as_str() == Some("need-more") || WITHOUT_VECTOR.contains(&code) {
            continue;
        }
        let format = if row["format"].as_str() == Some("pmesh") { "pmesh" } else { "ivg" };
        let clause = clauses.iter().find(|row| row["id"].as_str() == Some(clause)).expect("a clause");
        let prefix = format!("conformance/vectors/{format}/x-{code}-");
        if !tests_of(clause).iter().any(|test| test.starts_with(&prefix)) {
            wrong.push(format!("{} names no vector for {code} {}", clause["id"], row["name"]));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Rules for readers of `.pmesh` for which no file with one defect can be made, and why.
const WITHOUT_REFUSED_FILE: [(&str, &str); 6] = [
    ("PMESH-HDR-01", "what is judged first shows in files with several defects"),
    ("PMESH-PKT-03", "the same"),
    ("PMESH-LVL-01", "what a reader shows; the manifest has hashes of it"),
    ("PMESH-LVL-05", "a recommendation"),
    ("PMESH-LIM-03", "a reader refuses nothing for it"),
    ("PMESH-LIM-04", "the same"),
];

#[test]
fn every_rule_for_readers_of_meshes_names_a_file_to_refuse() {
    let mut without = BTreeSet::new();
    for clause in rows("clauses-pmesh", "clause") {
        let for_readers =
            clause["binds"].as_array().unwrap().iter().any(|party| party.as_str() == Some("reader"));
        let names_one = tests_of(&clause).iter().any(|test| test.starts_with("conformance/vectors/pmesh/x-"));
        if for_readers && !names_one {
            without.insert(clause["id"].as_str().unwrap().to_owned());
        }
    }
    let excepted: BTreeSet<String> = WITHOUT_REFUSED_FILE.iter().map(|(id, _)| (*id).to_owned()).collect();
    assert_eq!(without, excepted);
}
