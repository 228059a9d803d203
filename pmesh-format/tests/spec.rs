//! The specification's tables, Markdown, clause ids and worked example against each other and against this crate.
//!
//! `IVG_BLESS=1 cargo test -p pmesh-format --test spec` writes tables and example into the Markdown anew.

use std::fmt::Write;
use std::path::PathBuf;

#[allow(dead_code, reason = "shared with the tests of the other crates, which use other parts")]
#[path = "../../ivg-wire/tests/document/mod.rs"]
mod document;

use document::{
    cited, compare, compare_codes, defined, listed, markdown, of_format, read, rows, shared_table,
    with_tables,
};
use pmesh_format::{EncodeOptions, Limits, MAX_COUNT, ProgressiveMesh, Replay, Wedges, check, codes, encode};

/// What belongs between `<!-- table NAME -->` and `<!-- end -->`.
fn expected(name: &str) -> String {
    let own = |columns: &[&str]| markdown(&rows("pmesh", name), columns);
    match name {
        "header" | "entry" => own(&["offset", "type", "name", "clause", "text"]),
        "payload" => own(&["name", "type", "count", "clause", "text"]),
        "modes" | "positions" => own(&["id", "name", "status", "text"]),
        "attributes" => own(&["bit", "name", "text"]),
        "chunks" => own(&["type", "critical", "text"]),
        _ => shared_table(name).unwrap_or_else(|| panic!("unknown table {name:?}")),
    }
}

#[test]
fn the_tables_and_the_example_in_the_document_are_up_to_date() {
    let text = with_tables(&read("pmesh.md"), expected);
    let (before, example) = text.split_once("<!-- example -->\n").unwrap();
    let (_, after) = example.split_once("<!-- end -->").unwrap();
    compare("pmesh.md", &format!("{before}<!-- example -->\n```\n{}```\n<!-- end -->{after}", dump()));
}

#[test]
fn every_error_code_equals_its_row() {
    compare_codes("pmesh", codes::ALL);
}

#[test]
fn limits_equal_their_row() {
    let [row] = &of_format(rows("limits", "limit"), "pmesh")[..] else { panic!("one row") };
    assert_eq!(row["maximum"].as_integer(), Some(MAX_COUNT.into()));
    assert_eq!(row["default"].as_integer(), Some(Limits::new().counts.into()));
    assert!(row["guaranteed"].as_integer() <= row["default"].as_integer());
}

const DOCUMENTS: [&str; 1] = ["pmesh.md"];

#[test]
fn every_clause_is_listed_with_the_parties_it_binds() {
    let listed = listed("clauses-pmesh");
    assert_eq!(listed, defined(&DOCUMENTS), "spec/tables/clauses-pmesh.toml against the document");
    let known = ["writer", "reader", "validator", "definition"];
    assert!(listed.values().flatten().all(|party| known.contains(&party.as_str())));
}

#[test]
fn every_clause_that_is_cited_exists() {
    let defined = defined(&DOCUMENTS);
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
        for id in cited(&std::fs::read_to_string(&source).unwrap(), &["PMESH"]) {
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
    for (key, table) in [("common", "header"), ("pmesh", "header")] {
        for row in rows(key, table) {
            fields.push((row["offset"].as_integer().unwrap() as usize, row["name"].as_str().unwrap().into()));
        }
    }
    let mut more = |items: &[(usize, &str)]| fields.extend(items.iter().map(|&(at, what)| (at, what.into())));
    more(&[
        (0x98, "chunk: type"),
        (0x9C, "critical, reserved"),
        (0xA0, "length"),
        (0xA8, "packet 0: end_vertex"),
        (0xAC, "end_wedge"),
        (0xB0, "end_face"),
        (0xB4, "payload_bytes"),
        (0xB8, "error: 0.5 m"),
        (0xBC, "checksum of the chunk"),
        (0xC0, "record: id"),
        (0xC4, "generation"),
        (0xC8, "number of switches"),
        (0xCC, "position of vertex 0"),
        (0xD8, "vertex 1"),
        (0xE4, "vertex 2"),
        (0xF0, "vertex 3"),
        (0xFC, "corners of face 0, as at level 4: its third switches to vertex 3"),
        (0x108, "face 1: it has vertex 3 and its parent"),
        (0x114, "parent of vertex 3"),
        (0x115, "padding"),
        (0x118, "checksum of the record"),
        (0x11C, "end record: id"),
        (0x120, "generation"),
        (0x124, "length of the file"),
        (0x12C, "checksum of the record"),
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

#[test]
fn the_printed_coded_packet_is_that_of_the_vector() {
    let text = read("pmesh.md");
    let (_, after) = text.split_once("<!-- coded example -->\n```\n").expect("the example's mark");
    let (block, _) = after.split_once("```\n<!-- end -->").expect("the example's end");
    let printed: Vec<u8> =
        block.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect();
    let file = include_bytes!("../../conformance/vectors/pmesh/0057-coded-wedges.pmesh");
    let mut replay = Replay::default();
    pmesh_format::decode_all(file, &Limits::default(), |event| {
        if let pmesh_format::Event::Packet(packet) = &event {
            assert_eq!(packet.payload(), printed);
        }
        replay.accept(&event).unwrap();
    })
    .unwrap();
    assert_eq!(replay.indices(), [[0, 6, 3], [5, 7, 10], [1, 4, 9], [2, 11, 8]]);
}
