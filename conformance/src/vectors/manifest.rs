//! The list of all vectors for readers in other languages.

use super::Vector;
use serde::Serialize;
use sha2::{Digest, Sha256};

/// The file `manifest.json`.
#[derive(Serialize)]
struct Manifest<'a> {
    /// The version of the specification that the vectors belong to.
    specification: &'static str,
    licence: &'static str,
    vectors: Vec<Entry<'a>>,
}

/// One vector.
#[derive(Serialize)]
struct Entry<'a> {
    id: String,
    file: String,
    bytes: usize,
    sha256: String,
    op: &'static str,
    verdict: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    code: Option<u16>,
    #[serde(skip_serializing_if = "Option::is_none")]
    twin: Option<String>,
    why: &'a str,
}

/// The text of `manifest.json`: one flat entry for each vector.
///
/// # Panics
///
/// Never: strings and numbers can always be written as JSON.
#[must_use]
pub fn manifest(vectors: &[Vector]) -> String {
    let manifest = Manifest {
        specification: "draft 0",
        licence: "CC0-1.0",
        vectors: vectors.iter().map(entry).collect(),
    };
    let mut text = serde_json::to_string_pretty(&manifest).expect("no map with keys that are not strings");
    text.push('\n');
    text
}

fn entry(vector: &Vector) -> Entry<'_> {
    let format = vector.format.name();
    let digest = Sha256::digest(&vector.bytes);
    Entry {
        id: format!("{format}/{}", vector.name),
        file: vector.file(),
        bytes: vector.bytes.len(),
        sha256: digest.iter().map(|byte| format!("{byte:02x}")).collect(),
        op: "decode",
        verdict: vector.verdict.name(),
        code: vector.code,
        twin: vector.twin.map(|twin| format!("{format}/{twin}")),
        why: vector.why,
    }
}
