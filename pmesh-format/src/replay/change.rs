//! What a change of level reports.

use alloc::vec::Vec;
use core::ops::{Range, RangeInclusive};

/// What is different after a change of level.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LevelChange {
    /// The level before.
    pub from: u32,
    /// The level now.
    pub to: u32,
    /// Faces of the new level whose corners are others than before, or that are new: what a copy of the index buffer must
    /// be given again. Ascending, without overlaps.
    pub changed: Vec<Range<u32>>,
}

/// A level that has not arrived, or that the mesh does not have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LevelError {
    /// The level asked for.
    pub asked: u32,
    /// The levels there are; `None` before the first packet.
    pub levels: Option<RangeInclusive<u32>>,
}

impl core::fmt::Display for LevelError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match &self.levels {
            Some(levels) => {
                write!(
                    f,
                    "no level of {} vertices: there are {} to {}",
                    self.asked,
                    levels.start(),
                    levels.end()
                )
            }
            None => write!(f, "no level of {} vertices: no packet has arrived yet", self.asked),
        }
    }
}

impl core::error::Error for LevelError {}
