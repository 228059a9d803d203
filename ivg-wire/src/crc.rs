//! CRC-32 (ISO-HDLC, zlib's) and the content id that seeds it (COM-CRC-01, COM-CRC-02).

use crate::code::Code;
use crate::error::{ByteOffset, Error, Part};
use crate::hash::splitmix64;

/// A number that differs whenever anything encoded differs, so that chunks and records of another version of
/// a file, mixed in by a cache, fail their checksums (COM-CRC-02). Readers treat it as opaque.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct ContentId(pub u64);

impl ContentId {
    /// The content id that our writers give to a file made of `parts`: a hash of their bytes and lengths.
    /// It guards against mixing by accident, not against an adversary.
    #[must_use]
    pub fn of(parts: &[&[u8]]) -> Self {
        let mut state = 0u64;
        let mut absorb = |word: u64| state = splitmix64(state.rotate_left(23) ^ word, 0);
        for part in parts {
            let mut words = part.chunks_exact(8);
            for word in &mut words {
                let mut bytes = [0u8; 8];
                bytes.copy_from_slice(word);
                absorb(u64::from_le_bytes(bytes));
            }
            let mut rest = [0u8; 8];
            for (to, from) in rest.iter_mut().zip(words.remainder()) {
                *to = *from;
            }
            absorb(u64::from_le_bytes(rest));
            absorb(part.len() as u64);
        }
        Self(state)
    }

    /// CRC-32 over this id (8 bytes, little-endian) followed by `bytes`: the checksum of chunks and records.
    #[must_use]
    pub fn crc32(self, bytes: &[u8]) -> u32 {
        crc32(&[&self.0.to_le_bytes(), bytes])
    }
}

/// CRC-32/ISO-HDLC over the concatenation of `parts`.
#[must_use]
pub fn crc32(parts: &[&[u8]]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    for part in parts {
        hasher.update(part);
    }
    hasher.finalize()
}

/// Compares a stored checksum with the computed one: the only place that does.
///
/// Under `cfg(fuzzing)` every checksum counts as right, since a fuzzer cannot find its way past one.
pub(crate) fn compare(
    code: Code,
    stored: u32,
    computed: u32,
    offset: ByteOffset,
    part: Part,
) -> Result<(), Error> {
    if cfg!(fuzzing) || stored == computed {
        Ok(())
    } else {
        Err(Error::checksum(code, stored, computed, offset, part))
    }
}

#[cfg(test)]
mod tests;
