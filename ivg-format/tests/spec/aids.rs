//! What stands beside the documents, against them: the layout for Kaitai Struct, the media types.

use super::{read, rows};
use std::collections::BTreeMap;

/// A field of the layout file: its id, and its size in bytes unless it follows from other fields.
type Field = (String, Option<usize>);

/// The fields of a type in `ivg.ksy`, whose form is plain enough to be read line by line.
fn layout(name: &str) -> Vec<Field> {
    let text = read("ivg.ksy");
    let (_, after) = text.split_once(&format!("\n  {name}:\n")).unwrap_or_else(|| panic!("no type {name}"));
    let (_, after) = after.split_once("    seq:\n").expect("a sequence");
    let mut fields: Vec<BTreeMap<&str, &str>> = vec![];
    for line in after.lines().take_while(|line| line.starts_with("      ")) {
        let line = line.trim_start();
        let (line, begins) = line.strip_prefix("- ").map_or((line, false), |line| (line, true));
        if begins {
            fields.push(BTreeMap::new());
        }
        let (key, value) = line.split_once(": ").unwrap_or_else(|| panic!("{line:?} is no pair"));
        fields.last_mut().unwrap().insert(key, value);
    }
    fields.into_iter().map(|field| (field["id"].to_string(), size(&field))).collect()
}

fn size(field: &BTreeMap<&str, &str>) -> Option<usize> {
    if let Some(contents) = field.get("contents") {
        return Some(contents.matches("0x").count());
    }
    if let Some(size) = field.get("size") {
        return size.parse().ok();
    }
    let one = match field["type"] {
        "u1" => 1,
        "u2" | "s2" => 2,
        "u4" => 4,
        "u8" | "f8" => 8,
        other => panic!("unknown type {other}"),
    };
    let count = field.get("repeat-expr").map_or(1, |count| count.parse().unwrap());
    Some(one * count)
}

/// Compares names and offsets with the rows of the tables, one after the other.
fn check(name: &str, mut expected: Vec<toml::Table>) {
    let mut offset = Some(0);
    let mut fields = layout(name).into_iter();
    expected.retain(|row| row["name"].as_str() != Some("type"));
    for row in &expected {
        let (mut id, mut size) = fields.next().unwrap_or_else(|| panic!("{name}: {row:?} is missing"));
        if id == "type" {
            offset = offset.zip(size).map(|(at, size)| at + size);
            (id, size) = fields.next().unwrap();
        }
        let field = row["name"].as_str().unwrap();
        let id = id.strip_suffix("_specific").unwrap_or(&id);
        assert_eq!(
            (id, offset),
            (field, row.get("offset").map(|at| at.as_integer().unwrap() as usize)),
            "{name}"
        );
        offset = offset.zip(size).map(|(at, size)| at + size);
    }
}

#[test]
fn the_layout_file_has_the_fields_of_the_tables_at_their_offsets() {
    check("header", [rows("common", "header"), rows("ivg", "header")].concat());
    check("chunk", rows("common", "chunk"));
    check("record", rows("common", "record"));
}

#[test]
fn the_layout_file_has_the_registries() {
    let text = read("ivg.ksy");
    for (registry, key) in [("encodings", "encoding"), ("orders", "order"), ("units", "units")] {
        let (_, after) = text.split_once(&format!("\n  {key}:\n    ")).unwrap();
        let listed: Vec<&str> = after
            .lines()
            .take_while(|line| !line.starts_with("  ") || line.starts_with("    "))
            .map(str::trim)
            .collect();
        let expected: Vec<String> = rows("registry", registry)
            .iter()
            .filter(|row| row["status"].as_str() != Some("forbidden"))
            .map(|row| format!("{}: {}", row["id"], row["name"].as_str().unwrap().replace('-', "_")))
            .collect();
        assert_eq!(listed[..expected.len()], expected, "{registry}");
    }
    let bytes: Vec<String> =
        rows("registry", "encodings").iter().map(|row| row["bytes"].to_string()).collect();
    assert!(text.contains(&format!("'[{}][encoding.to_i]'", bytes.join(", "))), "bytes a vertex: {bytes:?}");
}

#[test]
fn the_media_types_name_the_signatures_of_the_files() {
    let text = read("media-types.md");
    let magics: Vec<&str> = text
        .lines()
        .filter_map(|line| line.trim().strip_prefix("- Magic number(s): ")?.strip_suffix(" at offset 0"))
        .collect();
    let signature = |letters: &str| {
        let bytes = [&[0x89], letters.as_bytes(), &[0x0D, 0x0A, 0x1A, 0x0A]].concat();
        bytes.iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(" ")
    };
    assert_eq!(magics, [signature("IVG"), signature("PMS")]);
    let lattice = ivg_format::Lattice::new([1, 1, 1], [0.0; 3], [0.0; 3]).unwrap();
    let vectors = [[[[0.0; 3]; 3]; 6]];
    let source = ivg_format::GridSource::new(lattice, &vectors);
    let file = ivg_format::encode(&source, &ivg_format::EncodeOptions::new()).unwrap();
    assert!(file.starts_with(b"\x89IVG\r\n\x1A\n"), "COM-HDR-01");
    for (name, extension) in [("irradiance-grid", "`.ivg`"), ("progressive-mesh", "`.pmesh`")] {
        let (_, after) = text.split_once(&format!("## application/vnd.ivg.{name}\n")).unwrap();
        let (template, _) = after.split_once("\n## ").unwrap_or((after, ""));
        assert!(template.contains(&format!("File extension(s): {extension}")), "{name}");
        assert!(read("stream.md").contains(&format!("`application/vnd.ivg.{name}`")), "STR-SRV-06");
    }
}
