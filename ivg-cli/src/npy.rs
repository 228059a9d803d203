//! NumPy's .npy format, version 1.0, for one array of f32.

use std::collections::TryReserveError;

/// Length of the preamble must be a multiple of this (numpy.lib.format).
const ALIGNMENT: usize = 64;

/// A C-ordered array of little-endian f32.
///
/// # Errors
///
/// If there is not enough memory for it.
///
/// # Panics
///
/// If the number of values is not the product of `shape`.
pub(crate) fn encode(
    shape: &[usize],
    values: impl ExactSizeIterator<Item = f32>,
) -> Result<Vec<u8>, TryReserveError> {
    assert_eq!(values.len(), shape.iter().product::<usize>(), "the values fill the shape");
    let sides: Vec<String> = shape.iter().map(ToString::to_string).collect();
    let mut header =
        format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({},), }}", sides.join(", "));
    let before = 10;
    let length = (before + header.len() + 1).next_multiple_of(ALIGNMENT) - before;
    header.extend(std::iter::repeat_n(' ', length - header.len() - 1));
    header.push('\n');
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(before + length + 4 * values.len())?;
    bytes.extend_from_slice(b"\x93NUMPY\x01\x00");
    bytes.extend_from_slice(&(length as u16).to_le_bytes());
    bytes.extend_from_slice(header.as_bytes());
    for value in values {
        bytes.extend_from_slice(&value.to_le_bytes());
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests;
