//! Output files that are either complete or not there.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use crate::failure::Failure;

/// Reads a whole file.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    std::fs::read(path).map_err(|error| Failure::file(path, error))
}

/// Writes `bytes` beside `path` and renames at the end, so that no partial file is ever seen under `path`. A link is
/// followed; what is neither a file nor free, such as a device, is left alone.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let failed = |error: std::io::Error| Failure::file(path, error);
    let target = target(path)?;
    let folder = folder_of(&target);
    if !folder.is_dir() {
        return Err(Failure::file(
            path,
            format_args!("the folder {} does not exist; make it first", folder.display()),
        ));
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".ivg-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // A temporary file is private by default; a result is as readable as the user's umask allows.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder).map_err(failed)?;
    file.write_all(bytes).map_err(failed)?;
    file.as_file().sync_all().map_err(failed)?;
    file.persist(&target).map_err(|error| failed(error.error))?;
    Ok(())
}

/// Refuses, before any work is done, an output path with another extension than the wanted ones: a mistyped name could
/// be that of an input.
pub(crate) fn require_extension<'a>(path: &'a Path, wanted: &[&str]) -> Result<&'a str, Failure> {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some(extension) if wanted.contains(&extension) => Ok(extension),
        _ => Err(Failure::usage(format_args!(
            "{}: the name of this output must end in .{}",
            path.display(),
            wanted.join(" or .")
        ))),
    }
}

/// Where a file of this name really is or will be.
fn target(path: &Path) -> Result<PathBuf, Failure> {
    let failed = |error: std::io::Error| Failure::file(path, error);
    match std::fs::symlink_metadata(path) {
        Ok(metadata) if metadata.is_file() => Ok(path.to_owned()),
        Ok(metadata) if metadata.is_symlink() => {
            let named = std::fs::read_link(path).map_err(failed)?;
            let target = folder_of(path).join(named);
            match std::fs::metadata(&target) {
                Ok(metadata) if !metadata.is_file() => Err(not_a_file(path)),
                Ok(_) => target.canonicalize().map_err(failed),
                Err(_) => Ok(target),
            }
        }
        Ok(_) => Err(not_a_file(path)),
        Err(_) => Ok(path.to_owned()),
    }
}

fn not_a_file(path: &Path) -> Failure {
    Failure::file(path, "there is something that is not a file; choose another name")
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Prints to stdout.
///
/// # Errors
///
/// What is printed cannot be written, as to a full disk.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    printed(stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()))
}

/// What became of a write to stdout; a reader that has gone away is not an error worth a message.
pub(crate) fn printed(result: std::io::Result<()>) -> Result<(), Failure> {
    match result {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::new(format_args!("stdout: {error}")))
        }
        _ => Ok(()),
    }
}

/// Text from a file or a scene as it may be shown on a terminal: control characters are written as escapes
/// (`spec/common.md`, security considerations).
pub(crate) fn shown(text: &str) -> String {
    let plain = |c: char| if c.is_control() { c.escape_default().to_string() } else { c.to_string() };
    text.chars().map(plain).collect()
}

#[cfg(test)]
mod tests;
