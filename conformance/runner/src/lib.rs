//! Runs the conformance suite on any decoder, through the adapter program of `conformance/PROTOCOL.md`. It knows nothing of
//! the formats but how an OUT is laid out; `conformance/run.py` is the same program for machines without Rust, and gives the
//! same results.
//!
//! - [`manifest`]: what `vectors/manifest.json` holds, one entry a test.
//! - [`capabilities`]: what an adapter says that it can do; which tests that leaves, and with which verdicts.
//! - [`mod@run`]: runs tests, [`report`] says how they went, as text, JSON and JUnit.
//! - [`layout`] finds the first number in which an OUT differs, and [`mod@explain`] tells everything about one test.

#![forbid(unsafe_code)]

pub mod capabilities;
pub mod explain;
pub mod layout;
pub mod manifest;
pub mod process;
pub mod report;
pub mod run;
pub mod words;

/// Lowercase hexadecimal.
#[must_use]
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// SHA-256, lowercase hexadecimal.
#[must_use]
pub fn sha256(bytes: &[u8]) -> String {
    hex(&<sha2::Sha256 as sha2::Digest>::digest(bytes))
}
