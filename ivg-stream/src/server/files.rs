//! Which file a request means, and its strong entity tag.

use std::collections::HashMap;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, SystemTime};

use sha2::{Digest, Sha256};

use crate::digest::hex;
use crate::http::path;

/// A file younger than this is hashed again at the next request: it could be written once more within the same
/// tick of the file system's clock (10 ms at most on Linux) and keep length and times.
const SETTLED_AFTER: Duration = Duration::from_millis(100);
/// How often hashing is begun anew when a file changes under it.
const HASH_ATTEMPTS: u32 = 3;

/// The files below one directory.
#[derive(Debug)]
pub(super) struct Files {
    root: PathBuf,
    tags: Mutex<HashMap<PathBuf, Arc<TagSlot>>>,
}

/// The tag of one file, with the state of the file it belongs to, once it is known.
type TagSlot = tokio::sync::Mutex<Option<(Identity, String)>>;

/// A file opened for one answer.
#[derive(Debug)]
pub(super) struct Opened {
    /// Open at byte 0.
    pub(super) file: std::fs::File,
    /// Where it really is.
    pub(super) path: PathBuf,
    /// Its length \[bytes\].
    pub(super) length: u64,
    /// Quoted SHA-256 of its content.
    pub(super) tag: String,
}

/// What tells one state of a file from another without reading it.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Identity {
    length: u64,
    modified: Option<SystemTime>,
    /// Device, inode and change time where the platform has them.
    platform: [i64; 4],
}

impl Identity {
    fn of(file: &std::fs::File) -> io::Result<Self> {
        let metadata = file.metadata()?;
        #[cfg(unix)]
        let platform = {
            use std::os::unix::fs::MetadataExt;
            [
                metadata.dev().cast_signed(),
                metadata.ino().cast_signed(),
                metadata.ctime(),
                metadata.ctime_nsec(),
            ]
        };
        #[cfg(not(unix))]
        let platform = [0; 4];
        Ok(Self { length: metadata.len(), modified: metadata.modified().ok(), platform })
    }

    fn is_settled(&self) -> bool {
        let age = self.modified.and_then(|modified| SystemTime::now().duration_since(modified).ok());
        age.is_some_and(|age| age > SETTLED_AFTER)
    }
}

impl Files {
    /// # Errors
    /// If `directory` is none or cannot be read.
    pub(super) fn open(directory: &Path) -> io::Result<Self> {
        let root = directory.canonicalize()?;
        std::fs::read_dir(&root)?;
        Ok(Self { root, tags: Mutex::default() })
    }

    /// Opens the file that the path of a request means and finds its tag; `Ok(None)` if there is none to be had.
    ///
    /// # Errors
    /// If the file is there but cannot be read, or keeps changing while it is read.
    pub(super) async fn find(&self, request_path: &str) -> io::Result<Option<Opened>> {
        let Some(names) = path::names(request_path) else { return Ok(None) };
        let root = self.root.clone();
        let Some((file, path)) = blocking(move || open_below(&root, &names)).await? else { return Ok(None) };
        let slot = {
            let mut tags = self.tags.lock().unwrap_or_else(PoisonError::into_inner);
            Arc::clone(tags.entry(path.clone()).or_default())
        };
        // Held while hashing: others who ask for the same file wait and find the result.
        let mut known = slot.lock().await;
        let earlier = known.clone();
        let (file, identity, tag) = blocking(move || tagged(file, earlier)).await?;
        *known = identity.is_settled().then(|| (identity.clone(), tag.clone()));
        Ok(Some(Opened { file, path, length: identity.length, tag }))
    }
}

/// Opens a regular file below `root`; `None` if there is none. Links are followed only inside.
fn open_below(root: &Path, names: &[String]) -> io::Result<Option<(std::fs::File, PathBuf)>> {
    let asked = names.iter().fold(root.to_owned(), |path, name| path.join(name));
    let found = match asked.canonicalize() {
        Ok(found) => found,
        // Too long a name, a file where a directory should be, a loop of links: all mean "not there".
        Err(error) if error.kind() == io::ErrorKind::PermissionDenied => return Err(error),
        Err(_) => return Ok(None),
    };
    // Looked at before opening: opening a pipe or a device can wait for ever or do something.
    if !found.starts_with(root) || !found.metadata()?.is_file() {
        return Ok(None);
    }
    Ok(Some((std::fs::File::open(&found)?, found)))
}

/// The tag of an open file, from `known` if that still holds, and the file at byte 0.
fn tagged(
    mut file: std::fs::File,
    known: Option<(Identity, String)>,
) -> io::Result<(std::fs::File, Identity, String)> {
    use std::io::Seek;
    for _ in 0..HASH_ATTEMPTS {
        let before = Identity::of(&file)?;
        if let Some((_, tag)) = known.as_ref().filter(|(identity, _)| *identity == before) {
            return Ok((file, before, tag.clone()));
        }
        let digest = sha256_of(&mut file)?;
        file.rewind()?;
        if Identity::of(&file)? == before {
            return Ok((file, before, format!("\"{}\"", hex(&digest))));
        }
    }
    Err(io::Error::new(io::ErrorKind::ResourceBusy, "the file keeps changing"))
}

fn sha256_of(file: &mut std::fs::File) -> io::Result<[u8; 32]> {
    let mut hash = Sha256::new();
    let mut piece = vec![0; 64 * 1024];
    loop {
        match file.read(&mut piece) {
            Ok(0) => return Ok(hash.finalize().into()),
            Ok(n) => hash.update(&piece[..n]),
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

async fn blocking<T: Send + 'static>(work: impl FnOnce() -> io::Result<T> + Send + 'static) -> io::Result<T> {
    tokio::task::spawn_blocking(work).await.map_err(io::Error::other)?
}

#[cfg(test)]
mod tests;
