//! The list of all vectors for readers in other languages.

use super::levels::{LevelHash, level_hashes};
use super::{Format, Vector};
use ivg_format::{Event, Limits, VertexValues, decode_all};
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

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
    #[serde(skip_serializing_if = "Option::is_none")]
    values: Option<String>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    levels: Vec<LevelHash>,
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
    Entry {
        id: format!("{format}/{}", vector.name),
        file: vector.file(),
        bytes: vector.bytes.len(),
        sha256: hash(&vector.bytes),
        op: "decode",
        verdict: vector.verdict.name(),
        code: vector.code,
        twin: vector.twin.map(|twin| format!("{format}/{twin}")),
        values: values(vector),
        levels: match (vector.format, vector.code) {
            (Format::Pmesh, None) => level_hashes(&vector.bytes),
            _ => Vec::new(),
        },
        why: vector.why,
    }
}

fn hash(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The SHA-256 of all light of an accepted `.ivg` file: for each received vertex, by ascending linear index, the index as
/// u64 and its numbers as f32, 54 of vectors (hemisphere, channel, coordinate) or 27 of harmonics (channel, coefficient).
fn values(vector: &Vector) -> Option<String> {
    if vector.format != Format::Ivg || vector.code.is_some() {
        return None;
    }
    let mut received = BTreeMap::new();
    decode_all(&vector.bytes, &Limits::default(), |event| {
        if let Event::Corners(bundle) | Event::Bundle(bundle) = event {
            received.extend(bundle.iter());
        }
    })
    .ok()?;
    let mut bytes = Vec::new();
    for (vertex, values) in received {
        bytes.extend(vertex.to_le_bytes());
        let numbers: Vec<f32> = match values {
            VertexValues::Vectors(vectors) => vectors.into_iter().flatten().flatten().collect(),
            VertexValues::Radiance(radiance) => radiance.into_iter().flatten().collect(),
        };
        bytes.extend(numbers.into_iter().flat_map(f32::to_le_bytes));
    }
    Some(hash(&bytes))
}
