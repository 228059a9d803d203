//! What an indexed triangle mesh with attributes is, without a byte of the format.

use alloc::string::String;
use alloc::vec::Vec;

/// An indexed triangle mesh whose attributes lie on wedges over shared vertices.
///
/// A *vertex* is a position; a *wedge* is a vertex together with one set of attributes (normal, texture coordinates,
/// colour). A corner of a triangle names a wedge. Where a surface is smooth a vertex has one wedge; along an attribute
/// seam it has several. A graphics processor draws wedges: its vertex buffer has one entry a wedge.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct IndexedMesh {
    /// What must be added to each position \[m\].
    pub origin: [f64; 3],
    /// Vertex positions relative to [`origin`](Self::origin) \[m\].
    pub positions: Vec<[f32; 3]>,
    /// The wedges that corners name.
    pub wedges: Wedges,
    /// Wedge indices of each triangle, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Index of a material, one a triangle; empty where every triangle has material 0.
    pub materials: Vec<u16>,
    /// Names of the materials, by index; may be empty.
    pub material_names: Vec<String>,
}

/// Wedges as parallel arrays: an attribute array is empty (attribute absent) or has one entry a wedge.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Wedges {
    /// Index of the vertex that each wedge belongs to.
    pub vertices: Vec<u32>,
    /// Unit normals.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates; (0, 0) is the upper left corner of an image.
    pub uvs: Vec<[f32; 2]>,
    /// Colours: sRGB red, green, blue and linear alpha, 0 to 255.
    pub colours: Vec<[u8; 4]>,
}

impl IndexedMesh {
    /// A mesh without attributes: one wedge a vertex, material 0, origin 0.
    pub fn from_positions(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Self {
        let wedges = Wedges { vertices: (0u32..).take(positions.len()).collect(), ..Wedges::default() };
        Self { positions, wedges, triangles, ..Self::default() }
    }

    /// The vertices of triangle `triangle`.
    ///
    /// # Panics
    /// If the triangle or one of its corners is out of range; [`check_level`] finds that out without a panic.
    pub fn triangle_vertices(&self, triangle: usize) -> [u32; 3] {
        self.triangles[triangle].map(|w| self.wedges.vertices[w as usize])
    }

    /// The material of triangle `triangle`.
    pub fn material(&self, triangle: usize) -> u16 {
        self.materials.get(triangle).copied().unwrap_or(0)
    }
}

impl Wedges {
    /// How many wedges there are.
    pub fn len(&self) -> usize {
        self.vertices.len()
    }

    /// Whether there is no wedge.
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }
}

/// What is wrong with a mesh that should be a level (spec PMESH-LVL-02).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum LevelFault {
    /// A coordinate of this vertex is NaN or infinite.
    NonFinitePosition {
        /// Index of the vertex.
        vertex: usize,
    },
    /// An array of attributes or materials is neither empty nor of the length that it must have.
    ArrayLength {
        /// What the array holds.
        array: &'static str,
        /// Its length.
        found: usize,
        /// The length it must have.
        expected: usize,
    },
    /// A wedge belongs to a vertex that the level does not have.
    WedgeVertex {
        /// Index of the wedge.
        wedge: usize,
    },
    /// A wedge belongs to a vertex before that of the wedge before it.
    WedgeOrder {
        /// Index of the wedge.
        wedge: usize,
    },
    /// A corner names a wedge that the level does not have.
    Corner {
        /// Index of the triangle.
        triangle: usize,
    },
    /// Two corners of a triangle are the same vertex.
    RepeatedVertex {
        /// Index of the triangle.
        triangle: usize,
    },
}

impl core::fmt::Display for LevelFault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::NonFinitePosition { vertex } => {
                write!(f, "vertex {vertex} has a NaN or infinite coordinate")
            }
            Self::ArrayLength { array, found, expected } => {
                write!(f, "{array}: {found} entries, expected {expected} or none")
            }
            Self::WedgeVertex { wedge } => write!(f, "wedge {wedge} belongs to a vertex that is not there"),
            Self::WedgeOrder { wedge } => write!(f, "wedge {wedge} is not sorted by vertex"),
            Self::Corner { triangle } => write!(f, "triangle {triangle} names a wedge that is not there"),
            Self::RepeatedVertex { triangle } => write!(f, "triangle {triangle} names a vertex twice"),
        }
    }
}

impl core::error::Error for LevelFault {}

/// Checks that `mesh` is a valid level: every index in range, wedges sorted by vertex, the three corners of each
/// triangle distinct vertices, positions finite (spec PMESH-LVL-02).
///
/// # Errors
/// The first fault found, in the order positions, wedges, triangles.
pub fn check_level(mesh: &IndexedMesh) -> Result<(), LevelFault> {
    if let Some(vertex) = mesh.positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        return Err(LevelFault::NonFinitePosition { vertex });
    }
    let wedges = mesh.wedges.len();
    let lengths = [
        ("normals", mesh.wedges.normals.len(), wedges),
        ("texture coordinates", mesh.wedges.uvs.len(), wedges),
        ("colours", mesh.wedges.colours.len(), wedges),
        ("materials", mesh.materials.len(), mesh.triangles.len()),
    ];
    for (array, found, expected) in lengths {
        if found != 0 && found != expected {
            return Err(LevelFault::ArrayLength { array, found, expected });
        }
    }
    for (wedge, &vertex) in mesh.wedges.vertices.iter().enumerate() {
        if vertex as usize >= mesh.positions.len() {
            return Err(LevelFault::WedgeVertex { wedge });
        }
        if wedge > 0 && mesh.wedges.vertices[wedge - 1] > vertex {
            return Err(LevelFault::WedgeOrder { wedge });
        }
    }
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        if corners.iter().any(|&w| w as usize >= wedges) {
            return Err(LevelFault::Corner { triangle });
        }
        let [a, b, c] = mesh.triangle_vertices(triangle);
        if a == b || b == c || c == a {
            return Err(LevelFault::RepeatedVertex { triangle });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
