//! Writing one record alone: what a server that has better light replaces a record by.

use super::lists::Lists;
use super::{EncodeError, GridSource, check_source, named, write_validity};
use crate::codec::{Prepared, Scale};
use crate::header::{Header, RecordId};
use crate::order::explicit::write_list;
use crate::values::{HemisphereVectors, RadianceHarmonics, Values};
use alloc::vec::Vec;
use ivg_wire::{write_end, write_record};

/// Writes one record of the file with this header, at a generation: what a server replaces a record by that it has better
/// light for (IVG-UPD-01). At generation 0 and from the source that [`encode`](super::encode()) was given, the bytes in the file.
///
/// The header stays as it is, so values are stored at its scale exponent, whatever the source's largest is now.
///
/// # Errors
///
/// As [`encode`](super::encode()); [`EncodeError::OtherFile`] if the source does not fit the header, [`EncodeError::ScaleExponent`] if a
/// value is too large for the file, [`EncodeError::NeverReplaced`] for a generation of a record that has none.
pub fn encode_record(
    source: &GridSource<'_>,
    header: &Header,
    id: RecordId,
    generation: u32,
) -> Result<Vec<u8>, EncodeError> {
    check_source(source)?;
    let has_validity = source.validity.is_some() || source.blocked_edges.is_some();
    let what = if source.lattice != header.lattice {
        "lattice"
    } else if has_validity != (header.validity_records > 0) {
        "validity"
    } else if header.record_range(id).is_empty() {
        "record"
    } else {
        ""
    };
    if !what.is_empty() {
        return Err(EncodeError::OtherFile { what });
    }
    let mut out = Vec::new();
    if generation != 0 && matches!(id, RecordId::Validity(_) | RecordId::End) {
        return Err(EncodeError::NeverReplaced { id });
    }
    if id == RecordId::End {
        write_end(&mut out, header.file_bytes, header.content_id);
        return Ok(out);
    }
    let mut payload = Vec::new();
    if let RecordId::Validity(j) = id {
        write_validity(&mut payload, source, header, j);
    } else {
        let vertices = record_vertices(source, header, id, &mut payload)?;
        // Only the values of this record are made ready, however large the grid is.
        let values = Gathered::of(source.values, &vertices);
        let prepared = Prepared::new(values.borrowed(), header.encoding, Scale::Fixed(header.scale_exponent))
            .map_err(|fault| named(fault, source, header.encoding, |index| vertices[index]))?;
        let index_bytes = payload.len();
        payload.resize(index_bytes + vertices.len() * header.encoding.bytes_per_vertex() as usize, 0);
        prepared.fill(&mut payload[index_bytes..], 0..vertices.len() as u64);
    }
    if payload.len() as u64 != header.payload_len(id) {
        return Err(EncodeError::OtherFile { what: "bundles" });
    }
    write_record(&mut out, id.stored(), generation, &payload, header.content_id);
    Ok(out)
}

/// The vertices of corners or a bundle; their list, where the payload begins with one, is appended.
fn record_vertices(
    source: &GridSource<'_>,
    header: &Header,
    id: RecordId,
    payload: &mut Vec<u8>,
) -> Result<Vec<u64>, EncodeError> {
    let lists = Lists::of(source, header.order, header.largest_bundle())?;
    let RecordId::Bundle(k) = id else { return Ok(header.lattice.corners().collect()) };
    if let Some(vertices) = header.bundle_vertices(k) {
        return Ok(vertices.collect());
    }
    if lists.len() != header.bundle_count as usize {
        return Err(EncodeError::OtherFile { what: "bundles" });
    }
    write_list(payload, lists.get(k).iter().copied());
    Ok(lists.get(k).to_vec())
}

/// The values of some vertices, one after the other.
enum Gathered {
    Vectors(Vec<HemisphereVectors>),
    Radiance(Vec<RadianceHarmonics>),
}

impl Gathered {
    fn of(values: Values<'_>, vertices: &[u64]) -> Self {
        match values {
            Values::Vectors(all) => Self::Vectors(vertices.iter().map(|&v| all[v as usize]).collect()),
            Values::Radiance(all) => Self::Radiance(vertices.iter().map(|&v| all[v as usize]).collect()),
        }
    }

    fn borrowed(&self) -> Values<'_> {
        match self {
            Self::Vectors(vectors) => vectors.into(),
            Self::Radiance(radiance) => radiance.into(),
        }
    }
}
