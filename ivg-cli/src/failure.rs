use std::fmt;
use std::path::Path;
use std::process::ExitCode;

use ivg_scene::SceneError;

/// Why a command ended early: one line for the user, and an exit status.
#[derive(Debug)]
pub(crate) struct Failure {
    message: String,
    status: u8,
}

/// Exit status of everything that is not a verdict about a file nor a usage error (`spec/common.md`).
const STATUS_FAILED: u8 = 1;
/// Exit status of a usage error; clap uses the same.
const STATUS_USAGE: u8 = 2;

impl Failure {
    /// The command could not do its work.
    pub(crate) fn new(message: impl fmt::Display) -> Self {
        Self { message: one_line(&message.to_string()), status: STATUS_FAILED }
    }

    /// The arguments contradict each other or the input.
    pub(crate) fn usage(message: impl fmt::Display) -> Self {
        Self { message: one_line(&message.to_string()), status: STATUS_USAGE }
    }

    /// A file could not be read or written, or its content was refused.
    pub(crate) fn file(path: &Path, error: impl fmt::Display) -> Self {
        Self::new(format_args!("{}: {error}", path.display()))
    }

    /// A scene could not be read or used; the file is named also where the error names but an object in it.
    pub(crate) fn scene(path: &Path, error: &SceneError) -> Self {
        if matches!(error, SceneError::Object { .. }) { Self::file(path, error) } else { Self::new(error) }
    }

    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(self.status)
    }
}

/// Errors are one line on stderr, whatever a library's message looks like.
fn one_line(message: &str) -> String {
    crate::files::shown(&message.split_whitespace().collect::<Vec<_>>().join(" "))
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}
