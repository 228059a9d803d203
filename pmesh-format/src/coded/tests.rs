use std::vec;
use std::vec::Vec;

use ivg_wire::splitmix64;

use super::models::{Binary, Symbols};
use super::rans::{Coder, Reader, Writer};
use crate::decode::{decode_all, decode_packet};
use crate::encode::{EncodeOptions, PacketSize, encode};
use crate::header::Header;
use crate::limits::Limits;
use crate::mesh::Wedges;
use crate::progressive::ProgressiveMesh;
use crate::replay::Replay;
use crate::storage::{Mode, Positions};
use crate::tests::{Kind, random_mesh};

pub(in crate::coded) fn options(positions: Positions, size: u32) -> EncodeOptions {
    EncodeOptions { packets: PacketSize::Fixed(size), mode: Mode::Coded, positions, ..EncodeOptions::new() }
}

/// A mesh without attributes: random tables, or a surface.
fn meshes() -> Vec<ProgressiveMesh> {
    let mut meshes = vec![ProgressiveMesh::default(), grid(7, 5, 1), grid(12, 9, 2), grid(20, 20, 3)];
    for seed in 0..40 {
        let mut mesh =
            random_mesh(seed, Kind { vertices: 1 + seed as usize * 2, seams: false, materials: false });
        mesh.wedges = Wedges { vertices: mesh.wedges.vertices, ..Wedges::default() };
        mesh.materials.clear();
        meshes.push(mesh);
    }
    meshes
}

/// A height field whose vertices collapse onto neighbours in random order: rims, fans that go round, and late ones that do not.
fn grid(width: u32, height: u32, seed: u64) -> ProgressiveMesh {
    let count = width * height;
    let mut order: Vec<u32> = (0..count).collect();
    order.sort_by_key(|&v| splitmix64(seed, v.into()));
    let mut number = vec![0; count as usize];
    for (new, &old) in (0u32..).zip(&order) {
        number[old as usize] = new;
    }
    let faces: Vec<[u32; 3]> = (0..(width - 1) * (height - 1))
        .flat_map(|k| {
            let at = k / (width - 1) * width + k % (width - 1);
            [[at, at + 1, at + width], [at + 1, at + width + 1, at + width]]
        })
        .map(|face| face.map(|v| number[v as usize]))
        .collect();
    // Each vertex, last first, onto the earliest of those that it shares a face with by then.
    let mut present = faces.clone();
    let mut collapse = vec![0; count as usize];
    let mut base = 1;
    for v in (1..count).rev() {
        let beside = present.iter().filter(|face| face.contains(&v)).flatten().filter(|&&w| w < v).min();
        let Some(&parent) = beside else {
            base = v + 1;
            break;
        };
        collapse[v as usize] = parent;
        for face in &mut present {
            *face = face.map(|w| if w == v { parent } else { w });
        }
        present.retain(|[a, b, c]| a != b && b != c && c != a);
    }
    let collapse = collapse[base as usize..].to_vec();
    ProgressiveMesh {
        positions: order
            .iter()
            .map(|&v| {
                let noise = splitmix64(seed, u64::from(v) + 99) % 1000;
                [(v % width) as f32 * 0.3, (v / width) as f32 * -0.25, noise as f32 * 1e-3 - 0.5]
            })
            .collect(),
        wedges: Wedges { vertices: (0..count).collect(), ..Wedges::default() },
        base_vertices: base,
        wedge_collapse: collapse.clone(),
        errors: vec![0.25; collapse.len()],
        collapse,
        faces,
        ..ProgressiveMesh::default()
    }
}

fn replayed(file: &[u8]) -> Replay {
    let mut replay = Replay::default();
    decode_all(file, &Limits::default(), |event| {
        replay.accept(&event).unwrap();
    })
    .unwrap();
    replay
}

#[test]
fn every_level_is_that_of_the_arranged_mesh() {
    for mesh in meshes() {
        for (positions, size) in
            [(Positions::F32, 5), (Positions::Quantised(10), 1), (Positions::Quantised(16), 30)]
        {
            let options = options(positions, size);
            let file = encode(&mesh, &options).unwrap();
            let mut arranged = options.arranged(&mesh);
            arranged.positions = positions.quantised(&arranged.positions);
            let mut replay = replayed(&file);
            for level in mesh.base_vertices..=mesh.positions.len() as u32 {
                replay.set_level(level).unwrap();
                let expected = arranged.level(level);
                assert_eq!(replay.indices(), expected.triangles, "{positions:?} level {level}");
                let bits = |all: &[[f32; 3]]| all.iter().map(|p| p.map(f32::to_bits)).collect::<Vec<_>>();
                assert_eq!(bits(replay.positions()), bits(&expected.positions));
            }
        }
    }
}

#[test]
fn arranging_keeps_the_levels_between_packets() {
    let mesh = grid(12, 9, 4);
    let arranged = options(Positions::F32, 10).arranged(&mesh);
    let shape = |mesh: &ProgressiveMesh, level| {
        let level = mesh.level(level);
        let mut faces: Vec<_> = level
            .triangles
            .iter()
            .map(|face| {
                let mut points = face.map(|v| level.positions[v as usize].map(f32::to_bits));
                let least = (0..3).min_by_key(|&k| points[k]).unwrap();
                points.rotate_left(least);
                points
            })
            .collect();
        faces.sort_unstable();
        faces
    };
    let header = replayed(&encode(&mesh, &options(Positions::F32, 10)).unwrap()).header().clone();
    assert!(header.packets.len() > 3);
    for entry in &header.packets {
        assert!(shape(&arranged, entry.vertices.end) == shape(&mesh, entry.vertices.end), "{entry:?}");
        let first = entry.vertices.start.max(mesh.base_vertices) - mesh.base_vertices;
        let parents = &arranged.collapse[first as usize..(entry.vertices.end - mesh.base_vertices) as usize];
        assert!(parents.is_sorted());
    }
    assert_ne!(arranged.positions, mesh.positions);
}

#[test]
fn surfaces_take_less_than_half_of_their_raw_bytes() {
    let mesh = grid(20, 20, 5);
    let coded = encode(&mesh, &options(Positions::Quantised(12), 100)).unwrap();
    let raw =
        encode(&mesh, &EncodeOptions { mode: Mode::Raw, ..options(Positions::Quantised(12), 100) }).unwrap();
    assert!(coded.len() * 2 < raw.len(), "{} of {}", coded.len(), raw.len());
}

#[test]
fn a_bad_packet_changes_nothing_and_the_right_one_can_follow() {
    let mesh = grid(12, 9, 6);
    let options = options(Positions::Quantised(12), 30);
    let file = encode(&mesh, &options).unwrap();
    let whole = replayed(&file);
    let header = whole.header().clone();
    let mut refused = 0;
    for index in 0..header.packet_count() {
        let entry = &header.packets[index as usize];
        let record = &file[entry.bytes.start as usize..entry.bytes.end as usize];
        let mut replay = Replay::new(&header);
        for k in 0..index {
            let range = header.packets[k as usize].bytes.clone();
            replay
                .apply(&decode_packet(&header, k, &file[range.start as usize..range.end as usize]).unwrap())
                .unwrap();
        }
        let before = replay.mesh();
        for seed in 0..200u64 {
            let bytes = damaged_record(&header, index, &record[8..8 + entry.payload_bytes as usize], seed);
            // Damage to bits that are stored as they are gives another mesh; checksums are there for that.
            let mut damaged = replay.clone();
            if damaged.apply(&decode_packet(&header, index, &bytes).unwrap()).is_err() {
                refused += 1;
                assert!(damaged.mesh() == before, "packet {index} seed {seed}");
                damaged.apply(&decode_packet(&header, index, record).unwrap()).unwrap();
                let mut whole = whole.clone();
                whole.set_level(entry.vertices.end).unwrap();
                assert!(damaged.mesh() == whole.mesh(), "packet {index} seed {seed}");
            }
        }
    }
    assert!(refused > 200, "{refused}");
}

#[test]
fn the_coder_gives_back_what_it_was_given() {
    let mut writer = Writer::default();
    let (mut bits, mut symbols) =
        (Binary::new(1 << 14), Symbols::new(core::array::from_fn(|k| k as i16 * 2048)));
    let number = |k: u64| splitmix64(7, k);
    for k in 0..2000 {
        writer.bit(&mut bits, number(k).is_multiple_of(9));
        writer.symbol(&mut symbols, (number(k) >> 8 & number(k) >> 16 & 15) as usize);
        writer.raw_long((k % 58) as u32, number(k) & ((1 << (k % 58)) - 1));
    }
    let payload = writer.finish(0);
    let mut reader = Reader::new(&payload).unwrap();
    let (mut bits, mut symbols) =
        (Binary::new(1 << 14), Symbols::new(core::array::from_fn(|k| k as i16 * 2048)));
    for k in 0..2000 {
        assert_eq!(reader.bit(&mut bits, false), number(k).is_multiple_of(9));
        assert_eq!(reader.symbol(&mut symbols, 0) as u64, number(k) >> 8 & number(k) >> 16 & 15);
        assert_eq!(reader.raw_long((k % 58) as u32, 0), number(k) & ((1 << (k % 58)) - 1));
    }
    assert!(reader.at_end() && reader.count_left() == 0 && reader.left().1.all(|bits| bits == 0));
}

#[test]
fn the_coder_writes_the_bytes_of_the_specification() {
    let mut writer = Writer::default();
    let mut model = Binary::new(1 << 14);
    let mut symbols = Symbols::new(core::array::from_fn(|k| k as i16 * 2048));
    for value in [true, false, false, true] {
        writer.bit(&mut model, value);
    }
    for value in [3, 3, 15] {
        writer.symbol(&mut symbols, value);
    }
    writer.raw(9, 0x155);
    assert_eq!(writer.finish(0), PINNED);
}

/// Test values of PMESH-COD-04.
const PINNED: &[u8] = &[142, 155, 158, 4, 85, 249, 117, 0, 1, 85];

/// A change that writer and reader share goes unnoticed when files are only read back.
#[test]
fn the_bytes_of_whole_files_stay_as_they_are() {
    let mesh = grid(20, 20, 3);
    for (positions, bytes, id) in [
        (Positions::Quantised(12), 3316, 5_198_280_197_344_528_526),
        (Positions::F32, 5568, 2_273_704_509_561_396_720),
    ] {
        let file = encode(&mesh, &options(positions, 100)).unwrap();
        assert_eq!((file.len(), replayed(&file).header().content_id.0), (bytes, id), "{positions:?}");
    }
}

/// The record of a packet with one bit of its payload turned over, for every third seed with noise from there on; its checksum
/// fits.
pub(in crate::coded) fn damaged_record(header: &Header, index: u32, payload: &[u8], seed: u64) -> Vec<u8> {
    let mut damaged = payload.to_vec();
    let at = splitmix64(seed, 1) as usize % damaged.len();
    damaged[at] ^= 1 << (seed % 8);
    if seed.is_multiple_of(3) {
        for (k, byte) in damaged[at..].iter_mut().enumerate() {
            *byte = splitmix64(seed, k as u64 + 2) as u8;
        }
    }
    let mut bytes = Vec::new();
    ivg_wire::write_record(&mut bytes, index, 0, &damaged, header.content_id);
    bytes
}
