//! How numbers are stored in raw packets: `spec/pmesh.md`, PMESH-PKT-02 and PMESH-PKT-04.

use super::Fault;

/// Codes of `spec/tables/errors.toml`.
pub(super) const VARINT: u16 = 508;
pub(super) const PACKET_LENGTH: u16 = 512;
pub(super) const PACKET_PADDING: u16 = 513;

/// ⌈log₂ x⌉ of a number that is not 0: the least number of bits that tell so many things apart.
pub(super) fn bits(x: usize) -> usize {
    (0..).find(|&bits| 1usize << bits >= x).unwrap_or(0)
}

/// Packed numbers, bit by bit, from a byte of the payload on.
pub(super) struct Packed<'a> {
    payload: &'a [u8],
    /// The first byte.
    pub(super) start: usize,
    /// Bits that have been read.
    bits: usize,
}

impl<'a> Packed<'a> {
    pub(super) fn new(payload: &'a [u8], start: usize) -> Self {
        Self { payload, start, bits: 0 }
    }

    /// The next number and the byte that its first bit is in; `None` if the payload ends before it does.
    pub(super) fn read(&mut self, width: usize) -> Option<(usize, usize)> {
        let at = self.start + self.bits / 8;
        let mut value = 0;
        for place in 0..width {
            let byte = self.payload.get(self.start + self.bits / 8)?;
            value |= usize::from(byte >> (self.bits % 8) & 1) << place;
            self.bits += 1;
        }
        Some((value, at))
    }

    /// The byte behind the last one that bits have been read of.
    pub(super) fn end(&self) -> usize {
        self.start + self.bits.div_ceil(8)
    }

    /// The unused bits of the last byte are 0.
    pub(super) fn padding(&self) -> Result<(), Fault> {
        let used = self.bits % 8;
        if used != 0 && self.payload[self.end() - 1] >> used != 0 {
            return Err(Fault { code: PACKET_PADDING, at: self.end() - 1 });
        }
        Ok(())
    }
}

/// A number of variable length, and where it begins.
pub(super) fn varint(payload: &[u8], at: &mut usize) -> Result<(usize, usize), Fault> {
    let start = *at;
    let mut value = 0u64;
    for place in 0.. {
        let Some(&byte) = payload.get(*at) else { return Err(Fault { code: PACKET_LENGTH, at: start }) };
        *at += 1;
        value |= u64::from(byte & 0x7F) << (7 * place);
        let more = byte & 0x80 != 0;
        let too_long = place > 0 && byte == 0;
        if too_long || value >= 1 << 32 || (place == 4 && more) {
            return Err(Fault { code: VARINT, at: start });
        }
        if !more {
            return Ok((value as usize, start));
        }
    }
    unreachable!("the fifth byte is the last")
}
