//! What all our formats share: magic, version, chunk and record envelopes, checksums, limits, errors.
//!
//! Authority: `spec/common.md`; every clause id that appears in code or in an error message (`COM-HDR-03`)
//! is a rule of that document. The crate knows frames, not contents:
//!
//! ```text
//! 0                 32                    header_bytes            data_offset                 file_bytes
//! ├─ common header ─┼─ specific header ───┼─ chunk ─┬─ chunk ─ … ─┼─ record ─┬─ record ─ … ─ end ┤
//!    magic, version    content id, ranges    type, payload, CRC      id, generation, payload, CRC
//! ```
//!
//! - [`CommonHeader`] reads and writes bytes 0 to 56, [`ChunkArea`] and [`write_chunk`] the chunks,
//!   [`read_record`] and [`write_record`] the records.
//! - [`Decoder`] is the push decoder of every format: a format crate implements [`Format`] and names it. [`BufferedDecoder`]
//!   owns the buffer; a visitor of events may answer with an error of its own ([`Answer`]).
//! - [`Error`] says what is wrong, at which absolute byte, in which part, against which clause; its
//!   [`Verdict`] is what a caller acts on.
//! - Nothing here allocates while reading: payloads are windows into the caller's buffer, and a length is
//!   compared with [`Limits`] before anybody waits for that many bytes.
//!
//! ```
//! use ivg_wire::{ByteOffset, ContentId, Step, read_record, write_record};
//!
//! let content = ContentId::of(&[b"what is encoded"]);
//! let mut file = Vec::new();
//! write_record(&mut file, 7, 0, b"payload", content);
//! match read_record(&file, ByteOffset(0), 7, 7, content)? {
//!     Step::Consumed(used, record) => {
//!         assert_eq!((used, record.payload), (file.len(), &b"payload"[..]));
//!     }
//!     Step::NeedMore(_) => unreachable!("the whole record is there"),
//! }
//! # Ok::<(), ivg_wire::Error>(())
//! ```
//!
//! Features: `std` (default) only lets dependencies detect processor features; it never changes a result.
#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;

mod buffered;
mod chunk;
mod code;
mod crc;
mod cursor;
mod decoder;
mod error;
mod hash;
mod header;
mod limits;
mod record;
mod step;

pub use buffered::BufferedDecoder;
pub use chunk::{CHUNK_OVERHEAD, Chunk, ChunkArea, ChunkKind, chunk_len, write_chunk};
pub use code::{Code, Rule, codes};
pub use crc::{ContentId, crc32};
pub use cursor::Cursor;
pub use decoder::{Answer, Decoder, Format, decode_all, once};
pub use error::{ByteOffset, Error, ErrorKind, Part, Verdict};
pub use hash::splitmix64;
pub use header::{COMMON_HEADER_BYTES, CommonHeader, FormatId, seal_header};
pub use limits::{Limits, Maximum};
pub use record::{
    END_PAYLOAD, END_RECORD, RECORD_OVERHEAD, Record, begin_record, fetched_alone, read_end, read_record,
    record_len, seal, write_end, write_record,
};
pub use step::Step;
