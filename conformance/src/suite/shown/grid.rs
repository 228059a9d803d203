//! What is known of a grid.

use super::{NOTHING, Out, Shown, pieces};
use ivg_format::{
    BufferedDecoder, Bundle, Event, Header, LIGHTS, Limits, METADATA, Quantity, ValidityBlock, VertexValues,
    lights,
};
use std::collections::BTreeMap;

/// What events have brought.
#[derive(Default)]
struct Grid {
    header: Option<Header>,
    lights: Option<Vec<(bool, Vec<u8>)>>,
    metadata: Option<Vec<u8>>,
    /// By linear index.
    values: BTreeMap<u64, Vec<f32>>,
    /// Validity and blocked edges, by linear index.
    validity: BTreeMap<u64, (u8, u8)>,
    records: u32,
}

/// Reads a grid that comes in pieces of these lengths, the last one again and again.
#[must_use]
pub fn grid(data: &[u8], sizes: &[usize]) -> Shown {
    let mut grid = Grid::default();
    let mut decoder = BufferedDecoder::new(Limits::default());
    let read = pieces(data, sizes).try_for_each(|piece| decoder.feed(piece, |event| grid.take(&event)));
    let error = read.and_then(|()| decoder.finish()).err();
    Shown { error, records: grid.records, out: grid.out() }
}

impl Grid {
    fn take(&mut self, event: &Event<'_>) {
        match event {
            Event::Header(header) => self.header = Some((*header).clone()),
            Event::Chunk(chunk) if chunk.kind == LIGHTS => {
                let list = lights(chunk).map(|list| {
                    list.map(|light| (light.direct_included, light.name.as_bytes().to_vec())).collect()
                });
                // The decoder has read it before.
                self.lights = list.ok();
            }
            Event::Chunk(chunk) if chunk.kind == METADATA => self.metadata = Some(chunk.payload.to_vec()),
            Event::Corners(bundle) | Event::Bundle(bundle) => self.bundle(bundle),
            Event::Validity(block) => self.block(block),
            _ => {}
        }
    }

    fn bundle(&mut self, bundle: &Bundle<'_>) {
        self.records += 1;
        for (vertex, values) in bundle.iter() {
            let numbers = match values {
                VertexValues::Vectors(vectors) => vectors.as_flattened().as_flattened().to_vec(),
                VertexValues::Radiance(radiance) => radiance.as_flattened().to_vec(),
            };
            self.values.insert(vertex, numbers);
        }
    }

    fn block(&mut self, block: &ValidityBlock<'_>) {
        self.records += 1;
        for (n, &validity) in block.validity().iter().enumerate() {
            self.validity.insert(block.first_vertex() + n as u64, (validity, block.blocked_edges(n)));
        }
    }

    fn out(&self) -> Vec<u8> {
        let Some(header) = &self.header else { return Vec::new() };
        let lattice = &header.lattice;
        let mut out = Out::default();
        out.words(&lattice.dims.map(u32::from));
        out.f64s(&lattice.origin);
        out.f64s(&lattice.step);
        out.word(u32::from(header.units.id()));
        out.word(u32::from(header.encoding.quantity() == Quantity::Radiance));
        match &self.lights {
            None => out.word(NOTHING),
            Some(lights) => {
                out.word(lights.len() as u32);
                for (direct, name) in lights {
                    out.word(u32::from(*direct));
                    out.text(name);
                }
            }
        }
        match &self.metadata {
            None => out.word(NOTHING),
            Some(metadata) => out.text(metadata),
        }
        let vertices = 0..lattice.vertex_count();
        let known = |vertex| self.validity.get(&vertex).copied().unwrap_or((255, 0));
        out.0.extend(vertices.clone().map(|vertex| u8::from(self.values.contains_key(&vertex))));
        out.0.extend(vertices.clone().map(|vertex| known(vertex).0));
        out.0.extend(vertices.map(|vertex| known(vertex).1));
        out.f32s(self.values.values().flatten());
        out.0
    }
}
