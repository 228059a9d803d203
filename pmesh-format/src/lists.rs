//! Which corner slots switch to each wedge when its vertex comes: slot = 3 × face + corner.
//!
//! A slot is on a list for every wedge that its corner passes on the way from the finest level down to that at which its face is
//! introduced. Adding a vertex gives the slots on the lists of its wedges these wedges; taking it away, what they become.

use alloc::vec::Vec;
use core::ops::Range;

/// The most slots of a [`Lists`].
pub(crate) const MOST: u64 = u32::MAX as u64;

/// The slots of corners, with all wedges that each passes.
pub(crate) trait Walks {
    /// Calls `visit` with each wedge and each slot that switches to it, slots ascending.
    fn each(&self, visit: impl FnMut(u32, u32));
}

/// The slots of each of some wedges that follow each other, one list behind the other.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lists {
    first: u32,
    /// Where the list of each wedge begins, and where the last one ends.
    starts: Vec<u32>,
    slots: Vec<u32>,
}

impl Lists {
    /// Lists of the wedges `wedges`, those that `walks` names, in as many parts as are needed for none to have more than `most`
    /// slots, but one wedge at least; appended to `parts`. Wedges before `wedges` are passed over.
    pub(crate) fn build(wedges: Range<u32>, walks: &impl Walks, most: u64, parts: &mut Vec<Self>) {
        // Counted two places up, so that filling leaves the starts.
        let count = wedges.len();
        let mut starts = Vec::new();
        starts.reserve_exact(count + 2);
        starts.resize(count + 2, 0u32);
        let mut total = 0u64;
        let counts = &mut starts[2..];
        walks.each(|wedge, _| {
            if let Some(of) = counts.get_mut(wedge.wrapping_sub(wedges.start) as usize) {
                *of += 1;
                total += 1;
            }
        });
        if total > most && count > 1 {
            drop(starts);
            let middle = wedges.start + count as u32 / 2;
            Self::build(wedges.start..middle, walks, most, parts);
            return Self::build(middle..wedges.end, walks, most, parts);
        }
        let mut sum = 0;
        for start in &mut starts[1..] {
            sum += *start;
            *start = sum;
        }
        let mut slots = Vec::new();
        slots.reserve_exact(total as usize);
        slots.resize(total as usize, 0u32);
        let next = &mut starts[1..=count];
        walks.each(|wedge, slot| {
            if let Some(at) = next.get_mut(wedge.wrapping_sub(wedges.start) as usize) {
                slots[*at as usize] = slot;
                *at += 1;
            }
        });
        starts.truncate(count + 1);
        parts.push(Self { first: wedges.start, starts, slots });
    }

    /// The wedges that it has lists of.
    pub(crate) fn wedges(&self) -> Range<u32> {
        self.first..self.first + self.starts.len().saturating_sub(1) as u32
    }

    /// The slots that switch to a wedge, ascending.
    #[inline]
    pub(crate) fn of(&self, wedge: u32) -> &[u32] {
        let place = (wedge - self.first) as usize;
        &self.slots[self.starts[place] as usize..self.starts[place + 1] as usize]
    }
}

#[cfg(test)]
mod tests;
