//! How arrays grow: with what has arrived, and not beyond what the file has in the end.

use alloc::vec::Vec;

/// By how much arrays grow at once, at most: untouched memory costs next to nothing, moving what is there does.
const GROWTH: usize = 4;

/// Makes room for `more` elements of an array that will have `total` in the end: [`GROWTH`] times what there is or more, so that
/// the work of moving stays in proportion, but not more than the total.
pub(crate) fn reserve<T>(array: &mut Vec<T>, more: usize, total: usize) {
    let needed = array.len().saturating_add(more);
    if needed > array.capacity() {
        let room = array.len().saturating_mul(GROWTH).min(total).max(needed);
        array.reserve_exact(room - array.len());
    }
}

/// Gives an array that will have `total` elements in the end `len` of them, new ones being `value`.
pub(crate) fn resize<T: Clone>(array: &mut Vec<T>, len: usize, total: usize, value: T) {
    reserve(array, len.saturating_sub(array.len()), total);
    array.resize(len, value);
}
