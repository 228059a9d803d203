//! Writing: a dense grid becomes a file. Deterministic: the same source and options give the same bytes.

mod lists;
mod record;

use crate::codec::{Fault, Prepared, Scale};
use crate::directory::{DIRECTORY, Directory};
use crate::encoding::{Encoding, Order, Units};
use crate::header::{Header, RecordId, VALIDITY_BLOCK};
use crate::lattice::{Lattice, LatticeError};
use crate::metadata::{self, BakedLight, LIGHTS, METADATA};
use crate::order::explicit::write_list;
use crate::validity;
use crate::values::{Quantity, Values};
use crate::wire::{FORMAT, HEADER_BYTES};
use alloc::vec;
use alloc::vec::Vec;
use core::fmt;
use ivg_wire::{ContentId, Maximum, begin_record, record_len, seal, write_chunk};
use lists::Lists;

pub use record::encode_record;

/// What to write: one grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridSource<'a> {
    /// Where the vertices are.
    pub lattice: Lattice,
    /// Values of every vertex in the order of its linear index: irradiance vectors \[W/m², or lux\] or radiance harmonics
    /// \[W/(m² sr), or cd/m²\], as the encoding stores them.
    pub values: Values<'a>,
    /// Validity of every vertex: 0 inside geometry … 255 all free. `None` counts as all free.
    pub validity: Option<&'a [u8]>,
    /// Blocked edges of every vertex: bit 0, 1, 2 set where geometry cuts the way to the neighbour in
    /// +x, +y, +z. `None` counts as none blocked. Without either, the file has no validity section.
    pub blocked_edges: Option<&'a [u8]>,
    /// For the order `explicit`, and for no other: the linear indices of the vertices of each bundle, in any order. Each
    /// vertex that is neither a corner nor of validity 0 is in exactly one of them; one of validity 0 is in one or none;
    /// a bundle has at least one vertex, and no more than vertices per slice times those of the longest axis.
    pub bundles: Option<&'a [Vec<u64>]>,
    /// The lights whose light is in the grid.
    pub lights: &'a [BakedLight<'a>],
    /// Free key–value pairs: keys of lower-case letters, digits, `-` and `_`, values of one line.
    pub meta: &'a [(&'a str, &'a str)],
}

impl<'a> GridSource<'a> {
    /// A grid without validity section, lights and metadata.
    #[must_use]
    pub fn new(lattice: Lattice, values: impl Into<Values<'a>>) -> Self {
        let values = values.into();
        Self { lattice, values, validity: None, blocked_edges: None, bundles: None, lights: &[], meta: &[] }
    }
}

/// How to write it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncodeOptions {
    /// How the values of a vertex are stored.
    pub encoding: Encoding,
    /// In which order bundles take the vertices.
    pub order: Order,
    /// Vertices that a bundle takes from each slice across the longest axis; at least 1. For the orders without slices,
    /// a bundle has this many times the vertices of the longest axis: so many in `octree`, at most so many in `explicit`.
    pub vertices_per_slice: u32,
    /// Seed of the order; without a meaning in `explicit`.
    pub seed: u64,
    /// What the numbers measure.
    pub units: Units,
    /// Powers of two by which light may get brighter in records that replace those written now ([`encode_record`]): 3 for
    /// eight times as bright. The scale of a file is fixed when it is first written (IVG-UPD-01). Room costs precision only
    /// where light is darker than a 2³⁰⁻ⁿth of the brightest, for room n, and none in binary32, which is not scaled.
    pub headroom: u8,
}

impl EncodeOptions {
    /// The defaults: `packed-oct24`, 64 vertices per slice, seed 0, W/m², no headroom.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            encoding: Encoding::PackedOct24,
            order: Order::Slices,
            vertices_per_slice: 64,
            seed: 0,
            units: Units::Radiometric,
            headroom: 0,
        }
    }
}

impl Default for EncodeOptions {
    fn default() -> Self {
        Self::new()
    }
}

/// Why a grid cannot be written.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum EncodeError {
    /// The lattice is none.
    Lattice(LatticeError),
    /// An array does not have one entry per vertex.
    Count {
        /// Which array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The lattice's vertices.
        expected: u64,
    },
    /// The encoding stores another quantity than the source holds.
    Quantity {
        /// The encoding asked for.
        encoding: Encoding,
        /// What the source holds.
        found: Quantity,
    },
    /// A coefficient of the radiance is NaN or infinite.
    RadianceNotFinite {
        /// The vertex's coordinates.
        vertex: [u16; 3],
    },
    /// The mean radiance of a vertex is too large for the encoding, whatever the scale exponent.
    RadianceTooLarge {
        /// The vertex's coordinates.
        vertex: [u16; 3],
    },
    /// A component of an irradiance vector is NaN or infinite.
    NotFinite {
        /// The vertex's coordinates.
        vertex: [u16; 3],
        /// The hemisphere, 0 to 5 for +x −x +y −y +z −z.
        hemisphere: u8,
    },
    /// An irradiance vector is too large for the encoding, whatever the scale exponent.
    TooLarge {
        /// The vertex's coordinates.
        vertex: [u16; 3],
        /// The hemisphere, 0 to 5 for +x −x +y −y +z −z.
        hemisphere: u8,
    },
    /// A bundle takes no vertex from a slice.
    NoVerticesPerSlice,
    /// A bundle would be longer than a record may be, or there would be too many bundles.
    BundleSize,
    /// The order `explicit` without the bundles in [`GridSource::bundles`].
    BundlesMissing,
    /// Bundles in [`GridSource::bundles`], but another order than `explicit`.
    BundlesUnwanted {
        /// The order asked for.
        order: Order,
    },
    /// A bundle has no vertex.
    BundleEmpty {
        /// Which bundle, counted from 0.
        bundle: usize,
    },
    /// A bundle has more vertices than the vertices per slice allow.
    BundleTooLarge {
        /// Which bundle, counted from 0.
        bundle: usize,
        /// Its vertices.
        found: usize,
        /// As many are allowed.
        most: u64,
    },
    /// A bundle names a vertex that the lattice does not have.
    VertexOutside {
        /// Which bundle, counted from 0.
        bundle: usize,
        /// The linear index.
        vertex: u64,
    },
    /// A bundle names a corner of the lattice, which is in the corners record.
    VertexIsCorner {
        /// Which bundle, counted from 0.
        bundle: usize,
        /// The vertex's coordinates.
        vertex: [u16; 3],
    },
    /// A vertex is named for the second time.
    VertexTwice {
        /// The bundle that names it again, counted from 0.
        bundle: usize,
        /// The vertex's coordinates.
        vertex: [u16; 3],
    },
    /// A vertex that is valid and not a corner is in no bundle.
    VertexMissing {
        /// The vertex's coordinates.
        vertex: [u16; 3],
    },
    /// The source is not one of the file whose header was given.
    OtherFile {
        /// What differs.
        what: &'static str,
    },
    /// A value is too large for the scale exponent of the file; write a new file.
    ScaleExponent {
        /// The file's.
        file: i16,
        /// The smallest that the values need.
        needed: i16,
    },
    /// A validity record or the end record, which are never replaced.
    NeverReplaced {
        /// Which record.
        id: RecordId,
    },
    /// A blocked edge leads out of the lattice.
    EdgeOutside {
        /// The vertex's coordinates.
        vertex: [u16; 3],
    },
    /// A light's name is longer than 65,535 bytes.
    LightName {
        /// Which light, counted from 0.
        light: usize,
    },
    /// A key is empty or has other characters than lower-case letters, digits, `-` and `_`, or a value has a
    /// line feed.
    Metadata {
        /// Which pair, counted from 0.
        pair: usize,
    },
    /// Lights or metadata are longer than a chunk may be.
    ChunkSize,
}

/// Writes a grid as a file.
///
/// # Errors
///
/// [`EncodeError`] names what cannot be written and where.
pub fn encode(source: &GridSource<'_>, options: &EncodeOptions) -> Result<Vec<u8>, EncodeError> {
    check_source(source)?;
    let prepared =
        Prepared::new(source.values, options.encoding, Scale::Smallest { headroom: options.headroom })
            .map_err(|fault| named(fault, source, options.encoding, |index| index as u64))?;
    let header = Header { scale_exponent: prepared.scale_exponent(), ..unplaced(source, options)? };
    let lists = Lists::of(source, options.order, header.largest_bundle())?;
    let directory = lists.directory(options)?;
    let mut chunks = Vec::new();
    write_chunks(&mut chunks, source, (options.order == Order::Explicit).then_some(&directory))?;
    let header = layout(header, directory, lists.len(), chunks.len())?;

    let mut out = vec![0; usize::try_from(header.file_bytes).map_err(|_| EncodeError::BundleSize)?];
    out[..HEADER_BYTES].copy_from_slice(&header.to_bytes());
    out[HEADER_BYTES..][..chunks.len()].copy_from_slice(&chunks);
    for id in header.records() {
        let range = header.record_range(id);
        let record = &mut out[range.start as usize..range.end as usize];
        let payload = begin_record(record, id.stored(), 0);
        fill_payload(&mut payload[..header.payload_len(id) as usize], source, &header, &lists, &prepared, id);
        seal(record, ContentId::default());
    }
    seal_all(&mut out, header);
    Ok(out)
}

fn write_validity(out: &mut Vec<u8>, source: &GridSource<'_>, header: &Header, j: u32) {
    let first = (u64::from(j) * VALIDITY_BLOCK) as usize;
    let range = first..first + header.record_vertices(RecordId::Validity(j)) as usize;
    validity::write(out, range, source.validity, source.blocked_edges);
}

/// Fills the payload of a record.
fn fill_payload(
    payload: &mut [u8],
    source: &GridSource<'_>,
    header: &Header,
    lists: &Lists,
    prepared: &Prepared<'_>,
    id: RecordId,
) {
    let mut bytes = Vec::new();
    match id {
        RecordId::Bundle(k) => match header.bundle_vertices(k) {
            Some(vertices) => prepared.fill(payload, vertices),
            None => {
                let list = lists.get(k).iter().copied();
                write_list(&mut bytes, list.clone());
                let (index, values) = payload.split_at_mut(bytes.len());
                index.copy_from_slice(&bytes);
                prepared.fill(values, list);
            }
        },
        RecordId::Validity(j) => {
            write_validity(&mut bytes, source, header, j);
            payload.copy_from_slice(&bytes);
        }
        RecordId::Corners => prepared.fill(payload, header.lattice.corners()),
        RecordId::End => payload.copy_from_slice(&header.file_bytes.to_le_bytes()),
    }
}

/// Derives the content id from the bytes written so far and makes every checksum anew with it.
fn seal_all(out: &mut [u8], header: Header) {
    let header = Header { content_id: ContentId::of(&[&*out]), ..header };
    out[..HEADER_BYTES].copy_from_slice(&header.to_bytes());
    let mut start = HEADER_BYTES;
    while (start as u64) < header.data_offset {
        let mut length = [0; 8];
        length.copy_from_slice(&out[start + 8..start + 16]);
        let end = start + ivg_wire::chunk_len(u64::from_le_bytes(length)).unwrap_or(u64::MAX) as usize;
        seal(&mut out[start..end], header.content_id);
        start = end;
    }
    for id in header.records() {
        let range = header.record_range(id);
        seal(&mut out[range.start as usize..range.end as usize], header.content_id);
    }
}

fn check_source(source: &GridSource<'_>) -> Result<(), EncodeError> {
    let lattice = &source.lattice;
    lattice.check().map_err(EncodeError::Lattice)?;
    let expected = lattice.vertex_count();
    let counts = [
        ("values", Some(source.values.len())),
        ("validity", source.validity.map(<[u8]>::len)),
        ("blocked_edges", source.blocked_edges.map(<[u8]>::len)),
    ];
    for (what, found) in counts {
        if let Some(found) = found.filter(|&found| found as u64 != expected) {
            return Err(EncodeError::Count { what, found, expected });
        }
    }
    for (index, &edges) in (0..).zip(source.blocked_edges.unwrap_or(&[])) {
        let vertex = lattice.coords(index);
        let outward = (0..3).any(|axis| edges >> axis & 1 != 0 && vertex[axis] + 1 == lattice.dims[axis]);
        if outward || edges > 7 {
            return Err(EncodeError::EdgeOutside { vertex });
        }
    }
    if let Some(light) = source.lights.iter().position(|l| l.name.len() > usize::from(u16::MAX)) {
        return Err(EncodeError::LightName { light });
    }
    match source.meta.iter().position(|(key, value)| !metadata::is_pair(key, value)) {
        Some(pair) => Err(EncodeError::Metadata { pair }),
        None => Ok(()),
    }
}

fn write_chunks(
    out: &mut Vec<u8>,
    source: &GridSource<'_>,
    directory: Option<&Directory>,
) -> Result<(), EncodeError> {
    let mut chunk = |kind, payload: &[u8]| {
        let length = ivg_wire::chunk_len(payload.len() as u64).unwrap_or(u64::MAX);
        if length > u64::from(Maximum::CHUNK_BYTES) {
            return Err(EncodeError::ChunkSize);
        }
        write_chunk(out, kind, kind == DIRECTORY, payload, ContentId::default());
        Ok(())
    };
    if let Some(directory) = directory {
        let mut payload = Vec::new();
        directory.write(&mut payload);
        chunk(DIRECTORY, &payload)?;
    }
    if !source.lights.is_empty() {
        chunk(LIGHTS, &metadata::write_lights(source.lights))?;
    }
    if !source.meta.is_empty() {
        chunk(METADATA, &metadata::write_metadata(source.meta))?;
    }
    Ok(())
}

/// The header of the file, without what follows from its bundles and chunks.
fn unplaced(source: &GridSource<'_>, options: &EncodeOptions) -> Result<Header, EncodeError> {
    if options.vertices_per_slice == 0 {
        return Err(EncodeError::NoVerticesPerSlice);
    }
    let has_validity = source.validity.is_some() || source.blocked_edges.is_some();
    let blocks = if has_validity { source.lattice.vertex_count().div_ceil(VALIDITY_BLOCK) } else { 0 };
    Ok(Header {
        minor: FORMAT.minor,
        optional_features: 0,
        header_bytes: FORMAT.header_bytes,
        content_id: ContentId::default(),
        data_offset: 0,
        file_bytes: 0,
        lattice: source.lattice,
        encoding: options.encoding,
        order: options.order,
        scale_exponent: 0,
        vertices_per_slice: options.vertices_per_slice,
        seed: options.seed,
        bundle_count: 0,
        validity_records: u32::try_from(blocks).map_err(|_| EncodeError::BundleSize)?,
        units: options.units,
        directory: Directory::default(),
    })
}

/// The header with the place of every record, its content id still 0.
fn layout(
    header: Header,
    directory: Directory,
    lists: usize,
    chunk_bytes: usize,
) -> Result<Header, EncodeError> {
    let bundles = header.rule().map_or(lists as u64, |rule| rule.bundle_count());
    let bundle_count = u32::try_from(bundles).map_err(|_| EncodeError::BundleSize)?;
    let data_offset = (HEADER_BYTES + chunk_bytes) as u64;
    let mut header = Header { bundle_count, data_offset, directory, ..header };
    // Bundles of a rule never grow; those of a list may.
    let judged =
        if header.order == Order::Explicit { header.bundle_count } else { header.bundle_count.min(1) };
    let fits = (1..=judged).all(|k| {
        let largest = record_len(header.payload_len(RecordId::Bundle(k))).unwrap_or(u64::MAX);
        largest <= u64::from(Maximum::RECORD_BYTES)
    });
    if header.bundle_count > i32::MAX as u32 || !fits {
        return Err(EncodeError::BundleSize);
    }
    header.file_bytes = header.implied_file_bytes().ok_or(EncodeError::BundleSize)?;
    Ok(header)
}

/// The encoding's complaint as the caller's: with the vertex' coordinates.
fn named(
    fault: Fault,
    source: &GridSource<'_>,
    encoding: Encoding,
    vertex: impl Fn(usize) -> u64,
) -> EncodeError {
    let at = |index| source.lattice.coords(vertex(index));
    match fault {
        Fault::Quantity => EncodeError::Quantity { encoding, found: source.values.quantity() },
        Fault::NotFinite(index, hemisphere) => {
            EncodeError::NotFinite { vertex: at(index), hemisphere: hemisphere as u8 }
        }
        Fault::TooLarge(index, hemisphere) => {
            EncodeError::TooLarge { vertex: at(index), hemisphere: hemisphere as u8 }
        }
        Fault::RadianceNotFinite(index) => EncodeError::RadianceNotFinite { vertex: at(index) },
        Fault::RadianceTooLarge(index) => EncodeError::RadianceTooLarge { vertex: at(index) },
        Fault::ScaleExponent { file, needed } => EncodeError::ScaleExponent { file, needed },
    }
}

impl fmt::Display for EncodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let hemisphere_name =
            |h: u8| ["+x", "-x", "+y", "-y", "+z", "-z"].get(usize::from(h)).copied().unwrap_or("?");
        match *self {
            Self::Lattice(error) => error.fmt(f),
            Self::Count { what, found, expected } => {
                write!(f, "{what} has {found} entries, but the lattice has {expected} vertices")
            }
            Self::Quantity { encoding, found } => write!(
                f,
                "{} stores {}, but the grid holds {}",
                encoding.name(),
                encoding.quantity().name(),
                found.name()
            ),
            Self::RadianceNotFinite { vertex: [i, j, k] } => {
                write!(f, "vertex ({i}, {j}, {k}) has a radiance coefficient that is not finite")
            }
            Self::RadianceTooLarge { vertex: [i, j, k] } => {
                write!(f, "vertex ({i}, {j}, {k}) has a radiance that is too large for the encoding")
            }
            Self::NotFinite { vertex: [i, j, k], hemisphere } => write!(
                f,
                "vertex ({i}, {j}, {k}) has an irradiance vector of hemisphere {} that is not finite",
                hemisphere_name(hemisphere)
            ),
            Self::TooLarge { vertex: [i, j, k], hemisphere } => write!(
                f,
                "vertex ({i}, {j}, {k}) has an irradiance vector of hemisphere {} that is too large for a \
                 packed encoding; use vectors-f32",
                hemisphere_name(hemisphere)
            ),
            Self::NoVerticesPerSlice => {
                f.write_str("a bundle takes no vertex from a slice; give at least 1 vertex per slice")
            }
            Self::BundleSize => f.write_str(
                "bundles would be too large, or too many, for the format; choose another number of vertices \
                 per slice",
            ),
            Self::OtherFile { what } => write!(f, "the grid has another {what} than the file"),
            Self::ScaleExponent { file, needed } => write!(
                f,
                "a value needs the scale exponent {needed}, and the file has {file}; write a new file"
            ),
            Self::NeverReplaced { id } => {
                write!(f, "record {:#x} is never replaced; write a new file", id.stored())
            }
            Self::BundlesMissing => {
                f.write_str("the order explicit needs the vertices of each bundle: set GridSource::bundles")
            }
            Self::BundlesUnwanted { order } => {
                write!(f, "bundles are given, but the order {} makes its own; use explicit", order.name())
            }
            Self::BundleEmpty { bundle } => write!(f, "bundle {bundle} has no vertex; leave it out"),
            Self::BundleTooLarge { bundle, found, most } => write!(
                f,
                "bundle {bundle} has {found} vertices, but vertices per slice times the longest axis is {most}"
            ),
            Self::VertexOutside { bundle, vertex } => {
                write!(f, "bundle {bundle} names vertex {vertex}, which the lattice does not have")
            }
            Self::VertexIsCorner { bundle, vertex: [i, j, k] } => {
                write!(f, "bundle {bundle} names vertex ({i}, {j}, {k}), a corner; corners are in no bundle")
            }
            Self::VertexTwice { bundle, vertex: [i, j, k] } => {
                write!(f, "bundle {bundle} names vertex ({i}, {j}, {k}), which was named before")
            }
            Self::VertexMissing { vertex: [i, j, k] } => {
                write!(f, "vertex ({i}, {j}, {k}) is valid and in no bundle")
            }
            Self::EdgeOutside { vertex: [i, j, k] } => {
                write!(f, "vertex ({i}, {j}, {k}) has a blocked edge that leads out of the lattice")
            }
            Self::LightName { light } => write!(f, "the name of light {light} is longer than 65,535 bytes"),
            Self::Metadata { pair } => write!(
                f,
                "metadata pair {pair} does not fit: keys are lower-case letters, digits, - and _, values one \
                 line"
            ),
            Self::ChunkSize => f.write_str("lights or metadata are longer than a chunk may be"),
        }
    }
}

impl core::error::Error for EncodeError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Lattice(error) => Some(error),
            _ => None,
        }
    }
}
