//! What a decoder must have to come to the verdict on a file: found by asking for something that nobody has.

use super::shown::{grid, mesh};
use crate::vectors::{Format, edit};
use conformance_runner::manifest::Needs;
use ivg_format::{Encoding, Order, codes as ivg};
use pmesh_format::codes as pmesh;

/// Places in the headers (`spec/tables/ivg.toml`, `spec/tables/pmesh.toml`).
const ENCODING_AT: usize = 62;
const ORDER_AT: usize = 112;
const MODE_AT: usize = 76;
/// A registry value that is reserved.
const NOBODY_HAS: u8 = 200;

/// What `data` needs: where a reader that lacks it would say so, rather than what the test expects.
pub(super) fn needs(format: Format, data: &[u8]) -> Needs {
    let asked = |at: usize, code: u16| {
        if data.len() < super::fields::header_bytes(data).max(edit::FILE_BYTES_AT + 8) {
            return false;
        }
        let header = super::fields::Envelope {
            range: 0..super::fields::header_bytes(data),
            name: "header".to_owned(),
        };
        if header.range.len() <= at || !super::fields::fits(data, &header) {
            return false;
        }
        let other = edit::in_header(data, at, &[NOBODY_HAS]);
        let shown = match format {
            Format::Ivg => grid(&other, &[]),
            Format::Pmesh => mesh(&other, &[], None),
        };
        shown.error.is_some_and(|error| error.code() == code)
    };
    let value = |at: usize| u16::from(data[at]) | u16::from(data[at + 1]) << 8;
    match format {
        Format::Ivg => Needs {
            encoding: asked(ENCODING_AT, ivg::ENCODING_UNKNOWN.number())
                .then(|| Encoding::from_id(value(ENCODING_AT)).map(|encoding| encoding.name().to_owned()))
                .flatten(),
            order: asked(ORDER_AT, ivg::ORDER_UNKNOWN.number())
                .then(|| Order::from_id(value(ORDER_AT)).map(|order| order.name().to_owned()))
                .flatten(),
            mode: None,
        },
        Format::Pmesh => Needs {
            mode: asked(MODE_AT, pmesh::MODE_UNKNOWN.number())
                .then(|| match data[MODE_AT] {
                    1 => Some("raw".to_owned()),
                    2 => Some("coded".to_owned()),
                    _ => None,
                })
                .flatten(),
            ..Needs::default()
        },
    }
}
