//! The orders of `spec/tables/orders.toml`, against what the encoder writes and what the header says.

use super::rows;
use ivg_format::{
    EncodeOptions, Event, GridSource, Header, Lattice, Limits, Order, Step, decode_all, encode,
};
use std::fmt::Write;
use toml::{Table, Value};

fn numbers(value: &Value) -> Vec<u64> {
    value.as_array().unwrap().iter().map(|n| n.as_integer().unwrap() as u64).collect()
}

fn dims(row: &Table) -> [u16; 3] {
    let numbers = numbers(&row["dims"]);
    [0, 1, 2].map(|axis: usize| numbers[axis] as u16)
}

fn words(numbers: &[u64]) -> String {
    numbers.iter().map(u64::to_string).collect::<Vec<_>>().join(" ")
}

/// The table of one order as it stands in the document.
pub(super) fn markdown(order: &str) -> String {
    let mut out = "| lattice | S | seed | corners | bundles | |\n|---|---|---|---|---|---|\n".to_string();
    for row in rows("orders", "order").iter().filter(|row| row["order"].as_str() == Some(order)) {
        let bundles: Vec<String> =
            row["bundles"].as_array().unwrap().iter().map(|bundle| words(&numbers(bundle))).collect();
        let bundles = if bundles.is_empty() { "–".to_string() } else { bundles.join("; ") };
        let lattice = dims(row).map(|n| n.to_string()).join(" × ");
        let (corners, text) = (words(&numbers(&row["corners"])), row["text"].as_str().unwrap());
        let seed = match row["seed"].as_integer().unwrap() {
            small @ 0..=9 => small.to_string(),
            large => format!("{large:#018X}").replace("0X", "0x"),
        };
        writeln!(out, "| {lattice} | {} | {seed} | {corners} | {bundles} | {text} |", row["per_slice"])
            .unwrap();
    }
    out
}

#[test]
fn orders_of_awkward_lattices_are_those_of_the_table() {
    let table = rows("orders", "order");
    for row in &table {
        let order =
            (1..16).filter_map(Order::from_id).find(|order| Some(order.name()) == row["order"].as_str());
        let order = order.unwrap_or_else(|| panic!("{} is not in this crate", row["order"]));
        let lattice = Lattice::new(dims(row), [0.0; 3], [1.0; 3]).unwrap();
        let vectors = vec![[[[0.0; 3]; 3]; 6]; lattice.vertex_count() as usize];
        let options = EncodeOptions {
            order,
            vertices_per_slice: row["per_slice"].as_integer().unwrap() as u32,
            seed: row["seed"].as_integer().unwrap() as u64,
            ..EncodeOptions::new()
        };
        let file = encode(&GridSource::new(lattice, &vectors), &options).unwrap();
        let (mut corners, mut bundles) = (vec![], vec![]);
        decode_all(&file, &Limits::default(), |event| match event {
            Event::Corners(bundle) => corners = bundle.vertices().collect::<Vec<u64>>(),
            Event::Bundle(bundle) => bundles.push(bundle.vertices().collect::<Vec<u64>>()),
            _ => {}
        })
        .unwrap();
        let expected: Vec<Vec<u64>> = row["bundles"].as_array().unwrap().iter().map(numbers).collect();
        assert_eq!((&corners, &bundles), (&numbers(&row["corners"]), &expected), "{row:?}");
        let Ok(Step::Consumed(_, header)) = Header::read(&file, &Limits::default()) else {
            panic!("a header")
        };
        assert_eq!(header.bundle_count as usize, expected.len(), "{row:?}");
        if let Some(longest) = row.get("longest").and_then(Value::as_str) {
            assert_eq!(["x", "y", "z"][lattice.longest_axis()], longest, "{row:?}");
        }
    }
    let has = |name: &str| table.iter().filter(|row| row["order"].as_str() == Some(name)).count();
    assert!(has("slices") >= 10 && has("octree") >= 10, "the table was not read");
}
