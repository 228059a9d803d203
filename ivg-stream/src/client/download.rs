//! One file of a scene directory on its way in: which bytes to ask for, and what to do with those that come.
//! Knows no connection.
//!
//! A file is a prefix (header and chunks) and then parts (records, packets) one after another. Parts are taken in
//! file order; bytes of a part that is not whole wait in a buffer.

use std::ops::Range;

use sha2::{Digest, Sha256};

use crate::extensions::FileEntry;

/// How far the beginning of a file has been understood.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Prefix {
    /// The file must be known up to this offset at least.
    NeedUpTo(u64),
    /// Header and chunks are read; the parts begin here.
    Whole(u64),
}

/// Why bytes were refused.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Refusal {
    /// They break the format, most likely on the way here; fetched again they may not.
    Damaged(String),
    /// The file itself is not for this reader.
    Final(String),
}

/// What is known of a file's format, and where its data goes.
pub(super) trait Contents: Sized {
    /// Reads header and chunks from the first bytes of the file. Called anew with more bytes until
    /// [`Prefix::Whole`]; a call that fails or needs more leaves nothing behind.
    fn read_prefix(&mut self, bytes: &[u8]) -> Result<Prefix, Refusal>;
    /// Content id of the prefix that was read.
    fn content_id(&self) -> Option<u64>;
    /// Length of the file as its header states it.
    fn file_bytes(&self) -> Option<u64>;
    /// Where part `index` lies; the parts adjoin, and `None` follows the last.
    fn part(&self, index: u32) -> Option<Range<u64>>;
    /// How many vertices part `index` adds.
    fn part_vertices(&self, index: u32) -> u64;
    /// Vertices of the whole file, if known.
    fn vertices(&self) -> Option<u64>;
    /// Takes part `index`; parts come in order. A part that is refused changes nothing.
    fn accept(&mut self, index: u32, bytes: &[u8]) -> Result<(), Refusal>;
    /// Forgets everything.
    fn reset(&mut self) {
        *self = self.fresh();
    }
    /// The same with nothing read.
    fn fresh(&self) -> Self;
}

/// What has become of bytes that were received.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Arrived {
    /// Header and chunks are in; the parts begin at this offset.
    Prefix(u64),
    /// A part is in.
    Part {
        /// Which one.
        index: u32,
        /// Its length \[bytes\].
        bytes: u64,
        /// Vertices of the file that are in with it.
        vertices: u64,
    },
    /// The file is whole; whether its SHA-256 is the stated one.
    Complete {
        /// As stated in `scene.glb`.
        matches: bool,
    },
}

/// The state of one file.
#[derive(Debug)]
pub(super) struct Download<C> {
    pub(super) file: FileEntry,
    pub(super) contents: C,
    /// Strong entity tag of the answers so far, if the server gives one.
    pub(super) tag: Option<String>,
    /// Whether an answer has been taken since the file was begun.
    pub(super) answered: bool,
    /// Everything before this offset is in `contents`.
    verified: u64,
    /// What was received from `verified` on; while parts are being taken, from a little before.
    buffer: Vec<u8>,
    /// Bytes at the front of `buffer` that lie before `verified`.
    taken: usize,
    /// Next part; `None` before the prefix is in.
    next_part: Option<u32>,
    vertices: u64,
    /// Of the bytes before `verified`.
    hash: Sha256,
    complete: bool,
    /// How far the prefix must be known.
    prefix_target: u64,
    /// Highest position reached since the file was begun.
    pub(super) high_water: u64,
}

impl<C: Contents> Download<C> {
    pub(super) fn new(file: FileEntry, contents: C) -> Self {
        Self {
            file,
            contents,
            tag: None,
            answered: false,
            verified: 0,
            buffer: Vec::new(),
            taken: 0,
            next_part: None,
            vertices: 0,
            hash: Sha256::new(),
            complete: false,
            prefix_target: 0,
            high_water: 0,
        }
    }

    /// Offset of the first byte not received.
    pub(super) fn position(&self) -> u64 {
        self.verified + (self.buffer.len() - self.taken) as u64
    }

    pub(super) fn is_complete(&self) -> bool {
        self.complete
    }

    /// Length of header and chunks, once they are in.
    pub(super) fn data_offset(&self) -> Option<u64> {
        self.next_part.and(self.contents.part(0)).map(|first| first.start)
    }

    /// Vertices that are in.
    pub(super) fn vertices(&self) -> u64 {
        self.vertices
    }

    /// Share of the vertices that are in, in [0, 1]; 1 only for a whole file.
    pub(super) fn share(&self) -> f64 {
        match self.contents.vertices() {
            _ if self.complete => 1.0,
            Some(total) if total > 0 => (self.vertices as f64 / total as f64).min(1.0 - f64::EPSILON),
            _ => 0.0,
        }
    }

    /// Whether `share` of the vertices is in; 0 is always reached, 1 needs the whole file.
    pub(super) fn has_reached(&self, share: f64) -> bool {
        share <= 0.0
            || share.is_nan()
            || self.complete
            || (share < 1.0 && self.vertices >= self.needed(share).unwrap_or(u64::MAX))
    }

    fn needed(&self, share: f64) -> Option<u64> {
        self.contents.vertices().map(|total| (share * total as f64).ceil() as u64)
    }

    /// The bytes to ask for next on the way to `share`: about `request_bytes`, ending on the end of a part where
    /// one ends in there. Empty if nothing is needed.
    pub(super) fn next_range(&self, share: f64, request_bytes: u64, prefix_bytes: u64) -> Range<u64> {
        let start = self.position();
        if self.has_reached(share) {
            return start..start;
        }
        let Some(next) = self.next_part else {
            let end = self.prefix_target.max(prefix_bytes).max(start + 1);
            return start..end.min(self.file.byte_length).min(start + prefix_bytes.max(request_bytes));
        };
        let furthest = start.saturating_add(request_bytes.max(1));
        let needed = if share < 1.0 { self.needed(share).unwrap_or(0) } else { u64::MAX };
        let mut vertices = self.vertices;
        let mut end = start;
        for index in next.. {
            let Some(part) = self.contents.part(index) else { break };
            if part.end > furthest {
                // Part of a part, but only if not even one ends before.
                end = if end == start { furthest } else { end };
                break;
            }
            end = part.end;
            vertices += self.contents.part_vertices(index);
            if vertices >= needed {
                break;
            }
        }
        start..end.min(self.file.byte_length)
    }

    /// Takes the bytes that follow what was received, at most up to the stated length of the file, and reports
    /// what they complete.
    pub(super) fn receive(&mut self, bytes: &[u8], arrived: &mut dyn FnMut(Arrived)) -> Result<(), Refusal> {
        self.buffer.extend_from_slice(bytes);
        self.high_water = self.high_water.max(self.position());
        if self.next_part.is_none() && !self.take_prefix(arrived)? {
            return Ok(());
        }
        let outcome = self.take_parts(arrived);
        // Once for all parts: moving the rest forward after each would cost the square of their number.
        self.buffer.drain(..self.taken);
        self.taken = 0;
        outcome
    }

    fn take_prefix(&mut self, arrived: &mut dyn FnMut(Arrived)) -> Result<bool, Refusal> {
        if (self.buffer.len() as u64) < self.prefix_target {
            return Ok(false);
        }
        match self.contents.read_prefix(&self.buffer) {
            Ok(Prefix::NeedUpTo(target)) => {
                self.prefix_target = target;
                if target > self.file.byte_length {
                    return Err(self.damaged(format!(
                        "its header needs {target} bytes, scene.glb states {}",
                        self.file.byte_length
                    )));
                }
                Ok(false)
            }
            Ok(Prefix::Whole(data_offset)) => {
                let stated = self.contents.file_bytes();
                if stated != Some(self.file.byte_length) {
                    let found = stated.unwrap_or(0);
                    let expected = self.file.byte_length;
                    self.contents.reset();
                    return Err(self.damaged(format!("its header says {found} bytes, scene.glb {expected}")));
                }
                self.advance(data_offset);
                self.next_part = Some(0);
                arrived(Arrived::Prefix(data_offset));
                Ok(true)
            }
            Err(Refusal::Damaged(reason)) => Err(self.damaged(reason)),
            Err(refusal) => Err(refusal),
        }
    }

    fn take_parts(&mut self, arrived: &mut dyn FnMut(Arrived)) -> Result<(), Refusal> {
        while let Some(index) = self.next_part {
            let Some(part) = self.contents.part(index) else { break };
            let length = usize::try_from(part.end - part.start).unwrap_or(usize::MAX);
            let Some(bytes) = self.buffer[self.taken..].get(..length) else { return Ok(()) };
            match self.contents.accept(index, bytes) {
                Ok(()) => {}
                Err(Refusal::Damaged(reason)) => return Err(self.damaged(reason)),
                Err(refusal) => return Err(refusal),
            }
            self.vertices += self.contents.part_vertices(index);
            self.advance(part.end);
            self.next_part = Some(index + 1);
            arrived(Arrived::Part { index, bytes: part.end - part.start, vertices: self.vertices });
        }
        if !self.complete && self.verified == self.file.byte_length {
            self.complete = true;
            let digest: [u8; 32] = self.hash.clone().finalize().into();
            arrived(Arrived::Complete { matches: digest == self.file.sha256 });
        }
        Ok(())
    }

    /// The bytes up to `offset`, all of them in the buffer, are in `contents`.
    fn advance(&mut self, offset: u64) {
        let rest = &self.buffer[self.taken..];
        let length = usize::try_from(offset - self.verified).map_or(rest.len(), |n| n.min(rest.len()));
        self.hash.update(&rest[..length]);
        self.taken += length;
        self.verified = offset;
    }

    /// Drops what cannot be trusted: it is asked for again.
    fn damaged(&mut self, reason: String) -> Refusal {
        self.buffer.clear();
        self.taken = 0;
        self.prefix_target = 0;
        Refusal::Damaged(reason)
    }

    /// Begins the file anew, as `file` states it now.
    pub(super) fn restart(&mut self, file: FileEntry) {
        self.contents.reset();
        self.tag = None;
        self.answered = false;
        self.verified = 0;
        self.buffer = Vec::new();
        self.taken = 0;
        self.next_part = None;
        self.vertices = 0;
        self.hash = Sha256::new();
        self.complete = false;
        self.prefix_target = 0;
        self.high_water = 0;
        self.file = file;
    }
}

#[cfg(test)]
mod tests;
