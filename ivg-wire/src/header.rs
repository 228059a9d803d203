//! The first 56 bytes, alike in all our formats (`spec/common.md`, "Header").
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use crate::code::codes;
use crate::crc::{ContentId, compare, crc32};
use crate::error::{ByteOffset, Error, Part};
use crate::limits::{Limits, Maximum};
use crate::step::Step;
use core::mem::offset_of;
use zerocopy::little_endian::{U16, U32, U64};
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

/// Bytes of the common header; the specific header follows.
pub const COMMON_HEADER_BYTES: usize = 56;

/// Bytes up to and including the header's checksum: what is asked for first.
const PREFIX_BYTES: usize = 32;

/// Which format and which version of it a reader understands or a writer writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FormatId {
    /// The eight bytes every file begins with.
    pub magic: [u8; 8],
    /// The major version: a reader accepts no other.
    pub major: u16,
    /// The newest minor version known.
    pub minor: u16,
    /// Length of the whole header in that minor version, a multiple of 8.
    pub header_bytes: u32,
    /// The required-feature bits known.
    pub features: u32,
}

/// The common part of a header, checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CommonHeader {
    /// Minor version of the file.
    pub minor: u16,
    /// Feature bits that a reader must know.
    pub required_features: u32,
    /// Feature bits that a reader may ignore.
    pub optional_features: u32,
    /// Length of the whole header in bytes.
    pub header_bytes: u32,
    /// Seed of all checksums but the header's.
    pub content_id: ContentId,
    /// Where the records begin: header and chunks are the bytes before.
    pub data_offset: u64,
    /// Length of the whole file.
    pub file_bytes: u64,
}

/// The bytes of [`CommonHeader`].
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
struct Wire {
    magic: [u8; 8],
    major: U16,
    minor: U16,
    required_features: U32,
    optional_features: U32,
    header_bytes: U32,
    reserved: U32,
    header_crc: U32,
    content_id: U64,
    data_offset: U64,
    file_bytes: U64,
}

const _: () =
    assert!(size_of::<Wire>() == COMMON_HEADER_BYTES && offset_of!(Wire, content_id) == PREFIX_BYTES);

const CRC_AT: usize = offset_of!(Wire, header_crc);

impl CommonHeader {
    /// Reads the common header from the beginning of a file and verifies the whole header.
    ///
    /// [`Step::Consumed`] carries the length of the whole header, which is then known to be complete and
    /// undamaged. The magic is compared byte by byte as it arrives, so that what is not this format is
    /// refused at once.
    ///
    /// # Errors
    ///
    /// In this order: signature, major version, header length, checksum, reserved field, required features,
    /// data offset; each at its own offset.
    pub fn read(input: &[u8], format: &FormatId, limits: &Limits) -> Result<Step<Self>, Error> {
        let fail = |code, at: usize| Err(Error::new(code, ByteOffset(at as u64), Part::Header));
        if let Some(at) = input.iter().zip(&format.magic).position(|(a, b)| a != b) {
            return fail(codes::MAGIC, at);
        }
        // Each field is judged as soon as it is whole, so that any split of the bytes meets the same first error.
        let major_at = offset_of!(Wire, major);
        match field::<2>(input, major_at) {
            Some(bytes) if u16::from_le_bytes(bytes) != format.major => {
                return fail(codes::MAJOR_VERSION, major_at);
            }
            _ => {}
        }
        let length_at = offset_of!(Wire, header_bytes);
        let prefix = field(input, offset_of!(Wire, minor)).zip(field(input, length_at));
        let Some((minor, header_bytes)) = prefix else {
            return Ok(Step::NeedMore(PREFIX_BYTES.saturating_sub(input.len())));
        };
        let (minor, header_bytes) = (u16::from_le_bytes(minor), u32::from_le_bytes(header_bytes));
        // A newer minor version may have appended fields; one that is known has exactly its length.
        let known = minor <= format.minor;
        let fits =
            if known { header_bytes == format.header_bytes } else { header_bytes >= format.header_bytes };
        if !fits || header_bytes % 8 != 0 || header_bytes > Maximum::HEADER_BYTES {
            return fail(codes::HEADER_BYTES, length_at);
        }
        if header_bytes > limits.header_bytes {
            return fail(codes::LIMIT_HEADER_BYTES, length_at);
        }
        let length = header_bytes as usize;
        let Some(header) = input.get(..length) else {
            return Ok(Step::NeedMore(length.saturating_sub(input.len())));
        };
        let Ok((wire, _)) = Wire::ref_from_prefix(header) else {
            return fail(codes::HEADER_BYTES, length_at);
        };
        compare(codes::HEADER_CHECKSUM, wire.header_crc.get(), header_crc(header), at(CRC_AT), Part::Header)?;
        if wire.reserved.get() != 0 {
            return fail(codes::RESERVED, offset_of!(Wire, reserved));
        }
        if wire.required_features.get() & !format.features != 0 {
            return fail(codes::REQUIRED_FEATURE, offset_of!(Wire, required_features));
        }
        let (data_offset, file_bytes) = (wire.data_offset.get(), wire.file_bytes.get());
        if data_offset % 8 != 0 || data_offset < u64::from(header_bytes) || data_offset > file_bytes {
            return fail(codes::DATA_OFFSET, offset_of!(Wire, data_offset));
        }
        let header = Self {
            minor,
            required_features: wire.required_features.get(),
            optional_features: wire.optional_features.get(),
            header_bytes,
            content_id: ContentId(wire.content_id.get()),
            data_offset,
            file_bytes,
        };
        Ok(Step::Consumed(length, header))
    }

    /// The 56 bytes of this header with its checksum still zero; [`seal_header`] fills it in once the
    /// specific header follows.
    #[must_use]
    pub fn to_bytes(&self, format: &FormatId) -> [u8; COMMON_HEADER_BYTES] {
        let wire = Wire {
            magic: format.magic,
            major: format.major.into(),
            minor: self.minor.into(),
            required_features: self.required_features.into(),
            optional_features: self.optional_features.into(),
            header_bytes: self.header_bytes.into(),
            reserved: 0.into(),
            header_crc: 0.into(),
            content_id: self.content_id.0.into(),
            data_offset: self.data_offset.into(),
            file_bytes: self.file_bytes.into(),
        };
        zerocopy::transmute!(wire)
    }
}

/// The offset of the field `file_bytes`, at which a format crate reports [`codes::FILE_BYTES`].
pub(crate) const FILE_BYTES_AT: usize = offset_of!(Wire, file_bytes);

impl CommonHeader {
    /// Checks the file length against the one that the format's header implies (COM-HDR-10).
    ///
    /// # Errors
    ///
    /// Malformed, at the field `file_bytes`, if they differ.
    pub fn expect_file_bytes(&self, implied: Option<u64>) -> Result<(), Error> {
        if implied == Some(self.file_bytes) {
            Ok(())
        } else {
            Err(Error::new(codes::FILE_BYTES, at(FILE_BYTES_AT), Part::Header))
        }
    }
}

/// Writes the checksum into a whole header (COM-HDR-06). Headers shorter than 32 bytes are left alone.
pub fn seal_header(header: &mut [u8]) {
    let crc = header_crc(header);
    if let Some(place) = header.get_mut(CRC_AT..PREFIX_BYTES) {
        place.copy_from_slice(&crc.to_le_bytes());
    }
}

/// CRC-32 over the header without the four bytes of the checksum itself.
fn header_crc(header: &[u8]) -> u32 {
    let before = header.get(..CRC_AT).unwrap_or(header);
    let after = header.get(PREFIX_BYTES..).unwrap_or(&[]);
    crc32(&[before, after])
}

fn field<const N: usize>(input: &[u8], at: usize) -> Option<[u8; N]> {
    input.get(at..)?.first_chunk().copied()
}

const fn at(offset: usize) -> ByteOffset {
    ByteOffset(offset as u64)
}

#[cfg(test)]
mod tests;
