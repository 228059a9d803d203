//! The documents and tables of `spec/`, as the tests of every format crate read them.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use ivg_wire::Code;
use toml::{Table, Value};

/// A path relative to the repository.
pub(crate) fn repository(name: &str) -> String {
    format!("{}/../{name}", env!("CARGO_MANIFEST_DIR"))
}

/// A path relative to `spec/`.
pub(crate) fn path(name: &str) -> String {
    repository(&format!("spec/{name}"))
}

/// A file of `spec/`.
pub(crate) fn read(name: &str) -> String {
    std::fs::read_to_string(path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The rows of one list in `spec/tables/FILE.toml`.
pub(crate) fn rows(file: &str, key: &str) -> Vec<Table> {
    let text = read(&format!("tables/{file}.toml"));
    let table: Table = text.parse().unwrap_or_else(|error| panic!("{file}: {error}"));
    table[key].as_array().unwrap().iter().map(|row| row.as_table().unwrap().clone()).collect()
}

/// Those rows that are of one format, in a table that several formats share.
pub(crate) fn of_format(rows: Vec<Table>, format: &str) -> Vec<Table> {
    rows.into_iter().filter(|row| row["format"].as_str() == Some(format)).collect()
}

/// A cell's text: numbers of limits with thousands separated, absent fields as a dash.
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

/// Rows as a table in Markdown.
pub(crate) fn markdown(rows: &[Table], columns: &[&str]) -> String {
    let mut out = format!("| {} |\n|{}\n", columns.join(" | "), "---|".repeat(columns.len()));
    for row in rows {
        let cells: Vec<String> = columns.iter().map(|key| cell(row, key)).collect();
        writeln!(out, "| {} |", cells.join(" | ")).unwrap();
    }
    out
}

/// The tables that documents of several formats have: `errors FORMAT` and `limits FORMAT`.
pub(crate) fn shared_table(name: &str) -> Option<String> {
    match name.split_once(' ')? {
        ("errors", format) => {
            let columns = ["code", "name", "verdict", "clause", "text"];
            Some(markdown(&of_format(rows("errors", "error"), format), &columns))
        }
        ("limits", format) => {
            let columns = ["name", "text", "maximum", "guaranteed", "default"];
            Some(markdown(&of_format(rows("limits", "limit"), format), &columns))
        }
        _ => None,
    }
}

/// A document with `expected` between each `<!-- table NAME -->` and its `<!-- end -->`.
pub(crate) fn with_tables(text: &str, expected: impl Fn(&str) -> String) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(start) = rest.find("<!-- table ") {
        let (before, marked) = rest.split_at(start);
        let (mark, after) = marked.split_once(" -->\n").unwrap();
        let end = after.find("<!-- end -->").unwrap_or_else(|| panic!("{mark} has no end"));
        write!(out, "{before}{mark} -->\n{}", expected(mark.trim_start_matches("<!-- table "))).unwrap();
        rest = &after[end..];
    }
    out + rest
}

/// Compares a document with what it should be; with `IVG_BLESS` set, writes that.
pub(crate) fn compare(document: &str, expected: &str) {
    if std::env::var_os("IVG_BLESS").is_some() {
        std::fs::write(path(document), expected).unwrap();
        return;
    }
    let text = read(document);
    for (found, expected) in text.lines().zip(expected.lines()) {
        assert_eq!(found, expected, "{document} differs from the tables");
    }
    assert!(text == expected, "{document} differs from the tables in its length");
}

/// Compares the error codes of a crate with their rows.
pub(crate) fn compare_codes(format: &str, codes: &[Code]) {
    let rows = of_format(rows("errors", "error"), format);
    assert_eq!(rows.len(), codes.len());
    for (row, code) in rows.iter().zip(codes) {
        let rule = code.rule();
        assert_eq!(row["code"].as_integer(), Some(rule.number.into()));
        let ours = [rule.name, rule.verdict.name(), rule.clause, rule.text];
        assert_eq!(["name", "verdict", "clause", "text"].map(|key| row[key].as_str().unwrap()), ours);
    }
}

/// Clauses that documents define, as `**ID** (parties)`, with the parties that they bind.
pub(crate) fn defined(documents: &[&str]) -> BTreeMap<String, Vec<String>> {
    let mut clauses = BTreeMap::new();
    for document in documents {
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

/// Clauses that `spec/tables/FILE.toml` lists, with the parties that they bind.
pub(crate) fn listed(file: &str) -> BTreeMap<String, Vec<String>> {
    let strings =
        |value: &Value| value.as_array().unwrap().iter().map(|s| s.as_str().unwrap().into()).collect();
    let rows = rows(file, "clause");
    rows.iter().map(|row| (row["id"].as_str().unwrap().into(), strings(&row["binds"]))).collect()
}

/// Clause ids that stand in a text: `PREFIX-…-nn` for each of the prefixes.
pub(crate) fn cited(text: &str, prefixes: &[&str]) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (start, _) in
        prefixes.iter().flat_map(|prefix| text.match_indices(&format!("{prefix}-")).collect::<Vec<_>>())
    {
        let is_part = |c: &char| c.is_ascii_uppercase() || c.is_ascii_digit() || *c == '-';
        let id: String = text[start..].chars().take_while(is_part).collect();
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
