//! The tables: those of the documents, the constants of this crate, the rows of `spec/tables`.

use super::document::{compare, compare_codes, markdown, shared_table, with_tables};
use super::{of_format, read, rows};
use ivg_format::{Encoding, Limits, Order, Units};
use std::collections::BTreeSet;
use toml::Table;

/// The table that belongs between `<!-- table NAME -->` and `<!-- end -->` in a document.
fn expected(document: &str, name: &str) -> String {
    let fields = ["offset", "type", "name", "clause", "text"];
    match name.split(' ').collect::<Vec<_>>()[..] {
        [kind @ ("header" | "chunk" | "record")] => markdown(&rows(document, kind), &fields),
        ["orders", order] => super::orders::markdown(order),
        ["values", quantiser] => super::values::markdown(quantiser),
        ["derived", _] => {
            markdown(&rows("limits", "derived"), &["name", "text", "maximum", "guaranteed", "default"])
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
        _ => shared_table(name).unwrap_or_else(|| panic!("{document}.md has an unknown table {name:?}")),
    }
}

#[test]
fn the_tables_in_the_documents_are_those_of_the_table_files() {
    for document in ["common", "ivg"] {
        let name = format!("{document}.md");
        compare(&name, &with_tables(&read(&name), |table| expected(document, table)));
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
    compare_codes("ivg", ivg_format::codes::ALL);
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
        let (id, name) = (row["id"].as_integer().unwrap() as u16, row["name"].as_str().unwrap());
        let order = Order::from_id(id);
        assert_eq!(order.map(Order::name), (row["status"].as_str() == Some("described")).then_some(name));
        assert_eq!(order, Order::from_name(name));
    }
    for row in rows("registry", "units") {
        let units = Units::from_id(row["id"].as_integer().unwrap() as u8).unwrap();
        assert_eq!(Some(units.name()), row["name"].as_str());
    }
    let chunks = rows("registry", "chunks");
    let kinds: Vec<_> = chunks.iter().map(|row| row["type"].as_str().unwrap().to_string()).collect();
    let ours = [ivg_format::DIRECTORY, ivg_format::LIGHTS, ivg_format::METADATA];
    assert_eq!(kinds, ours.map(|kind| kind.to_string()));
    let limits = of_format(rows("limits", "limit"), "ivg");
    assert_eq!(limits.len(), 1);
    assert_eq!(limits[0]["default"].as_integer(), Some(Limits::new().vertices as i64));
    assert_eq!(limits[0]["maximum"].as_integer(), Some(65_535 * 65_535 * 65_535));
}

#[test]
fn chunk_types_are_four_capital_letters() {
    for row in rows("registry", "chunks") {
        let kind = row["type"].as_str().unwrap();
        assert!(kind.len() == 4 && kind.bytes().all(|b| b.is_ascii_uppercase()), "{kind} (COM-CHK-09)");
    }
    // What the encoder writes is registered.
    let lights = [ivg_format::BakedLight { name: "", direct_included: false }];
    let lattice = ivg_format::Lattice::new([1, 1, 1], [0.0; 3], [0.0; 3]).unwrap();
    let vectors = [[[[0.0; 3]; 3]; 6]];
    let source = ivg_format::GridSource {
        lights: &lights,
        meta: &[("generator", "test")],
        ..ivg_format::GridSource::new(lattice, &vectors)
    };
    let mut kinds = vec![];
    let file = ivg_format::encode(&source, &ivg_format::EncodeOptions::new()).unwrap();
    ivg_format::decode_all(&file, &Limits::default(), |event| {
        if let ivg_format::Event::Chunk(chunk) = event {
            kinds.push(chunk.kind.to_string());
        }
    })
    .unwrap();
    assert_eq!(kinds, ["LITE", "META"]);
}

#[test]
fn counts_without_a_limit_are_bounded_by_those_that_have_one() {
    let limits = rows("limits", "limit");
    let derived = rows("limits", "derived");
    for column in ["maximum", "guaranteed", "default"] {
        let number = |rows: &[Table], name: &str| {
            let row = rows.iter().find(|row| row["name"].as_str() == Some(name)).unwrap();
            row[column].as_integer().unwrap()
        };
        // Payloads: 20 bytes of envelope of a chunk (COM-CHK-02), 12 of a record (COM-REC-01).
        let chunk = number(&limits, "chunk_bytes") - 20;
        let record = number(&limits, "record_bytes") - 12;
        // Ids of validity records are the reason for the one maximum that is not a quotient (IVG-VAL-01).
        let blocks = ((number(&limits, "vertices") + 4095) / 4096).min((1 << 31) - 1);
        let expected = [
            ("lights", (chunk - 4) / 4),
            ("light_name", (chunk - 8).min(65_535)),
            ("metadata", chunk),
            ("directory", chunk / 8),
            ("validity_records", blocks),
            ("bundle", record / 216),
        ];
        assert_eq!(derived.len(), expected.len());
        for (name, expected) in expected {
            assert_eq!(number(&derived, name), expected, "{name}, {column}");
        }
    }
}
