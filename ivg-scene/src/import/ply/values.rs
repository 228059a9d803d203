//! One value after the other, in any of the three encodings.

use crate::SceneError;

/// How the data of a PLY file is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    /// Both generations of names.
    pub(super) fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// The value of a channel of a colour at full brightness; `None` for a type that colours do not have.
    pub(super) fn full_brightness(self) -> Option<f64> {
        Some(match self {
            Self::U8 => f64::from(u8::MAX),
            Self::U16 => f64::from(u16::MAX),
            Self::F32 | Self::F64 => 1.0,
            Self::I8 | Self::I16 | Self::I32 | Self::U32 => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// A cursor over the data after the header.
pub(super) struct Values<'a> {
    file: &'a str,
    bytes: &'a [u8],
    at: usize,
    encoding: Encoding,
    line: usize,
}

impl<'a> Values<'a> {
    pub(super) fn new(
        file: &'a str,
        bytes: &'a [u8],
        at: usize,
        encoding: Encoding,
        header_lines: usize,
    ) -> Self {
        Self { file, bytes, at, encoding, line: header_lines + 1 }
    }

    /// An error at the cursor: a line of text or a byte offset.
    pub(super) fn error(&self, what: String) -> SceneError {
        match self.encoding {
            Encoding::Ascii => SceneError::line(self.file, self.line, what),
            _ => SceneError::Byte { file: self.file.into(), offset: self.at as u64, what },
        }
    }

    /// The next value; every type fits f64.
    pub(super) fn next(&mut self, scalar: Scalar) -> Result<f64, SceneError> {
        if self.encoding == Encoding::Ascii {
            return self.next_word();
        }
        let size = scalar.size();
        let Some(bytes) = self.bytes.get(self.at..self.at + size) else {
            return Err(self.error("data ends too early".into()));
        };
        let mut le = [0; 8];
        le[..size].copy_from_slice(bytes);
        if self.encoding == Encoding::BigEndian {
            le[..size].reverse();
        }
        self.at += size;
        let [a, b, c, d, ..] = le;
        Ok(match scalar {
            Scalar::I8 => f64::from(a as i8),
            Scalar::U8 => f64::from(a),
            Scalar::I16 => f64::from(i16::from_le_bytes([a, b])),
            Scalar::U16 => f64::from(u16::from_le_bytes([a, b])),
            Scalar::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Scalar::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Scalar::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Scalar::F64 => f64::from_le_bytes(le),
        })
    }

    fn next_word(&mut self) -> Result<f64, SceneError> {
        let mut rest = &self.bytes[self.at..];
        while let [first, tail @ ..] = rest
            && first.is_ascii_whitespace()
        {
            self.line += usize::from(*first == b'\n');
            rest = tail;
        }
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at = self.bytes.len() - rest.len() + length;
        let word = std::str::from_utf8(&rest[..length]).unwrap_or("\u{fffd}");
        if word.is_empty() {
            return Err(self.error("data ends too early".into()));
        }
        word.parse().map_err(|_| self.error(format!("\"{word}\" is no number")))
    }
}
