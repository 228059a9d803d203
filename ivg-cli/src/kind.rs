//! Which of the two formats a file is in.

use std::path::Path;

/// A file format of this project.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FileKind {
    Grid,
    Mesh,
}

impl FileKind {
    /// Decides by the file's first bytes and, if they are of neither format, by its name, so that a damaged file is
    /// judged by the decoder it was meant for. What is neither by bytes nor by name is judged as a grid, and refused.
    pub(crate) fn of(path: &Path, bytes: &[u8]) -> Self {
        match bytes.get(1..4) {
            Some(b"IVG") => Self::Grid,
            Some(b"PMS") => Self::Mesh,
            _ if path.extension().is_some_and(|extension| extension == "pmesh") => Self::Mesh,
            _ => Self::Grid,
        }
    }
}
