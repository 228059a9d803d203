//! What can go wrong with a grid.

use std::fmt;

/// Why a grid could not be made or changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum GridError {
    /// The lattice has more vertices than the caller allows, or than fit this machine's memory addresses.
    TooManyVertices {
        /// Vertices of the lattice.
        vertices: u64,
        /// Vertices allowed.
        limit: u64,
    },
    /// The lattice breaks a rule of its own.
    Lattice(ivg_format::LatticeError),
    /// The bytes are no sound .ivg file, or end too early.
    Format(ivg_format::Error),
    /// There is not enough memory for a value at each vertex.
    Memory {
        /// Vertices of the lattice.
        vertices: usize,
    },
    /// A record belongs to a grid with another lattice.
    OtherLattice,
    /// A record holds another quantity than the grid.
    OtherQuantity,
    /// A record belongs to another file than those accepted before (another content id).
    OtherFile,
    /// An array does not have one element a vertex.
    Length {
        /// Name of the array.
        array: &'static str,
        /// Elements it has.
        found: usize,
        /// Vertices of the lattice.
        vertices: usize,
    },
}

impl fmt::Display for GridError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooManyVertices { vertices, limit } => write!(
                f,
                "the lattice has {vertices} vertices, but at most {limit} are allowed; use a coarser grid"
            ),
            Self::Memory { vertices } => {
                write!(f, "not enough memory for a lattice of {vertices} vertices; use a coarser grid")
            }
            Self::Lattice(error) => error.fmt(f),
            Self::Format(error) => error.fmt(f),
            Self::OtherLattice => f.write_str(
                "the record belongs to a file with another lattice; start again with that file's header",
            ),
            Self::OtherQuantity => f.write_str(
                "the record holds another quantity than the grid; start again with that file's header",
            ),
            Self::OtherFile => f.write_str(
                "the record belongs to another file than those before it; start again with that file's header",
            ),
            Self::Length { array, found, vertices } => {
                write!(f, "the array of {array} has {found} elements; the lattice has {vertices} vertices")
            }
        }
    }
}

impl std::error::Error for GridError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Lattice(error) => Some(error),
            Self::Format(error) => Some(error),
            _ => None,
        }
    }
}

impl From<ivg_format::LatticeError> for GridError {
    fn from(error: ivg_format::LatticeError) -> Self {
        Self::Lattice(error)
    }
}

impl From<ivg_format::Error> for GridError {
    fn from(error: ivg_format::Error) -> Self {
        Self::Format(error)
    }
}
