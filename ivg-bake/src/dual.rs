//! The dual cells of a lattice: one box around each vertex, half a step to every side.
//!
//! The cells of the outermost vertices reach half a step beyond the lattice, so that every cell has its full volume.

use glam::Vec3;
use ivg_format::Lattice;

use crate::space::Space;

/// Boxes in a row along each axis, in bake space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Boxes {
    /// Lowest corner of the lowest box.
    pub(crate) low: [f32; 3],
    /// Size of a box, positive.
    pub(crate) step: [f32; 3],
    /// Boxes along each axis, at least 1.
    pub(crate) count: [usize; 3],
}

/// The points origin + t direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    origin: [f32; 3],
    direction: [f32; 3],
    /// 1 / direction.
    inverse: [f32; 3],
}

impl Line {
    /// The line from `origin` along `direction`.
    #[inline]
    pub(crate) fn new(origin: Vec3, direction: Vec3) -> Self {
        let direction = direction.to_array();
        Self { origin: origin.to_array(), direction, inverse: direction.map(|x| 1.0 / x) }
    }

    /// The part of t from `from` to `to` that lies in the box from `low` to `high`; `None` if there is none.
    #[inline]
    pub(crate) fn clip(
        &self,
        low: [f32; 3],
        high: [f32; 3],
        mut from: f32,
        mut to: f32,
    ) -> Option<(f32, f32)> {
        for a in 0..3 {
            if self.direction[a] == 0.0 {
                if self.origin[a] < low[a] || self.origin[a] >= high[a] {
                    return None;
                }
            } else {
                let t0 = (low[a] - self.origin[a]) * self.inverse[a];
                let t1 = (high[a] - self.origin[a]) * self.inverse[a];
                from = from.max(t0.min(t1));
                to = to.min(t0.max(t1));
            }
        }
        // A number that is none is not less.
        (from < to).then_some((from, to))
    }
}

impl Boxes {
    /// The dual cells of `lattice`. `thickness` is the size of the cells along an axis of one vertex \[m\].
    pub(crate) fn dual_cells(lattice: &Lattice, thickness: [f64; 3], space: Space) -> Self {
        let step =
            core::array::from_fn(|a| if lattice.step[a] > 0.0 { lattice.step[a] } else { thickness[a] });
        let low = core::array::from_fn(|a| lattice.origin[a] - 0.5 * step[a]);
        Self {
            low: space.to_bake(low.into()).to_array(),
            step: step.map(|s: f64| (s * space.scale()) as f32),
            count: lattice.dims.map(usize::from),
        }
    }

    /// Number of boxes.
    pub(crate) fn len(&self) -> usize {
        self.count.iter().product()
    }

    /// Linear index of a box.
    #[inline]
    pub(crate) fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        i + self.count[0] * (j + self.count[1] * k)
    }

    /// Coordinates of the box with a linear index.
    pub(crate) fn coords(&self, index: usize) -> [usize; 3] {
        let [nx, ny, _] = self.count;
        [index % nx, index / nx % ny, index / nx / ny]
    }

    /// Middle of a box: the vertex it is the dual cell of.
    pub(crate) fn middle(&self, at: [usize; 3]) -> Vec3 {
        core::array::from_fn(|a| self.low[a] + (at[a] as f32 + 0.5) * self.step[a]).into()
    }

    /// Lowest corner of a box.
    pub(crate) fn corner(&self, at: [usize; 3]) -> [f32; 3] {
        core::array::from_fn(|a| self.low[a] + at[a] as f32 * self.step[a])
    }

    /// Length of a box's diagonal.
    pub(crate) fn diagonal(&self) -> f32 {
        Vec3::from(self.step).length()
    }

    /// Volume of a box.
    pub(crate) fn volume(&self) -> f64 {
        self.step.iter().map(|&s| f64::from(s)).product()
    }

    /// Calls `visit(box, from, to)` for the stretches of a line, t from `from` to `to`, inside
    /// each box, in order (J. Amanatides, A. Woo, "A fast voxel traversal algorithm for ray tracing", 1987).
    #[inline]
    pub(crate) fn walk(&self, line: &Line, from: f32, to: f32, mut visit: impl FnMut([usize; 3], f32, f32)) {
        let &Line { origin: o, direction: d, inverse } = line;
        let high = core::array::from_fn(|a| self.low[a] + self.count[a] as f32 * self.step[a]);
        let Some((from, to)) = line.clip(self.low, high, from, to) else { return };
        let mut at = [0usize; 3];
        let mut next = [f32::INFINITY; 3];
        let mut stride = [0f32; 3];
        let ahead = d.map(|x| if x > 0.0 { 1 } else { usize::MAX });
        for a in 0..3 {
            let position = o[a] + d[a] * from;
            // The cast saturates, so a position rounded below the lowest box lands in it.
            at[a] = (((position - self.low[a]) / self.step[a]) as usize).min(self.count[a] - 1);
            if d[a] != 0.0 {
                let plane = at[a] as f32 + if d[a] > 0.0 { 1.0 } else { 0.0 };
                next[a] = (self.low[a] + plane * self.step[a] - o[a]) * inverse[a];
                stride[a] = self.step[a] * inverse[a].abs();
            }
        }
        let mut t = from;
        let [mut next_x, mut next_y, mut next_z] = next;
        loop {
            // Which plane comes first is as good as random, so it is selected without a branch.
            let x_first = (next_x < next_y) & (next_x < next_z);
            let y_first = !x_first & (next_y < next_z);
            let z_first = !(x_first | y_first);
            let plane = next_x.min(next_y).min(next_z);
            let end = plane.min(to);
            if end > t {
                visit(at, t, end);
                t = end;
            }
            if plane >= to {
                return;
            }
            next_x += if x_first { stride[0] } else { 0.0 };
            next_y += if y_first { stride[1] } else { 0.0 };
            next_z += if z_first { stride[2] } else { 0.0 };
            // Below the lowest box the coordinate wraps around, and is too large as well.
            at[0] = at[0].wrapping_add(if x_first { ahead[0] } else { 0 });
            at[1] = at[1].wrapping_add(if y_first { ahead[1] } else { 0 });
            at[2] = at[2].wrapping_add(if z_first { ahead[2] } else { 0 });
            if (at[0] >= self.count[0]) | (at[1] >= self.count[1]) | (at[2] >= self.count[2]) {
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests;
