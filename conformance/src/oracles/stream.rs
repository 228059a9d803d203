//! Drives a push decoder as a caller does who owns the buffer, and notes all that can be seen.

use ivg_wire::{Error, Step, Verdict};

/// What one event shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Seen {
    /// A hash of everything in the event.
    pub digest: u64,
    /// Whether it is a record; the end record is none here.
    pub is_record: bool,
    /// Whether the file ends with this event.
    pub is_end: bool,
}

/// How a stream ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// With the end of a whole file.
    Complete,
    /// The decoder waits for more.
    NeedMore,
    /// The decoder refused the bytes.
    Refused(Error),
}

impl End {
    /// The verdict on the bytes.
    #[must_use]
    pub fn verdict(self) -> Verdict {
        match self {
            Self::Complete => Verdict::Ok,
            Self::NeedMore => Verdict::NeedMore,
            Self::Refused(error) => error.verdict(),
        }
    }
}

/// All that a caller sees of a stream; it must not depend on how the bytes arrived.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Transcript {
    /// A digest for each event.
    pub events: Vec<u64>,
    /// How many of the events are records; the end record is not counted.
    pub records: usize,
    /// Whether the last event was the end of the file; bytes behind it may have been refused still.
    pub has_ended: bool,
    /// Bytes that the events used.
    pub consumed: usize,
    /// How it ended.
    pub end: End,
}

/// Pushes `data` into a decoder, in pieces of the given lengths (a length of 0 counts as 1; after the last, the rest comes at
/// once).
///
/// # Panics
///
/// When the decoder breaks what every caller relies on: an event uses at least one byte and none that is not there; "need
/// more" names at least one byte; the same bytes after an error give the same error; an error lies inside the file's bytes.
pub fn transcribe(
    data: &[u8],
    pieces: impl IntoIterator<Item = usize>,
    mut push: impl FnMut(&[u8]) -> Result<Step<Seen>, Error>,
) -> Transcript {
    let mut pieces = pieces.into_iter();
    let mut next =
        |received: usize| pieces.next().map_or(data.len(), |length| data.len().min(received + length.max(1)));
    let mut transcript =
        Transcript { events: Vec::new(), records: 0, has_ended: false, consumed: 0, end: End::NeedMore };
    let mut received = next(0);
    loop {
        let window = &data[transcript.consumed..received];
        match push(window) {
            Ok(Step::NeedMore(more)) => {
                assert!(more > 0, "nothing more is needed, and yet there is no event");
                if received == data.len() {
                    return transcript;
                }
                received = next(received);
            }
            Ok(Step::Consumed(used, seen)) => {
                assert!(used > 0, "an event without bytes: a caller could wait for ever");
                assert!(used <= window.len(), "an event of {used} bytes, {} are there", window.len());
                transcript.consumed += used;
                transcript.events.push(seen.digest);
                transcript.records += usize::from(seen.is_record);
                transcript.has_ended = seen.is_end;
                if seen.is_end && transcript.consumed == data.len() {
                    transcript.end = End::Complete;
                    return transcript;
                }
                // What follows the end is invalid in a file, so the decoder must be asked about it; the bytes may not have
                // arrived yet.
                if transcript.consumed == received {
                    received = next(received);
                }
            }
            Err(error) => {
                assert_eq!(push(window).err(), Some(error), "the same bytes again, another answer");
                assert!(error.offset().0 <= data.len() as u64, "{error}: of {} bytes", data.len());
                transcript.end = End::Refused(error);
                return transcript;
            }
        }
    }
}

#[cfg(test)]
mod tests;
