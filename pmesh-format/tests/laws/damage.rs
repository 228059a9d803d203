//! Damage on the way: checksums find every changed byte, and what came before it stays.

use crate::files::{header, levels, replayed, samples};
use pmesh_format::{Decoder, Limits, Replay, Step, Verdict};

/// Reads until the error; the levels that are there.
fn read(file: &[u8]) -> (Replay, Option<pmesh_format::Error>) {
    let mut replay = Replay::default();
    let mut decoder = Decoder::new(Limits::default());
    let mut rest = file;
    loop {
        match decoder.push(rest) {
            Err(error) => return (replay, Some(error)),
            Ok(Step::NeedMore(_)) => return (replay, None),
            Ok(Step::Consumed(used, event)) => {
                rest = &rest[used..];
                if let Err(error) = replay.accept(&event) {
                    return (replay, Some(error));
                }
            }
        }
    }
}

#[test]
fn any_flipped_bit_is_refused_and_the_packets_before_it_stay() {
    for file in samples() {
        let header = header(&file);
        for at in 0..file.len() {
            for bit in 0..8 {
                let mut changed = file.clone();
                changed[at] ^= 1 << bit;
                let (mut replay, error) = read(&changed);
                let error = error.unwrap_or_else(|| panic!("bit {bit} of byte {at}: nobody noticed"));
                assert!(
                    matches!(error.verdict(), Verdict::Invalid | Verdict::Unsupported),
                    "byte {at}: {error}"
                );
                assert!(error.offset().0 < file.len() as u64);
                let whole = (0..header.packet_count())
                    .take_while(|&k| {
                        header.packet_range(k).end <= at as u64 && header.data_offset <= at as u64
                    })
                    .count();
                assert_eq!(replay.packets() as usize, whole, "bit {bit} of byte {at}: {error}");
                // Without a packet there may not even be a header.
                if bit == 0 && whole > 0 {
                    assert_eq!(levels(&mut replay), levels(&mut replayed(&file, whole as u32)));
                }
            }
        }
    }
}
