//! Prefix tables: what a reader knows after each number of bytes of a file. They are made from where the records lie, not by
//! pushing bytes into a decoder.

use super::{Format, Vector, ivg, pmesh};
use ivg_wire::Verdict;

/// What is known after so many bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PrefixRow {
    /// The fewest bytes that the row is about.
    pub from: usize,
    /// The most bytes that the row is about.
    pub to: usize,
    /// The verdict on so many bytes.
    pub verdict: Verdict,
    /// Whole records; the end record is not counted.
    pub records: usize,
}

/// The table of an accepted vector, from no bytes to all.
#[must_use]
pub fn prefix_rows(vector: &Vector) -> Vec<PrefixRow> {
    let mut records = match vector.format {
        Format::Ivg => ivg::records(&vector.bytes),
        Format::Pmesh => pmesh::records(&vector.bytes),
    };
    // The end record is not counted.
    records.pop();
    let ends = records.into_iter().map(|(_, range)| range.end);
    let length = vector.bytes.len();
    let mut rows = Vec::new();
    let mut from = 0;
    for (records, end) in ends.enumerate() {
        rows.push(PrefixRow { from, to: end - 1, verdict: Verdict::NeedMore, records });
        from = end;
    }
    let records = rows.len();
    rows.push(PrefixRow { from, to: length - 1, verdict: Verdict::NeedMore, records });
    rows.push(PrefixRow { from: length, to: length, verdict: Verdict::Ok, records });
    rows
}

/// A table as text: columns separated by tabs.
#[must_use]
pub fn table(rows: &[PrefixRow]) -> String {
    let lines = rows
        .iter()
        .map(|PrefixRow { from, to, verdict, records }| format!("{from}\t{to}\t{verdict}\t{records}\n"));
    "from\tto\tverdict\trecords\n".to_owned() + &lines.collect::<String>()
}
