//! The part of a dual cell that counts: what can be seen from its vertex.
//!
//! A wall through a dual cell must not average both its sides, and space inside a solid must not count as dark air. So
//! a cell that geometry touches is divided into 8 × 8 × 8 sub-cells, and those count whose eight corners can all be
//! seen from the vertex. The volume that deposits are divided by is the volume of exactly those sub-cells, so that it
//! carries no sampling error, and the light that crosses the others is left out.

use glam::Vec3;

use crate::accel::TraceScene;
use crate::dual::{Boxes, Line};

/// Sub-cells along each axis of a cell.
pub(crate) const SUB: usize = 8;

/// Sub-cells of a cell.
pub(crate) const SUB_CELLS: u32 = (SUB * SUB * SUB) as u32;

/// Fewest sub-cells that make a region, a thirty-second of the cell. Below, the volume is so small that few photons
/// cross it and each one shows; the vertex is then invalid.
pub(crate) const FEWEST_SUB_CELLS: u32 = SUB_CELLS / 32;

/// Sub-cells of one cell that count: word z, bit x + 8 y.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Mask([u64; SUB]);

/// How much of a way counts as seen: a corner that lies in a wall, as where walls and cells are aligned, is seen from
/// its front. The last 0.1 % of the way is 0.05 % of a cell.
const SIGHT: f32 = 0.999;

impl Mask {
    /// No sub-cell counts.
    pub(crate) const NONE: Self = Self([0; SUB]);

    /// The sub-cells of the cell with lowest `corner` and size `step` that can be seen from `eye`.
    pub(crate) fn seen(scene: &TraceScene, eye: Vec3, corner: [f32; 3], step: [f32; 3]) -> Self {
        // Bit x of row (z, y): is the corner (x, y, z) of the 9³ corners seen?
        let mut rows = [[0u16; SUB + 1]; SUB + 1];
        for (z, slice) in rows.iter_mut().enumerate() {
            for (y, row) in slice.iter_mut().enumerate() {
                for x in 0..=SUB {
                    let at = [x, y, z];
                    let place: [f32; 3] =
                        core::array::from_fn(|a| corner[a] + step[a] * (at[a] as f32 / SUB as f32));
                    let way = Vec3::from(place) - eye;
                    let seen = way == Vec3::ZERO || !scene.occluded(eye, way, SIGHT);
                    *row |= u16::from(seen) << x;
                }
            }
        }
        let mut mask = Self::NONE;
        for z in 0..SUB {
            for y in 0..SUB {
                let edge = rows[z][y] & rows[z][y + 1] & rows[z + 1][y] & rows[z + 1][y + 1];
                mask.0[z] |= u64::from((edge & edge >> 1) & 0xff) << (8 * y);
            }
        }
        mask
    }

    /// How many sub-cells count.
    pub(crate) fn count(&self) -> u32 {
        self.0.iter().map(|word| word.count_ones()).sum()
    }

    /// Sum over the sub-cells that count of twice the distance of their middles from that of the cell, in sub-cells.
    pub(crate) fn moments(&self) -> [i16; 3] {
        let mut moments = [0; 3];
        for at in (0..SUB * SUB * SUB).map(|n| [n % SUB, n / SUB % SUB, n / SUB / SUB]) {
            if self.contains(at) {
                moments.iter_mut().zip(at).for_each(|(sum, x)| *sum += 2 * x as i16 + 1 - SUB as i16);
            }
        }
        moments
    }

    /// Whether a sub-cell counts.
    #[inline]
    pub(crate) fn contains(&self, [x, y, z]: [usize; 3]) -> bool {
        self.0[z] >> (x + SUB * y) & 1 == 1
    }

    /// How many sub-cells count in the layer `at` across `axis`, and `None` for an axis or layer that is not there.
    pub(crate) fn layer_count(&self, axis: usize, at: usize) -> u32 {
        let mut count = 0;
        for b in 0..SUB {
            for c in 0..SUB {
                let mut cell = [at; 3];
                cell[(axis + 1) % 3] = b;
                cell[(axis + 2) % 3] = c;
                count += u32::from(self.contains(cell));
            }
        }
        count
    }

    /// Those of the sub-cells that `keep` names by their coordinates.
    pub(crate) fn count_if(&self, keep: impl Fn([usize; 3]) -> bool) -> u32 {
        (0..SUB * SUB * SUB)
            .map(|n| [n % SUB, n / SUB % SUB, n / SUB / SUB])
            .filter(|&at| self.contains(at) && keep(at))
            .count() as u32
    }
}

/// What counts in each dual cell.
#[derive(Debug)]
pub(crate) struct Regions {
    /// [`WHOLE`], [`NOTHING`], or an index into `masks`.
    codes: Vec<u32>,
    masks: Vec<Part>,
}

/// The part of a cell that counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Part {
    pub(crate) mask: Mask,
    /// Lowest sub-cell that counts along each axis, and one beyond the highest.
    low: [u8; 3],
    high: [u8; 3],
    /// Whether all sub-cells between these count, as where walls lie along the axes.
    is_box: bool,
}

impl Part {
    fn new(mask: Mask) -> Self {
        let (mut low, mut high) = ([SUB as u8; 3], [0; 3]);
        for at in (0..SUB * SUB * SUB).map(|n| [n % SUB, n / SUB % SUB, n / SUB / SUB]) {
            if mask.contains(at) {
                low = core::array::from_fn(|a| low[a].min(at[a] as u8));
                high = core::array::from_fn(|a| high[a].max(at[a] as u8 + 1));
            }
        }
        let between: u32 = (0..3).map(|a| u32::from(high[a].saturating_sub(low[a]))).product();
        Self { mask, low, high, is_box: between == mask.count() }
    }

    /// Length of a line from `from` to `to` in the part of the cell with lowest corner `corner` and sub-cells of size `step`.
    #[inline]
    fn length(&self, corner: [f32; 3], step: [f32; 3], line: &Line, from: f32, to: f32) -> f32 {
        let plane = |at: [u8; 3]| core::array::from_fn(|a| corner[a] + f32::from(at[a]) * step[a]);
        let low = plane(self.low);
        let Some((from, to)) = line.clip(low, plane(self.high), from, to) else { return 0.0 };
        if self.is_box {
            return to - from;
        }
        let count = core::array::from_fn(|a| usize::from(self.high[a] - self.low[a]));
        let [x, y, z] = self.low.map(usize::from);
        let mut length = 0.0;
        Boxes { low, step, count }.walk(line, from, to, |at, from, to| {
            let counts = self.mask.contains([at[0] + x, at[1] + y, at[2] + z]);
            length += if counts { to - from } else { 0.0 };
        });
        length
    }
}

const WHOLE: u32 = u32::MAX;
const NOTHING: u32 = u32::MAX - 1;

/// What counts in a dual cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Region<'a> {
    /// All of it.
    Whole,
    /// Nothing: no light reaches the vertex.
    Nothing,
    /// Some sub-cells.
    Part(&'a Part),
}

impl Regions {
    /// Regions from what was found for each cell.
    pub(crate) fn new(found: impl Iterator<Item = Option<Mask>>) -> Self {
        let mut regions = Self { codes: Vec::new(), masks: Vec::new() };
        for mask in found {
            let code = match mask {
                None => WHOLE,
                Some(mask) if mask.count() == 0 => NOTHING,
                Some(mask) if mask.count() == SUB_CELLS => WHOLE,
                Some(mask) => {
                    regions.masks.push(Part::new(mask));
                    (regions.masks.len() - 1) as u32
                }
            };
            regions.codes.push(code);
        }
        regions
    }

    /// What counts in a cell.
    #[inline]
    pub(crate) fn get(&self, cell: usize) -> Region<'_> {
        match self.codes[cell] {
            WHOLE => Region::Whole,
            NOTHING => Region::Nothing,
            code => Region::Part(&self.masks[code as usize]),
        }
    }
}

impl Region<'_> {
    /// Share of the cell's volume that counts, in [0, 1].
    pub(crate) fn share(&self) -> f64 {
        match self {
            Self::Whole => 1.0,
            Self::Nothing => 0.0,
            Self::Part(part) => f64::from(part.mask.count()) / f64::from(SUB_CELLS),
        }
    }

    /// Length of a line from `from` to `to`, all of it inside `cell`, in the part that counts.
    #[inline]
    pub(crate) fn length(&self, cells: &Boxes, cell: [usize; 3], line: &Line, from: f32, to: f32) -> f32 {
        match self {
            Self::Whole => to - from,
            Self::Nothing => 0.0,
            Self::Part(part) => {
                let step = cells.step.map(|s| s * (1.0 / SUB as f32));
                part.length(cells.corner(cell), step, line, from, to)
            }
        }
    }
}

#[cfg(test)]
mod tests;
