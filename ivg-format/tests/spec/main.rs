//! The specification's tables, Markdown, clauses and worked examples against each other and against this crate.
//!
//! `IVG_BLESS=1 cargo test -p ivg-format --test spec` writes the tables into the Markdown anew.

mod aids;
mod clauses;
mod examples;
mod orders;
mod tables;
mod values;

use toml::Table;

/// A path relative to the repository.
fn repository(name: &str) -> String {
    format!("{}/../{name}", env!("CARGO_MANIFEST_DIR"))
}

fn path(name: &str) -> String {
    repository(&format!("spec/{name}"))
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
