mod plain;

use super::*;
use crate::surfaces::{Kind, surface};
use crate::vectors::{Format, vectors};
use plain::Plain;
use pmesh_format::{EncodeOptions, Limits, ProgressiveMesh, Replay, Step, decode_packet, encode};

/// The reference after every packet of a file.
fn read(file: &[u8]) -> (Header, Vec<Vec<u8>>) {
    let Ok(Step::Consumed(_, header)) = Header::read(file, &Limits::default()) else { panic!("no header") };
    let payloads = (0..header.packet_count())
        .map(|k| {
            let range = header.packet_range(k);
            let bytes = &file[range.start as usize..range.end as usize];
            decode_packet(&header, k, bytes).unwrap().payload().to_vec()
        })
        .collect();
    (header, payloads)
}

/// The direct mapping of a mesh without the format: the oracle of the oracle.
fn direct(mesh: &ProgressiveMesh, level: u32) -> IndexedMesh {
    IndexedMesh { material_names: Vec::new(), ..mesh.level(level) }
}

#[test]
fn the_reference_reads_what_was_written() {
    for (seed, seams, irregular) in [(1, false, false), (2, true, false), (3, true, true), (4, false, true)] {
        let mut n = 0;
        let kind = Kind { vertices: 30, seams, irregular, normals: seams, uvs: seams, ..Kind::default() };
        let mesh = surface(kind, |bound| {
            n += 1;
            (ivg_wire::splitmix64(seed, n) % bound as u64) as usize
        });
        let (header, payloads) = read(&encode(&mesh, &EncodeOptions::fixed(7)).unwrap());
        let plain = Plain::new(&header, &mesh);
        let plainly: Vec<Vec<u8>> = header.packets.iter().map(|entry| plain.payload(entry)).collect();
        assert_eq!(payloads, plainly, "two writers");
        let mut reference = Reference::new(&header);
        for payload in &payloads {
            assert_eq!(reference.take(payload), Ok(()));
        }
        assert_eq!(reference.levels(), (3..=30).collect::<Vec<u32>>());
        for level in 3..=30 {
            assert_eq!(reference.level(level), Some(direct(&mesh, level)), "level {level}");
        }
        assert_eq!(reference.level(31), None);
    }
}

/// Of every vector whose packets arrive: the same levels, or the same code at the same byte, as the crate's reader.
#[test]
fn reference_and_replay_agree_on_every_vector() {
    let mut refused = 0;
    for vector in vectors().iter().filter(|vector| vector.format == Format::Pmesh) {
        let Ok(Step::Consumed(_, header)) = Header::read(&vector.bytes, &Limits::default()) else { continue };
        let mut reference = Reference::new(&header);
        let mut replay = Replay::new(&header);
        for k in 0..header.packet_count() {
            let range = header.packet_range(k);
            let Some(bytes) = vector.bytes.get(range.start as usize..range.end as usize) else { break };
            let Ok(packet) = decode_packet(&header, k, bytes) else { break };
            match (reference.take(packet.payload()), replay.apply(&packet)) {
                (Ok(()), Ok(_)) => {}
                (Err(fault), Err(error)) => {
                    let at = error.offset().0 - range.start - 8;
                    assert_eq!(
                        (fault.code, fault.at as u64),
                        (error.code(), at),
                        "{}: {error}",
                        vector.file()
                    );
                    refused += 1;
                    break;
                }
                (reference, replay) => panic!("{}: {reference:?}, {replay:?}", vector.file()),
            }
            for level in reference.levels() {
                replay.set_level(level).unwrap();
                let mesh = IndexedMesh { material_names: Vec::new(), ..replay.mesh() };
                assert_eq!(reference.level(level), Some(mesh), "{}, level {level}", vector.file());
            }
        }
    }
    assert!(refused > 15, "{refused} refused in a packet");
}
