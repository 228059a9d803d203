//! Accumulator files against `spec/accumulator.md`, its tables and its clauses.
//!
//! `IVG_BLESS=1 cargo test -p ivg-bake --test accumulator` writes the tables into the Markdown anew.

use std::collections::BTreeSet;

use ivg_bake::{Accumulator, AccumulatorError};
use ivg_format::Quantity;
use ivg_wire::{Code, Verdict, codes};
use toml::Table;

#[allow(dead_code, reason = "shared with the tests of the formats, which use other parts")]
#[path = "../../ivg-wire/tests/document/mod.rs"]
mod document;
mod sample;

use document::{cited, compare, defined, listed, markdown, read, repository, rows, with_tables};
use sample::{HEADER, Parts, file};

/// What belongs between `<!-- table NAME -->` and `<!-- end -->`.
fn expected(name: &str) -> String {
    let columns: &[&str] = match name {
        "header" | "vertex" => &["offset", "type", "name", "clause", "text"],
        "record" => &["id", "name", "bytes", "clause", "text"],
        "refusal" => &["name", "clause", "text"],
        _ => panic!("unknown table {name:?}"),
    };
    markdown(&rows("accumulator", name), columns)
}

#[test]
fn the_tables_in_the_document_are_up_to_date() {
    compare("accumulator.md", &with_tables(&read("accumulator.md"), expected));
}

#[test]
fn every_clause_is_listed_with_the_parties_it_binds() {
    let defined = defined(&["accumulator.md"]);
    assert_eq!(
        listed("clauses-accumulator"),
        defined,
        "spec/tables/clauses-accumulator.toml against the document"
    );
    let sources =
        ["ivg-bake/src/accumulator.rs", "ivg-bake/src/accumulator/file.rs", "spec/tables/accumulator.toml"];
    let texts = sources.map(|name| std::fs::read_to_string(repository(name)).unwrap());
    let found: BTreeSet<String> = texts.iter().flat_map(|text| cited(text, &["ACC"])).collect();
    assert!(found.len() > 10, "{found:?}");
    for id in found {
        assert!(defined.contains_key(&id), "{id} is not defined");
    }
}

fn text<'a>(row: &'a Table, key: &str) -> &'a str {
    row[key].as_str().unwrap()
}

/// Where a field of the header begins.
fn offset(name: &str) -> usize {
    let row = rows("accumulator", "header").into_iter().find(|row| text(row, "name") == name);
    row.unwrap_or_else(|| panic!("no field {name}"))["offset"].as_integer().unwrap() as usize
}

/// Bytes of a type of the field tables.
fn size(kind: &str) -> usize {
    let (base, count) = match kind.split_once('[') {
        Some((base, rest)) => (base, rest.trim_end_matches(']').parse().unwrap()),
        None => (kind, 1),
    };
    count * base[1..].parse::<usize>().unwrap() / 8
}

#[test]
fn fields_follow_each_other_without_gaps() {
    for (table, first, end) in [("header", 56, HEADER), ("vertex", 0, 14)] {
        let next = rows("accumulator", table).iter().fold(first, |next, row| {
            assert_eq!(row["offset"].as_integer(), Some(next as i64), "{row:?}");
            next + size(text(row, "type"))
        });
        assert_eq!(next, end, "{table}");
    }
}

#[test]
fn fields_stand_where_the_table_says() {
    let header = Parts::of(&file(Quantity::Vectors)).header;
    let number = |name| u64::from_le_bytes(header[offset(name)..][..8].try_into().unwrap());
    let float = |name| f64::from_bits(number(name));
    let short = |name| number(name) as u32;
    assert_eq!(header[..16], *b"\x89IVA\r\n\x1a\n\0\0\x01\0\0\0\0\0");
    assert_eq!((number("seed"), number("photons"), number("traced")), (1, 3000, 3000));
    assert_eq!([short("shard"), short("shards"), short("max_bounces"), short("quantity")], [1, 1, 3, 0]);
    assert_eq!(number("dims"), 2 | 2 << 16 | 1 << 32);
    assert_eq!((float("first"), float("last")), (0.1, 0.9));
    assert!(["power", "per_area", "quantum", "volume"].into_iter().all(|name| float(name) > 0.0));
    assert_eq!(header[offset("reserved_2")..], [0; 16]);
}

#[test]
fn records_stand_where_the_table_says() {
    for quantity in [Quantity::Vectors, Quantity::Radiance] {
        let bytes = file(quantity);
        let parts = Parts::of(&bytes);
        assert_eq!(parts.file(), bytes, "put together again");
        let table = rows("accumulator", "record");
        assert!(table.iter().map(|row| row["id"].as_integer().unwrap()).eq(0..4));
        assert_eq!(text(&table[2], "bytes"), parts.records[2].len().to_string());
        assert_eq!(text(&table[3], "bytes"), format!("{} a vertex", parts.records[3].len() / 4));
        // Two lamps without their direct light.
        assert_eq!(parts.records[1], *b"\0\x04\0\0\0left\0\x05\0\0\0right");
        // Emitted and flights, in the books.
        let books = &parts.records[2];
        let emitted = i128::from_le_bytes(books[..16].try_into().unwrap());
        let flights = u64::from_le_bytes(books[1216..].try_into().unwrap());
        // All photons are white and carry one each in every colour.
        let each = f64::from(1 << 24);
        assert!((emitted as f64 / (3000.0 * each) - 1.0).abs() < 1e-6, "{emitted}");
        assert!((3000..6000).contains(&flights), "{flights}");
    }
}

fn refused(parts: &Parts) -> AccumulatorError {
    Accumulator::from_bytes(&parts.file()).expect_err("refused")
}

/// For each row of the table of refusals at least one file with that fault alone.
#[test]
fn every_refusal_of_the_table_has_a_file() {
    let whole = Parts::of(&file(Quantity::Vectors));
    let field = |name: &str, bytes: &[u8]| whole.clone().with_header(offset(name), bytes);
    let record = |id, at, bytes: &[u8]| whole.clone().with_record(id, at, bytes);
    let float = |number: f64| number.to_le_bytes();
    let sized = |bytes: u64| Parts { records: vec![bytes.to_le_bytes().to_vec()], ..whole.clone() };
    // The first vertex' sub-cells, all of them: 7 · 512 is the most that a moment may be.
    let full = |at, bytes: &[u8]| record(3, 0, &512u16.to_le_bytes()).with_record(3, at, bytes);
    let cases = [
        ("number of photons", field("photons", &[0; 8])),
        ("number of photons", field("photons", &(1u64 << 39).to_le_bytes())),
        ("number of photons", field("max_bounces", &u32::MAX.to_le_bytes())),
        ("number of photons", field("traced", &3001u64.to_le_bytes())),
        ("shard", field("shard", &[0; 4])),
        ("shard", field("shard", &2u32.to_le_bytes())),
        ("shard", field("shards", &[0; 4])),
        ("quantity", field("quantity", &2u32.to_le_bytes())),
        ("number of vertices", field("dims", &[0; 2])),
        ("number of vertices", field("dims", &[0, 1, 0, 1, 1, 1])),
        ("reserved field", field("reserved", &[1])),
        ("reserved field", field("reserved_2", &[0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1])),
        ("bounds", field("first", &float(f64::NAN))),
        ("bounds", field("last", &float(f64::NEG_INFINITY))),
        ("scale", field("power", &float(0.0))),
        ("scale", field("per_area", &float(-1.0))),
        ("scale", field("quantum", &float(f64::INFINITY))),
        ("scale", field("volume", &float(f64::NAN))),
        ("data offset", whole.clone().with_header(40, &224u64.to_le_bytes())),
        ("list of lights", sized((1 << 24) + 1)),
        ("list of lights", record(1, 0, &[2])),
        ("list of lights", record(1, 5, &[0xff])),
        ("energy", record(2, 12, &[1])),
        ("energy", record(2, 1200, &[0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x80])),
        ("number of flights", record(2, 1216, &((1u64 << 40) + 1).to_le_bytes())),
        ("list of vertices", record(3, 0, &513u16.to_le_bytes())),
        ("list of vertices", record(3, 3, &[8])),
        ("list of vertices", full(4, &3585i16.to_le_bytes())),
        ("list of vertices", full(8, &i16::MIN.to_le_bytes())),
        ("list of vertices", record(3, 14 + 13, &[0b1100_0000])),
    ];
    let mut seen = BTreeSet::new();
    for (name, parts) in &cases {
        assert_eq!(refused(parts), AccumulatorError::Field { what: name }, "{name}");
        seen.insert((*name).to_owned());
    }
    let table: BTreeSet<String> =
        rows("accumulator", "refusal").iter().map(|row| text(row, "name").to_owned()).collect();
    assert_eq!(seen, table);
    // At the ends of the ranges.
    for parts in [full(4, &3584i16.to_le_bytes()), full(4, &(-3584i16).to_le_bytes())] {
        Accumulator::from_bytes(&parts.file()).expect("within the range");
    }
}

#[test]
fn the_first_failure_is_reported() {
    let order: Vec<String> =
        rows("accumulator", "refusal").iter().map(|row| text(row, "name").to_owned()).collect();
    let mut parts = Parts::of(&file(Quantity::Vectors));
    // From the last fault to the first: each new one is judged before those that are there already.
    let faults: [(&str, usize, &[u8]); 8] = [
        ("data offset", 40, &[224]),
        ("scale", offset("power"), &[0; 8]),
        ("bounds", offset("first"), &[0xff; 8]),
        ("reserved field", offset("reserved"), &[1]),
        ("number of vertices", offset("dims"), &[0; 2]),
        ("quantity", offset("quantity"), &[7]),
        ("shard", offset("shard"), &[0; 4]),
        ("number of photons", offset("photons"), &[0; 8]),
    ];
    for (what, at, bytes) in faults {
        parts = parts.with_header(at, bytes);
        assert_eq!(refused(&parts), AccumulatorError::Field { what });
    }
    assert!(faults.iter().map(|(what, ..)| *what).rev().eq(order.iter().take(8).map(String::as_str)));
}

#[test]
fn records_in_another_order_are_refused() {
    let whole = Parts::of(&file(Quantity::Vectors));
    let mut swapped = whole.file();
    // Ids of the records 2 and 3 behind valid checksums: `write_record` numbers them as they come.
    let mut other = whole.clone();
    other.records.insert(2, vec![0; 1224]);
    assert!(matches!(refused(&other), AccumulatorError::Bytes(_)));
    other.records = whole.records[..4].to_vec();
    assert!(matches!(refused(&other), AccumulatorError::Bytes(_)), "without sums");
    // The id of record 0, without a checksum that fits.
    swapped[HEADER] = 1;
    assert!(matches!(Accumulator::from_bytes(&swapped), Err(AccumulatorError::Bytes(_))));
}

/// Number and verdict of an error of `common.md`.
fn code(bytes: &[u8]) -> Option<(u16, Verdict)> {
    match Accumulator::from_bytes(bytes) {
        Err(AccumulatorError::Bytes(error)) => Some((error.code(), error.verdict())),
        _ => None,
    }
}

fn expected_of(code: Code) -> Option<(u16, Verdict)> {
    Some((code.rule().number, code.rule().verdict))
}

#[test]
fn every_truncation_is_refused() {
    let bytes = file(Quantity::Radiance);
    for length in 0..bytes.len() {
        assert_eq!(code(&bytes[..length]), expected_of(codes::TRUNCATED), "{length} bytes");
    }
    assert_eq!(code(&[&bytes[..], &[0]].concat()), expected_of(codes::TRAILING_BYTES));
}

#[test]
fn a_length_that_does_not_follow_is_refused() {
    let bytes = file(Quantity::Vectors);
    for off in [-4i64, 4] {
        let mut wrong = bytes.clone();
        let length = (bytes.len() as i64 + off) as u64;
        wrong[48..56].copy_from_slice(&length.to_le_bytes());
        let mut header = wrong[..HEADER].to_vec();
        ivg_wire::seal_header(&mut header);
        wrong[..HEADER].copy_from_slice(&header);
        wrong.resize(length as usize, 0);
        assert_eq!(code(&wrong), expected_of(codes::FILE_BYTES), "{off}");
    }
}

/// Any byte of header or records may be anything, with checksums that fit: what is accepted is written as it was read, and
/// added up or refused without a panic.
#[test]
fn any_byte_may_lie() {
    let whole = Parts::of(&file(Quantity::Vectors));
    let try_it = |parts: &Parts| {
        let bytes = parts.file();
        let Ok(sums) = Accumulator::from_bytes(&bytes) else { return false };
        assert_eq!(sums.to_bytes().len(), bytes.len());
        assert_eq!(Accumulator::from_bytes(&sums.to_bytes()).as_ref(), Ok(&sums));
        let _ = Accumulator::merge(vec![sums.clone(), sums.clone()]);
        let _ = Accumulator::merge(vec![sums]).map(Accumulator::finish);
        true
    };
    let (mut accepted, mut tried) = (0, 0);
    for change in [0x01, 0x80, 0xff] {
        for at in 0..HEADER {
            let byte = whole.header[at] ^ change;
            accepted += usize::from(try_it(&whole.clone().with_header(at, &[byte])));
            tried += 1;
        }
        for id in 0..5 {
            // Of the sums, which may be any numbers, some.
            let step = if id == 4 { 13 } else { 1 };
            for at in (0..whole.records[id].len()).step_by(step) {
                let byte = whole.records[id][at] ^ change;
                accepted += usize::from(try_it(&whole.clone().with_record(id, at, &[byte])));
                tried += 1;
            }
        }
    }
    // Books and sums are free in most of their bytes; header and vertices are not.
    assert!(accepted > tried / 3 && accepted < tried, "{accepted} of {tried}");
}
