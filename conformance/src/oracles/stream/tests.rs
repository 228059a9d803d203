use super::{End, Seen, Transcript, transcribe};
use ivg_wire::{ByteOffset, Error, Part, Step, codes};

/// A toy: each event is a length and so many bytes, a length of 0 is the end.
fn toy(window: &[u8]) -> Result<Step<Seen>, Error> {
    match window {
        [] => Ok(Step::NeedMore(1)),
        [0, ..] => Ok(Step::Consumed(1, Seen { digest: 0, is_record: false, is_end: true })),
        [255, ..] => Err(Error::new(codes::RECORD_ID, ByteOffset(0), Part::Header)),
        [length, rest @ ..] => match rest.get(..usize::from(*length)) {
            None => Ok(Step::NeedMore(usize::from(*length) - rest.len())),
            Some(payload) => {
                let digest = payload.iter().map(|&byte| u64::from(byte)).sum();
                Ok(Step::Consumed(1 + payload.len(), Seen { digest, is_record: true, is_end: false }))
            }
        },
    }
}

const FILE: [u8; 8] = [2, 7, 8, 3, 1, 1, 1, 0];

#[test]
fn a_whole_file_in_any_pieces() {
    let expected = Transcript {
        events: vec![15, 3, 0],
        records: 2,
        has_ended: true,
        consumed: FILE.len(),
        end: End::Complete,
    };
    assert_eq!(transcribe(&FILE, [], toy), expected);
    assert_eq!(transcribe(&FILE, [0; 8], toy), expected);
    assert_eq!(transcribe(&FILE, [3, 4], toy), expected);
}

#[test]
fn a_prefix_ends_with_need_more() {
    let transcript = transcribe(&FILE[..5], [], toy);
    assert_eq!(
        transcript,
        Transcript { events: vec![15], records: 1, has_ended: false, consumed: 3, end: End::NeedMore }
    );
}

#[test]
fn a_refusal_is_the_end() {
    let transcript = transcribe(&[1, 9, 255, 0], [1, 1], toy);
    assert_eq!((transcript.events, transcript.consumed), (vec![9], 2));
    assert!(matches!(transcript.end, End::Refused(_)));
}

#[test]
fn a_decoder_that_sees_the_split_is_found() {
    let careless = |window: &[u8]| match toy(window)? {
        Step::NeedMore(_) if window.len() == 2 => {
            Ok(Step::Consumed(2, Seen { digest: 99, is_record: true, is_end: false }))
        }
        step => Ok(step),
    };
    assert_ne!(transcribe(&FILE, [1; 8], careless), transcribe(&FILE, [], careless));
}

#[test]
#[should_panic(expected = "an event without bytes")]
fn an_event_without_bytes_is_found() {
    transcribe(&FILE, [], |_| Ok(Step::Consumed(0, Seen { digest: 0, is_record: false, is_end: false })));
}

#[test]
#[should_panic(expected = "another answer")]
fn a_decoder_that_forgets_its_error_is_found() {
    let mut calls = 0;
    transcribe(&[255], [], |window| {
        calls += 1;
        if calls == 1 { toy(window) } else { Ok(Step::NeedMore(1)) }
    });
}
