//! How much a file may ask for: the formats' maxima and the caller's limits. Source: `spec/tables/limits.toml`.

/// The largest values that the formats allow; anything beyond is invalid (COM-LIM-02).
#[derive(Clone, Copy, Debug)]
pub struct Maximum;

impl Maximum {
    /// Bytes of a header.
    pub const HEADER_BYTES: u32 = 65_536;
    /// Bytes of one chunk, envelope included.
    pub const CHUNK_BYTES: u32 = 0x7FFF_FFF8;
    /// Chunks in a file.
    pub const CHUNKS: u32 = 65_535;
    /// Bytes of one record, envelope included.
    pub const RECORD_BYTES: u32 = 0x7FFF_FFFC;
}

/// What a caller is willing to hold in memory for one file. A reader compares a declared size with these
/// before it waits for the bytes, and never allocates because of one.
///
/// The defaults are the column "our default" of the specification.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of the header.
    pub header_bytes: u32,
    /// Bytes of one chunk, envelope included.
    pub chunk_bytes: u32,
    /// Number of chunks.
    pub chunks: u32,
    /// Bytes of one record, envelope included.
    pub record_bytes: u32,
}

impl Limits {
    /// The defaults.
    #[must_use]
    pub const fn new() -> Self {
        Self { header_bytes: 4096, chunk_bytes: 1 << 20, chunks: 1024, record_bytes: 64 << 20 }
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self::new()
    }
}
