//! The two formats as contents of a [`Download`](super::download::Download).

mod grid;
mod mesh;

pub(super) use grid::GridContents;
pub(super) use mesh::MeshContents;

use ivg_format::{Error, Verdict};
use pmesh_format::Replay;

use super::download::{Contents, Download, Refusal};
use super::options::SceneLimits;
use crate::extensions::FileEntry;

/// Whether fetching the bytes again could help: not if the file is for another reader or beyond a limit.
fn refusal(error: &Error) -> Refusal {
    match error.verdict() {
        Verdict::Ok | Verdict::NeedMore | Verdict::Invalid => Refusal::Damaged(error.to_string()),
        Verdict::Unsupported | Verdict::Limit => Refusal::Final(error.to_string()),
    }
}

/// A whole `.pmesh` in memory, verified.
pub(crate) fn read_mesh(bytes: &[u8], limits: &SceneLimits) -> Result<Replay, String> {
    let contents = read_whole(MeshContents::new(limits.mesh_counts), bytes)?;
    contents.into_replay().ok_or_else(|| "it has no header".to_owned())
}

/// Verifies a whole `.ivg` in memory.
pub(crate) fn check_grid(bytes: &[u8], limits: &SceneLimits) -> Result<(), String> {
    read_whole(GridContents::new(limits.grid_vertices), bytes).map(drop)
}

fn read_whole<C: Contents>(contents: C, bytes: &[u8]) -> Result<C, String> {
    let file = FileEntry::of(String::new(), bytes);
    let mut download = Download::new(file, contents);
    match download.receive(bytes, &mut |_| ()) {
        Err(Refusal::Damaged(reason) | Refusal::Final(reason)) => Err(reason),
        Ok(()) if !download.is_complete() => Err("it ends too early".to_owned()),
        Ok(()) => Ok(download.contents),
    }
}

#[cfg(test)]
mod tests;
