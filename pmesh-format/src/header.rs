//! The header and the packet directory: what a file holds and where each packet lies, without reading anything else.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use alloc::vec::Vec;
use core::ops::{Range, RangeInclusive};

use ivg_wire::{
    ByteOffset, COMMON_HEADER_BYTES, Chunk, ChunkArea, Code, CommonHeader, ContentId, END_PAYLOAD, Error,
    Maximum, Part, Step, record_len, seal_header,
};
use zerocopy::{FromBytes, IntoBytes};

use crate::attributes::Attributes;
use crate::code::codes;
use crate::coded::least_bytes;
use crate::limits::{Limits, MAX_COUNT};
use crate::storage::{Mode, Positions};
use crate::wire::{
    DIRECTORY, ENTRY_BYTES, Entry, FORMAT, HEADER_BYTES, PacketCounts, PacketLayout, Specific, at,
};

/// Bits that coded normals and texture coordinates may have (PMESH-HDR-08).
pub(crate) const PARAMETER_BITS: RangeInclusive<u8> = 4..=16;

/// A header and a packet directory that have been read and checked, or that an encoder is about to write. The default is
/// that of no file at all.
#[derive(Clone, Debug, Default, PartialEq)]
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
    /// Where the packets begin. Whoever fetches by ranges asks for this many bytes first.
    pub data_offset: u64,
    /// Length of the whole file in bytes.
    pub file_bytes: u64,
    /// Vertices of the finest level.
    pub vertex_count: u32,
    /// Wedges of the finest level.
    pub wedge_count: u32,
    /// Faces of the finest level.
    pub face_count: u32,
    /// Vertices of the coarsest level; 0 only if there are no vertices.
    pub base_vertices: u32,
    /// How packets are stored.
    pub mode: Mode,
    /// How positions are stored.
    pub positions: Positions,
    /// Which arrays the file has.
    pub attributes: Attributes,
    /// What must be added to each position \[m\].
    pub origin: [f64; 3],
    /// The least and the greatest coordinates of all positions, relative to the origin \[m\].
    pub bounds: [[f32; 3]; 2],
    /// Bits of each of the two components of a coded normal; 0 if normals are not coded.
    pub normal_bits: u8,
    /// Bits of each component of coded texture coordinates; 0 if they are not coded.
    pub uv_bits: u8,
    /// The least and the greatest texture coordinates, between which coded ones are quantised; 0 if they are not coded.
    pub uv_bounds: [[f32; 2]; 2],
    /// The packets, in order.
    pub packets: Vec<PacketEntry>,
}

/// What the directory says of a packet.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PacketEntry {
    /// The vertices that it brings.
    pub vertices: Range<u32>,
    /// The wedges that it brings.
    pub wedges: Range<u32>,
    /// The faces that it brings.
    pub faces: Range<u32>,
    /// Length of its payload \[bytes\].
    pub payload_bytes: u32,
    /// Estimated error of each of its levels, or less \[m\] (PMESH-DIR-05).
    pub error: f32,
    /// The bytes of the file in which its record lies.
    pub bytes: Range<u64>,
}

impl Header {
    /// Reads and checks the header that begins `input` and the directory that follows it.
    ///
    /// # Errors
    ///
    /// The common part first, see [`CommonHeader::read`]; then reserved bits; then the fields in the order in which they are
    /// stored; then the limits; then the directory; then the file's length. Each at the offset of its field.
    pub fn read(input: &[u8], limits: &Limits) -> Result<Step<Self>, Error> {
        match Self::read_both(input, limits)? {
            Step::NeedMore(more) => Ok(Step::NeedMore(more)),
            Step::Consumed(used, (header, _)) => Ok(Step::Consumed(used, header)),
        }
    }

    /// As [`Header::read`]; also returns the chunks that follow.
    pub(crate) fn read_both(input: &[u8], limits: &Limits) -> Result<Step<(Self, ChunkArea)>, Error> {
        let (length, common) = match CommonHeader::read(input, &FORMAT, &limits.wire)? {
            Step::NeedMore(more) => return Ok(Step::NeedMore(more)),
            Step::Consumed(length, common) => (length, common),
        };
        let specific = input.get(COMMON_HEADER_BYTES..length).unwrap_or(&[]);
        let Ok((specific, _)) = Specific::ref_from_prefix(specific) else {
            return Err(fail(ivg_wire::codes::HEADER_BYTES, 20));
        };
        let (mut header, packets) = Self::check(&common, specific, limits)?;
        let mut area = ChunkArea::new(u64::from(common.header_bytes), common.data_offset, common.content_id);
        if area.is_done() {
            return Err(Error::new(codes::DIRECTORY_MISSING, ByteOffset(common.data_offset), Part::Chunks));
        }
        match area.read(input.get(length..).unwrap_or(&[]), &limits.wire)? {
            Step::NeedMore(more) => Ok(Step::NeedMore(more)),
            Step::Consumed(used, chunk) => {
                header.read_directory(&chunk, packets, limits)?;
                common.expect_file_bytes(header.implied_file_bytes())?;
                Ok(Step::Consumed(length.saturating_add(used), (header, area)))
            }
        }
    }

    /// Checks the specific header; returns it, without its directory, and the number of packets.
    fn check(common: &CommonHeader, wire: &Specific, limits: &Limits) -> Result<(Self, u32), Error> {
        let header = Self {
            minor: common.minor,
            optional_features: common.optional_features,
            header_bytes: common.header_bytes,
            content_id: common.content_id,
            data_offset: common.data_offset,
            file_bytes: common.file_bytes,
            vertex_count: wire.vertex_count.get(),
            wedge_count: wire.wedge_count.get(),
            face_count: wire.face_count.get(),
            base_vertices: wire.base_vertices.get(),
            // Judged below, in their turn.
            mode: Mode::from_id(wire.mode).unwrap_or_default(),
            positions: Positions::from_id(wire.positions).unwrap_or_default(),
            attributes: Attributes::from_bits(wire.attributes.get())
                .ok_or(fail(ivg_wire::codes::RESERVED, at::ATTRIBUTES))?,
            origin: wire.origin.map(|x| x.get()),
            bounds: [wire.bounds_min.map(|x| x.get()), wire.bounds_max.map(|x| x.get())],
            normal_bits: wire.normal_bits,
            uv_bits: wire.uv_bits,
            uv_bounds: [wire.uv_min.map(|x| x.get()), wire.uv_max.map(|x| x.get())],
            packets: Vec::new(),
        };
        let packets = wire.packet_count.get();
        header.check_counts(packets)?;
        match Mode::from_id(wire.mode) {
            Some(_) => {}
            None if wire.mode == 0 => return Err(fail(codes::MODE_FORBIDDEN, at::MODE)),
            None => return Err(fail(codes::MODE_UNKNOWN, at::MODE)),
        }
        match Positions::from_id(wire.positions) {
            Some(_) => {}
            None if wire.positions == 0 => return Err(fail(codes::POSITIONS_FORBIDDEN, at::POSITIONS)),
            None => return Err(fail(codes::POSITIONS_UNKNOWN, at::POSITIONS)),
        }
        if !header.origin.iter().all(|x| x.is_finite()) {
            return Err(fail(codes::MESH_ORIGIN, at::ORIGIN));
        }
        let [low, high] = header.bounds;
        if !low.iter().all(|x| x.is_finite()) {
            return Err(fail(codes::BOUNDS, at::BOUNDS_MIN));
        }
        if low.iter().zip(&high).any(|(low, high)| !(high.is_finite() && low <= high)) {
            return Err(fail(codes::BOUNDS, at::BOUNDS_MAX));
        }
        if wire.reserved.get() != 0 {
            return Err(fail(ivg_wire::codes::RESERVED, at::RESERVED));
        }
        if wire.reserved_end.get() != 0 {
            return Err(fail(ivg_wire::codes::RESERVED, at::RESERVED_END));
        }
        header.check_parameters()?;
        let greatest = header.vertex_count.max(header.wedge_count).max(header.face_count);
        if greatest > limits.counts {
            return Err(fail(codes::LIMIT_COUNTS, at::VERTEX_COUNT));
        }
        Ok((header, packets))
    }

    fn check_counts(&self, packets: u32) -> Result<(), Error> {
        let Self { vertex_count, wedge_count, face_count, base_vertices, attributes, .. } = *self;
        if vertex_count > MAX_COUNT {
            return Err(fail(codes::COUNTS, at::VERTEX_COUNT));
        }
        let wedges = if attributes.seams {
            // Wedges without attributes would cost a file next to nothing and a reader much.
            attributes.on_wedges()
                && (vertex_count..=MAX_COUNT).contains(&wedge_count)
                && (vertex_count > 0 || wedge_count == 0)
        } else {
            wedge_count == vertex_count
        };
        if !wedges {
            return Err(fail(codes::COUNTS, at::WEDGE_COUNT));
        }
        if face_count > MAX_COUNT || (vertex_count == 0 && face_count != 0) {
            return Err(fail(codes::COUNTS, at::FACE_COUNT));
        }
        if base_vertices > vertex_count || (base_vertices == 0) != (vertex_count == 0) {
            return Err(fail(codes::COUNTS, at::BASE_VERTICES));
        }
        // Every packet brings a vertex, the first one the whole base.
        let splits = vertex_count.saturating_sub(base_vertices);
        if packets > splits.saturating_add(1) || (packets == 0) != (vertex_count == 0) {
            return Err(fail(codes::COUNTS, at::PACKET_COUNT));
        }
        Ok(())
    }

    /// Checks what coded attributes are quantised with (PMESH-HDR-08).
    fn check_parameters(&self) -> Result<(), Error> {
        let coded = self.mode == Mode::Coded;
        let fits = |bits: u8, coded: bool| if coded { PARAMETER_BITS.contains(&bits) } else { bits == 0 };
        if !fits(self.normal_bits, coded && self.attributes.normals) {
            return Err(fail(codes::PARAMETERS, at::NORMAL_BITS));
        }
        let uvs = coded && self.attributes.uvs;
        if !fits(self.uv_bits, uvs) {
            return Err(fail(codes::PARAMETERS, at::UV_BITS));
        }
        let [low, high] = self.uv_bounds;
        if !low.iter().all(|x| x.is_finite() && (uvs || *x == 0.0)) {
            return Err(fail(codes::PARAMETERS, at::UV_MIN));
        }
        let inside = |(low, high): (&f32, &f32)| high.is_finite() && low <= high && (uvs || *high == 0.0);
        if !low.iter().zip(&high).all(inside) {
            return Err(fail(codes::PARAMETERS, at::UV_MAX));
        }
        Ok(())
    }

    /// Reads the packet directory from its chunk.
    fn read_directory(&mut self, chunk: &Chunk<'_>, packets: u32, limits: &Limits) -> Result<(), Error> {
        if chunk.kind != DIRECTORY {
            return Err(Error::new(codes::DIRECTORY_MISSING, chunk.offset, Part::Chunk(chunk.kind)));
        }
        let start = chunk.payload_offset().0;
        let error =
            |code, at: u64| Error::new(code, ByteOffset(start.saturating_add(at)), Part::Chunk(DIRECTORY));
        let entries = match <[Entry]>::ref_from_bytes(chunk.payload) {
            Ok(entries) if entries.len() as u64 == u64::from(packets) => entries,
            _ => return Err(error(codes::DIRECTORY_LENGTH, 0)),
        };
        // As many bytes as this allocates are there.
        let mut directory = Vec::with_capacity(entries.len());
        for (k, wire) in entries.iter().enumerate() {
            let entry_at = (k as u64).saturating_mul(ENTRY_BYTES as u64);
            let entry = self
                .next_entry(directory.last(), wire, limits)
                .map_err(|(code, at)| error(code, entry_at.saturating_add(at)))?;
            directory.push(entry);
        }
        self.packets = directory;
        let whole = self.packets.last().map_or((0, 0, 0), |p| (p.vertices.end, p.wedges.end, p.faces.end));
        if whole != (self.vertex_count, self.wedge_count, self.face_count) {
            let last = (entries.len() as u64).saturating_sub(1).saturating_mul(ENTRY_BYTES as u64);
            return Err(error(codes::DIRECTORY_COUNTS, last));
        }
        Ok(())
    }

    /// The entry that follows `before`; or what is wrong with it, at which byte of it.
    fn next_entry(
        &self,
        before: Option<&PacketEntry>,
        wire: &Entry,
        limits: &Limits,
    ) -> Result<PacketEntry, (Code, u64)> {
        let start = before.map_or((0, 0, 0), |p| (p.vertices.end, p.wedges.end, p.faces.end));
        let entry = PacketEntry {
            vertices: start.0..wire.end_vertex.get(),
            wedges: start.1..wire.end_wedge.get(),
            faces: start.2..wire.end_face.get(),
            payload_bytes: wire.payload_bytes.get(),
            error: wire.error.get(),
            bytes: 0..0,
        };
        let least = start.0.saturating_add(1).max(self.base_vertices);
        if entry.vertices.end < least || entry.vertices.end > self.vertex_count {
            return Err((codes::DIRECTORY_COUNTS, at::END_VERTEX));
        }
        let wedges = entry.wedges.end.checked_sub(start.1);
        let fits = match wedges {
            Some(wedges) if self.attributes.seams => {
                wedges as usize >= entry.vertices.len() && entry.wedges.end <= self.wedge_count
            }
            Some(wedges) => wedges as usize == entry.vertices.len(),
            None => false,
        };
        if !fits {
            return Err((codes::DIRECTORY_COUNTS, at::END_WEDGE));
        }
        if entry.faces.end < start.2 || entry.faces.end > self.face_count {
            return Err((codes::DIRECTORY_COUNTS, at::END_FACE));
        }
        let arrays = match self.mode {
            Mode::Raw => self.layout(&entry).map_or(u64::MAX, |layout| layout.rest as u64),
            Mode::Coded => least_bytes(&entry),
        };
        let record = record_len(u64::from(entry.payload_bytes)).unwrap_or(u64::MAX);
        if arrays > u64::from(entry.payload_bytes) || record > u64::from(Maximum::RECORD_BYTES) {
            return Err((codes::DIRECTORY_BYTES, at::PAYLOAD_BYTES));
        }
        if record > u64::from(limits.wire.record_bytes) {
            return Err((ivg_wire::codes::LIMIT_RECORD_BYTES, at::PAYLOAD_BYTES));
        }
        let allowed = before.map_or(f32::MAX, |p| p.error);
        if !(0.0..=allowed).contains(&entry.error) {
            return Err((codes::DIRECTORY_ERROR, at::ERROR));
        }
        let first_byte = before.map_or(self.data_offset, |p| p.bytes.end);
        Ok(PacketEntry { bytes: first_byte..first_byte.saturating_add(record), ..entry })
    }

    /// Where the arrays of a packet lie in its payload.
    pub(crate) fn layout(&self, entry: &PacketEntry) -> Option<PacketLayout> {
        PacketLayout::new(self.counts(entry), self.attributes, self.positions)
    }

    /// How many of each thing a packet holds.
    pub(crate) fn counts(&self, entry: &PacketEntry) -> PacketCounts {
        let first_split = entry.vertices.start.max(self.base_vertices);
        PacketCounts {
            vertices: entry.vertices.end.saturating_sub(entry.vertices.start),
            wedges: entry.wedges.end.saturating_sub(entry.wedges.start),
            faces: entry.faces.end.saturating_sub(entry.faces.start),
            splits: entry.vertices.end.saturating_sub(first_split),
            end_vertex: entry.vertices.end,
        }
    }

    /// The levels of the whole file: every vertex count from the base to the finest level.
    #[must_use]
    pub fn levels(&self) -> RangeInclusive<u32> {
        self.base_vertices..=self.vertex_count
    }

    /// Number of packets.
    #[must_use]
    pub fn packet_count(&self) -> u32 {
        // Every packet brings at least one of at most 2³⁰ vertices.
        self.packets.len() as u32
    }

    /// The bytes of the file in which packet `k`, counted from 0, lies; empty if there is no such packet.
    #[must_use]
    pub fn packet_range(&self, k: u32) -> Range<u64> {
        self.packets.get(k as usize).map_or(0..0, |entry| entry.bytes.clone())
    }

    /// The bytes of the file in which the end record lies.
    #[must_use]
    pub fn end_range(&self) -> Range<u64> {
        let start = self.packets.last().map_or(self.data_offset, |entry| entry.bytes.end);
        start..self.file_bytes.max(start)
    }

    /// The first packet after which `level` can be shown; `None` if the file has no such level.
    #[must_use]
    pub fn packet_of_level(&self, level: u32) -> Option<u32> {
        if self.packets.is_empty() || !self.levels().contains(&level) {
            return None;
        }
        Some(self.packets.partition_point(|entry| entry.vertices.end < level) as u32)
    }

    /// The file's length that follows from the directory.
    fn implied_file_bytes(&self) -> Option<u64> {
        self.end_range().start.checked_add(record_len(END_PAYLOAD)?)
    }

    /// The bytes of header and directory payload; checksums of the header included.
    pub(crate) fn to_bytes(&self) -> ([u8; HEADER_BYTES], Vec<u8>) {
        let common = CommonHeader {
            minor: self.minor,
            required_features: 0,
            optional_features: self.optional_features,
            header_bytes: self.header_bytes,
            content_id: self.content_id,
            data_offset: self.data_offset,
            file_bytes: self.file_bytes,
        };
        let [low, high] = self.bounds;
        let [uv_low, uv_high] = self.uv_bounds;
        let specific = Specific {
            vertex_count: self.vertex_count.into(),
            wedge_count: self.wedge_count.into(),
            face_count: self.face_count.into(),
            base_vertices: self.base_vertices.into(),
            packet_count: self.packet_count().into(),
            mode: self.mode.id(),
            positions: self.positions.id(),
            attributes: self.attributes.bits().into(),
            origin: self.origin.map(Into::into),
            bounds_min: low.map(Into::into),
            bounds_max: high.map(Into::into),
            normal_bits: self.normal_bits,
            uv_bits: self.uv_bits,
            reserved: 0.into(),
            uv_min: uv_low.map(Into::into),
            uv_max: uv_high.map(Into::into),
            reserved_end: 0.into(),
        };
        let mut bytes = [0; HEADER_BYTES];
        for (to, from) in bytes.iter_mut().zip(common.to_bytes(&FORMAT).iter().chain(specific.as_bytes())) {
            *to = *from;
        }
        seal_header(&mut bytes);
        let mut directory = Vec::new();
        for entry in &self.packets {
            let wire = Entry {
                end_vertex: entry.vertices.end.into(),
                end_wedge: entry.wedges.end.into(),
                end_face: entry.faces.end.into(),
                payload_bytes: entry.payload_bytes.into(),
                error: entry.error.into(),
            };
            directory.extend_from_slice(wire.as_bytes());
        }
        (bytes, directory)
    }
}

fn fail(code: Code, at: u64) -> Error {
    Error::new(code, ByteOffset(at), Part::Header)
}

#[cfg(test)]
mod tests;
