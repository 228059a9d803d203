//! Prefix tables: what a reader knows after each number of bytes of a file. They are made from where the records lie, not by
//! pushing bytes into a decoder.

use super::{Format, Vector, ivg, pmesh};
use ivg_wire::Verdict;
use std::fmt::Write;

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

/// The table of a vector, from no bytes to all; `None` for a vector that has none.
#[must_use]
pub fn prefix_rows(vector: &Vector) -> Option<Vec<PrefixRow>> {
    let ends = match vector.format {
        Format::Ivg if ivg::PREFIX_VECTORS.contains(&vector.name.as_str()) => ivg::record_ends(&vector.bytes),
        Format::Pmesh if pmesh::PREFIX_VECTORS.contains(&vector.name.as_str()) => {
            pmesh::record_ends(&vector.bytes)
        }
        _ => return None,
    };
    let length = vector.bytes.len();
    let mut rows = Vec::new();
    let mut from = 0;
    for (records, end) in ends.into_iter().enumerate() {
        rows.push(PrefixRow { from, to: end - 1, verdict: Verdict::NeedMore, records });
        from = end;
    }
    let records = rows.len();
    rows.push(PrefixRow { from, to: length - 1, verdict: Verdict::NeedMore, records });
    rows.push(PrefixRow { from: length, to: length, verdict: Verdict::Ok, records });
    Some(rows)
}

/// Names and texts of all tables: columns separated by tabs.
pub(super) fn tables(vectors: &[Vector]) -> Vec<(String, String)> {
    let table = |vector: &Vector| {
        let mut text = "from\tto\tverdict\trecords\n".to_owned();
        for PrefixRow { from, to, verdict, records } in prefix_rows(vector)? {
            writeln!(text, "{from}\t{to}\t{verdict}\t{records}").expect("a string takes everything");
        }
        Some((format!("{}-{}.tsv", vector.format.name(), vector.name), text))
    };
    vectors.iter().filter_map(table).collect()
}
