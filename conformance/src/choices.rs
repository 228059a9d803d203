//! Turns bytes into choices, so that a fuzzer that mutates bytes mutates what is built from them.

/// Reads choices from the front of some bytes; when these are used up, every choice is zero.
#[derive(Debug, Clone)]
pub struct Choices<'a> {
    rest: &'a [u8],
}

impl<'a> Choices<'a> {
    /// All choices come from these bytes.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// Whether every further choice will be zero.
    #[must_use]
    pub fn is_used_up(&self) -> bool {
        self.rest.is_empty()
    }

    /// The bytes that no choice has used yet.
    #[must_use]
    pub fn rest(self) -> &'a [u8] {
        self.rest
    }

    /// Any 8 bits.
    pub fn byte(&mut self) -> u8 {
        self.bytes::<1>()[0]
    }

    /// Any 32 bits.
    pub fn word(&mut self) -> u32 {
        u32::from_le_bytes(self.bytes())
    }

    /// Any 64 bits.
    pub fn long(&mut self) -> u64 {
        u64::from_le_bytes(self.bytes())
    }

    /// A number below `end`, or 0 if `end` is 0; from 2 bytes, so not every number of a longer range.
    pub fn below(&mut self, end: usize) -> usize {
        usize::from(u16::from_le_bytes(self.bytes())) % end.max(1)
    }

    /// A finite number, small ones more often than not.
    pub fn finite(&mut self) -> f32 {
        let bits = self.word();
        let value = f32::from_bits(bits);
        if value.is_finite() { value } else { f32::from_bits(bits & 0x3FFF_FFFF) }
    }

    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        let mut bytes = [0; N];
        let (taken, rest) = self.rest.split_at(self.rest.len().min(N));
        bytes[..taken.len()].copy_from_slice(taken);
        self.rest = rest;
        bytes
    }
}
