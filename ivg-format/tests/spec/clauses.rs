//! The clauses: where they are defined, whom they bind, which tests show that they hold.

use super::{read, rows};
use std::collections::{BTreeMap, BTreeSet};

/// Clause ids that stand in a text: `COM-…-nn` and `IVG-…-nn`.
fn cited(text: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (start, _) in text.match_indices("COM-").chain(text.match_indices("IVG-")) {
        let id: String = text[start..]
            .chars()
            .take_while(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || *c == '-')
            .collect();
        let parts: Vec<&str> = id.split('-').collect();
        if let [_, word, number, ..] = parts[..]
            && !word.is_empty()
            && number.len() == 2
        {
            found.insert(parts[..3].join("-"));
        }
    }
    found
}

/// Clauses that a document defines: `**ID** (parties)`.
fn defined() -> BTreeMap<String, Vec<String>> {
    let mut clauses = BTreeMap::new();
    for document in ["common.md", "ivg.md"] {
        for line in read(document).lines() {
            let Some((id, rest)) = line.strip_prefix("**").and_then(|line| line.split_once("** (")) else {
                continue;
            };
            let (parties, _) = rest.split_once(')').unwrap();
            let parties = parties.split(", ").map(String::from).collect();
            assert!(clauses.insert(id.to_string(), parties).is_none(), "{id} is defined twice");
        }
    }
    clauses
}

#[test]
fn every_clause_is_listed_with_the_parties_it_binds() {
    let listed: BTreeMap<String, Vec<String>> = rows("clauses", "clause")
        .iter()
        .map(|row| {
            let parties = row["binds"].as_array().unwrap();
            (row["id"].as_str().unwrap().into(), parties.iter().map(|p| p.as_str().unwrap().into()).collect())
        })
        .collect();
    assert_eq!(listed, defined(), "spec/tables/clauses.toml against the documents");
    let known = ["writer", "reader", "validator", "definition"];
    assert!(listed.values().flatten().all(|party| known.contains(&party.as_str())));
}

#[test]
fn every_clause_that_is_cited_exists() {
    let defined = defined();
    let mut sources = vec![];
    for folder in ["../ivg-wire/src", "../ivg-format/src", "../spec/tables"] {
        let mut folders = vec![std::path::PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(folder)];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() { folders.push(path) } else { sources.push(path) }
            }
        }
    }
    assert!(sources.len() > 20, "the sources were not found");
    for source in sources {
        for id in cited(&std::fs::read_to_string(&source).unwrap()) {
            assert!(defined.contains_key(&id), "{}: {id} is not defined", source.display());
        }
    }
}
