use std::io;
use std::path::PathBuf;

/// Why a scene cannot be read or used. Each message says what is wrong, where, and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A file cannot be opened or read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },
    /// A file as a whole is not what it should be.
    #[error("{file}: {what}")]
    File {
        /// The file as the caller named it.
        file: String,
        /// What is wrong and what to do.
        what: String,
    },
    /// A line of a text file is wrong.
    #[error("{file}:{line}: {what}")]
    Line {
        /// The file as the caller named it.
        file: String,
        /// Line, counted from 1.
        line: usize,
        /// What is wrong and what to do.
        what: String,
    },
    /// A place in a binary file is wrong.
    #[error("{file}: {what} at byte {offset:#x}")]
    Byte {
        /// The file as the caller named it.
        file: String,
        /// Offset after decompression, counted from 0.
        offset: u64,
        /// What is wrong and what to do.
        what: String,
    },
    /// An object of the scene (mesh, material, light, node, texture, camera) is wrong.
    #[error("{object}: {what}")]
    Object {
        /// Kind and name, such as `mesh "teapot"`.
        object: String,
        /// What is wrong and what to do.
        what: String,
    },
    /// Nothing in the scene emits light.
    #[error(
        "scene \"{scene}\" has no light: no emissive material, light or sky; add one with --lights FILE.toml"
    )]
    NoLight {
        /// Name of the scene.
        scene: String,
    },
}

impl SceneError {
    pub(crate) fn file(file: &str, what: impl Into<String>) -> Self {
        Self::File { file: file.into(), what: what.into() }
    }

    pub(crate) fn line(file: &str, line: usize, what: impl Into<String>) -> Self {
        Self::Line { file: file.into(), line, what: what.into() }
    }

    pub(crate) fn object(kind: &str, name: &str, what: impl Into<String>) -> Self {
        Self::Object { object: format!("{kind} \"{name}\""), what: what.into() }
    }
}
