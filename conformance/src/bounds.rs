//! Bounds on memory and work, asserted with a counting allocator: of tests and fuzz targets alike, since it counts the
//! current thread alone.

/// So many bytes at most, for an input of a known length: `fixed + per_byte × length`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bound {
    /// Bytes that do not depend on the input.
    pub fixed: u64,
    /// Bytes for each byte of input.
    pub per_byte: u64,
}

impl Bound {
    /// The bound for an input of this length \[bytes\].
    #[must_use]
    pub fn of(self, length: usize) -> u64 {
        self.fixed.saturating_add(self.per_byte.saturating_mul(length as u64))
    }
}

/// What a function may allocate for an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Budget {
    /// Bytes held at any one time.
    pub held: Bound,
    /// Bytes allocated in all: what has been allocated has been worked on, so this bounds work too.
    pub allocated: Bound,
}

impl Budget {
    /// Calls the function, given an input of `length` bytes, and returns its result.
    ///
    /// # Panics
    ///
    /// When it allocates more than the budget has for that length.
    pub fn spend<T>(self, what: &str, length: usize, function: impl FnOnce() -> T) -> T {
        let mut result = None;
        let counted = allocation_counter::measure(|| result = Some(function()));
        let (held, allocated) = (self.held.of(length), self.allocated.of(length));
        assert!(
            counted.bytes_max <= held,
            "{what}: {} bytes held at once for {length} bytes of input, at most {held}",
            counted.bytes_max
        );
        assert!(
            counted.bytes_total <= allocated,
            "{what}: {} bytes allocated for {length} bytes of input, at most {allocated}",
            counted.bytes_total
        );
        result.expect("the function was called")
    }
}

#[cfg(test)]
mod tests;
