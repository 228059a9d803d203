//! Files beside a scene file: material libraries, images, buffers.

use std::fs;
use std::path::{Component, Path, PathBuf};

use crate::SceneError;

use super::compress;

/// The folder of a scene file. Nothing outside it is ever opened.
#[derive(Debug)]
pub(crate) struct Folder(Option<PathBuf>);

/// Why a file beside the scene cannot be had.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Unreadable(pub(crate) String);

impl Folder {
    /// The folder in which `file` lies.
    pub(crate) fn of(file: &Path) -> Self {
        let parent = file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Self(Some(parent.into()))
    }

    /// No folder: every file is refused.
    pub(crate) fn none() -> Self {
        Self(None)
    }

    /// Reads a file named relative to the folder, undoing its compression; `\` counts as `/`.
    ///
    /// # Errors
    ///
    /// Says why: absolute, outside the folder (also through a symbolic link), missing, too long.
    pub(crate) fn read(&self, relative: &str, limit: u64) -> Result<Vec<u8>, Unreadable> {
        let refuse = |why: &str| Err(Unreadable(format!("\"{relative}\" {why}")));
        let Some(folder) = &self.0 else { return refuse("is another file, and none may be read here") };
        let relative_path = PathBuf::from(relative.replace('\\', "/"));
        let inside =
            relative_path.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
        if !inside || relative_path.as_os_str().is_empty() {
            return refuse("lies outside the folder of the scene file; put it beside the scene");
        }
        let path = folder.join(&relative_path);
        let (Ok(real), Ok(root)) = (fs::canonicalize(&path), fs::canonicalize(folder)) else {
            return refuse("does not exist beside the scene file");
        };
        if !real.starts_with(&root) {
            return refuse("is a link out of the folder of the scene file; put the file itself there");
        }
        compress::read_file(&real, limit).map_err(|e| match e {
            SceneError::Read { source, .. } => Unreadable(format!("\"{relative}\" cannot be read: {source}")),
            other => Unreadable(other.to_string()),
        })
    }
}
