//! What the tests of several modules need: meshes with arbitrary valid tables, and files taken apart and put together again.

use std::vec;
use std::vec::Vec;

use ivg_wire::{
    ChunkKind, CommonHeader, ContentId, END_PAYLOAD, Step, chunk_len, record_len, seal_header, splitmix64,
    write_chunk, write_end, write_record,
};

use crate::decode::{Decoder, Event, decode_all, decode_packet};
use crate::header::Header;
use crate::limits::Limits;
use crate::mesh::{IndexedMesh, Wedges};
use crate::progressive::ProgressiveMesh;
use crate::replay::Replay;
use crate::wire::{DIRECTORY, FORMAT};

/// A repeatable source of numbers.
pub(crate) struct Numbers {
    seed: u64,
    next: u64,
}

impl Numbers {
    pub(crate) fn new(seed: u64) -> Self {
        Self { seed, next: 0 }
    }

    /// A number below `bound`, which is at least 1.
    pub(crate) fn below(&mut self, bound: usize) -> usize {
        self.next += 1;
        (splitmix64(self.seed, self.next) % bound as u64) as usize
    }

    fn float(&mut self) -> f32 {
        self.below(2001) as f32 / 1000.0 - 1.0
    }
}

/// What a random mesh has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kind {
    pub(crate) vertices: usize,
    pub(crate) seams: bool,
    pub(crate) materials: bool,
}

/// A mesh with random positions, random parents, random wedges and random faces: no surface anybody would draw, but every
/// table that the format allows is as likely as any other.
pub(crate) fn random_mesh(seed: u64, kind: Kind) -> ProgressiveMesh {
    let mut numbers = Numbers::new(seed);
    let vertices = kind.vertices;
    let base = 1 + numbers.below(vertices.min(5));
    let mut wedge_vertices = Vec::new();
    let mut first = vec![0usize];
    for v in 0..vertices {
        let count = if kind.seams { 1 + numbers.below(3) } else { 1 };
        wedge_vertices.extend(vec![v as u32; count]);
        first.push(wedge_vertices.len());
    }
    let wedges = wedge_vertices.len();
    let collapse: Vec<u32> = (base..vertices).map(|v| numbers.below(v) as u32).collect();
    let wedge_collapse = (first[base]..wedges)
        .map(|w| {
            let parent = collapse[wedge_vertices[w] as usize - base] as usize;
            (first[parent] + numbers.below(first[parent + 1] - first[parent])) as u32
        })
        .collect();
    let mut faces = Vec::new();
    if vertices >= 3 {
        for _ in 0..2 * vertices {
            let corners = [0; 3].map(|_: usize| numbers.below(wedges) as u32);
            let [a, b, c] = corners.map(|w| wedge_vertices[w as usize]);
            if a != b && b != c && c != a {
                faces.push(corners);
            }
        }
    }
    let mut errors: Vec<f32> = (base..vertices).map(|_| numbers.float().abs()).collect();
    errors.sort_by(|a, b| b.total_cmp(a));
    let with = |numbers: &mut Numbers| kind.seams || numbers.below(2) == 0;
    ProgressiveMesh {
        origin: [1e6, -2.5, 0.0],
        positions: (0..vertices).map(|_| [0; 3].map(|_| numbers.float())).collect(),
        base_vertices: base as u32,
        collapse,
        wedge_collapse,
        errors,
        materials: if kind.materials {
            faces.iter().map(|f| (f[0] % 7) as u16).collect()
        } else {
            Vec::new()
        },
        material_names: if kind.materials {
            vec!["stone".into(), "".into(), "Blätter".into()]
        } else {
            Vec::new()
        },
        faces,
        wedges: Wedges {
            normals: if with(&mut numbers) { vec![[0.0, 0.6, 0.8]; wedges] } else { Vec::new() },
            uvs: if kind.seams { (0..wedges).map(|w| [w as f32, 0.5]).collect() } else { Vec::new() },
            colours: if with(&mut numbers) { vec![[1, 2, 3, 255]; wedges] } else { Vec::new() },
            vertices: wedge_vertices,
        },
    }
}

/// Small meshes of all kinds.
pub(crate) fn some_meshes() -> Vec<ProgressiveMesh> {
    let mut meshes = vec![ProgressiveMesh::default()];
    for (seed, vertices) in [(1, 1), (2, 3), (3, 4), (4, 9), (5, 24)] {
        for (seams, materials) in [(false, false), (true, true)] {
            meshes.push(random_mesh(seed, Kind { vertices, seams, materials }));
        }
    }
    meshes
}

/// A mesh as [`Replay::mesh`] gives it: the oracle's, but materials that are all 0 are not stored.
pub(crate) fn expected(mesh: &ProgressiveMesh, level: u32) -> IndexedMesh {
    let mut expected = mesh.level(level);
    if mesh.materials.iter().all(|&m| m == 0) {
        expected.materials.clear();
    }
    expected
}

/// Everything of a file into a replay.
pub(crate) fn replay_all(file: &[u8]) -> Replay {
    let mut replay = Replay::default();
    decode_all(file, &Limits::default(), |event| {
        replay.accept(&event).unwrap();
    })
    .unwrap();
    replay
}

/// The header of a file.
pub(crate) fn header_of(file: &[u8]) -> Header {
    match Header::read(file, &Limits::default()) {
        Ok(Step::Consumed(_, header)) => header,
        other => panic!("{other:?}"),
    }
}

/// A file taken apart, to be put together again with right checksums and lengths, whatever was changed.
#[derive(Clone, Debug)]
pub(crate) struct Parts {
    /// The header's bytes from 56 on.
    pub(crate) specific: Vec<u8>,
    /// Chunks: kind, critical, payload.
    pub(crate) chunks: Vec<(ChunkKind, bool, Vec<u8>)>,
    /// Records: id, generation, payload.
    pub(crate) packets: Vec<(u32, u32, Vec<u8>)>,
}

impl Parts {
    pub(crate) fn of(file: &[u8]) -> Self {
        let header = header_of(file);
        let directory = header.to_bytes().1;
        let mut parts = Self {
            specific: file[56..header.header_bytes as usize].to_vec(),
            chunks: vec![(DIRECTORY, true, directory)],
            packets: Vec::new(),
        };
        let mut decoder = Decoder::new(Limits::default());
        let mut at = 0;
        while let Ok(Step::Consumed(used, event)) = decoder.push(&file[at..]) {
            if let Event::Chunk(chunk) = event {
                parts.chunks.push((chunk.kind, chunk.critical, chunk.payload.to_vec()));
            }
            at += used;
        }
        for k in 0..header.packet_count() {
            let range = header.packet_range(k);
            let packet = decode_packet(&header, k, &file[range.start as usize..range.end as usize]).unwrap();
            parts.packets.push((k, 0, packet.payload().to_vec()));
        }
        parts
    }

    /// The payload of the directory.
    pub(crate) fn directory(&mut self) -> &mut Vec<u8> {
        &mut self.chunks[0].2
    }

    /// Gives a packet another payload, and the directory its length.
    pub(crate) fn set_payload(&mut self, k: usize, payload: Vec<u8>) {
        self.directory()[20 * k + 12..20 * k + 16].copy_from_slice(&(payload.len() as u32).to_le_bytes());
        self.packets[k].2 = payload;
    }

    /// Where the payload of packet `k` begins in the file.
    pub(crate) fn payload_offset(&self, k: usize) -> u64 {
        let records = self.packets[..k].iter().map(|p| record_len(p.2.len() as u64).unwrap());
        self.data_offset() + records.sum::<u64>() + 8
    }

    fn data_offset(&self) -> u64 {
        let chunks = self.chunks.iter().map(|chunk| chunk_len(chunk.2.len() as u64).unwrap());
        56 + self.specific.len() as u64 + chunks.sum::<u64>()
    }

    /// The file.
    pub(crate) fn build(&self) -> Vec<u8> {
        let content_id = ContentId::of(&[&self.specific]);
        let records = self.packets.iter().map(|p| record_len(p.2.len() as u64).unwrap());
        let file_bytes = self.data_offset() + records.sum::<u64>() + record_len(END_PAYLOAD).unwrap();
        let common = CommonHeader {
            minor: FORMAT.minor,
            required_features: 0,
            optional_features: 0,
            header_bytes: 56 + self.specific.len() as u32,
            content_id,
            data_offset: self.data_offset(),
            file_bytes,
        };
        let mut file = common.to_bytes(&FORMAT).to_vec();
        file.extend(&self.specific);
        seal_header(&mut file);
        for (kind, critical, payload) in &self.chunks {
            write_chunk(&mut file, *kind, *critical, payload, content_id);
        }
        for (id, generation, payload) in &self.packets {
            write_record(&mut file, *id, *generation, payload, content_id);
        }
        write_end(&mut file, file_bytes, content_id);
        file
    }
}
