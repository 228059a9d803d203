//! The vertices as their neighbours see them, in few bytes: what is looked at in no order is what takes the time.

use alloc::vec::Vec;

use super::Shape;
use super::geometry::Cell;
use crate::machine::fetch;
use crate::room::reserve;

/// A vertex as its neighbours see it (PMESH-COD-05): the cell, then its class of height × 2¹⁶ + its scale. All four numbers of
/// several can be added at once.
pub(super) type Point = [i32; 4];

/// Bits of a coordinate that stand in the first array.
const LOW_BITS: u32 = 16;

/// Bits of one that stand in the second: those of [`Exact`](super::exact::Exact) have 20.
const HIGH_BITS: u32 = 4;

/// Bits of a scale (PMESH-COD-05).
const SCALE_BITS: u32 = 4;

/// All vertices.
#[derive(Clone, Debug, Default)]
pub(super) struct Points {
    /// The lowest bits of each coordinate; 16 × the class of height + the scale.
    lows: Vec<[u16; 4]>,
    /// The other bits of the coordinates; empty where none has any.
    highs: Vec<u16>,
    is_wide: bool,
}

impl Points {
    /// Makes room for more vertices whose coordinates are `top` at most, `total` in the end.
    pub(super) fn reserve(&mut self, more: usize, total: usize, top: [u32; 3]) {
        self.is_wide = top.iter().any(|&top| top >> LOW_BITS != 0);
        reserve(&mut self.lows, more, total);
        if self.is_wide {
            reserve(&mut self.highs, more, total);
        }
    }

    #[inline(always)]
    pub(super) fn get(&self, vertex: u32) -> Point {
        let [x, y, z, shape] = self.lows[vertex as usize].map(i32::from);
        let point = [x, y, z, shape >> SCALE_BITS << 16 | shape & ((1 << SCALE_BITS) - 1)];
        if self.is_wide { self.with_highs(point, vertex) } else { point }
    }

    /// What [`Points::scale`] is in, of the first vertices.
    #[inline(always)]
    pub(super) fn few(&self, count: usize) -> &[[u16; 4]] {
        &self.lows[..count]
    }

    /// The scale of a vertex.
    #[inline(always)]
    pub(super) fn scale([.., packed]: [u16; 4]) -> usize {
        usize::from(packed & ((1 << SCALE_BITS) - 1))
    }

    /// Has a point brought near.
    #[inline(always)]
    pub(super) fn fetch(&self, vertex: u32) {
        if let Some(point) = self.lows.get(vertex as usize) {
            fetch(point);
        }
    }

    #[inline]
    fn with_highs(&self, [x, y, z, shape]: Point, vertex: u32) -> Point {
        let high = i32::from(self.highs[vertex as usize]);
        let bits = |k: u32| (high >> (HIGH_BITS * k) & ((1 << HIGH_BITS) - 1)) << LOW_BITS;
        [x | bits(0), y | bits(1), z | bits(2), shape]
    }

    #[inline(always)]
    pub(super) fn set_shape(&mut self, vertex: u32, shape: Shape) {
        self.lows[vertex as usize][3] = packed(shape);
    }

    /// Adds a vertex, in whose cell no coordinate is negative or greater than was said.
    #[inline(always)]
    pub(super) fn push(&mut self, cell: Cell, shape: Shape) {
        let [x, y, z] = cell.map(|x| x as u16);
        self.lows.push([x, y, z, packed(shape)]);
        if self.is_wide {
            let [x, y, z] = cell.map(|x| (x >> LOW_BITS) as u16);
            self.highs.push(x | y << HIGH_BITS | z << (2 * HIGH_BITS));
        }
    }

    /// Drops all vertices from there on.
    pub(super) fn truncate(&mut self, count: usize) {
        self.lows.truncate(count);
        self.highs.truncate(count);
    }
}

#[inline(always)]
fn packed(shape: Shape) -> u16 {
    u16::from(shape.height) << SCALE_BITS | u16::from(shape.scale)
}
