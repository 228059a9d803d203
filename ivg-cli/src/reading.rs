//! What a client knows after the first bytes of a file: the decoders driven over a prefix.

use std::path::Path;

use ivg_format::Header as GridHeader;
use ivg_grid::IrradianceGrid;
use ivg_wire::{Error, Step};
use pmesh_format::Replay;

use crate::failure::Failure;

/// A grid with the vertices that whole records of `bytes` bring, and how many bytes those records end at.
pub(crate) fn grid(path: &Path, bytes: &[u8]) -> Result<(GridHeader, IrradianceGrid, u64), Failure> {
    let mut decoder = ivg_format::Decoder::new(ivg_format::Limits::default());
    let mut grid: Option<IrradianceGrid> = None;
    loop {
        let rest = &bytes[decoder.offset().0 as usize..];
        match decoder.push(rest).map_err(|error| Failure::file(path, error))? {
            Step::NeedMore(_) => break,
            Step::Consumed(_, ivg_format::Event::Header(header)) => {
                let new = IrradianceGrid::of(header.lattice, header.encoding.quantity());
                grid = Some(new.map_err(|error| Failure::file(path, error))?);
            }
            Step::Consumed(_, event) => {
                if let Some(grid) = &mut grid {
                    grid.accept(&event).map_err(|error| Failure::file(path, error))?;
                }
            }
        }
    }
    match (decoder.header(), grid) {
        (Some(header), Some(grid)) => Ok((header.clone(), grid, decoder.offset().0)),
        _ => Err(Failure::file(path, "the bytes end inside the header; a client knows nothing yet")),
    }
}

/// Vertices of a grid that have not arrived although light reaches them, as far as is known.
pub(crate) fn missing(grid: &IrradianceGrid) -> usize {
    (0..grid.vertex_count()).filter(|&vertex| grid.is_valid(vertex) && !grid.is_received(vertex)).count()
}

/// A mesh with the vertices that whole packets of `bytes` bring, and how many bytes those packets end at.
pub(crate) fn mesh(path: &Path, bytes: &[u8]) -> Result<(Replay, u64), Failure> {
    let refused = |error: Error| Failure::file(path, error);
    let mut decoder = pmesh_format::Decoder::new(pmesh_format::Limits::default());
    let mut replay: Option<Replay> = None;
    loop {
        let rest = &bytes[decoder.offset().0 as usize..];
        match decoder.push(rest).map_err(refused)? {
            Step::NeedMore(_) => break,
            Step::Consumed(_, pmesh_format::Event::Header(header)) => replay = Some(Replay::new(header)),
            Step::Consumed(_, event) => {
                if let Some(replay) = &mut replay {
                    replay.accept(&event).map_err(refused)?;
                }
            }
        }
    }
    match replay {
        Some(replay) => Ok((replay, decoder.offset().0)),
        None => Err(Failure::file(path, "the bytes end inside the header; a client knows nothing yet")),
    }
}

/// The header of a mesh.
pub(crate) fn mesh_header(path: &Path, bytes: &[u8]) -> Result<pmesh_format::Header, Failure> {
    let mut decoder = pmesh_format::Decoder::new(pmesh_format::Limits::default());
    match decoder.push(bytes).map_err(|error| Failure::file(path, error))? {
        Step::Consumed(_, pmesh_format::Event::Header(header)) => Ok(header.clone()),
        _ => Err(Failure::file(path, "the file ends inside its header")),
    }
}
