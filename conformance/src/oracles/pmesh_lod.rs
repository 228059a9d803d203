//! What must hold of the levels of a `.pmesh`.

use super::PIECE_CHOICES;
use super::pmesh::reference;
use crate::reference::Reference;
use pmesh_format::{
    BufferedDecoder, Header, IndexedMesh, LevelChange, Limits, Replay, check_level, decode_packet,
};

/// How many levels are visited.
const VISITS: usize = 12;

/// The mesh at a level does not depend on the way there, nor on how many packets have arrived; it is valid, and that of the second
/// reader; and what a change of level reports is all that a copy of the index buffer needs.
///
/// The last bytes of the input, which lie behind the file or in its end record, choose the levels.
///
/// # Panics
///
/// When that does not hold.
pub fn pmesh_lod(data: &[u8]) {
    pmesh_lod_as(data, Replay::mesh);
}

/// As [`pmesh_lod`], with the meshes that `shown` makes of the levels that are visited.
pub(super) fn pmesh_lod_as(data: &[u8], shown: impl Fn(&Replay) -> IndexedMesh) {
    let Some(mut whole) = replay_all(data) else { return };
    let choices = &data[data.len() - data.len().min(PIECE_CHOICES)..];
    let levels = choices.iter().cycle().take(VISITS).map(|&choice| u32::from(choice));

    let packets = whole.packets();
    let header = whole.header().clone();
    let reference = referenced(data, &header, packets);
    let mut partial = Replay::default();
    let mut copy = Vec::new();
    let mut visit = |replay: &mut Replay, change: &LevelChange| {
        update(&mut copy, replay, change);
        let level = replay.level();
        let mesh = shown(replay);
        check_level(&mesh).unwrap_or_else(|fault| panic!("level {level}: {fault}"));
        assert_eq!(mesh.positions.len() as u32, level);
        assert_eq!(mesh, at_level(&mut whole, level), "level {level} depends on the way there");
        if let Some(reference) = &reference {
            let unnamed = IndexedMesh { material_names: Vec::new(), ..mesh };
            assert_eq!(reference.level(level), Some(unnamed), "level {level} for the second reader");
        }
    };
    feed(data, |event| {
        if partial.packets() == packets {
            return;
        }
        let Some(change) = partial.accept(event).expect("it was accepted before") else { return };
        visit(&mut partial, &change);
        for choice in levels.clone() {
            let range = partial.levels().expect("a packet is in");
            let level = range.start() + choice % (range.end() - range.start() + 1);
            let change = partial.set_level(level).expect("a level that is there");
            assert_eq!(change.to, level);
            visit(&mut partial, &change);
        }
    });
}

/// The second reader with the first packets of the file, which have been accepted; `None` if they are too many for it.
fn referenced<'a>(data: &[u8], header: &'a Header, packets: u32) -> Option<Reference<'a>> {
    let mut reference = reference(header, data)?;
    for k in 0..packets {
        let range = header.packet_range(k);
        let packet = decode_packet(header, k, &data[range.start as usize..range.end as usize]);
        let taken = reference.take(packet.expect("it was accepted before").payload());
        assert_eq!(taken, Ok(()), "packet {k} is refused by the second reader");
    }
    Some(reference)
}

/// The mesh at a level, reached from below: from the coarsest level.
fn at_level(replay: &mut Replay, level: u32) -> IndexedMesh {
    let coarsest = *replay.levels().expect("packets are in").start();
    replay.set_level(coarsest).expect("the coarsest level");
    replay.set_level(level).expect("a level of the whole file");
    replay.mesh()
}

/// Does to a copy of the index buffer what a renderer does that copies only what is said to have changed.
fn update(copy: &mut Vec<[u32; 3]>, replay: &Replay, change: &LevelChange) {
    let indices = replay.indices();
    copy.resize(indices.len(), [u32::MAX; 3]);
    for range in &change.changed {
        let range = range.start as usize..range.end as usize;
        copy[range.clone()].copy_from_slice(&indices[range]);
    }
    assert_eq!(copy, indices, "a change from level {} to {} is incomplete", change.from, change.to);
}

/// All valid packets of the file replayed; `None` if there is none.
fn replay_all(data: &[u8]) -> Option<Replay> {
    let mut replay = Replay::default();
    let mut is_sound = true;
    feed(data, |event| is_sound = is_sound && replay.accept(event).is_ok());
    (replay.packets() > 0).then_some(replay)
}

/// Shows the events of the file up to the first error.
fn feed(data: &[u8], mut visit: impl FnMut(&pmesh_format::Event<'_>)) {
    // An error ends the file; what came before it counts.
    let _: Result<(), _> = BufferedDecoder::new(Limits::default()).feed(data, |event| visit(&event));
}
