//! The specification's tables, Markdown, clause ids and worked example against each other and against this crate.
//!
//! `IVG_BLESS=1 cargo test -p ivg-format --test spec` writes the tables into the Markdown anew.

use ivg_format::{
    BakedLight, EncodeOptions, Encoding, Event, GridSource, Lattice, Limits, Order, Units, decode_all, encode,
};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use toml::{Table, Value};

fn path(name: &str) -> String {
    format!("{}/../spec/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn read(name: &str) -> String {
    std::fs::read_to_string(path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn table(name: &str) -> Table {
    read(&format!("tables/{name}.toml")).parse().unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn rows(file: &str, key: &str) -> Vec<Table> {
    table(file)[key].as_array().unwrap().iter().map(|row| row.as_table().unwrap().clone()).collect()
}

fn of_format(rows: Vec<Table>, format: &str) -> Vec<Table> {
    rows.into_iter().filter(|row| row["format"].as_str() == Some(format)).collect()
}

/// A cell's text: numbers with thousands separated, absent fields as a dash.
fn cell(row: &Table, key: &str) -> String {
    match row.get(key) {
        None => "–".into(),
        Some(Value::String(text)) if key == "name" || key == "type" => format!("`{text}`"),
        Some(Value::String(text)) => text.clone(),
        Some(Value::Integer(n)) if ["maximum", "guaranteed", "default"].contains(&key) => {
            let digits = n.to_string();
            let groups: Vec<&str> =
                digits.as_bytes().rchunks(3).rev().map(|g| std::str::from_utf8(g).unwrap()).collect();
            groups.join(",")
        }
        Some(Value::Integer(n)) if key == "last" || *n > 0x7FFF_0000 => {
            format!("{n:#010X}").replace("0X", "0x")
        }
        Some(Value::Boolean(b)) => if *b { "critical" } else { "ancillary" }.into(),
        Some(other) => other.to_string(),
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

/// The table that belongs between `<!-- table NAME -->` and `<!-- end -->` in a document.
fn expected(document: &str, name: &str) -> String {
    let fields = ["offset", "type", "name", "clause", "text"];
    match name.split(' ').collect::<Vec<_>>()[..] {
        [kind @ ("header" | "chunk" | "record")] => markdown(&rows(document, kind), &fields),
        ["errors", format] => {
            let columns = ["code", "name", "verdict", "clause", "text"];
            markdown(&of_format(rows("errors", "error"), format), &columns)
        }
        ["limits", format] => {
            let columns = ["name", "text", "maximum", "guaranteed", "default"];
            markdown(&of_format(rows("limits", "limit"), format), &columns)
        }
        ["registry", key] => {
            let columns: &[&str] = match key {
                "encodings" => &["id", "name", "bytes", "status", "text"],
                "records" => &["id", "last", "name", "text"],
                "chunks" => &["type", "critical", "text"],
                _ => &["id", "name", "status", "text"],
            };
            markdown(&rows("registry", key), columns)
        }
        _ => panic!("{document}.md has an unknown table {name:?}"),
    }
}

#[test]
fn the_tables_in_the_documents_are_those_of_the_table_files() {
    for document in ["common", "ivg"] {
        let text = read(&format!("{document}.md"));
        let mut out = String::new();
        let mut rest = text.as_str();
        while let Some(start) = rest.find("<!-- table ") {
            let (before, marked) = rest.split_at(start);
            let (mark, after) = marked.split_once(" -->\n").unwrap();
            let end = after.find("<!-- end -->").unwrap_or_else(|| panic!("{document}: {mark} has no end"));
            let name = mark.trim_start_matches("<!-- table ");
            write!(out, "{before}{mark} -->\n{}", expected(document, name)).unwrap();
            rest = &after[end..];
        }
        out.push_str(rest);
        if std::env::var_os("IVG_BLESS").is_some() {
            std::fs::write(path(&format!("{document}.md")), &out).unwrap();
        } else {
            for (found, expected) in text.lines().zip(out.lines()) {
                assert_eq!(found, expected, "{document}.md differs from the tables");
            }
            assert!(text == out, "{document}.md differs from the tables in its length");
        }
    }
}

/// Size in bytes of a type of the field tables; `None` where the length varies.
fn size(kind: &str) -> Option<i64> {
    let (base, count) = match kind.split_once('[') {
        Some((base, rest)) => (base, rest.trim_end_matches(']').parse().ok()?),
        None => (kind, 1),
    };
    let one: i64 = match base {
        "u8" => 1,
        "u16" | "i16" => 2,
        "u32" => 4,
        "u64" | "f64" => 8,
        other => panic!("unknown type {other}"),
    };
    Some(one * count)
}

#[test]
fn fields_follow_each_other_without_gaps() {
    let check = |rows: Vec<Table>, mut next: i64| {
        for row in rows.iter().filter(|row| row.contains_key("offset")) {
            assert_eq!(row["offset"].as_integer(), Some(next), "{row:?}");
            match row["type"].as_str().unwrap() {
                "bytes[]" => break,
                kind => next += size(kind).unwrap(),
            }
        }
        next
    };
    assert_eq!(check(rows("common", "header"), 0), 56);
    assert_eq!(check(rows("common", "chunk"), 0), 16);
    assert_eq!(check(rows("common", "record"), 0), 8);
    assert_eq!(check(rows("ivg", "header"), 56), ivg_format::HEADER_BYTES as i64);
}

#[test]
fn no_two_errors_of_any_format_share_a_number_or_a_name() {
    let rows = rows("errors", "error");
    let distinct = |key: &str| rows.iter().map(|row| row[key].to_string()).collect::<BTreeSet<_>>().len();
    assert_eq!((distinct("code"), distinct("name")), (rows.len(), rows.len()));
}

#[test]
fn every_error_code_equals_its_row() {
    let rows = of_format(rows("errors", "error"), "ivg");
    assert_eq!(rows.len(), ivg_format::codes::ALL.len());
    for (row, code) in rows.iter().zip(ivg_format::codes::ALL) {
        let rule = code.rule();
        assert_eq!(row["code"].as_integer(), Some(rule.number.into()));
        let ours = [rule.name, rule.verdict.name(), rule.clause, rule.text];
        assert_eq!(["name", "verdict", "clause", "text"].map(|key| row[key].as_str().unwrap()), ours);
    }
}

#[test]
fn registries_and_limits_equal_their_rows() {
    for row in rows("registry", "encodings") {
        let (id, name) = (row["id"].as_integer().unwrap() as u16, row["name"].as_str().unwrap());
        let described = row["status"].as_str() == Some("described");
        assert_eq!(Encoding::from_id(id).is_some(), described, "{name}");
        if let Some(encoding) = Encoding::from_id(id) {
            assert_eq!((encoding.name(), Encoding::from_name(name)), (name, Some(encoding)));
            assert_eq!(Some(encoding.bytes_per_vertex() as i64), row["bytes"].as_integer());
        }
    }
    for row in rows("registry", "orders") {
        let order = Order::from_id(row["id"].as_integer().unwrap() as u16);
        assert_eq!(order.map(Order::name), (row["status"].as_str() == Some("described")).then_some("slices"));
    }
    for row in rows("registry", "units") {
        let units = Units::from_id(row["id"].as_integer().unwrap() as u8).unwrap();
        assert_eq!(Some(units.name()), row["name"].as_str());
    }
    let chunks = rows("registry", "chunks");
    let kinds: Vec<_> = chunks.iter().map(|row| row["type"].as_str().unwrap().to_string()).collect();
    assert_eq!(kinds, [ivg_format::LIGHTS, ivg_format::METADATA].map(|kind| kind.to_string()));
    let limits = of_format(rows("limits", "limit"), "ivg");
    assert_eq!(limits.len(), 1);
    assert_eq!(limits[0]["default"].as_integer(), Some(Limits::new().vertices as i64));
    assert_eq!(limits[0]["maximum"].as_integer(), Some(65_535 * 65_535 * 65_535));
}

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

/// The grid of the section "A file, byte by byte".
fn example() -> Vec<u8> {
    let lattice = Lattice::new([1, 1, 3], [0.0; 3], [0.0, 0.0, 2.0]).unwrap();
    let mut vectors = vec![[[[0.0; 3]; 3]; 6]; 3];
    vectors[0][4] = [[0.0, 0.0, 1.0]; 3];
    vectors[1][0] = [[0.5, 0.0, 0.0], [0.25, 0.0, 0.0], [0.0; 3]];
    let source = GridSource { meta: &[("generator", "by hand")], ..GridSource::new(lattice, &vectors) };
    encode(&source, &EncodeOptions { vertices_per_slice: 1, ..EncodeOptions::new() }).unwrap()
}

/// The bytes printed there: lines of offset, two spaces, bytes, two spaces, meaning.
fn printed() -> Vec<u8> {
    let text = read("ivg.md");
    let (_, after) = text.split_once("<!-- example -->\n```\n").expect("the example's mark");
    let (block, _) = after.split_once("```\n<!-- end -->").expect("the example's end");
    let mut bytes = vec![];
    for line in block.lines() {
        let (offset, rest) = line.split_once("  ").unwrap();
        let (hex, _meaning) = rest.split_once("  ").unwrap_or((rest, ""));
        assert_eq!(usize::from_str_radix(offset, 16), Ok(bytes.len()), "{line}");
        bytes.extend(hex.split(' ').map(|byte| u8::from_str_radix(byte, 16).unwrap()));
    }
    bytes
}

#[test]
fn the_worked_example_is_what_the_encoder_writes_and_the_decoder_reads() {
    let bytes = printed();
    let ours = example();
    let differing: Vec<usize> = (0..ours.len()).filter(|&at| bytes.get(at) != ours.get(at)).collect();
    assert!(differing.is_empty() && bytes.len() == ours.len(), "the encoder differs at {differing:x?}");
    let mut received = BTreeMap::new();
    decode_all(&bytes, &Limits::default(), |event| {
        if let Event::Corners(bundle) | Event::Bundle(bundle) = event {
            received.extend(bundle.iter());
        }
    })
    .unwrap();
    assert_eq!(received[&0][4], [[0.0, 0.0, 1.0]; 3]);
    assert_eq!(received[&1][0], [[0.5, 0.0, 0.0], [0.25, 0.0, 0.0], [0.0; 3]]);
    assert_eq!(received[&2], [[[0.0; 3]; 3]; 6]);
}

#[test]
fn the_light_entry_is_laid_out_as_its_clause_says() {
    let lattice = Lattice::new([1, 1, 1], [0.0; 3], [0.0; 3]).unwrap();
    let vectors = [[[[0.0; 3]; 3]; 6]];
    let lights = [BakedLight { name: "sun", direct_included: true }];
    let source = GridSource { lights: &lights, ..GridSource::new(lattice, &vectors) };
    let file = encode(&source, &EncodeOptions::new()).unwrap();
    let payload = [1, 0, 0, 0, 1, 0, 3, 0, b's', b'u', b'n'];
    assert_eq!(file[144..][..8], *b"LITE\0\0\0\0");
    assert_eq!(file[152..][..8], 11u64.to_le_bytes());
    assert_eq!(file[160..][..11], payload);
}
