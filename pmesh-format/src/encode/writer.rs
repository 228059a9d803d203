//! What the packets of a mesh are written from.

use alloc::vec::Vec;

use ivg_wire::ContentId;

use super::EncodeOptions;
use super::codes::Switches;
use crate::attributes::Attributes;
use crate::coded::{Given, Known, Plan, Saver, cells};
use crate::header::{Header, PacketEntry};
use crate::lattice::bounds;
use crate::progressive::ProgressiveMesh;
use crate::storage::{Mode, Positions};
use crate::wire::FORMAT;

/// What coded packets hold, in whole numbers.
pub(super) struct Quantised {
    cells: Vec<[i32; 3]>,
    /// How attributes are stored, if there are any.
    plan: Option<Plan>,
    normals: Vec<[i32; 2]>,
    uvs: Vec<[i32; 2]>,
    /// With seams, the faces with vertices instead of wedges.
    faces: Option<Vec<(u32, [u32; 3], usize)>>,
}

impl Quantised {
    pub(super) fn new(writer: &Writer<'_>) -> Self {
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

/// A mesh and its faces in stored order.
pub(super) struct Writer<'a> {
    pub(super) mesh: &'a ProgressiveMesh,
    pub(super) attributes: Attributes,
    mode: Mode,
    pub(super) positions: Positions,
    /// Bits of coded normals and texture coordinates.
    bits: [u8; 2],
    /// The bounding box.
    pub(super) bounds: [[f32; 3]; 2],
    /// First wedge of each vertex, and the end.
    pub(super) wedge_starts: Vec<u32>,
    /// Level of introduction, corners as mapped there, and index in the mesh of each stored face.
    pub(super) faces: Vec<(u32, [u32; 3], usize)>,
    /// What coded packets need beside.
    switches: Option<Switches>,
}

impl<'a> Writer<'a> {
    pub(super) fn new(mesh: &'a ProgressiveMesh, options: &EncodeOptions) -> Self {
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
        let switches = (options.mode == Mode::Coded).then(|| Switches::find(mesh, &faces, &wedge_starts));
        let bounds = bounds(&mesh.positions);
        let EncodeOptions { mode, positions, normal_bits, uv_bits, .. } = *options;
        let bits = [normal_bits, uv_bits];
        Self { mesh, attributes, mode, positions, bits, bounds, wedge_starts, faces, switches }
    }

    /// The writer of coded packets.
    pub(super) fn saver<'b>(&'b self, quantised: &'b Quantised) -> Saver<'b> {
        let switches = self.switches.as_ref().map_or((&[][..], &[][..]), Switches::parts);
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

    pub(super) fn vertex_count(&self) -> u32 {
        self.mesh.positions.len() as u32
    }

    pub(super) fn base(&self) -> u32 {
        self.mesh.base_vertices
    }

    /// The first wedge of a vertex that collapses.
    pub(super) fn first_split_wedge(&self) -> u32 {
        self.wedge_starts[self.mesh.base_vertices as usize]
    }

    /// The packet that follows `before` and ends before vertex `end`; its payload's length is not known yet.
    pub(super) fn entry(&self, before: Option<&PacketEntry>, end: u32) -> PacketEntry {
        let start = before.map_or((0, 0, 0), |p| (p.vertices.end, p.wedges.end, p.faces.end));
        let mut entry = PacketEntry {
            vertices: start.0..end,
            wedges: start.1..0,
            faces: start.2..0,
            payload_bytes: 0,
            error: 0.0,
            bytes: 0..0,
        };
        self.end_at(&mut entry, end);
        // The coarsest level that the packet brings lacks this vertex and all later ones.
        let lacking = (start.0 + 1).max(self.mesh.base_vertices) - self.mesh.base_vertices;
        entry.error = self.mesh.errors.get(lacking as usize).copied().unwrap_or(0.0);
        entry
    }

    /// Lets a packet end before vertex `end`.
    pub(super) fn end_at(&self, entry: &mut PacketEntry, end: u32) {
        entry.vertices.end = end;
        entry.wedges.end = self.wedge_starts[end as usize];
        entry.faces.end = self.faces.partition_point(|&(level, ..)| level <= end) as u32;
    }

    /// The header, as far as it is known before the file is laid out.
    pub(super) fn header(&self, packets: Vec<PacketEntry>) -> Header {
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

/// The least and the greatest texture coordinates; 0 without any.
pub(super) fn uv_bounds(uvs: &[[f32; 2]]) -> [[f32; 2]; 2] {
    let first = uvs.first().map_or([[0.0; 2]; 2], |&uv| [uv, uv]);
    uvs.iter().fold(first, |[low, high], uv| {
        [core::array::from_fn(|k| low[k].min(uv[k])), core::array::from_fn(|k| high[k].max(uv[k]))]
    })
}
