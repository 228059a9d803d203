//! The tables of the specification are the single source: constants of this crate must equal their rows.

use ivg_wire::{Code, Limits, Maximum, codes};
use toml::{Table, Value};

fn table(name: &str) -> Table {
    let path = format!("{}/../spec/tables/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
    text.parse().unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// The rows of one format, as comparable values.
fn rows(file: &str, key: &str, format: &str) -> Vec<Table> {
    let table = table(file);
    let rows = table[key].as_array().unwrap();
    rows.iter()
        .map(|row| row.as_table().unwrap().clone())
        .filter(|row| row["format"].as_str() == Some(format))
        .collect()
}

fn row(code: Code) -> Table {
    let rule = code.rule();
    let mut row = Table::new();
    row.insert("code".into(), Value::Integer(rule.number.into()));
    row.insert("format".into(), "common".into());
    for (key, value) in
        [("name", rule.name), ("verdict", rule.verdict.name()), ("clause", rule.clause), ("text", rule.text)]
    {
        row.insert(key.into(), value.into());
    }
    row
}

#[test]
fn every_error_code_equals_its_row() {
    let constants: Vec<Table> = codes::ALL.iter().map(|&code| row(code)).collect();
    for (constant, row) in constants.iter().zip(rows("errors", "error", "common")) {
        assert_eq!(*constant, row);
    }
    assert_eq!(constants.len(), rows("errors", "error", "common").len());
}

#[test]
fn error_numbers_are_used_once_and_ascend() {
    let table = table("errors");
    let numbers: Vec<i64> =
        table["error"].as_array().unwrap().iter().map(|row| row["code"].as_integer().unwrap()).collect();
    assert!(numbers.is_sorted_by(|a, b| a < b), "{numbers:?}");
}

#[test]
fn every_limit_equals_its_row() {
    let limits = Limits::new();
    let ours = [
        ("header_bytes", Maximum::HEADER_BYTES, limits.header_bytes),
        ("chunk_bytes", Maximum::CHUNK_BYTES, limits.chunk_bytes),
        ("chunks", Maximum::CHUNKS, limits.chunks),
        ("record_bytes", Maximum::RECORD_BYTES, limits.record_bytes),
    ];
    let rows = rows("limits", "limit", "common");
    assert_eq!(rows.len(), ours.len());
    for (row, (name, maximum, default)) in rows.iter().zip(ours) {
        let number = |key: &str| row[key].as_integer().unwrap();
        assert_eq!(row["name"].as_str(), Some(name));
        assert_eq!((number("maximum"), number("default")), (maximum.into(), default.into()), "{name}");
        assert!(
            number("guaranteed") <= number("default"),
            "{name}: the default must accept what is guaranteed"
        );
    }
}
