//! Writing: a mesh with its collapse order becomes a file. Deterministic: the same mesh and options give the same bytes.

use alloc::vec::Vec;

use ivg_wire::{
    ContentId, END_PAYLOAD, Maximum, chunk_len, record_len, write_chunk, write_end, write_record,
};

use crate::attributes::Attributes;
use crate::bits::Bits;
use crate::coded::{Given, Known, Plan, Saver, arranged, cells};
use crate::header::{Header, PARAMETER_BITS, PacketEntry};
use crate::lattice::{Lattice, bounds};
use crate::material::write_names;
use crate::mesh::Wedges;
use crate::packet::{code_bits, write_varint};
use crate::progressive::ProgressiveMesh;
use crate::slots::Slots;
use crate::storage::{Mode, Positions};
use crate::wire::{DIRECTORY, FORMAT, HEADER_BYTES, MATERIALS};

mod error;

pub use error::EncodeError;

/// How many vertices each packet brings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketSize {
    /// The same number in every packet.
    Fixed(u32),
    /// A share of the vertices that came before, so that every packet refines the picture by as much as the one before.
    Growing {
        /// Vertices of the first packet.
        first: u32,
        /// Growth by each packet \[%\].
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
    /// The defaults: raw packets of 256 vertices, then 30 % more with each packet, but at most 262,144 at once; positions as
    /// given; 10 bits for coded normals, 12 for coded texture coordinates.
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
        let size = match self {
            Self::Fixed(size) => size,
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
    let known = (options.mode == Mode::Coded).then(|| Quantised::new(&writer));
    let mut saver = known.as_ref().map(|known| writer.saver(known));
    let names = write_names(&mesh.material_names).ok_or(EncodeError::MaterialName)?;

    let mut packets: Vec<PacketEntry> = Vec::new();
    let mut payloads = Vec::new();
    let vertices = mesh.positions.len() as u32;
    while packets.last().map_or(0, |p| p.vertices.end) < vertices {
        let entry = writer.entry(packets.last(), options.packets);
        let payload = match &mut saver {
            Some(saver) => saver.packet(&entry),
            None => writer.payload(&entry),
        };
        let record = record_len(payload.len() as u64).filter(|&len| len <= u64::from(Maximum::RECORD_BYTES));
        record.ok_or(EncodeError::PacketSize { packet: packets.len() })?;
        packets.push(PacketEntry { payload_bytes: payload.len() as u32, ..entry });
        payloads.push(payload);
    }

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

/// What coded packets hold, in whole numbers.
struct Quantised {
    cells: Vec<[i32; 3]>,
    /// How attributes are stored, if there are any.
    plan: Option<Plan>,
    normals: Vec<[i32; 2]>,
    uvs: Vec<[i32; 2]>,
    /// With seams, the faces with vertices instead of wedges.
    faces: Option<Vec<(u32, [u32; 3], usize)>>,
}

impl Quantised {
    fn new(writer: &Writer<'_>) -> Self {
        let mesh = writer.mesh;
        let plan = Plan::new(&writer.header(Vec::new()));
        let vertex = |wedge: u32| mesh.wedges.vertices[wedge as usize];
        let faces = || writer.faces.iter().map(|&(level, face, k)| (level, face.map(vertex), k)).collect();
        Self {
            cells: cells(writer.bounds, writer.positions, &mesh.positions),
            normals: plan.map_or_else(Vec::new, |plan| plan.normals(&mesh.wedges.normals)),
            uvs: plan.map_or_else(Vec::new, |plan| plan.uvs(&mesh.wedges.uvs)),
            plan,
            faces: writer.attributes.seams.then(faces),
        }
    }
}

/// A mesh, its faces in stored order, and the switch codes of its vertices.
struct Writer<'a> {
    mesh: &'a ProgressiveMesh,
    attributes: Attributes,
    mode: Mode,
    positions: Positions,
    /// Bits of coded normals and texture coordinates.
    bits: [u8; 2],
    /// The bounding box.
    bounds: [[f32; 3]; 2],
    /// First wedge of each vertex, and the end.
    wedge_starts: Vec<u32>,
    /// Level of introduction, corners as mapped there, and index in the mesh of each stored face.
    faces: Vec<(u32, [u32; 3], usize)>,
    switches: Switches,
}

impl<'a> Writer<'a> {
    fn new(mesh: &'a ProgressiveMesh, options: &EncodeOptions) -> Self {
        let vertices = mesh.positions.len();
        let mut wedge_starts = alloc::vec![0; vertices + 1];
        for &v in &mesh.wedges.vertices {
            wedge_starts[v as usize + 1] += 1;
        }
        for v in 0..vertices {
            wedge_starts[v + 1] += wedge_starts[v];
        }
        let faces = mesh.stored_faces();
        let attributes = Attributes {
            normals: !mesh.wedges.normals.is_empty(),
            uvs: !mesh.wedges.uvs.is_empty(),
            colours: !mesh.wedges.colours.is_empty(),
            materials: mesh.materials.iter().any(|&m| m != 0),
            seams: mesh.wedges.len() != vertices,
        };
        let switches = Switches::find(mesh, &faces, &wedge_starts);
        let bounds = bounds(&mesh.positions);
        let EncodeOptions { mode, positions, normal_bits, uv_bits, .. } = *options;
        let bits = [normal_bits, uv_bits];
        Self { mesh, attributes, mode, positions, bits, bounds, wedge_starts, faces, switches }
    }

    /// The writer of coded packets.
    fn saver<'b>(&'b self, quantised: &'b Quantised) -> Saver<'b> {
        let switches = (&self.switches.codes[..], &self.switches.ranges[..]);
        let given = |plan| {
            let given = Given {
                wedge_starts: &self.wedge_starts,
                targets: &self.mesh.wedge_collapse,
                switches,
                faces: &self.faces,
                materials: &self.mesh.materials,
                normals: &quantised.normals,
                uvs: &quantised.uvs,
                colours: &self.mesh.wedges.colours,
            };
            (plan, given)
        };
        let known = Known {
            mesh: self.mesh,
            faces: quantised.faces.as_deref().unwrap_or(&self.faces),
            switches,
            cells: &quantised.cells,
            wedges: quantised.plan.map(given),
        };
        Saver::new(known, self.bounds, self.positions)
    }

    /// The packet that follows `before`; its payload's length is not known yet.
    fn entry(&self, before: Option<&PacketEntry>, size: PacketSize) -> PacketEntry {
        let start = before.map_or((0, 0, 0), |p| (p.vertices.end, p.wedges.end, p.faces.end));
        let vertices = self.mesh.positions.len() as u32;
        let end = size.end(start.0, self.mesh.base_vertices, vertices);
        // The coarsest level that the packet brings lacks this vertex and all later ones.
        let lacking = (start.0 + 1).max(self.mesh.base_vertices) - self.mesh.base_vertices;
        PacketEntry {
            vertices: start.0..end,
            wedges: start.1..self.wedge_starts[end as usize],
            faces: start.2..self.faces.partition_point(|&(level, ..)| level <= end) as u32,
            payload_bytes: 0,
            error: self.mesh.errors.get(lacking as usize).copied().unwrap_or(0.0),
            bytes: 0..0,
        }
    }

    /// The payload of a packet (PMESH-PKT-02).
    fn payload(&self, entry: &PacketEntry) -> Vec<u8> {
        let mesh = self.mesh;
        let vertices = entry.vertices.start as usize..entry.vertices.end as usize;
        let wedges = entry.wedges.start as usize..entry.wedges.end as usize;
        let faces = &self.faces[entry.faces.start as usize..entry.faces.end as usize];
        let base = mesh.base_vertices as usize;
        let splits = vertices.start.max(base) - base..vertices.end - base;
        let mut out = Vec::new();
        match self.positions.bits() {
            None => floats(&mut out, &mesh.positions[vertices.clone()]),
            Some(bits) => {
                points(&mut out, &mesh.positions[vertices.clone()], &Lattice::new(self.bounds, bits));
            }
        }
        if self.attributes.normals {
            floats(&mut out, &mesh.wedges.normals[wedges.clone()]);
        }
        if self.attributes.uvs {
            floats(&mut out, &mesh.wedges.uvs[wedges.clone()]);
        }
        if self.attributes.colours {
            out.extend(mesh.wedges.colours[wedges.clone()].as_flattened());
        }
        for wedge in faces.iter().flat_map(|(_, corners, _)| corners) {
            out.extend_from_slice(&wedge.to_le_bytes());
        }
        out.extend(mesh.collapse[splits.clone()].iter().flat_map(|parent| parent.to_le_bytes()));
        if self.attributes.materials {
            out.extend(faces.iter().flat_map(|&(_, _, i)| mesh.materials[i].to_le_bytes()));
        }
        if self.attributes.seams {
            for v in vertices {
                write_varint(&mut out, self.wedge_starts[v + 1] - self.wedge_starts[v]);
            }
            let base_wedges = self.wedge_starts[base];
            for v in splits.clone() {
                let first_of_parent = self.wedge_starts[mesh.collapse[v] as usize];
                for w in self.wedge_starts[base + v]..self.wedge_starts[base + v + 1] {
                    write_varint(&mut out, mesh.wedge_collapse[(w - base_wedges) as usize] - first_of_parent);
                }
            }
        }
        let mut bits = Bits::default();
        for v in splits {
            let wedges = self.wedge_starts[base + v + 1] - self.wedge_starts[base + v];
            for &code in self.switches.of(v) {
                bits.push(code.into(), code_bits(wedges));
            }
        }
        out.extend_from_slice(&bits.to_bytes());
        out
    }

    /// The header, as far as it is known before the file is laid out.
    fn header(&self, packets: Vec<PacketEntry>) -> Header {
        let mesh = self.mesh;
        let coded = self.mode == Mode::Coded;
        Header {
            minor: FORMAT.minor,
            optional_features: 0,
            header_bytes: FORMAT.header_bytes,
            content_id: ContentId(0),
            data_offset: 0,
            file_bytes: 0,
            vertex_count: mesh.positions.len() as u32,
            wedge_count: mesh.wedges.len() as u32,
            face_count: self.faces.len() as u32,
            base_vertices: mesh.base_vertices,
            mode: self.mode,
            positions: self.positions,
            attributes: self.attributes,
            origin: mesh.origin,
            bounds: self.bounds,
            normal_bits: if coded && self.attributes.normals { self.bits[0] } else { 0 },
            uv_bits: if coded && self.attributes.uvs { self.bits[1] } else { 0 },
            uv_bounds: if coded { uv_bounds(&mesh.wedges.uvs) } else { [[0.0; 2]; 2] },
            packets,
        }
    }
}

/// The switch codes of each vertex from the base on, in the order of the slots of its parent (PMESH-SWI-01).
struct Switches {
    codes: Vec<u32>,
    /// Where the codes of each vertex lie.
    ranges: Vec<(usize, usize)>,
}

impl Switches {
    /// Takes vertices away from the finest level down, as a reader that goes down does, and notes what switched.
    fn find(mesh: &ProgressiveMesh, faces: &[(u32, [u32; 3], usize)], wedge_starts: &[u32]) -> Self {
        let base = mesh.base_vertices as usize;
        let base_wedges = wedge_starts.get(base).copied().unwrap_or(0);
        let mut corners: Vec<[u32; 3]> = faces.iter().map(|&(_, _, i)| mesh.faces[i]).collect();
        let vertex_of = |w: u32| mesh.wedges.vertices[w as usize];
        let mut slots = Slots::default();
        slots.resize(mesh.positions.len(), mesh.positions.len());
        for (face, corners) in (0u32..).zip(&corners) {
            for (corner, &wedge) in (0u32..).zip(corners) {
                slots.push(vertex_of(wedge), 3 * face + corner);
            }
        }
        let mut codes = Vec::new();
        let mut ranges = alloc::vec![(0, 0); mesh.collapse.len()];
        let mut left = faces.len();
        for split in (0..mesh.collapse.len()).rev() {
            let vertex = (base + split) as u32;
            while left > 0 && faces[left - 1].0 == vertex + 1 {
                left -= 1;
                debug_assert_eq!(corners[left], faces[left].1, "corners as mapped at introduction");
                for wedge in corners[left] {
                    slots.pop(vertex_of(wedge));
                }
            }
            let start = codes.len();
            slots.merge(vertex, mesh.collapse[split], |slot, was_child| {
                let corner = &mut corners[(slot / 3) as usize][(slot % 3) as usize];
                if was_child {
                    codes.push(*corner - wedge_starts[vertex as usize] + 1);
                    *corner = mesh.wedge_collapse[(*corner - base_wedges) as usize];
                } else {
                    codes.push(0);
                }
            });
            // Canonical order is descending.
            codes[start..].reverse();
            ranges[split] = (start, codes.len());
        }
        Self { codes, ranges }
    }

    fn of(&self, split: usize) -> &[u32] {
        let (start, end) = self.ranges[split];
        &self.codes[start..end]
    }
}

/// The least and the greatest texture coordinates; 0 without any.
fn uv_bounds(uvs: &[[f32; 2]]) -> [[f32; 2]; 2] {
    let first = uvs.first().map_or([[0.0; 2]; 2], |&uv| [uv, uv]);
    uvs.iter().fold(first, |[low, high], uv| {
        [core::array::from_fn(|k| low[k].min(uv[k])), core::array::from_fn(|k| high[k].max(uv[k]))]
    })
}

fn floats<const N: usize>(out: &mut Vec<u8>, array: &[[f32; N]]) {
    out.reserve(4 * N * array.len());
    for x in array.as_flattened() {
        out.extend_from_slice(&x.to_le_bytes());
    }
}

/// The nearest points of the lattice, four u16 each, the last 0 (PMESH-POS-03).
fn points(out: &mut Vec<u8>, positions: &[[f32; 3]], lattice: &Lattice) {
    for &position in positions {
        // A lattice has at most 16 bits.
        let [x, y, z] = lattice.nearest(position).map(|q| q as u16);
        out.extend([x, y, z, 0].into_iter().flat_map(u16::to_le_bytes));
    }
}

#[cfg(test)]
mod tests;
