//! The header: what a file holds and where each record lies, without reading a record.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use crate::code::codes;
use crate::directory::{Bounds, DIRECTORY, Directory};
use crate::encoding::{Encoding, Order, Units};
use crate::lattice::{Lattice, LatticeError};
use crate::limits::Limits;
use crate::order::{BundleVertices, Rule};
use crate::values::Quantity;
use crate::wire::{FORMAT, HEADER_BYTES, Specific, at};
use core::ops::Range;
use ivg_wire::{
    ByteOffset, COMMON_HEADER_BYTES, ChunkArea, Code, CommonHeader, ContentId, END_PAYLOAD, END_RECORD,
    Error, Maximum, Part, Step, record_len, seal_header,
};
use zerocopy::{FromBytes, IntoBytes};

/// Vertices of a validity record; the last one may have fewer (IVG-VAL-02).
pub const VALIDITY_BLOCK: u64 = 4096;

/// Id of the first validity record; bundles have the ids below it (IVG-REC-01).
const FIRST_VALIDITY: u32 = 0x8000_0000;

/// A record of an .ivg file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum RecordId {
    /// The corner vertices of the lattice.
    Corners,
    /// Block `j`, counted from 0, of the validity section.
    Validity(u32),
    /// Bundle `k`, counted from 1.
    Bundle(u32),
    /// The end record.
    End,
}

impl RecordId {
    /// The id as it is stored (IVG-REC-01).
    #[must_use]
    pub const fn stored(self) -> u32 {
        match self {
            Self::Corners => 0,
            Self::Validity(j) => FIRST_VALIDITY.saturating_add(j),
            Self::Bundle(k) => k,
            Self::End => END_RECORD,
        }
    }

    /// The record with this stored id.
    #[must_use]
    pub const fn from_stored(id: u32) -> Self {
        match id {
            0 => Self::Corners,
            END_RECORD => Self::End,
            FIRST_VALIDITY.. => Self::Validity(id.saturating_sub(FIRST_VALIDITY)),
            _ => Self::Bundle(id),
        }
    }
}

/// A header that has been read and checked, or that an encoder is about to write. It says where every record lies: for
/// the order `explicit`, the directory behind it is part of it. Cloning it is cheap.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Header {
    /// Minor version of the file.
    pub minor: u16,
    /// Feature bits that a reader may ignore.
    pub optional_features: u32,
    /// Length of the header in bytes; chunks begin there.
    pub header_bytes: u32,
    /// Differs whenever anything encoded differs; seeds every checksum but the header's.
    pub content_id: ContentId,
    /// Where the records begin. Whoever fetches by ranges asks for this many bytes first.
    pub data_offset: u64,
    /// Length of the whole file in bytes.
    pub file_bytes: u64,
    /// Where the vertices are.
    pub lattice: Lattice,
    /// How the values of a vertex are stored.
    pub encoding: Encoding,
    /// In which order bundles take the vertices.
    pub order: Order,
    /// Stored values are multiplied by 2 to this power; −125 to 112 (IVG-HDR-04).
    pub scale_exponent: i16,
    /// Vertices that a bundle takes from each slice, at least 1; in the orders without slices a bundle has this many times
    /// the vertices of the longest axis: so many in `octree`, at most so many in `explicit`.
    pub vertices_per_slice: u32,
    /// Seed of the order; without a meaning in `explicit`.
    pub seed: u64,
    /// Number of bundles.
    pub bundle_count: u32,
    /// Number of validity records; 0 where the file has no validity section.
    pub validity_records: u32,
    /// What the numbers measure.
    pub units: Units,
    /// Of each bundle, for the order `explicit`; empty for others.
    pub(crate) directory: Directory,
}

/// A header and what was read of the file with it.
pub(crate) struct HeaderRead {
    /// The header, its directory included.
    pub(crate) header: Header,
    /// The chunks that have not been read.
    pub(crate) chunks: ChunkArea,
}

impl Header {
    /// Reads and checks the header that begins `input`; for the order `explicit`, the directory behind it too, so that
    /// a header never lacks the place of a record. What is wrong with the header itself is reported before the
    /// directory is there.
    ///
    /// # Errors
    ///
    /// The common part first, see [`CommonHeader::read`]; then the fields in the order of IVG-HDR-01; then the limits;
    /// then the directory (IVG-DIRE-03); then the file's length. Each at the offset of its field.
    pub fn read(input: &[u8], limits: &Limits) -> Result<Step<Self>, Error> {
        Ok(Self::read_with_chunks(input, limits)?.map(|read| read.header))
    }

    /// As [`Header::read`], and where the chunks that follow lie.
    pub(crate) fn read_with_chunks(input: &[u8], limits: &Limits) -> Result<Step<HeaderRead>, Error> {
        let (length, common) = match CommonHeader::read(input, &FORMAT, &limits.wire)? {
            Step::NeedMore(more) => return Ok(Step::NeedMore(more)),
            Step::Consumed(length, common) => (length, common),
        };
        let (specific, rest) = input.split_at_checked(length).unwrap_or((input, &[]));
        let specific = specific.get(COMMON_HEADER_BYTES..).unwrap_or(&[]);
        let Ok((specific, _)) = Specific::ref_from_prefix(specific) else {
            return Err(fail(ivg_wire::codes::HEADER_BYTES, 20));
        };
        let mut header = Self::check(&common, specific, limits)?;
        let mut chunks =
            ChunkArea::new(u64::from(header.header_bytes), header.data_offset, header.content_id);
        let used = match header.read_directory(&mut chunks, rest, limits)? {
            Step::NeedMore(more) => return Ok(Step::NeedMore(more)),
            Step::Consumed(used, ()) => used,
        };
        common.expect_file_bytes(header.implied_file_bytes())?;
        Ok(Step::Consumed(length.saturating_add(used), HeaderRead { header, chunks }))
    }

    /// Reads the first chunk, where it is the directory (IVG-DIRE-01).
    fn read_directory(
        &mut self,
        chunks: &mut ChunkArea,
        input: &[u8],
        limits: &Limits,
    ) -> Result<Step<()>, Error> {
        if self.order != Order::Explicit {
            return Ok(Step::Consumed(0, ()));
        }
        let missing =
            |part| Err(Error::new(codes::DIRECTORY_ABSENT, ByteOffset(u64::from(self.header_bytes)), part));
        if chunks.is_done() {
            return missing(Part::Chunks);
        }
        let (used, chunk) = match chunks.read(input, &limits.wire)? {
            Step::NeedMore(more) => return Ok(Step::NeedMore(more)),
            Step::Consumed(used, chunk) => (used, chunk),
        };
        if chunk.kind != DIRECTORY {
            return missing(Part::Chunk(chunk.kind));
        }
        let bounds = Bounds {
            bundles: self.bundle_count,
            vertices: self.inner_vertices(),
            may_lack: self.validity_records > 0,
            per_bundle: self.largest_bundle(),
            vertex_bytes: self.encoding.bytes_per_vertex(),
            record_limit: limits.wire.record_bytes,
        };
        self.directory = Directory::read(&chunk, &bounds)?;
        Ok(Step::Consumed(used, ()))
    }

    fn check(common: &CommonHeader, wire: &Specific, limits: &Limits) -> Result<Self, Error> {
        let lattice = Lattice {
            dims: wire.dims.map(|n| n.get()),
            origin: wire.origin.map(|x| x.get()),
            step: wire.step.map(|x| x.get()),
        };
        lattice.check().map_err(lattice_error)?;
        let encoding = match wire.encoding.get() {
            0 => return Err(fail(codes::ENCODING_FORBIDDEN, at::ENCODING)),
            id => Encoding::from_id(id).ok_or(fail(codes::ENCODING_UNKNOWN, at::ENCODING))?,
        };
        let order = match wire.order.get() {
            0 => return Err(fail(codes::ORDER_FORBIDDEN, at::ORDER)),
            id => Order::from_id(id).ok_or(fail(codes::ORDER_UNKNOWN, at::ORDER))?,
        };
        let scale_exponent = wire.scale_exponent.get();
        if !scale_exponents(encoding).contains(&scale_exponent) {
            return Err(fail(codes::SCALE_EXPONENT, at::SCALE_EXPONENT));
        }
        let header = Self {
            minor: common.minor,
            optional_features: common.optional_features,
            header_bytes: common.header_bytes,
            content_id: common.content_id,
            data_offset: common.data_offset,
            file_bytes: common.file_bytes,
            lattice,
            encoding,
            order,
            scale_exponent,
            vertices_per_slice: wire.vertices_per_slice.get(),
            seed: wire.seed.get(),
            bundle_count: wire.bundle_count.get(),
            validity_records: wire.validity_records.get(),
            units: Units::from_id(wire.units).ok_or(fail(codes::UNITS_UNKNOWN, at::UNITS))?,
            directory: Directory::default(),
        };
        header.check_layout(limits)?;
        if wire.reserved != [0; 7] {
            return Err(fail(ivg_wire::codes::RESERVED, at::RESERVED));
        }
        Ok(header)
    }

    /// Checks counts and sizes against the lattice and the limits.
    fn check_layout(&self, limits: &Limits) -> Result<(), Error> {
        if self.vertices_per_slice == 0 {
            return Err(fail(codes::SLICE_VERTICES, at::VERTICES_PER_SLICE));
        }
        let bundles = u64::from(self.bundle_count);
        let fits = match self.rule() {
            Some(rule) => bundles == rule.bundle_count(),
            None => bundles <= self.inner_vertices(),
        };
        if !fits || self.bundle_count >= FIRST_VALIDITY {
            return Err(fail(codes::BUNDLE_COUNT, at::BUNDLE_COUNT));
        }
        let blocks = self.lattice.vertex_count().div_ceil(VALIDITY_BLOCK);
        // Their ids follow FIRST_VALIDITY and end before that of the end record.
        let fits = u64::from(self.validity_records) == blocks && self.validity_records < FIRST_VALIDITY;
        if self.validity_records != 0 && !fits {
            return Err(fail(codes::VALIDITY_COUNT, at::VALIDITY_RECORDS));
        }
        let largest = self.largest_record().unwrap_or(u64::MAX);
        if largest > u64::from(Maximum::RECORD_BYTES) {
            return Err(fail(codes::RECORD_TOO_LARGE, at::VERTICES_PER_SLICE));
        }
        if self.lattice.vertex_count() > limits.vertices {
            return Err(fail(codes::LIMIT_VERTICES, at::DIMS));
        }
        if largest > u64::from(limits.wire.record_bytes) {
            return Err(fail(ivg_wire::codes::LIMIT_RECORD_BYTES, at::VERTICES_PER_SLICE));
        }
        Ok(())
    }

    /// The header's bytes, checksum included.
    #[must_use]
    pub(crate) fn to_bytes(&self) -> [u8; HEADER_BYTES] {
        let common = CommonHeader {
            minor: self.minor,
            required_features: 0,
            optional_features: self.optional_features,
            header_bytes: self.header_bytes,
            content_id: self.content_id,
            data_offset: self.data_offset,
            file_bytes: self.file_bytes,
        };
        let specific = Specific {
            dims: self.lattice.dims.map(Into::into),
            encoding: self.encoding.id().into(),
            origin: self.lattice.origin.map(Into::into),
            step: self.lattice.step.map(Into::into),
            order: self.order.id().into(),
            scale_exponent: self.scale_exponent.into(),
            vertices_per_slice: self.vertices_per_slice.into(),
            seed: self.seed.into(),
            bundle_count: self.bundle_count.into(),
            validity_records: self.validity_records.into(),
            units: self.units.id(),
            reserved: [0; 7],
        };
        let mut bytes = [0; HEADER_BYTES];
        for (to, from) in bytes.iter_mut().zip(common.to_bytes(&FORMAT).iter().chain(specific.as_bytes())) {
            *to = *from;
        }
        seal_header(&mut bytes);
        bytes
    }

    /// By what rule bundles take the vertices; `None` where each lists its own.
    pub(crate) fn rule(&self) -> Option<Rule> {
        Rule::new(self.order, &self.lattice, self.vertices_per_slice, self.seed)
    }

    /// Vertices that are not corners.
    pub(crate) fn inner_vertices(&self) -> u64 {
        self.lattice.vertex_count().saturating_sub(self.record_vertices(RecordId::Corners))
    }

    /// The most vertices that a bundle of the order `explicit` may have (IVG-DIRE-03).
    pub(crate) fn largest_bundle(&self) -> u64 {
        let longest = self.lattice.dims.iter().fold(1, |most, &n| most.max(u64::from(n)));
        u64::from(self.vertices_per_slice).saturating_mul(longest)
    }

    /// Number of records, the end record included.
    #[must_use]
    pub const fn record_count(&self) -> u64 {
        (self.bundle_count as u64).saturating_add(self.validity_records as u64).saturating_add(2)
    }

    /// Number of vertices in a record: of the lattice's values for corners and bundles, of validity entries
    /// for validity records, 0 for the end record and for records that the file does not have.
    #[must_use]
    pub fn record_vertices(&self, id: RecordId) -> u64 {
        match id {
            RecordId::Corners => self.lattice.dims.iter().map(|&n| u64::from(n.min(2))).product(),
            RecordId::Bundle(k) if (1..=self.bundle_count).contains(&k) => match self.rule() {
                Some(rule) => rule.bundle_len(k),
                None => self.directory.get(k).map_or(0, |entry| u64::from(entry.vertices)),
            },
            RecordId::Validity(j) if j < self.validity_records => {
                let first = u64::from(j).saturating_mul(VALIDITY_BLOCK);
                self.lattice.vertex_count().saturating_sub(first).min(VALIDITY_BLOCK)
            }
            _ => 0,
        }
    }

    /// Length of a record's payload in bytes (IVG-REC-02).
    #[must_use]
    pub fn payload_len(&self, id: RecordId) -> u64 {
        let vertices = self.record_vertices(id);
        match id {
            RecordId::Corners | RecordId::Bundle(_) => {
                vertices.saturating_mul(self.encoding.bytes_per_vertex()).saturating_add(self.index_bytes(id))
            }
            RecordId::Validity(_) => vertices.saturating_add(vertices.saturating_mul(3).div_ceil(8)),
            RecordId::End => END_PAYLOAD,
        }
    }

    /// Bytes of the list of vertices that begins a record's payload: 0 but for bundles of the order `explicit`.
    #[must_use]
    pub fn index_bytes(&self, id: RecordId) -> u64 {
        match id {
            RecordId::Bundle(k) => self.directory.get(k).map_or(0, |entry| u64::from(entry.index_bytes)),
            _ => 0,
        }
    }

    /// The bytes of the file in which a record lies, whatever the number of records: closed form, or from the
    /// directory (IVG-REC-03).
    ///
    /// Empty for a record that the file does not have.
    #[must_use]
    pub fn record_range(&self, id: RecordId) -> Range<u64> {
        self.checked_range(id).unwrap_or(0..0)
    }

    fn checked_range(&self, id: RecordId) -> Option<Range<u64>> {
        let exists = match id {
            RecordId::Corners | RecordId::End => true,
            RecordId::Validity(j) => j < self.validity_records,
            RecordId::Bundle(k) => (1..=self.bundle_count).contains(&k),
        };
        if !exists {
            return None;
        }
        let len = |id| record_len(self.payload_len(id));
        let mut start = self.data_offset;
        if id != RecordId::Corners {
            let blocks = match id {
                RecordId::Validity(j) => j,
                _ => self.validity_records,
            };
            start = start.checked_add(len(RecordId::Corners)?)?;
            // Every block before another one is full; only the last of all may be shorter.
            let full = blocks.min(self.validity_records.saturating_sub(1));
            start = start.checked_add(u64::from(full).checked_mul(len(RecordId::Validity(0))?)?)?;
            if blocks > full {
                start = start.checked_add(len(RecordId::Validity(full))?)?;
            }
        }
        let bundles = match id {
            RecordId::Bundle(k) => k.saturating_sub(1),
            RecordId::End => self.bundle_count,
            _ => 0,
        };
        start = start.checked_add(self.bytes_of_bundles(bundles)?)?;
        Some(start..start.checked_add(len(id)?)?)
    }

    /// Bytes of the first `count` bundles.
    fn bytes_of_bundles(&self, count: u32) -> Option<u64> {
        let Some(rule) = self.rule() else {
            let vertex_bytes = self.encoding.bytes_per_vertex();
            return match self.directory.get(count.checked_add(1)?) {
                Some(next) => Some(next.start),
                None => Some(self.directory.bundle_bytes(vertex_bytes)),
            };
        };
        // The leading bundles are equally long. Of slices, an inner one has at most four vertices more than an outer
        // one, so that at most four bundles come after them.
        let len = |k| record_len(self.payload_len(RecordId::Bundle(k)));
        let full = u64::from(count).min(rule.full_bundles());
        let mut bytes = if full > 0 { full.checked_mul(len(1)?)? } else { 0 };
        for k in u32::try_from(full).ok()?..count {
            bytes = bytes.checked_add(len(k.checked_add(1)?)?)?;
        }
        Some(bytes)
    }

    /// The length of the longest record, without bundles that list their vertices.
    fn largest_record(&self) -> Option<u64> {
        let ids = [RecordId::Corners, RecordId::Validity(0), RecordId::Bundle(1), RecordId::End];
        ids.into_iter()
            .map(|id| record_len(self.payload_len(id)))
            .try_fold(0, |most, len| Some(most.max(len?)))
    }

    /// The file's length that follows from everything else in the header.
    pub(crate) fn implied_file_bytes(&self) -> Option<u64> {
        self.checked_range(RecordId::End).map(|range| range.end)
    }

    /// The record that follows `id` in the file; `None` after the end record.
    #[must_use]
    pub fn next_record(&self, id: RecordId) -> Option<RecordId> {
        let bundle_or_end = |k| if k <= self.bundle_count { RecordId::Bundle(k) } else { RecordId::End };
        match id {
            RecordId::Corners if self.validity_records > 0 => Some(RecordId::Validity(0)),
            RecordId::Corners => Some(bundle_or_end(1)),
            RecordId::Validity(j) => match j.saturating_add(1) {
                next if next < self.validity_records => Some(RecordId::Validity(next)),
                _ => Some(bundle_or_end(1)),
            },
            RecordId::Bundle(k) => Some(bundle_or_end(k.saturating_add(1))),
            RecordId::End => None,
        }
    }

    /// Every record of the file, in the order in which they lie.
    pub fn records(&self) -> impl Iterator<Item = RecordId> + '_ {
        core::iter::successors(Some(RecordId::Corners), |&id| self.next_record(id))
    }

    /// The linear indices of the vertices in bundle `k`, counted from 1, in stored order. `None` if the file has no such
    /// bundle, and for the order `explicit`, whose bundles list their vertices themselves: see
    /// [`Bundle::vertices`](crate::Bundle::vertices).
    #[must_use]
    pub fn bundle_vertices(&self, k: u32) -> Option<BundleVertices> {
        let rule = self.rule()?;
        (1..=self.bundle_count).contains(&k).then(|| rule.vertices(&self.lattice, k))
    }

    /// The linear index of vertex `n`, counted from 0, of bundle `k`, without walking there. `None` if the file has no
    /// such vertex, and for the order `explicit`.
    #[must_use]
    pub fn bundle_vertex(&self, k: u32, n: u64) -> Option<u64> {
        let rule = self.rule()?;
        (1..=self.bundle_count).contains(&k).then(|| rule.vertex(&self.lattice, k, n)).flatten()
    }
}

/// The scale exponents for which every RGB9E5 colour is exact in binary32 (IVG-HDR-04).
pub(crate) const SCALE_EXPONENTS: core::ops::RangeInclusive<i16> = -125..=112;

/// The scale exponents that an encoding may have: in `sh2-28`, coefficients are up to √5 times the scaled colour and must be
/// finite in binary32 too (IVG-HDR-04).
pub(crate) const fn scale_exponents(encoding: Encoding) -> core::ops::RangeInclusive<i16> {
    match encoding.quantity() {
        Quantity::Vectors => SCALE_EXPONENTS,
        Quantity::Radiance => -125..=110,
    }
}

fn fail(code: Code, at: u64) -> Error {
    Error::new(code, ByteOffset(at), Part::Header)
}

fn lattice_error(error: LatticeError) -> Error {
    let field = |start: u64, size: u64, axis: u8| start.saturating_add(size.saturating_mul(u64::from(axis)));
    match error {
        LatticeError::EmptyAxis { axis } => fail(codes::DIMENSIONS, field(at::DIMS, 2, axis)),
        LatticeError::NotFinite { axis } => fail(codes::ORIGIN, field(at::ORIGIN, 8, axis)),
        LatticeError::Step { axis } => fail(codes::STEP, field(at::STEP, 8, axis)),
    }
}
