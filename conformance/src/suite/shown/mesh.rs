//! What is known of a mesh.

use super::{NOTHING, Out, Shown, pieces};
use crate::vectors::levels::level_bytes;
use ivg_wire::Error;
use pmesh_format::{BufferedDecoder, Event, Limits, MATERIALS, Replay, material_names};

/// What events have brought.
#[derive(Default)]
struct Mesh {
    replay: Replay,
    has_header: bool,
    names: Option<Vec<Vec<u8>>>,
    records: u32,
}

/// Reads a mesh that comes in pieces of these lengths, the last one again and again, and shows a level: that one, or the finest
/// that there is.
#[must_use]
pub fn mesh(data: &[u8], sizes: &[usize], level: Option<u32>) -> Shown {
    let mut mesh = Mesh::default();
    let mut decoder = BufferedDecoder::new(Limits::default());
    let read = pieces(data, sizes).try_for_each(|piece| decoder.feed(piece, |event| mesh.take(&event)));
    let error = read.and_then(|()| decoder.finish()).err();
    Shown { error, records: mesh.records, out: mesh.out(level) }
}

impl Mesh {
    fn take(&mut self, event: &Event<'_>) -> Result<(), Error> {
        self.replay.accept(event)?;
        match event {
            Event::Header(_) => self.has_header = true,
            Event::Chunk(chunk) if chunk.kind == MATERIALS => {
                self.names = Some(material_names(chunk)?.map(|name| name.as_bytes().to_vec()).collect());
            }
            Event::Packet(_) => self.records += 1,
            _ => {}
        }
        Ok(())
    }

    fn out(mut self, level: Option<u32>) -> Vec<u8> {
        if !self.has_header {
            return Vec::new();
        }
        let finest = self.replay.levels().map(|levels| *levels.end());
        let shown = finest.and_then(|finest| {
            let level = level.unwrap_or(finest);
            self.replay.set_level(level).ok().map(|_| level)
        });
        let header = self.replay.header();
        let mut out = Out::default();
        out.f64s(&header.origin);
        out.word(u32::from(header.attributes.bits()));
        out.words(&[header.vertex_count, header.wedge_count, header.face_count, header.base_vertices]);
        out.word(header.packet_count());
        for entry in &header.packets {
            out.words(&[entry.vertices.end, entry.wedges.end, entry.faces.end, entry.payload_bytes]);
            out.f32s([&entry.error]);
        }
        match &self.names {
            None => out.word(NOTHING),
            Some(names) => {
                out.word(names.len() as u32);
                names.iter().for_each(|name| out.text(name));
            }
        }
        match shown {
            Some(level) => {
                out.word(level);
                out.0.extend(level_bytes(&self.replay.mesh()));
            }
            // A file without vertices has one level, without anything.
            None if header.vertex_count == 0 => out.words(&[0; 4]),
            None => out.word(NOTHING),
        }
        out.0
    }
}
