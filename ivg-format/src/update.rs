//! Updates: records that come again with a higher generation (`spec/ivg.md`, "Updates").

use crate::decode::{Event, decode_record};
use crate::header::{Header, RecordId};
use crate::limits::Limits;
use alloc::collections::BTreeMap;
use core::cmp::Ordering;
use core::fmt;
use ivg_wire::{ByteOffset, ContentId, Error, Part, Step};

/// What a record that arrives is to a reader that may hold another generation of it (IVG-UPD-03).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Arrival {
    /// The first of this id.
    New,
    /// A higher generation: it replaces all that the record brought before.
    Newer,
    /// The same generation again, which is the same content (IVG-UPD-02): it changes nothing.
    Same,
    /// A lower generation: it is ignored.
    Stale,
}

impl Arrival {
    /// A record of `generation` where `held` is held.
    fn of(held: Option<u32>, generation: u32) -> Self {
        match held.map(|held| generation.cmp(&held)) {
            None => Self::New,
            Some(Ordering::Greater) => Self::Newer,
            Some(Ordering::Equal) => Self::Same,
            Some(Ordering::Less) => Self::Stale,
        }
    }
}

/// Which generation of each record of a file a reader holds, so that stale ones are told from newer ones in whatever
/// order they arrive.
///
/// Memory: two u32 and the overhead of a `BTreeMap` for each record *seen*, less than the 12 bytes of a record's own
/// envelope twice over; what a file declares costs nothing.
///
/// ```
/// use ivg_format::{Arrival, ContentId, Generations, RecordId};
///
/// let (file, id) = (ContentId(7), RecordId::Bundle(1));
/// let mut held = Generations::new();
/// assert_eq!(held.admit(file, id, 0), Arrival::New);
/// assert_eq!(held.admit(file, id, 2), Arrival::Newer);
/// assert_eq!(held.admit(file, id, 1), Arrival::Stale);
/// assert_eq!(held.generation(id), Some(2));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Generations {
    file: Option<ContentId>,
    held: BTreeMap<RecordId, u32>,
}

impl Generations {
    /// Nothing held.
    #[must_use]
    pub const fn new() -> Self {
        Self { file: None, held: BTreeMap::new() }
    }

    /// Says what a record of the file `file` is to what is held, and holds it from now on unless it is stale. A record
    /// of another file than those before begins anew: its generations have nothing to do with theirs.
    pub fn admit(&mut self, file: ContentId, id: RecordId, generation: u32) -> Arrival {
        if self.file.replace(file).is_some_and(|before| before != file) {
            self.held.clear();
        }
        let arrival = Arrival::of(self.generation(id), generation);
        if arrival != Arrival::Stale {
            self.held.insert(id, generation);
        }
        arrival
    }

    /// The file whose records are held, once one was admitted.
    #[must_use]
    pub const fn file(&self) -> Option<ContentId> {
        self.file
    }

    /// The generation held of a record, if any.
    #[must_use]
    pub fn generation(&self, id: RecordId) -> Option<u32> {
        self.held.get(&id).copied()
    }

    /// Number of records of which a generation is held.
    #[must_use]
    pub fn len(&self) -> usize {
        self.held.len()
    }

    /// Whether nothing is held.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.held.is_empty()
    }
}

/// Why a record cannot take the place of another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum UpdateError {
    /// The file, the record in it or the new record is not valid.
    Format(Error),
    /// The bundle lists other vertices than the one in its place (IVG-UPD-01).
    OtherVertices {
        /// Which bundle, counted from 1.
        bundle: u32,
    },
    /// A validity record or the end record, which are never replaced (IVG-UPD-01).
    NeverReplaced {
        /// Which record.
        id: RecordId,
    },
}

impl From<Error> for UpdateError {
    fn from(error: Error) -> Self {
        Self::Format(error)
    }
}

impl fmt::Display for UpdateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Format(error) => error.fmt(f),
            Self::OtherVertices { bundle } => {
                write!(f, "bundle {bundle} lists other vertices than the one in its place; write a new file")
            }
            Self::NeverReplaced { id } => {
                write!(f, "record {:#x} is never replaced; write a new file", id.stored())
            }
        }
    }
}

impl core::error::Error for UpdateError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Format(error) => Some(error),
            _ => None,
        }
    }
}

/// Puts a record in the place of the one with its id in a whole file, if it is newer; the file is as before otherwise.
/// [`encode_record`](crate::encode_record) makes such records.
///
/// # Errors
///
/// [`UpdateError`]; the file is as before then.
pub fn replace_record(file: &mut [u8], record: &[u8], limits: &Limits) -> Result<Arrival, UpdateError> {
    let header = match Header::read(file, limits)? {
        Step::Consumed(_, header) => header,
        Step::NeedMore(_) => return Err(truncated(file.len(), Part::Header).into()),
    };
    let Some(stored) = record.first_chunk() else {
        return Err(truncated(record.len(), Part::Record(0)).into());
    };
    let id = RecordId::from_stored(u32::from_le_bytes(*stored));
    let part = Part::Record(id.stored());
    let new = decode_record(&header, id, record)?;
    let range = header.record_range(id);
    let length = file.len();
    let in_place = usize::try_from(range.start).ok().zip(usize::try_from(range.end).ok());
    let Some(place) = in_place.and_then(|(start, end)| file.get_mut(start..end)) else {
        return Err(truncated(length, part).into());
    };
    let old = decode_record(&header, id, place)?;
    let arrival = match (&new, &old) {
        (Event::Corners(new) | Event::Bundle(new), Event::Corners(old) | Event::Bundle(old)) => {
            if let RecordId::Bundle(bundle) = id
                && new.index() != old.index()
            {
                return Err(UpdateError::OtherVertices { bundle });
            }
            Arrival::of(Some(old.generation()), new.generation())
        }
        _ => return Err(UpdateError::NeverReplaced { id }),
    };
    if arrival == Arrival::Newer {
        place.copy_from_slice(record);
    }
    Ok(arrival)
}

fn truncated(length: usize, part: Part) -> Error {
    Error::truncated(ByteOffset(length as u64), part)
}
