//! What must hold of raw `.pmesh` packets that no writer would make.

use super::{pmesh_decode, pmesh_lod};
use crate::choices::Choices;
use crate::invented::invented;
use crate::vectors::edit::in_envelope;
use pmesh_format::{Header, Limits, Step};

/// Bytes of a record before its payload.
const RECORD_HEAD: usize = 8;

/// A file of packets made of the bytes, which break no rule, and the same with one byte of a packet changed: what holds for any
/// bytes, and the levels are those of the second reader.
///
/// # Panics
///
/// When that does not hold.
pub fn pmesh_packets(data: &[u8]) {
    let mut choices = Choices::new(data);
    let (packet, place, change) = (choices.byte(), choices.word(), choices.byte());
    let file = invented(&mut choices);
    read(&file, choices.clone());
    let Ok(Step::Consumed(_, header)) = Header::read(&file, &Limits::default()) else {
        panic!("the header of an invented file is refused")
    };
    let k = u32::from(packet) % header.packet_count();
    let range = header.packet_range(k);
    let record = range.start as usize..range.end as usize;
    let at = record.start + RECORD_HEAD + (place % header.packets[k as usize].payload_bytes) as usize;
    let byte = file[at] ^ change.max(1);
    read(&in_envelope(&file, record, at, &[byte]), choices);
}

/// Packets, and levels that further choices choose.
fn read(file: &[u8], choices: Choices<'_>) {
    pmesh_decode(file);
    pmesh_lod(&[file, choices.rest()].concat());
}
