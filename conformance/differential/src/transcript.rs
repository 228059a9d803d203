//! What our decoders see of a file, as bytes that `readers.c` makes of the readers in C too: numbers are little-endian, one after the
//! other.

use conformance::vectors::levels::level_bytes;
use ivg_format::{Bundle, LIGHTS, METADATA, ValidityBlock, VertexValues, lights};
use ivg_wire::Error;
use pmesh_format::{MATERIALS, Replay, material_names};
use std::fmt;

/// How the reading of a file ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct End {
    /// As an exit status (COM-VERD-02).
    pub(crate) verdict: i32,
    /// The number of the error code; 0 for none.
    pub(crate) code: i32,
    /// The byte at fault.
    pub(crate) offset: u64,
}

impl End {
    fn of(error: Option<Error>) -> Self {
        error.map_or(Self { verdict: 0, code: 0, offset: 0 }, |error| Self {
            verdict: i32::from(error.verdict().exit_code()),
            code: i32::from(error.code()),
            offset: error.offset().0,
        })
    }
}

impl fmt::Display for End {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "verdict {}, code {}, offset {}", self.verdict, self.code, self.offset)
    }
}

/// What a reader saw of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Transcript {
    /// Header, chunks, records or levels.
    pub(crate) bytes: Vec<u8>,
    /// How it ended.
    pub(crate) end: End,
}

/// Numbers one after the other.
#[derive(Default)]
struct Out(Vec<u8>);

impl Out {
    fn bytes(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    fn word(&mut self, word: u32) {
        self.bytes(&word.to_le_bytes());
    }

    fn words(&mut self, words: &[u32]) {
        words.iter().for_each(|&word| self.word(word));
    }

    fn longs(&mut self, longs: &[u64]) {
        longs.iter().for_each(|long| self.bytes(&long.to_le_bytes()));
    }

    fn f32s(&mut self, numbers: &[f32]) {
        numbers.iter().for_each(|number| self.bytes(&number.to_le_bytes()));
    }

    fn f64s(&mut self, numbers: &[f64]) {
        numbers.iter().for_each(|number| self.bytes(&number.to_le_bytes()));
    }
}

/// What our decoder sees of a grid.
pub(crate) fn grid(data: &[u8]) -> Transcript {
    let mut out = Out::default();
    let mut decoder = ivg_format::BufferedDecoder::new(ivg_format::Limits::default());
    let read = decoder.feed(data, |event| out.grid_event(&event));
    let end = End::of(read.and_then(|()| decoder.finish()).err());
    Transcript { bytes: out.0, end }
}

/// What our decoder sees of a mesh, with so many levels between the coarsest and the finest.
pub(crate) fn mesh(data: &[u8], between: u32) -> Transcript {
    let mut out = Out::default();
    let mut replay = Replay::default();
    let mut has_header = false;
    let mut decoder = pmesh_format::BufferedDecoder::new(pmesh_format::Limits::default());
    let read = decoder.feed(data, |event| {
        replay.accept(&event)?;
        has_header |= matches!(event, pmesh_format::Event::Header(_));
        out.mesh_event(&event)
    });
    let end = End::of(read.and_then(|()| decoder.finish()).err());
    if has_header {
        out.levels(&mut replay, between);
    }
    Transcript { bytes: out.0, end }
}

impl Out {
    fn grid_event(&mut self, event: &ivg_format::Event<'_>) {
        match event {
            ivg_format::Event::Header(header) => self.grid_header(header),
            ivg_format::Event::Chunk(chunk) if chunk.kind == LIGHTS => {
                self.bytes(b"L");
                // The decoder has read the list before.
                for light in lights(chunk).into_iter().flatten() {
                    self.words(&[u32::from(light.direct_included), light.name.len() as u32]);
                    self.bytes(light.name.as_bytes());
                }
            }
            ivg_format::Event::Chunk(chunk) if chunk.kind == METADATA => {
                self.bytes(b"M");
                self.longs(&[chunk.payload.len() as u64]);
                self.bytes(chunk.payload);
            }
            ivg_format::Event::Corners(bundle) | ivg_format::Event::Bundle(bundle) => self.bundle(bundle),
            ivg_format::Event::Validity(block) => self.validity(block),
            // The reader in C has no event for other chunks and for the end.
            _ => {}
        }
    }

    fn grid_header(&mut self, header: &ivg_format::Header) {
        self.bytes(b"H");
        self.words(&[u32::from(header.minor), header.optional_features, header.header_bytes]);
        self.longs(&[header.content_id.0, header.data_offset, header.file_bytes]);
        self.words(&header.lattice.dims.map(u32::from));
        self.f64s(&header.lattice.origin);
        self.f64s(&header.lattice.step);
        self.words(&[u32::from(header.encoding.id()), u32::from(header.order.id())]);
        self.words(&[i32::from(header.scale_exponent).cast_unsigned(), header.vertices_per_slice]);
        self.longs(&[header.seed]);
        self.words(&[header.bundle_count, header.validity_records, u32::from(header.units.id())]);
    }

    /// What stands before the values of a record.
    fn record(
        &mut self,
        header: &ivg_format::Header,
        id: ivg_format::RecordId,
        generation: u32,
        vertices: usize,
    ) {
        let range = header.record_range(id);
        self.bytes(b"R");
        self.words(&[id.stored(), generation]);
        self.longs(&[range.start, range.end - range.start]);
        self.word(vertices as u32);
    }

    fn bundle(&mut self, bundle: &Bundle<'_>) {
        self.record(bundle.header(), bundle.id(), bundle.generation(), bundle.len());
        for (vertex, values) in bundle.iter() {
            self.longs(&[vertex]);
            match values {
                VertexValues::Vectors(vectors) => self.f32s(vectors.as_flattened().as_flattened()),
                VertexValues::Radiance(radiance) => self.f32s(radiance.as_flattened()),
            }
        }
    }

    fn validity(&mut self, block: &ValidityBlock<'_>) {
        self.record(block.header(), block.id(), block.generation(), block.len());
        self.longs(&[block.first_vertex()]);
        for (n, &validity) in block.validity().iter().enumerate() {
            self.bytes(&[validity, block.blocked_edges(n)]);
        }
    }

    fn mesh_event(&mut self, event: &pmesh_format::Event<'_>) -> Result<(), Error> {
        match event {
            pmesh_format::Event::Header(header) => self.mesh_header(header),
            pmesh_format::Event::Chunk(chunk) if chunk.kind == MATERIALS => {
                self.bytes(b"M");
                for name in material_names(chunk)? {
                    self.word(name.len() as u32);
                    self.bytes(name.as_bytes());
                }
            }
            pmesh_format::Event::Packet(packet) => {
                let (entry, range) = (packet.entry(), packet.header().packet_range(packet.index()));
                self.bytes(b"P");
                self.words(&[packet.index(), entry.vertices.end, entry.wedges.end, entry.faces.end]);
                self.word(entry.payload_bytes);
                self.f32s(&[entry.error]);
                self.longs(&[range.start, range.end - range.start]);
            }
            _ => {}
        }
        Ok(())
    }

    fn mesh_header(&mut self, header: &pmesh_format::Header) {
        self.bytes(b"H");
        self.words(&[u32::from(header.minor), header.optional_features, header.header_bytes]);
        self.longs(&[header.content_id.0, header.data_offset, header.file_bytes]);
        self.words(&[header.vertex_count, header.wedge_count, header.face_count, header.base_vertices]);
        self.words(&[header.packet_count(), u32::from(header.attributes.bits())]);
        self.f64s(&header.origin);
        self.f32s(header.bounds.as_flattened());
        self.words(&[u32::from(header.normal_bits), u32::from(header.uv_bits)]);
        self.f32s(header.uv_bounds.as_flattened());
    }

    /// The coarsest level, the finest that is complete, and `between` levels between them, the finest first. A mesh without vertices
    /// has the level 0 as soon as its header is known.
    fn levels(&mut self, replay: &mut Replay, between: u32) {
        let coarsest = replay.header().base_vertices;
        let finest = match replay.levels() {
            Some(levels) => *levels.end(),
            None if replay.header().vertex_count == 0 => 0,
            None => return,
        };
        for i in 0..=u64::from(between) + 1 {
            let level = u64::from(finest) - u64::from(finest - coarsest) * i / (u64::from(between) + 1);
            self.bytes(b"V");
            self.word(level as u32);
            if finest > 0 {
                let _change = replay.set_level(level as u32).expect("a level that is complete");
            }
            self.bytes(&level_bytes(&replay.mesh()));
        }
    }
}
