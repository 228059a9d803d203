//! The tables of the specification are the single source: constants of this crate must equal their rows.

#[allow(dead_code, reason = "shared with the tests of the format crates, which use other parts")]
mod document;

use document::{compare_codes, of_format, rows};
use ivg_wire::{Limits, Maximum, codes};

#[test]
fn every_error_code_equals_its_row() {
    compare_codes("common", codes::ALL);
}

#[test]
fn error_numbers_are_used_once_and_ascend() {
    let rows = rows("errors", "error");
    let numbers: Vec<i64> = rows.iter().map(|row| row["code"].as_integer().unwrap()).collect();
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
    let rows = of_format(rows("limits", "limit"), "common");
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
