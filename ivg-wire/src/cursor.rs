//! A checked reader of little-endian numbers that knows where in the file it is.

use crate::error::{ByteOffset, Error, Part};

/// Reads numbers and slices one after the other; running out of bytes is an [`Error`] with the absolute
/// offset, never a panic.
#[derive(Clone, Debug)]
pub struct Cursor<'a> {
    rest: &'a [u8],
    offset: u64,
    part: Part,
}

impl<'a> Cursor<'a> {
    /// A reader of `bytes`, which begin at `offset` in the file and belong to `part`.
    #[must_use]
    pub const fn new(bytes: &'a [u8], offset: ByteOffset, part: Part) -> Self {
        Self { rest: bytes, offset: offset.0, part }
    }

    /// Where the next byte lies in the file.
    #[must_use]
    pub const fn offset(&self) -> ByteOffset {
        ByteOffset(self.offset)
    }

    /// The bytes that have not been read.
    #[must_use]
    pub const fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// The next `count` bytes.
    ///
    /// # Errors
    ///
    /// Truncated, at the end of the bytes, if there are fewer.
    pub fn take(&mut self, count: usize) -> Result<&'a [u8], Error> {
        match self.rest.split_at_checked(count) {
            Some((taken, rest)) => {
                self.rest = rest;
                self.offset = self.offset.saturating_add(count as u64);
                Ok(taken)
            }
            None => {
                let end = self.offset.saturating_add(self.rest.len() as u64);
                Err(Error::truncated(ByteOffset(end), self.part))
            }
        }
    }

    /// The next `N` bytes as an array.
    ///
    /// # Errors
    ///
    /// As [`Cursor::take`].
    pub fn array<const N: usize>(&mut self) -> Result<[u8; N], Error> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }
}

macro_rules! numbers {
    ($($name:ident: $type:ty, $what:literal;)*) => {
        impl Cursor<'_> {
            $(
                #[doc = concat!("The next ", $what, ".")]
                ///
                /// # Errors
                ///
                /// As [`Cursor::take`].
                pub fn $name(&mut self) -> Result<$type, Error> {
                    self.array().map(<$type>::from_le_bytes)
                }
            )*
        }
    };
}

numbers! {
    u8: u8, "byte";
    u16: u16, "16-bit unsigned integer";
    i16: i16, "16-bit signed integer";
    u32: u32, "32-bit unsigned integer";
    u64: u64, "64-bit unsigned integer";
    f32: f32, "binary32 number";
    f64: f64, "binary64 number";
}
