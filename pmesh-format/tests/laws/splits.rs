//! Any split of the bytes gives the same events, the same levels, and the same error at the same offset.

use crate::files::{Parts, levels, samples};
use pmesh_format::{BufferedDecoder, Decoder, Error, Event, Limits, Replay, Step, Verdict, check};
use quickcheck::{Arbitrary, Gen, quickcheck};

/// What a client has at its end: the events, all levels, the error or that bytes are missing.
type Seen = (Vec<String>, Vec<pmesh_format::IndexedMesh>, Result<(), Error>);

/// Feeds the bytes in pieces of the given lengths, the last one repeated.
fn in_pieces(bytes: &[u8], sizes: &[u8]) -> Seen {
    let mut decoder = BufferedDecoder::new(Limits::default());
    let (mut events, mut replay, mut fault) = (vec![], Replay::default(), None);
    let mut sizes = sizes.iter().chain(std::iter::repeat(sizes.last().unwrap_or(&255)));
    let mut rest = bytes;
    let mut end = Ok(());
    while !rest.is_empty() && end.is_ok() {
        let (piece, after) = rest.split_at(usize::from(*sizes.next().unwrap()).clamp(1, rest.len()));
        end = decoder.feed(piece, |event| {
            if fault.is_none() {
                events.push(format!("{event:?}"));
                fault = replay.accept(&event).err();
            }
        });
        rest = after;
    }
    // A client stops at the first error, whoever reports it.
    let end = match fault {
        Some(error) => Err(error),
        None => end.and_then(|()| decoder.finish()),
    };
    (events, levels(&mut replay), end)
}

/// Gives the decoder all bytes that are there.
fn at_once(bytes: &[u8]) -> Seen {
    let mut decoder = Decoder::new(Limits::default());
    let (mut events, mut replay, mut used) = (vec![], Replay::default(), 0);
    let end = loop {
        match decoder.push(&bytes[used..]) {
            Err(error) => break Err(error),
            Ok(Step::NeedMore(_)) => break check(bytes, &Limits::default()),
            Ok(Step::Consumed(more, event)) => {
                events.push(format!("{event:?}"));
                used += more;
                if let Err(error) = replay.accept(&event) {
                    break Err(error);
                }
                if event == Event::End && used == bytes.len() {
                    break Ok(());
                }
            }
        }
    };
    (events, levels(&mut replay), end)
}

/// A sample with some bytes changed, cut or lengthened, half of them with fitting checksums.
#[derive(Clone, Debug)]
struct Mutant(Vec<u8>);

impl Arbitrary for Mutant {
    fn arbitrary(g: &mut Gen) -> Self {
        let samples = samples();
        let file = g.choose(&samples).unwrap();
        let edits = *g.choose(&[0, 1, 1, 2]).unwrap();
        let mut bytes = if bool::arbitrary(g) {
            let mut parts = Parts::of(file);
            for _ in 0..edits {
                let Some(packet) =
                    (!parts.packets.is_empty()).then(|| usize::arbitrary(g) % parts.packets.len())
                else {
                    break;
                };
                let payload = &mut parts.packets[packet].1;
                let at = usize::arbitrary(g) % payload.len();
                payload[at] = u8::arbitrary(g);
            }
            parts.build()
        } else {
            let mut bytes = file.clone();
            for _ in 0..edits {
                let at = usize::arbitrary(g) % bytes.len();
                bytes[at] = u8::arbitrary(g);
            }
            bytes
        };
        match u8::arbitrary(g) % 4 {
            0 => bytes.truncate(usize::arbitrary(g) % (bytes.len() + 1)),
            1 => bytes.push(0),
            _ => {}
        }
        Self(bytes)
    }
}

#[test]
fn one_byte_at_a_time_is_the_same() {
    for file in samples() {
        assert_eq!(in_pieces(&file, &[1]), at_once(&file));
        assert_eq!(at_once(&file).2, Ok(()));
    }
}

#[test]
fn mutants_are_not_all_refused_and_not_all_accepted() {
    let mut g = Gen::new(100);
    let accepted = (0..400).filter(|_| at_once(&Mutant::arbitrary(&mut g).0).2.is_ok()).count();
    assert!((20..380).contains(&accepted), "{accepted} of 400 accepted");
}

/// COM-STR-01, COM-STR-02: at every length the verdict is "need more", and the levels are those of the whole packets.
#[test]
fn a_file_cut_anywhere_needs_more_and_shows_its_whole_packets() {
    for file in samples() {
        let whole = at_once(&file).0;
        let mut records = 0;
        for length in 0..file.len() {
            let (events, levels, end) = at_once(&file[..length]);
            let error = end.unwrap_err();
            assert_eq!((error.verdict(), error.offset().0), (Verdict::NeedMore, length as u64), "{error}");
            assert_eq!(events, whole[..events.len()]);
            let packets = events.iter().filter(|event| event.starts_with("Packet")).count();
            assert_eq!(packets > 0, !levels.is_empty() && events.len() > 1);
            assert!(packets >= records, "a packet is gone again");
            records = packets;
        }
    }
}

quickcheck! {
    fn any_split_gives_the_same_events_levels_and_error(mutant: Mutant, sizes: Vec<u8>) -> bool {
        in_pieces(&mutant.0, &sizes) == at_once(&mutant.0)
    }

    fn any_bytes_in_place_of_an_end_never_panic(bytes: Vec<u8>, keep: u16) -> bool {
        samples().into_iter().all(|mut file| {
            file.truncate(usize::from(keep) % file.len());
            file.extend(&bytes);
            at_once(&file).2.is_err()
        })
    }
}
