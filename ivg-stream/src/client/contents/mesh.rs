//! A `.pmesh` file on its way into a mesh that can be shown at every level received.

use std::ops::Range;

use pmesh_format::{Decoder, Header, Limits, Replay, Step};

use super::refusal;
use crate::client::download::{Contents, Prefix, Refusal};

/// Header and packets received of a mesh.
#[derive(Debug)]
pub(in crate::client) struct MeshContents {
    max_counts: u32,
    /// The decoder after all that was accepted, and where it went; `None` before the prefix.
    state: Option<(Decoder, Replay)>,
}

impl MeshContents {
    pub(in crate::client) fn new(max_counts: u32) -> Self {
        Self { max_counts, state: None }
    }

    /// What is in, `None` before the first packet.
    pub(in crate::client) fn replay(&self) -> Option<&Replay> {
        self.state.as_ref().map(|(_, replay)| replay).filter(|replay| replay.packets() > 0)
    }

    /// As [`MeshContents::replay`], to choose a level.
    pub(in crate::client) fn replay_mut(&mut self) -> Option<&mut Replay> {
        self.state.as_mut().map(|(_, replay)| replay).filter(|replay| replay.packets() > 0)
    }

    /// The mesh of a file that is in, without packets if the file has none.
    pub(super) fn into_replay(self) -> Option<Replay> {
        self.state.map(|(_, replay)| replay)
    }

    fn header(&self) -> Option<&Header> {
        self.state.as_ref().and_then(|(decoder, _)| decoder.header())
    }
}

impl Contents for MeshContents {
    fn read_prefix(&mut self, bytes: &[u8]) -> Result<Prefix, Refusal> {
        let limits = Limits { counts: self.max_counts, ..Limits::default() };
        let mut decoder = Decoder::new(limits);
        let mut replay = Replay::default();
        loop {
            let offset = decoder.offset().0;
            if decoder.header().is_some_and(|header| header.data_offset == offset) {
                self.state = Some((decoder, replay));
                return Ok(Prefix::Whole(offset));
            }
            let rest = usize::try_from(offset).ok().and_then(|at| bytes.get(at..)).unwrap_or_default();
            match decoder.push(rest) {
                Ok(Step::Consumed(_, event)) => {
                    replay.accept(&event).map_err(|error| refusal(&error))?;
                }
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

    /// Packets, then the end record.
    fn part(&self, index: u32) -> Option<Range<u64>> {
        let header = self.header()?;
        match index {
            k if k < header.packet_count() => Some(header.packet_range(k)),
            k if k == header.packet_count() => Some(header.end_range()),
            _ => None,
        }
    }

    fn part_vertices(&self, index: u32) -> u64 {
        let entry = self.header().and_then(|header| header.packets.get(index as usize));
        entry.map_or(0, |entry| entry.vertices.len() as u64)
    }

    fn vertices(&self) -> Option<u64> {
        self.header().map(|header| u64::from(header.vertex_count))
    }

    fn accept(&mut self, _index: u32, bytes: &[u8]) -> Result<(), Refusal> {
        let Some((decoder, replay)) = &mut self.state else {
            return Err(Refusal::Damaged("a packet before the header".to_owned()));
        };
        // A decoder that has met an error stays at it; the one before can try the bytes fetched again.
        let mut next = decoder.clone();
        match next.push(bytes) {
            Ok(Step::Consumed(used, event)) if used == bytes.len() => {
                replay.accept(&event).map_err(|error| refusal(&error))?;
            }
            Ok(_) => return Err(Refusal::Damaged("a packet of another length than stated".to_owned())),
            Err(error) => return Err(refusal(&error)),
        }
        *decoder = next;
        Ok(())
    }

    fn fresh(&self) -> Self {
        Self::new(self.max_counts)
    }
}
