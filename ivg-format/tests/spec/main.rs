//! The specification's tables, Markdown, clauses and worked examples against each other and against this crate.
//!
//! `IVG_BLESS=1 cargo test -p ivg-format --test spec` writes the tables into the Markdown anew.

mod aids;
mod clauses;
mod examples;
mod hard_cases;
mod orders;
mod tables;
mod values;

#[allow(dead_code, reason = "shared with the tests of the other crates, which use other parts")]
#[path = "../../../ivg-wire/tests/document/mod.rs"]
mod document;

use document::{of_format, path, read, repository, rows};
