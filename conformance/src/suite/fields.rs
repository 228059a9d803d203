//! What each byte of an accepted file is, and what its checksums cover.

use crate::vectors::edit::{DATA_OFFSET_AT, HEADER_BYTES_AT, HEADER_CHECKSUM};
use crate::vectors::{Format, edit};
use std::ops::Range;

/// A field of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Field {
    /// The bytes.
    pub(super) range: Range<usize>,
    /// What it is called: `header.dims`, `chunk META.payload`, `bundle 2.crc`.
    pub(super) name: String,
}

/// What a checksum covers, and its own four bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Envelope {
    /// All of its bytes.
    pub(crate) range: Range<usize>,
    /// `header`, `chunk META`, `bundle 2`.
    pub(crate) name: String,
}

/// Offsets and names of the fields of the common header, and of the two specific ones.
const TABLES: [&str; 3] = [
    include_str!("../../../spec/tables/common.toml"),
    include_str!("../../../spec/tables/ivg.toml"),
    include_str!("../../../spec/tables/pmesh.toml"),
];

/// The header's fields: offsets and names in ascending order.
fn header_fields(format: Format) -> Vec<(usize, String)> {
    let own = match format {
        Format::Ivg => TABLES[1],
        Format::Pmesh => TABLES[2],
    };
    [TABLES[0], own]
        .into_iter()
        .flat_map(|text| {
            let table: toml::Table = text.parse().expect("a table of the specification");
            let rows = table["header"].as_array().cloned().unwrap_or_default();
            rows.into_iter().map(|row| {
                let offset = row["offset"].as_integer().and_then(|offset| usize::try_from(offset).ok());
                (offset.expect("an offset"), row["name"].as_str().expect("a name").to_owned())
            })
        })
        .collect()
}

/// Where records lie in an accepted file, and what they are called.
fn records(format: Format, file: &[u8]) -> Vec<Envelope> {
    let records = match format {
        Format::Ivg => crate::vectors::ivg_records(file),
        Format::Pmesh => crate::vectors::pmesh_records(file),
    };
    records.into_iter().map(|(name, range)| Envelope { range, name }).collect()
}

/// Chunks from `at` to `end`, as far as their lengths lead.
pub(super) fn chunks(file: &[u8], mut at: usize, end: usize) -> Vec<Envelope> {
    let mut chunks = Vec::new();
    while at + 16 <= end.min(file.len()) {
        let payload = edit::read_u64(file, at + 8) as u64;
        let Some(length) = ivg_wire::chunk_len(payload).and_then(|length| usize::try_from(length).ok())
        else {
            break;
        };
        if length > end - at {
            break;
        }
        let name = format!("chunk {}", file[at..at + 4].escape_ascii());
        chunks.push(Envelope { range: at..at + length, name });
        at += length;
    }
    chunks
}

/// All checksums of an accepted file.
pub(crate) fn envelopes(format: Format, file: &[u8]) -> Vec<Envelope> {
    let header = header_bytes(file);
    let mut all = vec![Envelope { range: 0..header, name: "header".to_owned() }];
    all.extend(chunks(file, header, edit::read_u64(file, DATA_OFFSET_AT)));
    all.extend(records(format, file));
    all
}

/// The length that a header says it has.
pub(super) fn header_bytes(file: &[u8]) -> usize {
    file.get(HEADER_BYTES_AT..)
        .and_then(<[u8]>::first_chunk)
        .map_or(0, |bytes| u32::from_le_bytes(*bytes) as usize)
}

/// All fields of an accepted file, without gaps.
pub(super) fn fields(format: Format, file: &[u8]) -> Vec<Field> {
    let mut fields: Vec<Field> = Vec::new();
    for envelope in envelopes(format, file) {
        let Envelope { range, name } = envelope;
        let mut starts: Vec<(usize, String)> = if name == "header" {
            header_fields(format)
        } else if name.starts_with("chunk") {
            let payload = edit::read_u64(file, range.start + 8);
            let rest = [(16 + payload, "padding"), (range.len() - 4, "crc")];
            [(0, "type"), (4, "flags"), (5, "reserved"), (8, "length"), (16, "payload")]
                .into_iter()
                .chain(rest)
                .map(|(at, name)| (at, name.to_owned()))
                .collect()
        } else {
            [(0, "id"), (4, "generation"), (8, "payload"), (range.len() - 4, "crc")]
                .map(|(at, name)| (at, name.to_owned()))
                .to_vec()
        };
        starts.push((range.len(), String::new()));
        fields.extend(starts.windows(2).filter(|two| two[0].0 < two[1].0).map(|two| Field {
            range: range.start + two[0].0..range.start + two[1].0,
            name: format!("{name}.{}", two[0].1),
        }));
    }
    fields
}

/// Whether the checksum of an envelope fits its bytes.
pub(crate) fn fits(file: &[u8], envelope: &Envelope) -> bool {
    // A header is as long as it says.
    let range = match envelope.name.as_str() {
        "header" => 0..header_bytes(file).clamp(HEADER_CHECKSUM.end, file.len()),
        _ => envelope.range.clone(),
    };
    let mut copy = file[range.clone()].to_vec();
    if envelope.name == "header" {
        ivg_wire::seal_header(&mut copy);
    } else {
        let id = file[edit::CONTENT_ID_AT..].first_chunk().expect("a header");
        ivg_wire::seal(&mut copy, ivg_wire::ContentId(u64::from_le_bytes(*id)));
    }
    copy == file[range]
}
