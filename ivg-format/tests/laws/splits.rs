//! Any split of the bytes gives the same events and the same error at the same offset.

use crate::files::{describe, edited, one_shot, samples};
use ivg_format::{BufferedDecoder, Decoder, Error, Limits, Step};
use quickcheck::{Arbitrary, Gen, quickcheck};

/// Feeds the bytes in pieces of the given sizes, the last one repeated.
fn in_pieces(bytes: &[u8], sizes: &[u8]) -> (Vec<String>, Option<Error>) {
    let mut events = vec![];
    let mut decoder = BufferedDecoder::new(Limits::default());
    let mut rest = bytes;
    let mut sizes = sizes.iter().chain(std::iter::repeat(sizes.last().unwrap_or(&1)));
    while !rest.is_empty() {
        let size = usize::from(*sizes.next().unwrap()).clamp(1, rest.len());
        let (piece, after) = rest.split_at(size);
        if let Err(error) = decoder.feed(piece, |event| events.push(describe(&event))) {
            return (events, Some(error));
        }
        rest = after;
    }
    (events, decoder.finish().err())
}

/// Gives the decoder never more bytes than it asks for.
fn as_asked(bytes: &[u8]) -> (Vec<String>, Option<Error>) {
    let mut events = vec![];
    let mut decoder = Decoder::new(Limits::default());
    let (mut start, mut end) = (0, 0);
    loop {
        match decoder.push(&bytes[start..end]) {
            Err(error) => return (events, Some(error)),
            Ok(Step::Consumed(used, event)) => {
                events.push(describe(&event));
                start += used;
            }
            Ok(Step::NeedMore(0)) if end < bytes.len() => end += 1,
            Ok(Step::NeedMore(0)) => return (events, None),
            Ok(Step::NeedMore(more)) if end + more > bytes.len() => {
                // What it asks for is not there; whatever is left must not complete anything.
                return match decoder.push(&bytes[start..]) {
                    Err(error) => (events, Some(error)),
                    Ok(step) => {
                        assert!(matches!(step, Step::NeedMore(_)), "asked for {more} bytes too many");
                        let mut buffered = BufferedDecoder::new(Limits::default());
                        buffered.feed(bytes, |_| {}).unwrap();
                        (events, buffered.finish().err())
                    }
                };
            }
            Ok(Step::NeedMore(more)) => end += more,
        }
    }
}

/// A sample with some bytes changed, cut and lengthened, half of them with fitting checksums.
#[derive(Clone, Debug)]
struct Mutant(Vec<u8>);

impl Arbitrary for Mutant {
    fn arbitrary(g: &mut Gen) -> Self {
        let samples = samples();
        let file = g.choose(&samples).unwrap();
        let edits: Vec<(usize, u8)> = (0..*g.choose(&[0, 1, 1, 2, 3]).unwrap())
            .map(|_| {
                // Headers and small fields deserve most of the edits.
                let range = if bool::arbitrary(g) { 160.min(file.len()) } else { file.len() };
                (usize::arbitrary(g) % range, u8::arbitrary(g))
            })
            .collect();
        let apply = |bytes: &mut [u8]| edits.iter().for_each(|&(at, value)| bytes[at] = value);
        let mut bytes = if bool::arbitrary(g) {
            edited(file, apply)
        } else {
            let mut bytes = file.clone();
            apply(&mut bytes);
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
        assert_eq!(in_pieces(&file, &[1]), one_shot(&file));
        assert_eq!(as_asked(&file), one_shot(&file));
    }
}

#[test]
fn mutants_are_not_all_refused_and_not_all_accepted() {
    // The property below would be empty otherwise.
    let mut g = Gen::new(100);
    let accepted = (0..400).filter(|_| one_shot(&Mutant::arbitrary(&mut g).0).1.is_none()).count();
    assert!((20..380).contains(&accepted), "{accepted} of 400 accepted");
}

#[test]
fn after_an_error_the_same_error_comes_again() {
    let mut bytes = samples().remove(0);
    bytes[200] ^= 1;
    let mut decoder = BufferedDecoder::new(Limits::default());
    let error = decoder.feed(&bytes, |_| {}).unwrap_err();
    for piece in [&[][..], &[1, 2, 3], &bytes] {
        let mut after = vec![];
        assert_eq!(decoder.feed(piece, |event| after.push(describe(&event))), Err(error));
        assert!(after.is_empty(), "{after:?} after an error");
    }
    assert_eq!(decoder.finish(), Err(error));
}

quickcheck! {
    fn any_split_gives_the_same_events_and_error(mutant: Mutant, sizes: Vec<u8>) -> bool {
        in_pieces(&mutant.0, &sizes) == one_shot(&mutant.0)
    }

    fn asking_for_bytes_gives_the_same_events_and_error(mutant: Mutant) -> bool {
        as_asked(&mutant.0) == one_shot(&mutant.0)
    }

    fn arbitrary_bytes_never_panic(bytes: Vec<u8>, keep: u8) -> bool {
        let mut file = samples().swap_remove(0);
        file.truncate(usize::from(keep));
        file.extend(bytes);
        one_shot(&file).1.is_some()
    }
}
