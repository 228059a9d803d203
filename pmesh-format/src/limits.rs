//! How much one file may ask of a reader. Source: `spec/tables/limits.toml`.

/// The greatest number of vertices, of wedges and of faces (PMESH-LIM-01): corner slots are numbered in 32 bits.
pub const MAX_COUNT: u32 = 1 << 30;

/// What a caller is willing to spend on one .pmesh file (PMESH-LIM-02). The defaults are the column "our default" of the
/// specification.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Sizes of header, chunks and records.
    pub wire: ivg_wire::Limits,
    /// Vertices, wedges, and faces: none of the three counts may be greater.
    pub counts: u32,
}

impl Limits {
    /// The defaults: 2²⁷ of each.
    #[must_use]
    pub const fn new() -> Self {
        Self { wire: ivg_wire::Limits::new(), counts: 1 << 27 }
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self::new()
    }
}
