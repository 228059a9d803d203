//! What cannot be written.

use crate::limits::MAX_COUNT;
use crate::progressive::ProgressiveMesh;

/// Why a mesh cannot be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EncodeError {
    /// An array does not have the length that follows from the others.
    Length {
        /// Which array.
        array: &'static str,
        /// Its length.
        found: usize,
        /// The length needed.
        expected: usize,
    },
    /// More than the format can hold.
    TooMany {
        /// Vertices, wedges or faces.
        what: &'static str,
        /// How many there are.
        found: usize,
    },
    /// There are vertices, but no base, or a base without as many vertices.
    Base,
    /// A number is NaN or infinite.
    NotFinite {
        /// Which array; `origin` if it is that.
        array: &'static str,
        /// Which element.
        index: usize,
    },
    /// A vertex has no wedge, or a wedge is not sorted by vertex, or belongs to a vertex that is not there.
    Wedge {
        /// The wedge at which this shows.
        wedge: usize,
    },
    /// There are several wedges at a vertex, but no attribute in which they could differ.
    WedgesWithoutAttributes,
    /// A vertex does not collapse onto an earlier one.
    Parent {
        /// The vertex.
        vertex: usize,
    },
    /// A wedge becomes one that does not belong to the parent of its vertex.
    WedgeTarget {
        /// The wedge.
        wedge: usize,
    },
    /// A face names a wedge that is not there, or a vertex twice.
    Face {
        /// The face.
        face: usize,
    },
    /// An option has a value that cannot be written.
    Option {
        /// Which option.
        option: &'static str,
    },
    /// An error is negative or rises.
    ErrorEstimate {
        /// Its index, counted from the base.
        index: usize,
    },
    /// The name of a material is longer than 65,535 bytes.
    MaterialName,
    /// The names of the materials, or the packet directory, are longer than a chunk may be.
    ChunkSize,
    /// A packet is longer than a record may be; ask for smaller ones.
    PacketSize {
        /// Which packet.
        packet: usize,
    },
}

impl core::fmt::Display for EncodeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::Length { array, found, expected } => {
                write!(f, "{array}: {found} entries where {expected} are needed")
            }
            Self::TooMany { what, found } => {
                write!(f, "{found} {what}, but a .pmesh holds at most {MAX_COUNT}; split the mesh")
            }
            Self::Base => f.write_str("the base does not fit the number of vertices"),
            Self::NotFinite { array, index } => write!(f, "{array}: entry {index} is NaN or infinite"),
            Self::Wedge { wedge } => {
                write!(f, "wedge {wedge}: wedges are not sorted by vertex, one or more each")
            }
            Self::WedgesWithoutAttributes => f.write_str("several wedges a vertex, but no attributes"),
            Self::Parent { vertex } => write!(f, "vertex {vertex} does not collapse onto an earlier vertex"),
            Self::WedgeTarget { wedge } => {
                write!(f, "wedge {wedge} becomes a wedge that the parent of its vertex does not have")
            }
            Self::Face { face } => {
                write!(f, "face {face} names a wedge that is not there, or a vertex twice")
            }
            Self::ErrorEstimate { index } => write!(f, "error estimate {index} is negative or rises"),
            Self::Option { option } => write!(f, "option {option} has a value that cannot be written"),
            Self::MaterialName => f.write_str("the name of a material is longer than 65,535 bytes"),
            Self::ChunkSize => {
                f.write_str("material names or packet directory are longer than a chunk may be")
            }
            Self::PacketSize { packet } => {
                write!(f, "packet {packet} is longer than a record may be; ask for smaller packets")
            }
        }
    }
}

impl core::error::Error for EncodeError {}

/// Checks everything that a reader of the file would.
pub(super) fn check(mesh: &ProgressiveMesh) -> Result<(), EncodeError> {
    check_lengths(mesh)?;
    check_numbers(mesh)?;
    check_tables(mesh)?;
    for (face, corners) in mesh.faces.iter().enumerate() {
        let vertex = |w: u32| mesh.wedges.vertices.get(w as usize).copied();
        match corners.map(vertex) {
            [Some(a), Some(b), Some(c)] if a != b && b != c && c != a => {}
            _ => return Err(EncodeError::Face { face }),
        }
    }
    Ok(())
}

fn check_lengths(mesh: &ProgressiveMesh) -> Result<(), EncodeError> {
    let (vertices, wedges, faces) = (mesh.positions.len(), mesh.wedges.len(), mesh.faces.len());
    for (what, found) in [("vertices", vertices), ("wedges", wedges), ("faces", faces)] {
        if found > MAX_COUNT as usize {
            return Err(EncodeError::TooMany { what, found });
        }
    }
    let base = mesh.base_vertices as usize;
    if base > vertices || (base == 0) != (vertices == 0) {
        return Err(EncodeError::Base);
    }
    let optional = |found: usize, expected: usize| if found == 0 { 0 } else { expected };
    let lengths = [
        ("collapse", mesh.collapse.len(), vertices - base),
        ("errors", mesh.errors.len(), vertices - base),
        ("normals", mesh.wedges.normals.len(), optional(mesh.wedges.normals.len(), wedges)),
        ("uvs", mesh.wedges.uvs.len(), optional(mesh.wedges.uvs.len(), wedges)),
        ("colours", mesh.wedges.colours.len(), optional(mesh.wedges.colours.len(), wedges)),
        ("materials", mesh.materials.len(), optional(mesh.materials.len(), faces)),
    ];
    for (array, found, expected) in lengths {
        if found != expected {
            return Err(EncodeError::Length { array, found, expected });
        }
    }
    Ok(())
}

fn check_numbers(mesh: &ProgressiveMesh) -> Result<(), EncodeError> {
    let not_finite = |array, index| EncodeError::NotFinite { array, index };
    if !mesh.origin.iter().all(|x| x.is_finite()) {
        return Err(not_finite("origin", 0));
    }
    let vectors = [("positions", &mesh.positions), ("normals", &mesh.wedges.normals)];
    for (array, vectors) in vectors {
        if let Some(index) = vectors.iter().position(|v| !v.iter().all(|x| x.is_finite())) {
            return Err(not_finite(array, index));
        }
    }
    if let Some(index) = mesh.wedges.uvs.iter().position(|v| !v.iter().all(|x| x.is_finite())) {
        return Err(not_finite("uvs", index));
    }
    let mut least = f32::MAX;
    for (index, &error) in mesh.errors.iter().enumerate() {
        if !(0.0..=least).contains(&error) {
            return Err(EncodeError::ErrorEstimate { index });
        }
        least = error;
    }
    Ok(())
}

fn check_tables(mesh: &ProgressiveMesh) -> Result<(), EncodeError> {
    let vertices = &mesh.wedges.vertices;
    let mut next = 0;
    for (wedge, &vertex) in vertices.iter().enumerate() {
        let known = vertex as usize == next || (next > 0 && vertex as usize == next - 1);
        if !known || vertex as usize >= mesh.positions.len() {
            return Err(EncodeError::Wedge { wedge });
        }
        next = vertex as usize + 1;
    }
    if next != mesh.positions.len() {
        return Err(EncodeError::Wedge { wedge: vertices.len() });
    }
    let has_attributes =
        !(mesh.wedges.normals.is_empty() && mesh.wedges.uvs.is_empty() && mesh.wedges.colours.is_empty());
    if vertices.len() != mesh.positions.len() && !has_attributes {
        return Err(EncodeError::WedgesWithoutAttributes);
    }
    let base = mesh.base_vertices as usize;
    for (split, &parent) in mesh.collapse.iter().enumerate() {
        if parent as usize >= base + split {
            return Err(EncodeError::Parent { vertex: base + split });
        }
    }
    let base_wedges = mesh.base_wedges();
    let (found, expected) = (mesh.wedge_collapse.len(), vertices.len() - base_wedges);
    if found != expected {
        return Err(EncodeError::Length { array: "wedge_collapse", found, expected });
    }
    for (wedge, &target) in (base_wedges..).zip(&mesh.wedge_collapse) {
        let parent = mesh.collapse[vertices[wedge] as usize - base];
        if vertices.get(target as usize) != Some(&parent) {
            return Err(EncodeError::WedgeTarget { wedge });
        }
    }
    Ok(())
}
