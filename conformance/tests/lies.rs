//! Every packet of every accepted `.pmesh` vector with every byte changed, its checksum put right: what a fuzzer would find first.

use conformance::oracles::{pmesh_decode, pmesh_lod, pmesh_packets};
use conformance::vectors::edit::in_envelope;
use conformance::vectors::parts::Parts;
use conformance::vectors::{Format, Vector, vectors};
use ivg_wire::splitmix64;
use pmesh_format::{Header, IndexedMesh, Limits, Replay, Step, decode_packet};
use std::ops::Range;

/// Where the payload of each packet lies, and its record.
fn packets(file: &[u8]) -> Vec<(Range<usize>, Range<usize>)> {
    let Ok(Step::Consumed(_, header)) = Header::read(file, &Limits::default()) else { panic!("no header") };
    let range = |range: Range<u64>| range.start as usize..range.end as usize;
    (0..header.packet_count())
        .map(|k| {
            let record = range(header.packet_range(k));
            let payload = record.start + 8;
            (payload..payload + header.packets[k as usize].payload_bytes as usize, record)
        })
        .collect()
}

fn accepted() -> Vec<Vector> {
    let accepted = vectors().into_iter().filter(|v| v.format == Format::Pmesh && v.code.is_none());
    // The same packets with another header are those of another vector.
    accepted
        .filter(|vector| !["0007-unknown-chunk", "0008-newer-minor"].contains(&vector.name.as_str()))
        .collect()
}

#[test]
fn both_readers_judge_any_changed_byte_alike() {
    for vector in accepted() {
        println!("{}", vector.file());
        for (k, (payload, record)) in packets(&vector.bytes).into_iter().enumerate() {
            for at in payload {
                for change in [1, 0x80, 1 + splitmix64(k as u64, at as u64) as u8 % 254] {
                    let byte = vector.bytes[at] ^ change;
                    pmesh_decode(&in_envelope(&vector.bytes, record.clone(), at, &[byte]));
                }
            }
        }
    }
}

/// Where a change is accepted, the levels are those of both readers.
#[test]
fn both_readers_show_the_same_levels_of_changed_files() {
    for vector in accepted() {
        println!("{}", vector.file());
        let packets = packets(&vector.bytes);
        for n in 0..if packets.is_empty() { 0 } else { 60 } {
            let choose = |salt: u64, end: usize| (splitmix64(salt, n) % end as u64) as usize;
            let (payload, record) = packets[choose(1, packets.len())].clone();
            let at = payload.start + choose(2, payload.len());
            let byte = vector.bytes[at] ^ (1 << choose(3, 8));
            pmesh_lod(&in_envelope(&vector.bytes, record, at, &[byte]));
        }
    }
}

/// Packets that no writer would make, right and with a changed byte.
#[test]
fn both_readers_agree_on_packets_that_nobody_writes() {
    for seed in 0..400 {
        let data: Vec<u8> = (0..200).flat_map(|n| splitmix64(seed, n).to_le_bytes()).collect();
        pmesh_packets(&data);
    }
}

/// A packet whose vertices have as many wedges as they should, but others more and others fewer, is refused for what these become;
/// then the right one comes.
#[test]
fn wedges_of_a_refused_packet_leave_no_trace() {
    let vector = vectors().into_iter().find(|vector| vector.name == "0011-raw-attributes").unwrap();
    let Ok(Step::Consumed(_, header)) = Header::read(&vector.bytes, &Limits::default()) else {
        panic!("no header")
    };
    let mut replay = Replay::new(&header);
    let mut refused = 0;
    for (k, (payload, record)) in (0..).zip(packets(&vector.bytes)) {
        let mut parts = Parts::read(&header, k, &vector.bytes[payload.clone()]);
        let place = parts.wedge_counts.windows(2).position(|pair| pair[0] > pair[1]);
        if let (Some(place), false) = (place, parts.wedge_targets.is_empty()) {
            parts.wedge_counts.swap(place, place + 1);
            parts.wedge_targets[0] = 99;
            // Of the same length: numbers of one byte each.
            let lie = in_envelope(&vector.bytes, record.clone(), payload.start, &parts.payload());
            let lie = decode_packet(&header, k, &lie[record.clone()]).unwrap();
            assert!(replay.apply(&lie).is_err());
            refused += 1;
        }
        replay.apply(&decode_packet(&header, k, &vector.bytes[record]).unwrap()).unwrap();
    }
    assert!(refused > 0, "no packet has vertices with more and with fewer wedges");
    let mut whole = Replay::from_file(&vector.bytes, &Limits::default()).unwrap();
    for level in whole.levels().unwrap() {
        replay.set_level(level).unwrap();
        whole.set_level(level).unwrap();
        let unnamed = IndexedMesh { material_names: Vec::new(), ..whole.mesh() };
        assert_eq!(replay.mesh(), unnamed, "level {level}");
    }
}
