//! An `.ivg` file on its way into a dense grid.

use std::ops::Range;

use ivg_format::{Decoder, Event, Header, Limits, Order, RecordId, Step, decode_record};
use ivg_grid::{FillOptions, FilledGrid, IrradianceGrid};

use super::refusal;
use crate::client::download::{Contents, Prefix, Refusal};

/// Header and vertices received of a grid.
#[derive(Debug)]
pub(in crate::client) struct GridContents {
    max_vertices: u64,
    state: Option<State>,
}

/// What is known once the prefix is in.
#[derive(Debug)]
struct State {
    header: Header,
    /// Vertices that the file brings: all of the lattice, but for those inside geometry that no bundle lists.
    brought: u64,
    /// What has been received, once the first record is in.
    grid: Option<FilledGrid>,
}

impl GridContents {
    pub(in crate::client) fn new(max_vertices: u64) -> Self {
        Self { max_vertices, state: None }
    }

    /// What is in, filled; `None` before the first record.
    pub(in crate::client) fn grid(&mut self) -> Option<&IrradianceGrid> {
        self.state.as_mut()?.grid.as_mut().map(FilledGrid::grid)
    }

    /// The header, `None` before the prefix.
    pub(in crate::client) fn header(&self) -> Option<&Header> {
        self.state.as_ref().map(|state| &state.header)
    }

    /// The record at place `index` in file order: corners, validity records, bundles, end.
    fn record(&self, index: u32) -> Option<RecordId> {
        let header = self.header()?;
        let after_corners = match index.checked_sub(1) {
            None => return Some(RecordId::Corners),
            Some(block) if block < header.validity_records => return Some(RecordId::Validity(block)),
            Some(block) => block - header.validity_records,
        };
        match after_corners {
            k if k < header.bundle_count => Some(RecordId::Bundle(k + 1)),
            k if k == header.bundle_count => Some(RecordId::End),
            _ => None,
        }
    }
}

impl Contents for GridContents {
    fn read_prefix(&mut self, bytes: &[u8]) -> Result<Prefix, Refusal> {
        let limits = Limits { vertices: self.max_vertices, ..Limits::default() };
        let mut decoder = Decoder::new(limits);
        loop {
            let offset = decoder.offset().0;
            if let Some(header) = decoder.header().filter(|header| header.data_offset == offset) {
                self.state = Some(State { header: header.clone(), brought: brought(header), grid: None });
                return Ok(Prefix::Whole(offset));
            }
            let rest = usize::try_from(offset).ok().and_then(|at| bytes.get(at..)).unwrap_or_default();
            match decoder.push(rest) {
                Ok(Step::Consumed(..)) => {}
                Ok(Step::NeedMore(more)) => {
                    let least = bytes.len() as u64 + more.max(1) as u64;
                    let known = decoder.header().map_or(0, |header| header.data_offset);
                    return Ok(Prefix::NeedUpTo(least.max(known)));
                }
                Err(error) => return Err(refusal(&error)),
            }
        }
    }

    fn content_id(&self) -> Option<u64> {
        self.header().map(|header| header.content_id.0)
    }

    fn file_bytes(&self) -> Option<u64> {
        self.header().map(|header| header.file_bytes)
    }

    fn part(&self, index: u32) -> Option<Range<u64>> {
        self.record(index).and_then(|id| self.header().map(|header| header.record_range(id)))
    }

    fn part_vertices(&self, index: u32) -> u64 {
        match (self.record(index), self.header()) {
            (Some(id @ (RecordId::Corners | RecordId::Bundle(_))), Some(header)) => {
                header.record_vertices(id)
            }
            _ => 0,
        }
    }

    fn vertices(&self) -> Option<u64> {
        self.state.as_ref().map(|state| state.brought)
    }

    fn accept(&mut self, index: u32, bytes: &[u8]) -> Result<(), Refusal> {
        let (Some(id), Some(State { header, grid, .. })) = (self.record(index), &mut self.state) else {
            return Err(Refusal::Damaged("a record that the file does not have".to_owned()));
        };
        let event = decode_record(header, id, bytes).map_err(|error| refusal(&error))?;
        if matches!(event, Event::End) {
            return Ok(());
        }
        let grid = match grid {
            Some(grid) => grid,
            None => {
                let new =
                    IrradianceGrid::with_limit(header.lattice, header.encoding.quantity(), self.max_vertices);
                let new = new.map_err(|error| Refusal::Final(error.to_string()))?;
                grid.insert(FilledGrid::new(new, FillOptions::default()))
            }
        };
        grid.accept(&event).map_err(|error| Refusal::Final(error.to_string()))
    }

    fn fresh(&self) -> Self {
        Self::new(self.max_vertices)
    }
}

/// Vertices in the records of a file.
fn brought(header: &Header) -> u64 {
    match header.order {
        Order::Explicit => header
            .records()
            .filter(|id| matches!(id, RecordId::Corners | RecordId::Bundle(_)))
            .map(|id| header.record_vertices(id))
            .sum(),
        _ => header.lattice.vertex_count(),
    }
}
