//! How much one file may ask of a reader. Source: `spec/tables/limits.toml`.

/// What a caller is willing to spend on one .ivg file (IVG-LIM-01). The defaults are the column "our default"
/// of the specification.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Sizes of header, chunks and records.
    pub wire: ivg_wire::Limits,
    /// Vertices of the lattice. Nothing in this crate allocates a dense grid, but a caller does.
    pub vertices: u64,
}

impl Limits {
    /// The defaults: lattices of up to 512³ vertices.
    #[must_use]
    pub const fn new() -> Self {
        Self { wire: ivg_wire::Limits::new(), vertices: 1 << 27 }
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self::new()
    }
}
