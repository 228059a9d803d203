//! What a .pmesh file costs: bytes of its beginning, decoding time, the level with so many faces.

use std::path::Path;

use pmesh_format::{Header, Limits, Replay};
use serde_json::{Value, json};

use crate::Failure;
use crate::timing::median;

/// The mesh of a file, with everything received.
pub(crate) fn load(path: &Path, bytes: &[u8]) -> Result<Replay, Failure> {
    Replay::from_file(bytes, &Limits::default())
        .map_err(|error| format!("{}: {error}", path.display()).into())
}

/// Bytes up to the end of the packet with which `level` vertices are there, and how many that packet brings in all.
fn prefix(header: &Header, level: u32) -> Option<(u64, u32)> {
    let packet = header.packets.iter().find(|packet| packet.vertices.end >= level)?;
    Some((packet.bytes.end, packet.vertices.end))
}

/// Figures of a file: sizes, its first hundredth, processor time to have the finest level.
pub(crate) fn measure(path: &Path, bytes: &[u8], runs: usize) -> Result<Value, Failure> {
    let replay = load(path, bytes)?;
    let header = replay.header();
    let hundredth = header.vertex_count.div_ceil(100).max(header.base_vertices);
    let (first_bytes, first_vertices) = prefix(header, hundredth).ok_or("no packet")?;
    let seconds = median(runs, || load(path, bytes).map(|replay| replay.face_count()));
    Ok(json!({
        "bytes": bytes.len(), "vertices": header.vertex_count, "faces": header.face_count,
        "base_vertices": header.base_vertices, "packets": header.packets.len(),
        "hundredth": hundredth, "first_bytes": first_bytes, "first_vertices": first_vertices,
        "decode_seconds": seconds,
    }))
}

/// The finest level with at most so many faces, or else the coarsest.
pub(crate) fn level_of_faces(replay: &mut Replay, faces: u32) -> Result<Value, Failure> {
    let levels = replay.levels().ok_or("the file has no level")?;
    let (mut low, mut high) = (*levels.start(), *levels.end());
    while low < high {
        let middle = low + (high - low).div_ceil(2);
        replay.set_level(middle)?;
        if replay.face_count() <= faces {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    replay.set_level(low)?;
    Ok(json!({ "level": low, "faces": replay.face_count() }))
}
