//! Which of the two formats a file is in.

use std::path::Path;

use crate::failure::Failure;

/// A file format of this project.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FileKind {
    Grid,
    Mesh,
}

impl FileKind {
    /// Decides by the file's first bytes and, if they are of neither format, by its name, so that a damaged file is
    /// judged by the decoder it was meant for.
    pub(crate) fn of(path: &Path, bytes: &[u8]) -> Result<Self, Failure> {
        match bytes.get(1..4) {
            Some(b"IVG") => return Ok(Self::Grid),
            Some(b"PMS") => return Ok(Self::Mesh),
            _ => {}
        }
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("ivg") => Ok(Self::Grid),
            Some("pmesh") => Ok(Self::Mesh),
            _ => Err(Failure::file(path, "neither an .ivg nor a .pmesh file by its first bytes or its name")),
        }
    }
}
