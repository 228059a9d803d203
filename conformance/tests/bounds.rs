//! Memory and work of the reader of `.pmesh` on files that make it do as much as their bytes allow (PMESH-LIM-03, -04).

use conformance::bounds::{Bound, Budget};
use conformance::vectors::parts::{Parts, bits_for, file_of, packed};
use ivg_wire::Error;
use pmesh_format::{Limits, Replay, decode_all};

/// Vertices of the base of every file here.
const BASE: u32 = 3;

/// Vertices from `start` to `end` with these parents.
fn vertices(start: u32, end: u32, faces_before: u32, parent: impl Fn(u32) -> u32) -> Parts {
    Parts {
        arrays: vec![0; 12 * (end - start) as usize],
        parents: (start.max(BASE)..end).map(parent).collect(),
        parent_bits: bits_for(end),
        of: 3 * faces_before,
        ..Parts::default()
    }
}

fn base() -> Parts {
    Parts { corners: vec![[0, 1, 2]], ..vertices(0, BASE, 0, |_| 0) }
}

fn file(packets: Vec<(Parts, [u32; 2])>) -> Vec<u8> {
    let packets: Vec<_> = packets
        .into_iter()
        .map(|(parts, [vertices, faces])| (parts, [vertices, vertices, faces].map(|n| n as usize)))
        .collect();
    file_of(BASE as usize, 0, &packets)
}

/// A chain of vertices, each onto the one before, in one packet, with faces at its end: as deep as PMESH-SWI-07 allows.
fn deep() -> Vec<u8> {
    let end = 2000;
    let mut parts = vertices(BASE, end, 1, |v| v - 1);
    // Each new corner passes all vertices of the chain.
    let depth = u64::from(end - BASE);
    while (parts.corners.len() as u64 + 1) * depth <= 8 * (parts.payload().len() as u64 + 12) {
        parts.corners.push([0, 1, end - 1]);
    }
    let faces = 1 + parts.corners.len() as u32;
    file(vec![(base(), [BASE, 1]), (parts, [end, faces])])
}

/// A packet for each vertex, which takes the corner of one face and brings another.
fn one_by_one() -> Vec<u8> {
    let mut packets = vec![(base(), [BASE, 1])];
    for v in BASE..5000 {
        let parts = Parts {
            switch_count: 1,
            slots: vec![3 * (v - BASE)],
            corners: vec![[v, 1, 2]],
            ..vertices(v, v + 1, v - 2, |v| if v == BASE { 0 } else { v - 1 })
        };
        packets.push((parts, [v + 1, v - 1]));
    }
    file(packets)
}

/// Many faces, of which a second packet switches all corners at one vertex, to any of many.
fn hub() -> Vec<u8> {
    let (faces, end) = (4000, BASE + 1000);
    let first = Parts { corners: vec![[0, 1, 2]; faces as usize], ..vertices(0, BASE, 0, |_| 0) };
    let to: Vec<u32> = (0..faces).map(|k| k % (end - BASE)).collect();
    let second = Parts {
        switch_count: faces,
        slots: (0..faces).map(|face| 3 * face).collect(),
        switch_to: packed(&to, bits_for(end - BASE)),
        ..vertices(BASE, end, faces, |_| 0)
    };
    file(vec![(first, [BASE, faces]), (second, [end, faces])])
}

/// What the frame and the mesh may take together (COM-LIM-03, PMESH-LIM-03).
const STEPPED: Bound = Bound { fixed: 2 * 65_536, per_byte: 4 + 64 };
/// Before anybody steps: half of what is for the mesh is for the corners that steps change.
const LOADED: Bound = Bound { fixed: 2 * 65_536, per_byte: 4 + 32 };
/// Arrays grow fourfold, so that all that was ever allocated is at most 4/3 of what is held in the end, where that may be four times
/// what is used; and what a packet needs while it is read is no longer than the packet. Nothing may be allocated anew for each
/// packet in proportion to what was there before it.
const ALLOCATED: Bound = Bound { fixed: 2 * 65_536, per_byte: 2 * (4 + 64) };

#[test]
fn the_reader_keeps_within_its_bounds() {
    let loaded = Budget { held: LOADED, allocated: ALLOCATED };
    let stepped = Budget { held: STEPPED, allocated: ALLOCATED };
    for (name, file) in [("deep", deep()), ("one by one", one_by_one()), ("hub", hub())] {
        assert!(file.len() > 25_000, "{name} is so short that the constants hide what a byte costs");
        let read = |visit: &dyn Fn(&mut Replay)| {
            let mut replay = Replay::default();
            let read = decode_all(&file, &Limits::default(), |event| {
                replay.accept(&event)?;
                visit(&mut replay);
                Ok::<(), Error>(())
            });
            read.unwrap_or_else(|error| panic!("{name}: {error}"));
            replay
        };
        loaded.spend(&format!("{name}: loading"), file.len(), || drop(read(&|_| {})));
        stepped.spend(&format!("{name}: loading, then stepping"), file.len(), || {
            let mut replay = read(&|_| {});
            replay.set_level(BASE).unwrap();
            replay.set_level(replay.max_level()).unwrap();
        });
    }
}
