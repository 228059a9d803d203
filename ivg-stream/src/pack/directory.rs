//! A directory that is written beside its place and put there as a whole.

use std::collections::HashSet;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::PackError;
use crate::client::SCENE_FILE;
use crate::extensions::Extensions;

/// A directory under a name of its own, removed again unless it is put in its place.
#[derive(Debug)]
pub(super) struct Staged {
    /// Where it will be; absolute, links resolved.
    place: PathBuf,
    /// Where it is.
    path: PathBuf,
    /// Where an earlier one goes while they change places.
    aside: PathBuf,
}

impl Staged {
    /// Begins a directory that will be at `place`.
    pub(super) fn create(place: &Path) -> Result<Self, PackError> {
        let failed = |source| PackError::Write { path: place.to_owned(), source };
        let place = resolve(place).map_err(failed)?;
        check_replaceable(&place)?;
        let parent = place.parent().ok_or_else(|| failed(io::ErrorKind::InvalidInput.into()))?;
        let name = place.file_name().unwrap_or(OsStr::new("scene")).to_string_lossy().into_owned();
        let beside = |what: &str| parent.join(format!(".{name}.{what}-{}", std::process::id()));
        let (path, aside) = (beside("new"), beside("old"));
        // Left there by a process of the same number that was killed.
        remove(&path).map_err(failed)?;
        fs::create_dir_all(&path).map_err(|source| PackError::Write { path: path.clone(), source })?;
        Ok(Self { place, path, aside })
    }

    /// Writes a file, and makes sure that it is on the disk before anything is renamed.
    pub(super) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), PackError> {
        let path = self.path.join(name);
        let write = || {
            let mut file = File::create_new(&path)?;
            file.write_all(bytes)?;
            file.sync_all()
        };
        write().map_err(|source| PackError::Write { path: path.clone(), source })
    }

    /// Puts the directory in its place; an earlier one goes.
    pub(super) fn put_in_place(self) -> Result<(), PackError> {
        let failed = |source| PackError::Write { path: self.place.clone(), source };
        // Looked at again: something may have been put there in the meantime.
        check_replaceable(&self.place)?;
        remove(&self.aside).map_err(failed)?;
        let had_one = self.place.exists();
        if had_one {
            fs::rename(&self.place, &self.aside).map_err(failed)?;
        }
        if let Err(source) = fs::rename(&self.path, &self.place) {
            if had_one {
                // What was there comes back; if even that fails, it is still there under its other name.
                fs::rename(&self.aside, &self.place).map_err(failed)?;
            }
            return Err(failed(source));
        }
        // The new directory is complete; an old one that cannot be removed does no harm.
        let _remains = remove(&self.aside);
        Ok(())
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        // Gone already if it was put in its place.
        let _remains = remove(&self.path);
    }
}

/// The place as an absolute path without links, whether it exists or not; its parent is made.
fn resolve(place: &Path) -> io::Result<PathBuf> {
    if place.exists() {
        return place.canonicalize();
    }
    let name = place.file_name().ok_or(io::ErrorKind::InvalidInput)?;
    let parent = match place.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    fs::create_dir_all(parent)?;
    Ok(parent.canonicalize()?.join(name))
}

/// Refuses a place with anything in it that no earlier packing has put there.
fn check_replaceable(place: &Path) -> Result<(), PackError> {
    let failed = |source| PackError::Write { path: place.to_owned(), source };
    if !place.exists() {
        return Ok(());
    }
    let known = packed_files(place);
    for entry in fs::read_dir(place).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let is_file = entry.file_type().map_err(failed)?.is_file();
        if !is_file || !known.contains(&name) {
            return Err(PackError::Occupied { directory: place.to_owned(), name });
        }
    }
    Ok(())
}

/// The files that the `scene.glb` of a directory names, and itself; none if it has no readable one.
fn packed_files(directory: &Path) -> HashSet<String> {
    let Ok(glb) = fs::read(directory.join(SCENE_FILE)) else { return HashSet::new() };
    let Ok(Extensions { meshes, grid }) = Extensions::of_glb(&glb) else { return HashSet::new() };
    let files = meshes.into_iter().map(|mesh| mesh.file).chain(grid);
    files.map(|file| file.uri).chain([SCENE_FILE.to_owned()]).collect()
}

fn remove(directory: &Path) -> io::Result<()> {
    match fs::remove_dir_all(directory) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests;
