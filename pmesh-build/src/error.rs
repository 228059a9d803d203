//! What makes a mesh unfit for ordering.

/// Why [`build`](crate::build) refuses a mesh. Indices are those of the input arrays.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// A position is NaN or infinite.
    #[error("vertex {vertex}: coordinate {} is NaN or infinite; remove or repair it", ["x", "y", "z"][*axis])]
    NonFinitePosition {
        /// Index of the vertex.
        vertex: usize,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
    },
    /// The origin is NaN or infinite.
    #[error("the origin of the mesh is NaN or infinite")]
    NonFiniteOrigin,
    /// A normal or texture coordinate is NaN or infinite.
    #[error("wedge {wedge}: its {attribute} is NaN or infinite; remove or repair it")]
    NonFiniteAttribute {
        /// Index of the wedge.
        wedge: usize,
        /// Which attribute.
        attribute: &'static str,
    },
    /// A weight of attributes is negative, NaN or infinite.
    #[error("the weight of {attribute} is {weight}, but must be a finite number of metres, 0 or more")]
    AttributeWeight {
        /// Which attribute.
        attribute: &'static str,
        /// The weight, as written.
        weight: String,
    },
    /// A triangle names a wedge that is not there.
    #[error("triangle {triangle} names wedge {index}, but there are only {wedges}")]
    CornerOutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// What its corner says.
        index: u32,
        /// How many wedges there are.
        wedges: usize,
    },
    /// A wedge names a vertex that is not there.
    #[error("wedge {wedge} names vertex {index}, but there are only {vertices}")]
    VertexOutOfRange {
        /// Index of the wedge.
        wedge: usize,
        /// What it says.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// An array is neither empty nor as long as what it describes.
    #[error("{array}: {found} entries where {expected} (or none) are needed")]
    ArrayLength {
        /// Which array.
        array: &'static str,
        /// Its length.
        found: usize,
        /// The length needed.
        expected: usize,
    },
    /// More than the format can hold.
    #[error("{found} {what}, but a .pmesh holds at most {maximum}; split the mesh")]
    TooMany {
        /// Vertices, wedges or triangles.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many the format holds.
        maximum: usize,
    },
}
