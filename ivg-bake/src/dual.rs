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

impl Boxes {
    /// The dual cells of `lattice`. `thickness` is the size of the cells along an axis of one vertex \[m\].
    pub(crate) fn dual_cells(lattice: &Lattice, thickness: [f64; 3], space: Space) -> Self {
        let step = core::array::from_fn(|a| {
            if lattice.step[a] > 0.0 { lattice.step[a] } else { thickness[a] }
        });
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

    /// Calls `visit(box, from, to)` for the stretches of the ray `origin + t direction`, t from `from` to `to`, inside
    /// each box, in order (J. Amanatides, A. Woo, "A fast voxel traversal algorithm for ray tracing", 1987).
    #[inline]
    pub(crate) fn walk(
        &self,
        origin: Vec3,
        direction: Vec3,
        mut from: f32,
        mut to: f32,
        mut visit: impl FnMut([usize; 3], f32, f32),
    ) {
        let (o, d) = (origin.to_array(), direction.to_array());
        let inverse = d.map(|x| 1.0 / x);
        for a in 0..3 {
            let high = self.low[a] + self.count[a] as f32 * self.step[a];
            if d[a] == 0.0 {
                if o[a] < self.low[a] || o[a] >= high {
                    return;
                }
            } else {
                let (t0, t1) = ((self.low[a] - o[a]) * inverse[a], (high - o[a]) * inverse[a]);
                from = from.max(t0.min(t1));
                to = to.min(t0.max(t1));
            }
        }
        // Written so that a number that is none ends here too.
        if !matches!(from.partial_cmp(&to), Some(core::cmp::Ordering::Less)) {
            return;
        }
        let mut at = [0usize; 3];
        let mut next = [f32::INFINITY; 3];
        let mut stride = [f32::INFINITY; 3];
        for a in 0..3 {
            let position = o[a] + d[a] * from;
            // The cast saturates, so a position rounded below the lowest box lands in it.
            at[a] = (((position - self.low[a]) / self.step[a]) as usize).min(self.count[a] - 1);
            if d[a] != 0.0 {
                let ahead = if d[a] > 0.0 { 1.0 } else { 0.0 };
                next[a] = (self.low[a] + (at[a] as f32 + ahead) * self.step[a] - o[a]) * inverse[a];
                stride[a] = self.step[a] * inverse[a].abs();
            }
        }
        let mut t = from;
        loop {
            let axis = if next[0] < next[1] {
                if next[0] < next[2] { 0 } else { 2 }
            } else if next[1] < next[2] {
                1
            } else {
                2
            };
            let end = next[axis].min(to);
            if end > t {
                visit(at, t, end);
                t = end;
            }
            if next[axis] >= to {
                return;
            }
            at[axis] = if d[axis] > 0.0 { at[axis] + 1 } else { at[axis].wrapping_sub(1) };
            if at[axis] >= self.count[axis] {
                return;
            }
            next[axis] += stride[axis];
        }
    }
}

#[cfg(test)]
mod tests;
