//! Writing: a mesh with its collapse order becomes a file. Deterministic: the same mesh and options give the same bytes.

use alloc::vec::Vec;

use ivg_wire::{
    ContentId, END_PAYLOAD, Maximum, chunk_len, record_len, write_chunk, write_end, write_record,
};

use crate::attributes::Attributes;
use crate::coded::{Plan, arranged};
use crate::header::{Header, PARAMETER_BITS, PacketEntry};
use crate::material::write_names;
use crate::mesh::Wedges;
use crate::progressive::ProgressiveMesh;
use crate::storage::{Mode, Positions};
use crate::wire::{DIRECTORY, HEADER_BYTES, MATERIALS};

mod codes;
mod error;
mod raw;
mod writer;

pub use error::EncodeError;
use raw::RawWriter;
use writer::{Quantised, Writer, uv_bounds};

/// How many vertices each packet brings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketSize {
    /// The same number in every packet.
    Fixed(u32),
    /// A share of the vertices that came before, so that every packet refines the picture by as much as the one before. If the
    /// first hundredth of the vertices is at least four times the first packet, a packet ends with it, and up to there each
    /// brings as many as all before: small packets cost more bytes than what they show is worth.
    Growing {
        /// Vertices of the first packet, at least.
        first: u32,
        /// Growth by each packet from the first hundredth on \[%\].
        percent: u32,
        /// The most vertices of one packet.
        most: u32,
    },
}

/// How to write a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncodeOptions {
    /// How many vertices each packet brings. The first one always brings the whole base, each at least one.
    pub packets: PacketSize,
    /// How packets are stored.
    pub mode: Mode,
    /// How positions are stored.
    pub positions: Positions,
    /// Bits of each of the two components of a coded normal, 4 to 16; without effect where normals are not coded.
    pub normal_bits: u8,
    /// Bits of each component of coded texture coordinates, 4 to 16; without effect where they are not coded.
    pub uv_bits: u8,
}

impl EncodeOptions {
    /// The defaults: raw packets of at least 256 vertices, then 30 % more with each packet, but at most 262,144 at once;
    /// positions as given; 10 bits for coded normals, 12 for coded texture coordinates.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            packets: PacketSize::Growing { first: 256, percent: 30, most: 1 << 18 },
            mode: Mode::Raw,
            positions: Positions::F32,
            normal_bits: 10,
            uv_bits: 12,
        }
    }

    /// Whether every option has a value that can be written.
    fn check(&self) -> Result<(), EncodeError> {
        let fail = |option| Err(EncodeError::Option { option });
        if !self.positions.exists() {
            return fail("positions");
        }
        if !PARAMETER_BITS.contains(&self.normal_bits) {
            return fail("normal_bits");
        }
        if !PARAMETER_BITS.contains(&self.uv_bits) {
            return fail("uv_bits");
        }
        Ok(())
    }

    /// The mesh as a file with these options has it: the same levels after each packet, but in mode [`Mode::Coded`] with the
    /// vertices inside each packet sorted by parent, and faces turned and sorted (PMESH-COD-01).
    ///
    /// # Panics
    /// If the tables of the mesh are not valid; [`encode`] checks them first.
    #[must_use]
    pub fn arranged(&self, mesh: &ProgressiveMesh) -> ProgressiveMesh {
        if self.mode == Mode::Raw {
            return mesh.clone();
        }
        let vertices = mesh.positions.len() as u32;
        let mut ends: Vec<u32> = Vec::new();
        while ends.last().copied().unwrap_or(0) < vertices {
            ends.push(self.packets.end(ends.last().copied().unwrap_or(0), mesh.base_vertices, vertices));
        }
        arranged(mesh, &ends)
    }

    /// The wedges as a reader will have them: as given in mode [`Mode::Raw`]; otherwise with the nearest of the normals that
    /// can be coded (that of +z where one has no direction) and the nearest texture coordinates of the lattice in their box
    /// (PMESH-COD-16, -17). Doing it twice changes nothing more.
    #[must_use]
    pub fn quantised_wedges(&self, wedges: &Wedges) -> Wedges {
        let mut wedges = wedges.clone();
        let header = Header {
            attributes: Attributes { normals: true, uvs: true, ..Attributes::default() },
            normal_bits: self.normal_bits,
            uv_bits: self.uv_bits,
            uv_bounds: uv_bounds(&wedges.uvs),
            ..Header::default()
        };
        if let (Mode::Coded, Some(plan)) = (self.mode, Plan::new(&header)) {
            wedges.normals =
                plan.normals(&wedges.normals).into_iter().map(|code| plan.normal(code)).collect();
            wedges.uvs = plan.uvs(&wedges.uvs).into_iter().map(|point| plan.uv(point)).collect();
        }
        wedges
    }

    /// Packets of that many vertices each.
    #[must_use]
    pub const fn fixed(vertices: u32) -> Self {
        Self { packets: PacketSize::Fixed(vertices), ..Self::new() }
    }
}

impl Default for EncodeOptions {
    fn default() -> Self {
        Self::new()
    }
}

impl PacketSize {
    /// The vertex count after the packet that begins at vertex `start`.
    fn end(self, start: u32, base: u32, vertices: u32) -> u32 {
        let hundredth = vertices.div_ceil(100);
        let size = match self {
            Self::Fixed(size) => size,
            Self::Growing { first, most, .. } if start < hundredth && hundredth / 4 >= first => {
                let mut end = hundredth;
                while end > 1 && end.div_ceil(2) >= first && end.div_ceil(2) > start {
                    end = end.div_ceil(2);
                }
                (end - start).min(most)
            }
            Self::Growing { first, most, .. } if start == 0 => first.min(most),
            Self::Growing { percent, most, .. } => {
                let share = u64::from(start) * u64::from(percent) / 100;
                u32::try_from(share).unwrap_or(u32::MAX).min(most)
            }
        };
        start.saturating_add(size.max(1)).max(base).min(vertices)
    }
}

/// Writes a mesh with its collapse order as a file.
///
/// # Errors
///
/// [`EncodeError`] names what cannot be written and where.
pub fn encode(mesh: &ProgressiveMesh, options: &EncodeOptions) -> Result<Vec<u8>, EncodeError> {
    error::check(mesh)?;
    options.check()?;
    let arranged = (options.mode == Mode::Coded).then(|| options.arranged(mesh));
    let mesh = arranged.as_ref().unwrap_or(mesh);
    let writer = Writer::new(mesh, options);
    let names = write_names(&mesh.material_names).ok_or(EncodeError::MaterialName)?;
    let (packets, payloads) = match options.mode {
        Mode::Raw => {
            let mut raw = RawWriter::new(&writer);
            packets(&writer, options.packets, |entry| raw.packet(entry))?
        }
        Mode::Coded => {
            let quantised = Quantised::new(&writer);
            let mut saver = writer.saver(&quantised);
            packets(&writer, options.packets, |entry| saver.packet(entry))?
        }
    };

    let mut header = writer.header(packets);
    let (bytes, directory) = header.to_bytes();
    // The header without what depends on the content id and on itself; then all that is encoded.
    let mut parts = alloc::vec![&bytes[56..], &directory[..], &names[..]];
    parts.extend(payloads.iter().map(|payload| &payload[..]));
    header.content_id = ContentId::of(&parts);

    let chunk = |payload: usize| chunk_len(payload as u64).unwrap_or(u64::MAX);
    let chunks = [&directory, &names].map(|payload| chunk(payload.len()));
    if chunks.iter().any(|&len| len > u64::from(Maximum::CHUNK_BYTES)) {
        return Err(EncodeError::ChunkSize);
    }
    let with_names = !names.is_empty();
    header.data_offset = HEADER_BYTES as u64 + chunks[0] + if with_names { chunks[1] } else { 0 };
    // Lengths of things that are in memory, or a few times 2³¹: their sum fits.
    let records = payloads.iter().filter_map(|payload| record_len(payload.len() as u64)).sum::<u64>();
    header.file_bytes = header.data_offset + records + record_len(END_PAYLOAD).unwrap_or(0);

    let mut out = Vec::with_capacity(usize::try_from(header.file_bytes).unwrap_or(0));
    out.extend_from_slice(&header.to_bytes().0);
    write_chunk(&mut out, DIRECTORY, true, &directory, header.content_id);
    if with_names {
        write_chunk(&mut out, MATERIALS, false, &names, header.content_id);
    }
    for (k, payload) in (0u32..).zip(&payloads) {
        write_record(&mut out, k, 0, payload, header.content_id);
    }
    write_end(&mut out, header.file_bytes, header.content_id);
    debug_assert_eq!(out.len() as u64, header.file_bytes);
    Ok(out)
}

/// The packets, with their payloads; `write` gives that of the next one, and may move its end forward.
fn packets(
    writer: &Writer<'_>,
    size: PacketSize,
    mut write: impl FnMut(&mut PacketEntry) -> Vec<u8>,
) -> Result<(Vec<PacketEntry>, Vec<Vec<u8>>), EncodeError> {
    let (mut packets, mut payloads) = (Vec::<PacketEntry>::new(), Vec::new());
    while packets.last().map_or(0, |p| p.vertices.end) < writer.vertex_count() {
        let start = packets.last().map_or(0, |p| p.vertices.end);
        let mut entry = writer.entry(packets.last(), size.end(start, writer.base(), writer.vertex_count()));
        let payload = write(&mut entry);
        let record = record_len(payload.len() as u64).filter(|&len| len <= u64::from(Maximum::RECORD_BYTES));
        record.ok_or(EncodeError::PacketSize { packet: packets.len() })?;
        packets.push(PacketEntry { payload_bytes: payload.len() as u32, ..entry });
        payloads.push(payload);
    }
    Ok((packets, payloads))
}

#[cfg(test)]
mod tests;
