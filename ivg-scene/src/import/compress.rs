//! Reading whole files, with `.gz` and `.zst` undone and a limit on what comes out.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use crate::SceneError;

/// Most bytes that a file may have after decompression: a scene of a hundred million triangles as text fits,
/// a decompression bomb does not fill the memory.
pub(crate) const MAX_FILE_BYTES: u64 = 4 << 30;

/// How a file is compressed, by its last extension.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Compression {
    None,
    Gzip,
    Zstd,
}

/// Splits `dragon.ply.gz` into `dragon.ply` and how it is compressed.
pub(crate) fn strip(name: &str) -> (&str, Compression) {
    for (suffix, compression) in [(".gz", Compression::Gzip), (".zst", Compression::Zstd)] {
        let Some(at) = name.len().checked_sub(suffix.len()) else { continue };
        if name.is_char_boundary(at) && name[at..].eq_ignore_ascii_case(suffix) {
            return (&name[..at], compression);
        }
    }
    (name, Compression::None)
}

/// Reads a file and undoes its compression.
///
/// # Errors
///
/// [`SceneError::Read`] if it cannot be opened, read or decompressed; [`SceneError::File`] if it is longer
/// than `limit` bytes.
pub(crate) fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, SceneError> {
    let failed = |source| SceneError::Read { path: path.into(), source };
    let file = BufReader::new(File::open(path).map_err(failed)?);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    read(file, strip(&name).1, limit).map_err(failed)?.ok_or_else(|| {
        SceneError::file(&path.display().to_string(), format!("is longer than {limit} bytes, the limit"))
    })
}

/// The decompressed bytes, or `None` if there are more than `limit`.
pub(crate) fn read(
    input: impl std::io::BufRead,
    compression: Compression,
    limit: u64,
) -> std::io::Result<Option<Vec<u8>>> {
    let mut bytes = Vec::new();
    let more = limit.saturating_add(1);
    match compression {
        Compression::None => input.take(more).read_to_end(&mut bytes)?,
        Compression::Gzip => {
            flate2::bufread::MultiGzDecoder::new(input).take(more).read_to_end(&mut bytes)?
        }
        Compression::Zstd => zstd::Decoder::with_buffer(input)?.take(more).read_to_end(&mut bytes)?,
    };
    Ok((bytes.len() as u64 <= limit).then_some(bytes))
}
