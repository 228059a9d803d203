//! The error taxonomy: what is wrong, where, against which rule, and how a caller should react.

use crate::chunk::ChunkKind;
use crate::code::{Code, Rule, codes};
use core::fmt;

/// A position in a file, counted from its first byte, whatever window of it is in memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ByteOffset(pub u64);

/// What a reader says of a file or of a prefix of one (COM-VERD-01).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// A whole, valid file.
    Ok,
    /// Valid so far; more bytes are needed.
    NeedMore,
    /// The bytes break a rule; checksums included.
    Invalid,
    /// The bytes may be right, but need a newer or more capable reader.
    Unsupported,
    /// The file asks for more than this reader was told to spend.
    Limit,
}

impl Verdict {
    /// The exit status of a program that reports this verdict: 0, 40, 41, 42 or 43 (COM-VERD-02).
    #[must_use]
    pub const fn exit_code(self) -> u8 {
        match self {
            Self::Ok => 0,
            Self::NeedMore => 40,
            Self::Invalid => 41,
            Self::Unsupported => 42,
            Self::Limit => 43,
        }
    }

    /// The name used in the specification's tables: `ok`, `need-more`, `invalid`, `unsupported`, `limit`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::NeedMore => "need-more",
            Self::Invalid => "invalid",
            Self::Unsupported => "unsupported",
            Self::Limit => "limit",
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The part of a file in which an error lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Part {
    /// The common and the specific header.
    Header,
    /// A chunk whose type has not been read yet, or the area of chunks as a whole.
    Chunks,
    /// The chunk of this type.
    Chunk(ChunkKind),
    /// The record that should have this id.
    Record(u32),
    /// After the end record.
    AfterEnd,
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Header => f.write_str("header"),
            Self::Chunks => f.write_str("chunks"),
            Self::Chunk(kind) => write!(f, "chunk {kind}"),
            Self::Record(crate::record::END_RECORD) => f.write_str("end record"),
            Self::Record(id) if id < 0x8000_0000 => write!(f, "record {id}"),
            Self::Record(id) => write!(f, "record {id:#x}"),
            Self::AfterEnd => f.write_str("bytes after the end record"),
        }
    }
}

/// What is wrong, grouped by how a caller reacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The input ends inside something that is valid so far.
    Truncated,
    /// A rule is broken.
    Malformed(Code),
    /// A newer or more capable reader is needed.
    Unsupported(Code),
    /// One of the caller's limits is exceeded.
    Limit(Code),
    /// A checksum does not fit the bytes.
    Checksum {
        /// Which checksum: of the header, of a chunk, of a record.
        code: Code,
        /// The value in the file.
        stored: u32,
        /// The value that the bytes have.
        computed: u32,
    },
}

/// Why a file, or a part of one, was not accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Error {
    kind: ErrorKind,
    offset: ByteOffset,
    part: Part,
}

impl Error {
    /// The error `code` at `offset` in `part`; its kind follows from the verdict that the code has in the
    /// specification's table.
    #[cold]
    #[must_use]
    pub const fn new(code: Code, offset: ByteOffset, part: Part) -> Self {
        let kind = match code.rule().verdict {
            Verdict::Unsupported => ErrorKind::Unsupported(code),
            Verdict::Limit => ErrorKind::Limit(code),
            Verdict::NeedMore => ErrorKind::Truncated,
            Verdict::Ok | Verdict::Invalid => ErrorKind::Malformed(code),
        };
        Self { kind, offset, part }
    }

    /// The input ends at `offset`, inside `part`.
    #[cold]
    #[must_use]
    pub const fn truncated(offset: ByteOffset, part: Part) -> Self {
        Self { kind: ErrorKind::Truncated, offset, part }
    }

    /// The checksum stored at `offset` does not fit.
    #[cold]
    #[must_use]
    pub const fn checksum(code: Code, stored: u32, computed: u32, offset: ByteOffset, part: Part) -> Self {
        Self { kind: ErrorKind::Checksum { code, stored, computed }, offset, part }
    }

    /// What is wrong, grouped by reaction.
    #[must_use]
    pub const fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// Where: the absolute position of the field at fault, or of the end of the input if it is truncated.
    #[must_use]
    pub const fn offset(&self) -> ByteOffset {
        self.offset
    }

    /// In which part of the file.
    #[must_use]
    pub const fn part(&self) -> Part {
        self.part
    }

    /// The verdict on the file.
    #[must_use]
    pub const fn verdict(&self) -> Verdict {
        match self.kind {
            ErrorKind::Truncated => Verdict::NeedMore,
            ErrorKind::Malformed(_) | ErrorKind::Checksum { .. } => Verdict::Invalid,
            ErrorKind::Unsupported(_) => Verdict::Unsupported,
            ErrorKind::Limit(_) => Verdict::Limit,
        }
    }

    /// The number of the error in `spec/tables/errors.toml`.
    #[must_use]
    pub const fn code(&self) -> u16 {
        self.rule().number
    }

    /// The clause of the specification that is broken, such as `COM-HDR-03`.
    #[must_use]
    pub const fn clause(&self) -> &'static str {
        self.rule().clause
    }

    /// The row of the error table.
    #[must_use]
    pub const fn rule(&self) -> &'static Rule {
        match self.kind {
            ErrorKind::Truncated => codes::TRUNCATED.rule(),
            ErrorKind::Malformed(code)
            | ErrorKind::Unsupported(code)
            | ErrorKind::Limit(code)
            | ErrorKind::Checksum { code, .. } => code.rule(),
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Rule { text, clause, .. } = self.rule();
        f.write_str(text)?;
        if let ErrorKind::Checksum { stored, computed, .. } = self.kind {
            write!(f, ": stored {stored:#010x}, computed {computed:#010x},")?;
        }
        write!(f, " at byte {:#x} in {} ({clause})", self.offset.0, self.part)
    }
}

impl core::error::Error for Error {}

#[cfg(test)]
mod tests;
