//! A push decoder that owns the buffer.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::arithmetic_side_effects))]

use alloc::vec::Vec;

use crate::decoder::{Answer, Decoder, Format};
use crate::error::Error;

/// A decoder that owns the buffer: takes the bytes of a file in pieces of any size, as a network delivers them.
///
/// It holds at most the bytes of one header, chunk or record besides the piece just given; after a visitor's error, what
/// that piece has left.
#[derive(Clone, Debug)]
pub struct BufferedDecoder<F: Format> {
    decoder: Decoder<F>,
    buffer: Vec<u8>,
}

impl<F: Format> BufferedDecoder<F> {
    /// A decoder that accepts files within `limits`.
    #[must_use]
    pub const fn new(limits: F::Limits) -> Self {
        Self { decoder: Decoder::new(limits), buffer: Vec::new() }
    }

    /// The header, once it has been read.
    #[must_use]
    pub const fn header(&self) -> Option<&F::Header> {
        self.decoder.header()
    }

    /// Whether the end record has been read.
    #[must_use]
    pub const fn is_finished(&self) -> bool {
        self.decoder.is_finished()
    }

    /// Takes the next piece and shows `visit` every event that it completes.
    ///
    /// # Errors
    ///
    /// As [`Decoder::push`], trailing bytes included; what `visit` refuses. An event that was refused counts as read: the
    /// next piece, which may be empty, goes on with the event behind it.
    pub fn feed<A: Answer>(
        &mut self,
        piece: &[u8],
        mut visit: impl FnMut(F::Event<'_>) -> A,
    ) -> Result<(), A::Error> {
        // Events are read straight from the piece while nothing is waiting; only what is left is copied.
        let read = if self.buffer.is_empty() {
            let (used, read) = self.decoder.read_all(piece, &mut visit);
            self.buffer.extend_from_slice(piece.get(used..).unwrap_or(&[]));
            read
        } else {
            self.buffer.extend_from_slice(piece);
            let (used, read) = self.decoder.read_all(&self.buffer, &mut visit);
            self.buffer.drain(..used);
            read
        };
        if self.decoder.has_failed() {
            // Nothing will be read any more, however much comes.
            self.buffer = Vec::new();
        }
        read
    }

    /// Says that there are no more pieces.
    ///
    /// # Errors
    ///
    /// Truncated if the end record has not been read; or the error that [`BufferedDecoder::feed`] met in the file.
    pub fn finish(&self) -> Result<(), Error> {
        self.decoder.finish(self.buffer.len())
    }
}

#[cfg(test)]
mod tests;
