//! Error codes: a number, a verdict, a clause and a sentence each. `spec/tables/errors.toml` is their source;
//! a test compares every constant with its row.

use crate::error::Verdict;
use core::fmt;

/// One row of the error table.
#[derive(Debug, PartialEq, Eq)]
pub struct Rule {
    /// The number: 1xx container, 2xx version, 3xx ranges, 4xx irradiance values, 5xx mesh topology, 6xx limits.
    pub number: u16,
    /// The name of the constant and of the row.
    pub name: &'static str,
    /// What the error means for the file.
    pub verdict: Verdict,
    /// The clause that is broken.
    pub clause: &'static str,
    /// What is wrong and, where that helps, what to do; lower case, no full stop.
    pub text: &'static str,
}

/// An error code. The codes that all formats share are in [`codes`]; a format crate declares its own with
/// [`error_codes!`](crate::error_codes).
#[derive(Clone, Copy)]
pub struct Code(&'static Rule);

impl Code {
    /// The code of a row.
    #[must_use]
    pub const fn new(rule: &'static Rule) -> Self {
        Self(rule)
    }

    /// The row: number, verdict, clause, sentence.
    #[must_use]
    pub const fn rule(self) -> &'static Rule {
        self.0
    }

    /// The number of the code.
    #[must_use]
    pub const fn number(self) -> u16 {
        self.0.number
    }
}

impl PartialEq for Code {
    fn eq(&self, other: &Self) -> bool {
        self.0.number == other.0.number
    }
}

impl Eq for Code {}

impl fmt::Debug for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.0.number, self.0.name)
    }
}

/// Declares error codes: a constant for each, and `ALL` with every one of them in order.
///
/// ```
/// ivg_wire::error_codes! {
///     /// A face names a vertex that has not arrived.
///     VERTEX_UNKNOWN = 599, Invalid, "PM-FACE-02", "a face names a vertex that has not arrived";
/// }
/// assert_eq!(ALL[0], VERTEX_UNKNOWN);
/// ```
#[macro_export]
macro_rules! error_codes {
    ($($(#[$meta:meta])* $name:ident = $number:literal, $verdict:ident, $clause:literal, $text:literal;)*) => {
        $(
            $(#[$meta])*
            pub const $name: $crate::Code = $crate::Code::new(&$crate::Rule {
                number: $number,
                name: stringify!($name),
                verdict: $crate::Verdict::$verdict,
                clause: $clause,
                text: $text,
            });
        )*
        /// Every code declared here, in the order of the table.
        pub const ALL: &[$crate::Code] = &[$($name),*];
    };
}

/// The codes that all our formats share.
pub mod codes {
    error_codes! {
        /// The input ends inside something that is valid so far.
        TRUNCATED = 100, NeedMore, "COM-STR-01", "the input ends here and more bytes are needed";
        /// The first eight bytes are not the format's.
        MAGIC = 101, Invalid, "COM-HDR-01", "the first bytes are not this format's signature";
        /// The header's length is not one that this version has.
        HEADER_BYTES = 102, Invalid, "COM-HDR-04", "the header length is not one this version allows";
        /// The header's checksum does not fit.
        HEADER_CHECKSUM = 103, Invalid, "COM-HDR-06", "the header's checksum does not fit";
        /// A chunk's checksum does not fit.
        CHUNK_CHECKSUM = 104, Invalid, "COM-CHK-05", "the chunk's checksum does not fit; fetch the file again";
        /// A record's checksum does not fit.
        RECORD_CHECKSUM = 105, Invalid, "COM-REC-05",
            "the record's checksum does not fit; fetch the record again";
        /// A chunk reaches beyond the data offset, or beyond the largest chunk of the format.
        CHUNK_LENGTH = 106, Invalid, "COM-CHK-02", "the chunk does not fit between header and data";
        /// A chunk's padding is not zero.
        CHUNK_PADDING = 107, Invalid, "COM-CHK-04", "the chunk's padding is not zero";
        /// A chunk type that may appear once appears again.
        CHUNK_REPEATED = 108, Invalid, "COM-CHK-07", "this chunk type may appear only once";
        /// There are more chunks than the format allows.
        CHUNK_COUNT = 109, Invalid, "COM-CHK-08", "there are more chunks than the format allows";
        /// A critical chunk of unknown type.
        CHUNK_CRITICAL = 110, Unsupported, "COM-CHK-06",
            "a critical chunk of unknown type needs a newer reader";
        /// The record here does not have the id that belongs here.
        RECORD_ID = 111, Invalid, "COM-REC-03", "the record here has another id than belongs here";
        /// A record's padding is not zero.
        RECORD_PADDING = 112, Invalid, "COM-REC-04", "the record's padding is not zero";
        /// More bytes were given for a record than it has.
        RECORD_LENGTH = 113, Invalid, "COM-REC-06", "there are more bytes than this record has";
        /// The end record does not name the file's length.
        END_MISMATCH = 114, Invalid, "COM-REC-07", "the end record does not name the file's length";
        /// Bytes after the end record.
        TRAILING_BYTES = 115, Invalid, "COM-REC-08", "there are bytes after the end record";
        /// The data offset is impossible.
        DATA_OFFSET = 116, Invalid, "COM-HDR-09", "the data offset does not fit header and file length";
        /// The file length does not follow from the header.
        FILE_BYTES = 117, Invalid, "COM-HDR-10", "the file length is not the one that follows from the header";
        /// A reserved field is not zero.
        RESERVED = 118, Unsupported, "COM-VER-04", "a reserved field is not zero: a newer reader is needed";
        /// Another major version.
        MAJOR_VERSION = 201, Unsupported, "COM-VER-01", "the file has another major version";
        /// A required feature that this reader does not have.
        REQUIRED_FEATURE = 202, Unsupported, "COM-VER-03", "the file needs a feature that this reader lacks";
        /// The header is longer than the caller allows.
        LIMIT_HEADER_BYTES = 601, Limit, "COM-LIM-01", "the header is longer than the limit";
        /// A chunk is longer than the caller allows.
        LIMIT_CHUNK_BYTES = 602, Limit, "COM-LIM-01", "the chunk is longer than the limit";
        /// There are more chunks than the caller allows.
        LIMIT_CHUNKS = 603, Limit, "COM-LIM-01", "there are more chunks than the limit";
        /// A record is longer than the caller allows.
        LIMIT_RECORD_BYTES = 604, Limit, "COM-LIM-01", "a record is longer than the limit";
    }
}
