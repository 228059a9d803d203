//! Small meshes, and files taken apart and put together again with right checksums and lengths, whatever was changed. What is
//! needed of the layout is read here from the bytes, by `spec/common.md` and `spec/pmesh.md`, and not by the crate.

use ivg_wire::{
    ChunkKind, ContentId, record_len, seal_header, splitmix64, write_chunk, write_end, write_record,
};
use pmesh_format::{
    DIRECTORY, EncodeOptions, Header, IndexedMesh, Limits, Mode, Packet, Positions, ProgressiveMesh, Replay,
    Step, Wedges, decode_packet, encode,
};

/// Bytes of a directory entry (PMESH-DIR-02), and of a record before its payload.
pub(crate) const ENTRY: usize = 20;
pub(crate) const RECORD_HEAD: usize = 8;

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
}

/// A mesh with random parents and faces; two wedges at every other vertex, normals, texture coordinates, colours and materials
/// if `rich`. No surface, but every table that the format allows is as likely as any other.
pub(crate) fn random(seed: u64, vertices: usize, rich: bool) -> ProgressiveMesh {
    let mut numbers = Numbers::new(seed);
    let base = 3.min(vertices);
    let counts: Vec<usize> = (0..vertices).map(|v| if rich { 1 + v % 2 } else { 1 }).collect();
    let first = |v: usize| counts[..v].iter().sum::<usize>();
    let owners: Vec<u32> = (0..vertices).flat_map(|v| vec![v as u32; counts[v]]).collect();
    let wedges = owners.len();
    let collapse: Vec<u32> = (base..vertices).map(|v| numbers.below(v) as u32).collect();
    let wedge_collapse = (first(base)..wedges)
        .map(|w| {
            let parent = collapse[owners[w] as usize - base] as usize;
            (first(parent) + numbers.below(counts[parent])) as u32
        })
        .collect();
    let corners = (0..2 * vertices).map(|_| [0; 3].map(|_: usize| numbers.below(wedges) as u32));
    let differ = |f: &[u32; 3]| {
        let [a, b, c] = f.map(|w| owners[w as usize]);
        a != b && b != c && c != a
    };
    let faces: Vec<[u32; 3]> = corners.collect::<Vec<_>>().into_iter().filter(differ).collect();
    let unit = |k: usize| f32::from(k as u8) / 16.0;
    let when = |present: bool| if present { wedges } else { 0 };
    ProgressiveMesh {
        origin: [10.0, -2.5, 1e6],
        positions: (0..vertices).map(|_| [0; 3].map(|_: usize| unit(numbers.below(17)))).collect(),
        base_vertices: base as u32,
        collapse,
        wedge_collapse,
        errors: (base..vertices).map(|v| 1.0 / v as f32).collect(),
        materials: if rich { (0..faces.len()).map(|f| (f % 3) as u16).collect() } else { vec![] },
        material_names: if rich { vec!["stone".into(), "Blätter".into()] } else { vec![] },
        faces,
        wedges: Wedges {
            normals: (0..when(rich))
                .map(|w| if w % 2 == 0 { [0.0, 0.0, 1.0] } else { [0.0, -1.0, 0.0] })
                .collect(),
            uvs: (0..when(rich)).map(|w| [unit(w % 16), 0.5]).collect(),
            colours: (0..when(rich)).map(|w| [w as u8, 255, 7, 128]).collect(),
            vertices: owners,
        },
    }
}

/// Vertex k collapses onto k − 1, face k is (k, k + 1, k + 2).
pub(crate) fn strip() -> ProgressiveMesh {
    ProgressiveMesh {
        positions: (0..5u16).map(|v| [f32::from(v), f32::from(v % 2), 0.0]).collect(),
        wedges: Wedges { vertices: (0..5).collect(), ..Wedges::default() },
        base_vertices: 3,
        collapse: vec![2, 3],
        wedge_collapse: vec![2, 3],
        errors: vec![0.5, 0.25],
        faces: vec![[0, 1, 2], [1, 2, 3], [2, 3, 4]],
        ..ProgressiveMesh::default()
    }
}

/// Two vertices with two wedges each, of which the last collapses onto the other; both faces of the base switch. It has every
/// array that a file can have.
pub(crate) fn seam() -> ProgressiveMesh {
    ProgressiveMesh {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
        wedges: Wedges {
            vertices: vec![0, 1, 2, 2, 3, 3],
            normals: vec![[0.0, 0.0, 1.0]; 6],
            uvs: vec![[0.0; 2]; 6],
            colours: vec![[9; 4]; 6],
        },
        base_vertices: 3,
        collapse: vec![2],
        wedge_collapse: vec![2, 3],
        errors: vec![0.5],
        faces: vec![[0, 1, 4], [1, 0, 5], [0, 2, 4]],
        materials: vec![1, 0, 1],
        ..ProgressiveMesh::default()
    }
}

/// A file with packets of that many vertices.
pub(crate) fn file(mesh: &ProgressiveMesh, packet: u32) -> Vec<u8> {
    encode(mesh, &EncodeOptions::fixed(packet)).unwrap()
}

/// How packets and positions are stored: every way that this crate writes.
pub(crate) const STORED: &[(Mode, Positions)] = &[
    (Mode::Raw, Positions::F32),
    (Mode::Raw, Positions::Quantised(12)),
    (Mode::Coded, Positions::F32),
    (Mode::Coded, Positions::Quantised(14)),
];

/// A file that is stored in that way.
pub(crate) fn stored(mesh: &ProgressiveMesh, packet: u32, (mode, positions): (Mode, Positions)) -> Vec<u8> {
    encode(mesh, &EncodeOptions { mode, positions, ..EncodeOptions::fixed(packet) }).unwrap()
}

/// Whether attributes and materials are written that way.
pub(crate) fn attributes_too((mode, _): (Mode, Positions)) -> bool {
    mode == Mode::Raw
}

/// Files of all kinds that this crate writes.
pub(crate) fn samples() -> Vec<Vec<u8>> {
    STORED.iter().flat_map(|&way| samples_stored(way)).collect()
}

fn samples_stored(way: (Mode, Positions)) -> Vec<Vec<u8>> {
    let file = |mesh: &ProgressiveMesh, packet| stored(mesh, packet, way);
    let mut files = vec![file(&ProgressiveMesh::default(), 1), file(&strip(), 1)];
    if attributes_too(way) {
        files.push(file(&seam(), 3));
    }
    for (seed, vertices, rich, packet) in
        [(1, 1, false, 1), (2, 12, false, 5), (3, 14, true, 4), (4, 20, true, 100)]
    {
        files.push(file(&random(seed, vertices, rich && attributes_too(way)), packet));
    }
    files
}

/// The header of a file that has a right one.
pub(crate) fn header(file: &[u8]) -> Header {
    match Header::read(file, &Limits::default()) {
        Ok(Step::Consumed(_, header)) => header,
        other => panic!("{other:?}"),
    }
}

/// Packet `k` of a file, read alone.
pub(crate) fn packet<'a>(file: &'a [u8], header: &'a Header, k: u32) -> Packet<'a> {
    let range = header.packet_range(k);
    decode_packet(header, k, &file[range.start as usize..range.end as usize]).unwrap()
}

/// The first `count` packets of a file, applied.
pub(crate) fn replayed(file: &[u8], count: u32) -> Replay {
    let header = header(file);
    let mut replay = Replay::new(&header);
    for k in 0..count {
        replay.apply(&packet(file, &header, k)).unwrap();
    }
    replay
}

/// Every level that a replay can show, from the coarsest on, without the names of materials, which are no part of a packet; the
/// level that it shows stays.
pub(crate) fn levels(replay: &mut Replay) -> Vec<IndexedMesh> {
    let now = replay.level();
    let levels: Vec<IndexedMesh> = replay
        .levels()
        .into_iter()
        .flatten()
        .map(|level| {
            replay.set_level(level).unwrap();
            IndexedMesh { material_names: vec![], ..replay.mesh() }
        })
        .collect();
    if !levels.is_empty() {
        replay.set_level(now).unwrap();
    }
    levels
}

pub(crate) fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(*bytes[at..].first_chunk().unwrap())
}

pub(crate) fn u64_at(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(*bytes[at..].first_chunk().unwrap())
}

pub(crate) fn put(bytes: &mut [u8], at: usize, new: &[u8]) {
    bytes[at..at + new.len()].copy_from_slice(new);
}

pub(crate) fn put32(bytes: &mut [u8], at: usize, values: &[u32]) {
    for (k, value) in values.iter().enumerate() {
        put(bytes, at + 4 * k, &value.to_le_bytes());
    }
}

/// A file taken apart.
#[derive(Clone, Debug)]
pub(crate) struct Parts {
    /// The whole header; lengths in it, and its checksum, are put right when the file is put together.
    pub(crate) header: Vec<u8>,
    /// Chunks: kind, critical, payload.
    pub(crate) chunks: Vec<(ChunkKind, bool, Vec<u8>)>,
    /// Records: id, payload.
    pub(crate) packets: Vec<(u32, Vec<u8>)>,
}

impl Parts {
    pub(crate) fn of(file: &[u8]) -> Self {
        let header = file[..u32_at(file, 20) as usize].to_vec();
        let data = u64_at(file, 40) as usize;
        let (mut at, mut chunks) = (header.len(), vec![]);
        while at < data {
            let length = u64_at(file, at + 8) as usize;
            let payload = file[at + 16..at + 16 + length].to_vec();
            chunks.push((ChunkKind(*file[at..].first_chunk().unwrap()), file[at + 4] & 1 == 1, payload));
            at += (20 + length).next_multiple_of(8);
        }
        let mut packets = vec![];
        for entry in chunks[0].2.chunks_exact(ENTRY) {
            let length = u32_at(entry, 12) as usize;
            let start = at + RECORD_HEAD;
            packets.push((u32_at(file, at), file[start..start + length].to_vec()));
            at += (12 + length).next_multiple_of(4);
        }
        assert_eq!(at + 20, file.len(), "the end record ends the file");
        Self { header, chunks, packets }
    }

    /// The payload of the directory.
    pub(crate) fn directory(&mut self) -> &mut Vec<u8> {
        assert_eq!(self.chunks[0].0, DIRECTORY);
        &mut self.chunks[0].2
    }

    /// Gives a packet another payload, and the directory its length.
    pub(crate) fn set_payload(&mut self, k: usize, payload: Vec<u8>) {
        put32(self.directory(), ENTRY * k + 12, &[payload.len() as u32]);
        self.packets[k].1 = payload;
    }

    /// Where the chunks end and the records begin.
    pub(crate) fn data_offset(&self) -> u64 {
        let chunks = self.chunks.iter().map(|chunk| (20 + chunk.2.len() as u64).next_multiple_of(8));
        self.header.len() as u64 + chunks.sum::<u64>()
    }

    /// Where the payload of record `k` begins in the file.
    pub(crate) fn payload_offset(&self, k: usize) -> u64 {
        let records = self.packets[..k].iter().map(|p| record_len(p.1.len() as u64).unwrap());
        self.data_offset() + records.sum::<u64>() + RECORD_HEAD as u64
    }

    /// Bits of a parent in packet `k`.
    pub(crate) fn parent_bits(&self, k: usize) -> usize {
        let end = u32_at(&self.chunks[0].2, ENTRY * k);
        (0..).find(|&bits| 1 << bits >= end).unwrap()
    }

    /// The parents of packet `k`, which brings `count`.
    pub(crate) fn parents(&self, k: usize, count: usize) -> Vec<u32> {
        let (at, bits) = (self.arrays(k)[6], self.parent_bits(k));
        let bit = |n: usize| u32::from(self.packets[k].1[at + n / 8] >> (n % 8) & 1);
        (0..count).map(|nth| (0..bits).map(|b| bit(nth * bits + b) << b).sum()).collect()
    }

    /// Gives packet `k` other parents, from the `nth` on, as far as they fit in their bits.
    pub(crate) fn set_parents(&mut self, k: usize, nth: usize, parents: &[u32]) {
        let (at, bits) = (self.arrays(k)[6], self.parent_bits(k));
        for (nth, parent) in (nth..).zip(parents) {
            for b in 0..bits {
                let n = nth * bits + b;
                let byte = &mut self.packets[k].1[at + n / 8];
                *byte = *byte & !(1 << (n % 8)) | ((parent >> b & 1) as u8) << (n % 8);
            }
        }
    }

    /// Where the arrays of a raw packet with positions of 12 bytes begin, in the order of the table in PMESH-PKT-02 from
    /// `positions` on, and where the last of them, `parents`, ends.
    pub(crate) fn arrays(&self, k: usize) -> [usize; 8] {
        assert_eq!(self.header[76..78], [1, 1], "raw packets, f32 positions");
        let directory = &self.chunks[0].2;
        let entry = |k: usize, field: usize| u32_at(directory, ENTRY * k + 4 * field) as usize;
        let before = |field: usize| if k == 0 { 0 } else { entry(k - 1, field) };
        let [v, w, f] = [0, 1, 2].map(|field| entry(k, field) - before(field));
        let base = u32_at(&self.header, 68) as usize;
        let s = entry(k, 0) - before(0).max(base);
        let bits = self.header[78];
        let when = |bit: u8, length: usize| if bits >> bit & 1 == 1 { length } else { 0 };
        let parents = (s * self.parent_bits(k)).div_ceil(8);
        let lengths =
            [12 * v, when(0, 12 * w), when(1, 8 * w), when(2, 4 * w), 12 * f, when(3, 2 * f), parents];
        // Behind the number of switches.
        let mut starts = [4; 8];
        for (array, length) in lengths.into_iter().enumerate() {
            starts[array + 1] = starts[array] + length;
        }
        starts
    }

    /// The file.
    pub(crate) fn build(&self) -> Vec<u8> {
        let mut file = self.header.clone();
        let content_id = ContentId(u64_at(&file, 32));
        let records = self.packets.iter().map(|p| record_len(p.1.len() as u64).unwrap());
        let file_bytes = self.data_offset() + records.sum::<u64>() + 20;
        put(&mut file, 40, &self.data_offset().to_le_bytes());
        put(&mut file, 48, &file_bytes.to_le_bytes());
        seal_header(&mut file);
        for (kind, critical, payload) in &self.chunks {
            write_chunk(&mut file, *kind, *critical, payload, content_id);
        }
        for (id, payload) in &self.packets {
            write_record(&mut file, *id, 0, payload, content_id);
        }
        write_end(&mut file, file_bytes, content_id);
        file
    }
}

#[test]
fn a_file_taken_apart_and_put_together_is_the_same() {
    for file in samples() {
        assert_eq!(Parts::of(&file).build(), file);
    }
}
