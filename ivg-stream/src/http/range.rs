//! `Range` and `Content-Range`, RFC 9110 sections 14.1 to 14.4.

use std::ops::Range;

/// What a `Range` field asks of a representation of known length.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Asked {
    /// The field is absent, malformed, of another unit, or names several ranges: the whole is sent, as RFC 9110
    /// section 14.2 allows.
    Whole,
    /// These bytes, never empty, inside the representation.
    Part(Range<u64>),
    /// No byte of the representation: status 416.
    Unsatisfiable,
}

/// Reads a `Range` field for a representation of `length` bytes.
pub(crate) fn parse_range(field: &str, length: u64) -> Asked {
    let Some((unit, set)) = field.split_once('=') else { return Asked::Whole };
    let set = set.trim();
    if !unit.trim().eq_ignore_ascii_case("bytes") || set.contains(',') {
        return Asked::Whole;
    }
    let Some((first, last)) = set.split_once('-') else { return Asked::Whole };
    if first.is_empty() {
        return match decimal(last) {
            None => Asked::Whole,
            Some(_) if length == 0 => Asked::Unsatisfiable,
            Some(0) => Asked::Unsatisfiable,
            Some(suffix) => Asked::Part(length.saturating_sub(suffix)..length),
        };
    }
    let Some(first) = decimal(first) else { return Asked::Whole };
    let last = if last.is_empty() {
        u64::MAX
    } else {
        match decimal(last) {
            Some(last) if last >= first => last,
            _ => return Asked::Whole,
        }
    };
    if first >= length {
        Asked::Unsatisfiable
    } else {
        Asked::Part(first..last.saturating_add(1).min(length))
    }
}

/// A `Content-Range` field of a 206 answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ContentRange {
    /// The bytes that follow; never empty.
    pub(crate) bytes: Range<u64>,
    /// Length of the whole representation, unless the server does not say.
    pub(crate) total: Option<u64>,
}

/// Reads the `Content-Range` field of a 206 answer; `None` if it is malformed.
pub(crate) fn parse_content_range(field: &str) -> Option<ContentRange> {
    let (unit, rest) = field.split_once(' ')?;
    let (range, total) = rest.trim().split_once('/')?;
    let (first, last) = range.split_once('-')?;
    let bytes = decimal(first)?..decimal(last)?.checked_add(1)?;
    let total = if total == "*" { None } else { Some(decimal(total)?) };
    let inside = total.is_none_or(|total| bytes.end <= total);
    (unit.eq_ignore_ascii_case("bytes") && bytes.start < bytes.end && inside)
        .then_some(ContentRange { bytes, total })
}

/// Digits only: `u64::from_str` would also take a plus sign.
fn decimal(text: &str) -> Option<u64> {
    (!text.is_empty() && text.bytes().all(|b| b.is_ascii_digit())).then(|| text.parse().ok()).flatten()
}

#[cfg(test)]
mod tests;
