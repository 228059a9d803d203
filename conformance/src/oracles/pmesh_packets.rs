//! What must hold of raw `.pmesh` packets that no writer would make.

use super::{pmesh_decode, pmesh_lod};
use crate::choices::Choices;
use crate::invented::invented;
use crate::vectors::edit::in_envelope;
use pmesh_format::{Header, Limits, Replay, Step, decode_packet};

/// Bytes of a record before its payload.
const RECORD_HEAD: usize = 8;

/// Bytes that are changed, at most: which rule is judged first shows with several.
const MOST_CHANGES: usize = 3;

/// A file of packets made of the bytes, which break no rule, and the same with some bytes of a packet changed: what holds for any
/// bytes, and the levels are those of the second reader.
///
/// # Panics
///
/// When that does not hold.
pub fn pmesh_packets(data: &[u8]) {
    let mut choices = Choices::new(data);
    let packet = choices.byte();
    let changes = 1 + choices.below(MOST_CHANGES);
    let changes = [0; MOST_CHANGES].map(|_: u8| (choices.word(), choices.byte())).into_iter().take(changes);
    let file = invented(&mut choices);
    read(&file, choices.clone());
    let Ok(Step::Consumed(_, header)) = Header::read(&file, &Limits::default()) else {
        panic!("the header of an invented file is refused")
    };
    let k = u32::from(packet) % header.packet_count();
    let range = header.packet_range(k);
    let record = range.start as usize..range.end as usize;
    let changed = changes.fold(file.clone(), |file, (place, change)| {
        let at = record.start + RECORD_HEAD + (place % header.packets[k as usize].payload_bytes) as usize;
        let byte = file[at] ^ change.max(1);
        in_envelope(&file, record.clone(), at, &[byte])
    });
    read(&changed, choices);
    recover(&header, &file, &changed, k);
}

/// A packet that is refused leaves no trace: the right one can follow, and everything is as it would be without the other
/// (PMESH-LVL-04).
fn recover(header: &Header, file: &[u8], changed: &[u8], k: u32) {
    let packet = |file: &'_ [u8], k: u32| -> Vec<u8> {
        let range = header.packet_range(k);
        file[range.start as usize..range.end as usize].to_vec()
    };
    let (mut replay, mut other) = (Replay::new(header), Replay::new(header));
    for j in 0..header.packet_count() {
        let lie = packet(changed, j);
        let refused =
            decode_packet(header, j, &lie).is_ok_and(|lie| j == k && replay.clone().apply(&lie).is_err());
        if refused {
            let before = (replay.packets(), replay.levels(), replay.mesh());
            let lie = decode_packet(header, j, &lie).expect("read before");
            replay.apply(&lie).expect_err("refused before");
            assert_eq!(before, (replay.packets(), replay.levels(), replay.mesh()), "after a refused packet");
        }
        let right = packet(file, j);
        let right = decode_packet(header, j, &right).expect("an invented packet");
        let (found, expected) = (replay.apply(&right), other.apply(&right));
        assert_eq!(found, expected, "packet {j} after one that was refused");
        if found.is_err() {
            return;
        }
    }
    for level in other.levels().into_iter().flatten().rev() {
        let (found, expected) = (replay.set_level(level), other.set_level(level));
        assert_eq!(found, expected);
        assert_eq!(replay.mesh(), other.mesh(), "level {level} after a refused packet");
    }
}

/// Packets, and levels that further choices choose.
fn read(file: &[u8], choices: Choices<'_>) {
    pmesh_decode(file);
    pmesh_lod(&[file, choices.rest()].concat());
}
