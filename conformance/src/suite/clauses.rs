//! Which clauses a test is about: those that name its file in `spec/tables/clauses*.toml`, that of its error code, and what its
//! command shows.

use crate::vectors::{Format, Vector};
use conformance_runner::manifest::{Kind, Op};
use std::collections::{BTreeMap, BTreeSet};

const CLAUSES: [&str; 2] = [
    include_str!("../../../spec/tables/clauses.toml"),
    include_str!("../../../spec/tables/clauses-pmesh.toml"),
];
const ERRORS: &str = include_str!("../../../spec/tables/errors.toml");

/// The tables, inverted.
pub(super) struct Clauses {
    of_file: BTreeMap<String, Vec<String>>,
    of_code: BTreeMap<u16, String>,
    /// Clauses that bind readers, in the order of the tables.
    pub(super) readers: Vec<String>,
}

impl Clauses {
    pub(super) fn read() -> Self {
        let (mut of_file, mut readers) = (BTreeMap::<String, Vec<String>>::new(), Vec::new());
        for row in CLAUSES.iter().flat_map(|text| rows(text, "clause")) {
            let id = text(&row, "id");
            let strings = |key: &str| {
                let list = row.get(key).and_then(toml::Value::as_array).cloned().unwrap_or_default();
                list.into_iter().filter_map(|entry| entry.as_str().map(str::to_owned)).collect::<Vec<_>>()
            };
            for test in strings("tests") {
                if let Some(file) = test.strip_prefix("conformance/vectors/") {
                    of_file.entry(file.to_owned()).or_default().push(id.clone());
                }
            }
            if strings("binds").iter().any(|party| party == "reader") {
                readers.push(id);
            }
        }
        let code = |row: &toml::Table| row["code"].as_integer().and_then(|code| u16::try_from(code).ok());
        let of_code = rows(ERRORS, "error")
            .into_iter()
            .map(|row| (code(&row).expect("a code"), text(&row, "clause")))
            .collect();
        Self { of_file, of_code, readers }
    }

    /// The clauses of the test of a whole file.
    pub(super) fn of(&self, vector: &Vector, kind: Kind) -> Vec<String> {
        let listed = self.of_file.get(&vector.file()).cloned().unwrap_or_default();
        let mut all: BTreeSet<String> = listed.into_iter().collect();
        all.extend(vector.code.and_then(|code| self.of_code.get(&code).cloned()));
        let more: &[&str] = match (kind, vector.format, vector.name.as_str()) {
            (Kind::Limits, _, "x-605-vertices" | "x-604-record") => &["COM-LIM-03", "IVG-HDR-01"],
            (Kind::Limits, _, "x-620-limit-counts") => &["COM-LIM-03", "PMESH-HDR-01", "PMESH-LIM-03"],
            (Kind::Order, Format::Ivg, name) if name.contains("octree") => {
                &["IVG-OCT-02", "IVG-OCT-03", "IVG-OCT-04"]
            }
            (Kind::Order, Format::Ivg, _) => &["IVG-ORD-07", "IVG-ORD-08", "IVG-ORD-09", "IVG-ORD-10"],
            (_, _, "x-308-record-huge" | "x-351-vertex-count" | "x-361-entry-bytes-huge") => &["COM-LIM-02"],
            (_, Format::Ivg, "0036-seed") => &["IVG-HDR-03"],
            (_, _, "x-118-chunk-flags") => &["COM-CHK-03"],
            (_, _, "x-520-deep" | "x-518-coded-work") => &["COM-LIM-04", "PMESH-LIM-04"],
            _ => &[],
        };
        all.extend(vector.both.iter().map(|both| both.clause.to_owned()));
        all.extend(more.iter().map(|&clause| clause.to_owned()));
        all.into_iter().collect()
    }
}

/// What a command with part of a file, or with its parts, is about.
pub(super) fn of_command(format: Format, op: Op, refused: bool) -> Vec<String> {
    let list: &[&str] = match (format, op, refused) {
        (_, Op::Prefixes, true) => &["COM-HDR-03", "COM-CHK-03", "COM-STR-02"],
        (Format::Ivg, Op::Prefixes, false) => {
            &["COM-STR-01", "COM-STR-02", "IVG-STR-01", "COM-HDR-03", "COM-CHK-03"]
        }
        (Format::Pmesh, Op::Prefixes, false) => {
            &["COM-STR-01", "COM-STR-02", "PMESH-DIR-01", "COM-HDR-03", "COM-CHK-03"]
        }
        (Format::Ivg, Op::Prefix, _) => &["COM-STR-01", "COM-STR-02", "IVG-STR-01"],
        (Format::Pmesh, Op::Prefix, _) => &["COM-STR-01", "COM-STR-02", "PMESH-DIR-06", "PMESH-LVL-01"],
        (_, Op::Chunks, true) => &["COM-STR-03", "COM-VERD-03"],
        (_, Op::Chunks, false) => &["COM-STR-03"],
        (_, Op::Lod, _) => &["PMESH-DEF-04", "PMESH-LVL-01", "PMESH-LVL-05"],
        (_, Op::Decode | Op::Numeric, _) => &[],
    };
    list.iter().map(|&clause| clause.to_owned()).collect()
}

fn rows(text: &str, key: &str) -> Vec<toml::Table> {
    let table: toml::Table = text.parse().expect("a table of the specification");
    let rows = table[key].as_array().cloned().unwrap_or_default();
    rows.into_iter().filter_map(|row| row.as_table().cloned()).collect()
}

fn text(row: &toml::Table, key: &str) -> String {
    row[key].as_str().unwrap_or_default().to_owned()
}

/// The kind of mistake behind an error code, in one word.
pub(super) fn bug_class(code: u16) -> &'static str {
    match code {
        101 => "signature",
        103..=105 => "checksum",
        102 | 106 | 113..=117 | 359 | 422 | 512 | 515 => "length",
        107 | 112 | 408 | 513 | 516 => "padding",
        108 => "repetition",
        110 | 118 | 201 | 202 | 353 | 355 | 402 | 404 | 405 => "extension",
        111 | 514 => "order",
        308 => "overflow",
        401 | 403 | 352 | 354 | 406 | 412 => "forbidden",
        301..=304 | 356 | 357 | 362 | 364 | 407 | 413 | 414 | 501 | 502 => "range",
        305..=307 | 309..=313 | 351 | 358 | 360 | 361 | 509 | 517 | 518 | 520 => "count",
        363 | 410 | 411 => "text",
        420 | 508 => "number",
        409 | 421 | 503 | 504 | 510 | 511 | 519 => "index",
        505 => "degenerate",
        600.. => "trust-count",
        _ => "other",
    }
}
