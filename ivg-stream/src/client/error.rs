//! Why a scene could not be fetched.

use crate::manifest::ManifestError;

use super::url::UrlError;

/// Why a scene could not be fetched. `file` is the name in the scene directory.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FetchError {
    /// The URL is none of a scene directory.
    #[error(transparent)]
    Url(#[from] UrlError),
    /// `scene.glb` cannot be used.
    #[error("scene.glb: {0}")]
    Scene(#[from] ManifestError),
    /// The connection failed again and again without progress.
    #[error(
        "{file}: gave up after {attempts} attempts: {reason}; check the address and that the server runs"
    )]
    Connection {
        /// Which file.
        file: String,
        /// Attempts without progress.
        attempts: u32,
        /// The last failure.
        reason: String,
    },
    /// The server refuses the file.
    #[error("{file}: the server answers with status {status}")]
    Status {
        /// Which file.
        file: String,
        /// The HTTP status.
        status: u16,
    },
    /// An answer breaks HTTP's rules for ranges.
    #[error("{file}: {what} (STR-CLI-04); the server cannot be used")]
    Answer {
        /// Which file.
        file: String,
        /// What is wrong with it.
        what: String,
    },
    /// The same bytes fail their checksum again and again.
    #[error("{file}: damaged after byte {offset:#x}, in {attempts} attempts: {reason}")]
    Damaged {
        /// Which file.
        file: String,
        /// Up to here it is right.
        offset: u64,
        /// How often it was fetched.
        attempts: u32,
        /// What was found.
        reason: String,
    },
    /// The file is valid or may be, but not for this reader or within its limits.
    #[error("{file}: {reason}")]
    Refused {
        /// Which file.
        file: String,
        /// Why.
        reason: String,
    },
    /// No runtime can be had.
    #[error("cannot start a runtime: {0}")]
    Runtime(std::io::Error),
    /// `scene.glb` and a file it names do not fit together.
    #[error("{file}: does not fit scene.glb: {what}; pack the scene again")]
    Inconsistent {
        /// Which file.
        file: String,
        /// What differs.
        what: String,
    },
}
