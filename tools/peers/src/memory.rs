//! `peers-memory FILE.pmesh`: what the decoded file holds on the heap beside the mesh itself, by a counting allocator.

use std::path::Path;
use std::process::ExitCode;

use pmesh_format::{Limits, Replay, decode_all};
use serde_json::json;

fn main() -> ExitCode {
    let Some(path) = std::env::args_os().nth(1) else {
        eprintln!("usage: peers-memory FILE.pmesh");
        return ExitCode::from(2);
    };
    match measure(Path::new(&path)) {
        Ok(text) => {
            println!("{text}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("peers-memory: {}: {error}", path.display());
            ExitCode::FAILURE
        }
    }
}

/// As JSON: bytes of the mesh (12 a vertex, 12 a face), of the replay with all packets in, and the most while they came in.
fn measure(path: &Path) -> Result<String, Box<dyn std::error::Error>> {
    let bytes = std::fs::read(path)?;
    let mut replay = Replay::default();
    let mut fault = None;
    let mut whole = Ok(());
    let heap = allocation_counter::measure(|| {
        whole = decode_all(&bytes, &Limits::default(), |event| {
            fault = fault.take().or(replay.accept(&event).err());
        });
    });
    whole?;
    if let Some(fault) = fault {
        return Err(fault.into());
    }
    let mesh = 12 * u64::from(replay.max_level()) + 12 * u64::from(replay.face_count());
    let figures =
        json!({ "mesh_bytes": mesh, "replay_bytes": heap.bytes_current, "peak_bytes": heap.bytes_max });
    Ok(figures.to_string())
}
