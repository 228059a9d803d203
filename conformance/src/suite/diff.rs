//! How a file is made of its twin: the recipe, computed by comparing the two.

use super::fields::{Envelope, Field, chunks, envelopes, fields, fits, header_bytes};
use crate::vectors::Format;
use conformance_runner::hex;
use conformance_runner::manifest::{Edit, Recipe};
use std::ops::Range;

/// Where a file is longer or shorter than its twin: there its bytes have another place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shift {
    /// Where bytes come in, or go, in the twin.
    at: usize,
    /// Bytes of the twin that go.
    deleted: usize,
    /// Bytes that come.
    inserted: usize,
}

impl Shift {
    /// The one place that leaves fewest bytes different elsewhere; of equals, one where a field begins.
    fn between(twin: &[u8], file: &[u8], fields: &[Field]) -> Self {
        let (deleted, inserted) =
            (twin.len().saturating_sub(file.len()), file.len().saturating_sub(twin.len()));
        let most = twin.len().min(file.len());
        let differs = |a: usize, b: usize| usize::from(twin.get(a) != file.get(b));
        // Bytes that differ before each place, if nothing has moved; and from it on, if everything has.
        let mut before = vec![0];
        (0..most).for_each(|n| before.push(before[n] + differs(n, n)));
        let mut behind = vec![0; most + 1];
        for n in (0..most).rev() {
            behind[n] = behind[n + 1] + differs(n + deleted, n + inserted);
        }
        let starts = |at: usize| fields.binary_search_by_key(&at, |field| field.range.start).is_ok();
        let at = (0..=most).min_by_key(|&at| (before[at] + behind[at], !starts(at), at)).unwrap_or(0);
        Self { at, deleted, inserted }
    }

    /// Where an envelope of the twin lies in the file; `None` if part of it is gone.
    fn moved(self, range: &Range<usize>) -> Option<Range<usize>> {
        let place = |at: usize, end: bool| match at {
            at if at < self.at || at == self.at && end => Some(at),
            at if at >= self.at + self.deleted => Some(at - self.deleted + self.inserted),
            _ => None,
        };
        Some(place(range.start, false)?..place(range.end, true)?).filter(|range| range.len() >= 4)
    }
}

/// The recipe of a file, and the checksums in it that do not fit.
pub(super) fn compare(format: Format, from: &str, twin: &[u8], file: &[u8]) -> (Recipe, Vec<String>) {
    let fields = fields(format, twin);
    let shift = Shift::between(twin, file, &fields);
    let mut edits = Vec::new();
    for field in &fields {
        edits.extend(in_field(twin, file, field, shift));
    }
    if shift.deleted + shift.inserted > 0 {
        let insert = &file[shift.at..shift.at + shift.inserted];
        let (insert, repeat) = unit(insert);
        edits.push(Edit {
            at: shift.at as u64,
            delete: shift.deleted as u64,
            insert: hex(insert),
            repeat,
            field: place(&fields, shift),
        });
    }
    edits.sort_by_key(|edit| (edit.at, edit.delete));
    let (made_anew, wrong) = checksums(format, twin, file, shift);
    (Recipe { from: from.to_owned(), edits, checksums: made_anew }, wrong)
}

/// The shortest beginning that repeats to the whole, where that saves much.
fn unit(bytes: &[u8]) -> (&[u8], Option<u32>) {
    if bytes.len() < 256 {
        return (bytes, None);
    }
    let repeats = |length: &usize| {
        bytes.len().is_multiple_of(*length) && bytes[*length..] == bytes[..bytes.len() - length]
    };
    match (1..=64).find(repeats) {
        Some(length) => (&bytes[..length], u32::try_from(bytes.len() / length).ok()),
        None => (bytes, None),
    }
}

fn place(fields: &[Field], shift: Shift) -> String {
    match fields.iter().find(|field| field.range.contains(&shift.at)) {
        Some(field) if shift.deleted > field.range.len() => format!("{} and what follows", field.name),
        Some(field) if field.range.start == shift.at && shift.inserted > 0 => {
            format!("before {}", field.name)
        }
        Some(field) => field.name.clone(),
        None => "behind the end".to_owned(),
    }
}

/// Fields of at most so many bytes are replaced as a whole; in longer ones, runs so near to each other are one.
const WHOLE: usize = 8;
const NEAR: usize = 4;
/// A field with more runs than this is replaced from the first to the last.
const RUNS: usize = 8;

/// What differs in a field, the shift aside.
fn in_field(twin: &[u8], file: &[u8], field: &Field, shift: Shift) -> Vec<Edit> {
    let end = shift.at + shift.deleted;
    // The field's bytes that are there in both, each with its place in the file.
    let places = field.range.clone().filter_map(|at| match at {
        at if at < shift.at => Some((at, at)),
        at if at >= end => Some((at, at - shift.deleted + shift.inserted)),
        _ => None,
    });
    let places: Vec<(usize, usize)> = places.collect();
    let mut runs: Vec<Range<usize>> = Vec::new();
    for (n, &(a, b)) in places.iter().enumerate() {
        if twin[a] == file[b] {
            continue;
        }
        match runs.last_mut() {
            Some(run) if n < run.end + NEAR => run.end = n + 1,
            _ => runs.push(n..n + 1),
        }
    }
    if let (Some(first), Some(last)) = (runs.first().cloned(), runs.last().cloned()) {
        if places.len() <= WHOLE {
            runs.clear();
            runs.push(0..places.len());
        } else if runs.len() > RUNS {
            runs.clear();
            runs.push(first.start..last.end);
        }
    }
    let mut edits = Vec::new();
    for run in runs {
        // An edit does not reach over the place where bytes come in or go.
        let cut = places.iter().position(|&(a, _)| a >= shift.at).unwrap_or(0).clamp(run.start, run.end);
        for part in [run.start..cut, cut..run.end] {
            let Some(&(at, in_file)) = places.get(part.start).filter(|_| !part.is_empty()) else { continue };
            let offset = at - field.range.start;
            let name = if offset == 0 || field.range.len() <= WHOLE {
                field.name.clone()
            } else {
                format!("{} + {offset}", field.name)
            };
            edits.push(Edit {
                at: at as u64,
                delete: part.len() as u64,
                insert: hex(&file[in_file..in_file + part.len()]),
                repeat: None,
                field: name,
            });
        }
    }
    edits
}

/// Checksums that are other than the twin's and fit, and those that do not fit.
fn checksums(format: Format, twin: &[u8], file: &[u8], shift: Shift) -> (Vec<String>, Vec<String>) {
    let (mut made_anew, mut wrong) = (Vec::new(), Vec::new());
    // Behind a byte that is missing from the signature nothing has a place.
    if file.len() < 8 || shift.at < header_bytes(twin).min(32) && shift.deleted + shift.inserted > 0 {
        return (made_anew, wrong);
    }
    for envelope in envelopes(format, twin) {
        let Some(mut range) = shift.moved(&envelope.range) else { continue };
        if envelope.name == "header" {
            range.end = header_bytes(file);
        }
        let Envelope { name, range: old } = envelope;
        if range.end > file.len() {
            continue;
        }
        let stored = |bytes: &[u8], range: &Range<usize>| match name.as_str() {
            "header" => bytes[28..32].to_vec(),
            _ => bytes[range.end - 4..range.end].to_vec(),
        };
        let is_new = stored(twin, &old) != stored(file, &range);
        match fits(file, &Envelope { range, name: name.clone() }) {
            false => wrong.push(name),
            true if is_new => made_anew.push(name),
            true => {}
        }
    }
    for chunk in chunks(file, shift.at, shift.at + shift.inserted) {
        if !fits(file, &chunk) {
            wrong.push(chunk.name);
        }
    }
    (made_anew, wrong)
}
