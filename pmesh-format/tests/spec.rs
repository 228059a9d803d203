//! The specification's tables, Markdown, clause ids and worked example against each other and against this crate.
//!
//! `IVG_BLESS=1 cargo test -p pmesh-format --test spec` writes tables and example into the Markdown anew.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::PathBuf;

use pmesh_format::{EncodeOptions, Limits, MAX_COUNT, ProgressiveMesh, Replay, Wedges, check, codes, encode};
use toml::{Table, Value};

fn path(name: &str) -> String {
    format!("{}/../spec/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn read(name: &str) -> String {
    std::fs::read_to_string(path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn rows(file: &str, key: &str) -> Vec<Table> {
    let table: Table = read(file).parse().unwrap_or_else(|e| panic!("{file}: {e}"));
    table[key].as_array().unwrap().iter().map(|row| row.as_table().unwrap().clone()).collect()
}

/// Rows of this format in a table that several formats share.
fn shared(file: &str, key: &str) -> Vec<Table> {
    rows(file, key).into_iter().filter(|row| row["format"].as_str() == Some("pmesh")).collect()
}

/// A cell's text: numbers of limits with thousands separated.
fn cell(row: &Table, key: &str) -> String {
    match &row[key] {
        Value::String(text) if key == "name" || key == "type" => format!("`{text}`"),
        Value::String(text) => text.clone(),
        Value::Integer(n) if ["maximum", "guaranteed", "default"].contains(&key) => {
            let digits = n.to_string();
            let groups: Vec<&str> =
                digits.as_bytes().rchunks(3).rev().map(|g| std::str::from_utf8(g).unwrap()).collect();
            groups.join(",")
        }
        Value::Boolean(critical) => if *critical { "critical" } else { "ancillary" }.into(),
        other => other.to_string(),
    }
}

fn markdown(rows: &[Table], columns: &[&str]) -> String {
    let mut out = format!("| {} |\n|{}\n", columns.join(" | "), "---|".repeat(columns.len()));
    for row in rows {
        let cells: Vec<String> = columns.iter().map(|key| cell(row, key)).collect();
        writeln!(out, "| {} |", cells.join(" | ")).unwrap();
    }
    out
}

/// What belongs between `<!-- table NAME -->` and `<!-- end -->`.
fn expected(name: &str) -> String {
    let own = |columns: &[&str]| markdown(&rows("tables/pmesh.toml", name), columns);
    match name {
        "header" | "entry" => own(&["offset", "type", "name", "clause", "text"]),
        "payload" => own(&["name", "type", "count", "clause", "text"]),
        "modes" | "positions" => own(&["id", "name", "status", "text"]),
        "attributes" => own(&["bit", "name", "text"]),
        "chunks" => own(&["type", "critical", "text"]),
        "errors pmesh" => {
            markdown(&shared("tables/errors.toml", "error"), &["code", "name", "verdict", "clause", "text"])
        }
        "limits pmesh" => {
            let columns = ["name", "text", "maximum", "guaranteed", "default"];
            markdown(&shared("tables/limits.toml", "limit"), &columns)
        }
        _ => panic!("unknown table {name:?}"),
    }
}

#[test]
fn the_tables_and_the_example_in_the_document_are_up_to_date() {
    let text = read("pmesh.md");
    let mut out = String::new();
    let mut rest = text.as_str();
    while let Some(start) = rest.find("<!-- table ") {
        let (before, marked) = rest.split_at(start);
        let (mark, after) = marked.split_once(" -->\n").unwrap();
        let end = after.find("<!-- end -->").unwrap_or_else(|| panic!("{mark} has no end"));
        write!(out, "{before}{mark} -->\n{}", expected(mark.trim_start_matches("<!-- table "))).unwrap();
        rest = &after[end..];
    }
    let (before, example) = rest.split_once("<!-- example -->\n").unwrap();
    let (_, after) = example.split_once("<!-- end -->").unwrap();
    write!(out, "{before}<!-- example -->\n```\n{}```\n<!-- end -->{after}", dump()).unwrap();
    if std::env::var_os("IVG_BLESS").is_some() {
        std::fs::write(path("pmesh.md"), &out).unwrap();
    } else {
        for (found, expected) in text.lines().zip(out.lines()) {
            assert_eq!(found, expected, "pmesh.md differs from the tables");
        }
        assert!(text == out, "pmesh.md differs from the tables in its length");
    }
}

#[test]
fn every_error_code_equals_its_row() {
    let rows = shared("tables/errors.toml", "error");
    assert_eq!(rows.len(), codes::ALL.len());
    for (row, code) in rows.iter().zip(codes::ALL) {
        let rule = code.rule();
        assert_eq!(row["code"].as_integer(), Some(rule.number.into()));
        let ours = [rule.name, rule.verdict.name(), rule.clause, rule.text];
        assert_eq!(["name", "verdict", "clause", "text"].map(|key| row[key].as_str().unwrap()), ours);
    }
}

#[test]
fn limits_equal_their_row() {
    let [row] = &shared("tables/limits.toml", "limit")[..] else { panic!("one row") };
    assert_eq!(row["maximum"].as_integer(), Some(MAX_COUNT.into()));
    assert_eq!(row["default"].as_integer(), Some(Limits::new().counts.into()));
    assert!(row["guaranteed"].as_integer() <= row["default"].as_integer());
}

/// Clauses that the document defines: `**ID** (parties)`.
fn defined() -> BTreeMap<String, Vec<String>> {
    let mut clauses = BTreeMap::new();
    for line in read("pmesh.md").lines() {
        let Some((id, rest)) = line.strip_prefix("**").and_then(|line| line.split_once("** (")) else {
            continue;
        };
        let (parties, _) = rest.split_once(')').unwrap();
        let parties = parties.split(", ").map(String::from).collect();
        assert!(clauses.insert(id.to_string(), parties).is_none(), "{id} is defined twice");
    }
    clauses
}

#[test]
fn every_clause_is_listed_with_the_parties_it_binds() {
    let listed: BTreeMap<String, Vec<String>> = rows("tables/clauses-pmesh.toml", "clause")
        .iter()
        .map(|row| {
            let parties = row["binds"].as_array().unwrap();
            (row["id"].as_str().unwrap().into(), parties.iter().map(|p| p.as_str().unwrap().into()).collect())
        })
        .collect();
    assert_eq!(listed, defined(), "spec/tables/clauses-pmesh.toml against the document");
    let known = ["writer", "reader", "validator", "definition"];
    assert!(listed.values().flatten().all(|party| known.contains(&party.as_str())));
}

/// Clause ids `PMESH-…-nn` in a text.
fn cited(text: &str) -> BTreeSet<String> {
    let ids = text.match_indices("PMESH-").map(|(start, _)| {
        let is_part = |c: &char| c.is_ascii_uppercase() || c.is_ascii_digit() || *c == '-';
        text[start..].chars().take_while(is_part).collect::<String>()
    });
    let is_id = |id: &String| {
        id.rsplit_once('-').is_some_and(|(_, n)| n.len() == 2 && n.bytes().all(|b| b.is_ascii_digit()))
    };
    ids.filter(is_id).collect()
}

#[test]
fn every_clause_that_is_cited_exists() {
    let defined = defined();
    let mut sources = vec![];
    for folder in ["../pmesh-format/src", "../pmesh-build/src", "../spec"] {
        let mut folders = vec![PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(folder)];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() { folders.push(path) } else { sources.push(path) }
            }
        }
    }
    assert!(sources.len() > 20, "the sources were not found");
    let mut count = 0;
    for source in sources {
        for id in cited(&std::fs::read_to_string(&source).unwrap()) {
            assert!(defined.contains_key(&id), "{}: {id} is not defined", source.display());
            count += 1;
        }
    }
    assert!(count > 50, "{count} citations found");
}

/// The mesh of the section "A file, byte by byte".
fn square() -> ProgressiveMesh {
    ProgressiveMesh {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
        wedges: Wedges { vertices: vec![0, 1, 2, 3], ..Wedges::default() },
        base_vertices: 3,
        collapse: vec![0],
        wedge_collapse: vec![0],
        errors: vec![0.5],
        faces: vec![[1, 2, 3], [0, 1, 3]],
        ..ProgressiveMesh::default()
    }
}

/// The example with its meaning: offset, bytes, what they are.
fn dump() -> String {
    let file = encode(&square(), &EncodeOptions::default()).unwrap();
    let mut fields: Vec<(usize, String)> = vec![];
    for (key, table) in [("common.toml", "header"), ("pmesh.toml", "header")] {
        for row in rows(&format!("tables/{key}"), table) {
            fields.push((row["offset"].as_integer().unwrap() as usize, row["name"].as_str().unwrap().into()));
        }
    }
    let mut more = |items: &[(usize, &str)]| fields.extend(items.iter().map(|&(at, what)| (at, what.into())));
    more(&[
        (0x80, "chunk: type"),
        (0x84, "critical, reserved"),
        (0x88, "length"),
        (0x90, "packet 0: end_vertex"),
        (0x94, "end_wedge"),
        (0x98, "end_face"),
        (0x9C, "payload_bytes"),
        (0xA0, "error: 0.5 m"),
        (0xA4, "checksum of the chunk"),
        (0xA8, "record: id"),
        (0xAC, "generation"),
        (0xB0, "position of vertex 0"),
        (0xBC, "vertex 1"),
        (0xC8, "vertex 2"),
        (0xD4, "vertex 3"),
        (0xE0, "corners of face 0, as at level 3"),
        (0xEC, "face 1, as at level 4: it has vertex 3 and its parent"),
        (0xF8, "parent of vertex 3"),
        (0xFC, "switch codes of vertex 3: slot 2 switches"),
        (0xFD, "padding"),
        (0x100, "checksum of the record"),
        (0x104, "end record: id"),
        (0x108, "generation"),
        (0x10C, "length of the file"),
        (0x114, "checksum of the record"),
    ]);
    fields.push((file.len(), String::new()));
    let mut out = String::new();
    for pair in fields.windows(2) {
        let bytes: Vec<String> = file[pair[0].0..pair[1].0].iter().map(|b| format!("{b:02X}")).collect();
        writeln!(out, "{:04X}  {}  {}", pair[0].0, bytes.join(" "), pair[0].1).unwrap();
    }
    out
}

#[test]
fn the_printed_example_is_a_file() {
    let text = read("pmesh.md");
    let (_, after) = text.split_once("<!-- example -->\n```\n").expect("the example's mark");
    let (block, _) = after.split_once("```\n<!-- end -->").expect("the example's end");
    let mut bytes = vec![];
    for line in block.lines() {
        let (offset, rest) = line.split_once("  ").unwrap();
        let (hex, _meaning) = rest.split_once("  ").unwrap();
        assert_eq!(usize::from_str_radix(offset, 16), Ok(bytes.len()), "{line}");
        bytes.extend(hex.split(' ').map(|byte| u8::from_str_radix(byte, 16).unwrap()));
    }
    assert_eq!(check(&bytes, &Limits::default()), Ok(()));
    let mut replay = Replay::default();
    pmesh_format::decode_all(&bytes, &Limits::default(), |event| {
        replay.accept(&event).unwrap();
    })
    .unwrap();
    assert_eq!(replay.indices(), [[1, 2, 3], [0, 1, 3]]);
    replay.set_level(3).unwrap();
    assert_eq!(replay.indices(), [[1, 2, 0]]);
}
