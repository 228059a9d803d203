//! The faces of which a corner has switched since the last report.

use alloc::vec::Vec;
use core::ops::Range;

use crate::room::resize;

/// A set of faces.
#[derive(Clone, Debug, Default)]
pub(super) struct Touched {
    /// A bit for each face.
    words: Vec<u64>,
    /// The words that are not 0, in any order.
    marked: Vec<u32>,
}

impl Touched {
    /// Makes room for that many faces, `total` in the end.
    pub(super) fn resize(&mut self, faces: usize, total: usize) {
        resize(&mut self.words, faces.div_ceil(64), total.div_ceil(64), 0);
    }

    /// Adds a face.
    #[inline]
    pub(super) fn mark(&mut self, face: u32) {
        let word = &mut self.words[(face / 64) as usize];
        if *word == 0 {
            self.marked.push(face / 64);
        }
        *word |= 1 << (face % 64);
    }

    /// Takes all faces out.
    pub(super) fn clear(&mut self) {
        for word in self.marked.drain(..) {
            self.words[word as usize] = 0;
        }
    }

    /// Takes all faces out; returns those below `end`, then all from `end` to `new_end`, as ascending ranges.
    pub(super) fn report(&mut self, end: u32, new_end: u32) -> Vec<Range<u32>> {
        let mut ranges: Vec<Range<u32>> = Vec::new();
        let mut add = |range: Range<u32>| match ranges.last_mut() {
            _ if range.is_empty() => {}
            Some(last) if last.end == range.start => last.end = range.end,
            _ => ranges.push(range),
        };
        self.marked.sort_unstable();
        for &word in &self.marked {
            let first = 64 * word;
            let mut bits = core::mem::take(&mut self.words[word as usize]);
            while bits != 0 {
                // The lowest run of ones.
                let start = bits.trailing_zeros();
                let run = (bits >> start).trailing_ones();
                bits = bits.unbounded_shr(start + run).unbounded_shl(start + run);
                add((first + start).min(end)..(first + start + run).min(end));
            }
        }
        self.marked.clear();
        add(end..new_end);
        ranges
    }
}

/// Slots that are looked at together.
const BLOCK: usize = 256;

/// The faces of ascending slots, then all from `end` to `new_end`, which are later, as ascending ranges.
pub(super) fn faces_of(slots: &[u32], end: u32, new_end: u32) -> Vec<Range<u32>> {
    let mut ranges: Vec<Range<u32>> = Vec::new();
    // Ranges are begun and made longer without a branch, since nothing tells in advance which it will be.
    let mut found = [const { 0..0 }; BLOCK + 1];
    for block in slots.chunks(BLOCK) {
        let mut last = 0;
        found[0] = ranges.pop().unwrap_or(0..0);
        for slot in block {
            let face = slot / 3;
            let Range { start, end } = found[last];
            let new = face > end || (end == 0);
            last += usize::from(new);
            found[last] = if new { face } else { start }..face + 1;
        }
        let first = usize::from(found[0].is_empty());
        ranges.extend_from_slice(&found[first..=last]);
    }
    match ranges.last_mut() {
        _ if end == new_end => {}
        Some(last) if last.end == end => last.end = new_end,
        _ => ranges.push(end..new_end),
    }
    ranges
}

#[cfg(test)]
mod tests;
