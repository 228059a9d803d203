//! Which vertices a lookup between the vertices reads, and how much each counts.
//!
//! **Where nothing obstructs**: trilinear weights of the eight corners of the cell around the point, or the weights of
//! the uniform cubic B-spline over the 4 × 4 × 4 vertices around it. The B-spline *smooths*: it does not pass through
//! the vertices' values, and light never becomes negative, for no weight is. A GPU gets the same weights from eight
//! trilinear fetches (Sigg and Hadwiger, Fast Third-Order Texture Filtering, 2005): see [`cubic_fetches`].
//!
//! **Outside the grid** a lookup is the lookup at the nearest point of the lattice's box; the B-spline repeats the
//! border vertices. An axis of one vertex has the same value everywhere along it.
//!
//! **Where geometry obstructs**, only vertices on the lookup's side count:
//!
//! 1. A vertex is usable if it is valid and has a value. The usable corners of the cell, joined by those of the cell's
//!    twelve edges that are not blocked, form groups: the parts of the cell that geometry keeps apart.
//! 2. The group of the lookup's side is the one whose corners have the largest sum of trilinear weight times
//!    `max(0, cos)` of the angle between the normal and the direction to the corner: a surface receives light from in
//!    front. Without a normal, or when no corner is in front, it is the group of the largest trilinear weight. Of
//!    equals, the one with the first corner in order of the linear index.
//! 3. Vertices reached from that group over open edges inside the filter's support count with their weights; the
//!    others count nothing. The weights are divided by their sum.
//! 4. Only when that sum is zero (no corner is usable, or the point lies right at an unusable one) all vertices with a
//!    value count, which in a filled grid are all vertices. Without any, the light is zero.
//!
//! The result is continuous inside a cell as long as the lookup's side stays the same one, and across the cells' faces
//! as long as the same corners of the face are reached from both: always where nothing obstructs.

use glam::{DVec3, Vec3};

use crate::IrradianceGrid;

/// How irradiance vectors are interpolated between vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SpatialFilter {
    /// Linear along each axis, passing through the vertices' values.
    #[default]
    Trilinear,
    /// The uniform cubic B-spline along each axis: smooth, but not passing through the vertices' values.
    Tricubic,
}

impl SpatialFilter {
    /// All filters.
    pub const ALL: [Self; 2] = [Self::Trilinear, Self::Tricubic];

    /// The name that commands use: `trilinear` or `tricubic`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Trilinear => "trilinear",
            Self::Tricubic => "tricubic",
        }
    }

    /// The filter with that [`name`](Self::name).
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|filter| filter.name() == name)
    }
}

/// The two linear fetches along one axis that make a cubic B-spline: offset from the vertex at or before the point,
/// in steps, and weight. `fraction` is how far the point lies past that vertex, 0 to 1.
///
/// The eight combinations along three axes, each a trilinear lookup weighted by the product of its weights, sum up to
/// [`SpatialFilter::Tricubic`] (Sigg and Hadwiger 2005, equations 4 and 5).
#[must_use]
pub fn cubic_fetches(fraction: f64) -> [(f64, f64); 2] {
    let [w0, w1, w2, w3] = cubic_weights(fraction);
    [(-1.0 + w1 / (w0 + w1), w0 + w1), (1.0 + w3 / (w2 + w3), w2 + w3)]
}

/// The weights of the uniform cubic B-spline for the vertices -1, 0, 1, 2.
fn cubic_weights(f: f64) -> [f64; 4] {
    let g = 1.0 - f;
    [
        g * g * g / 6.0,
        (4.0 - 6.0 * f * f + 3.0 * f * f * f) / 6.0,
        (4.0 - 6.0 * g * g + 3.0 * g * g * g) / 6.0,
        f * f * f / 6.0,
    ]
}

/// Vertices and their weights, which sum to 1; none where nothing has a value.
#[derive(Clone, Debug)]
pub(crate) struct Taps {
    vertices: [u32; 64],
    weights: [f32; 64],
    count: usize,
}

impl Taps {
    /// The taps of a lookup at `p` \[m\], which stands on a surface with unit normal `n` if there is one.
    pub(crate) fn new(grid: &IrradianceGrid, p: DVec3, n: Option<Vec3>, filter: SpatialFilter) -> Self {
        let support = Support::new(grid, p, filter);
        if grid.is_unobstructed() {
            return Self::collect(&support, u64::MAX);
        }
        let usable = support.mask(|vertex| grid.is_valid(vertex) && grid.has_value(vertex));
        let reached = support.reach(grid, usable, support.side(grid, usable, p, n));
        if support.weight(reached) > 0.0 {
            return Self::collect(&support, reached);
        }
        Self::collect(&support, support.mask(|vertex| grid.has_value(vertex)))
    }

    /// The vertices with weight, in order of the linear index.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (usize, f32)> {
        self.vertices.iter().map(|&vertex| vertex as usize).zip(self.weights).take(self.count)
    }

    #[expect(
        clippy::cast_possible_truncation,
        reason = "weights are rounded; a grid has at most u32::MAX vertices"
    )]
    fn collect(support: &Support, counted: u64) -> Self {
        let mut taps = Self { vertices: [0; 64], weights: [0.0; 64], count: 0 };
        let sum = support.weight(counted);
        for local in support.locals(counted) {
            let weight = support.weight_of(local);
            if weight > 0.0 {
                taps.vertices[taps.count] = support.vertex(local) as u32;
                taps.weights[taps.count] = (weight / sum) as f32;
                taps.count += 1;
            }
        }
        taps
    }
}

/// The block of vertices that a filter reads: `width`³ of them, locally numbered `a + width (b + width c)`, a set of
/// them being the bits of a `u64`.
struct Support {
    width: usize,
    /// For each axis the coordinates of the vertices, clamped to the lattice, and their weights.
    coords: [[u16; 4]; 3],
    weights: [[f64; 4]; 3],
    /// Trilinear weights of the two middle vertices of each axis.
    linear: [[f64; 2]; 3],
    /// Number of vertices along x, and in a slice.
    strides: [usize; 2],
}

impl Support {
    fn new(grid: &IrradianceGrid, p: DVec3, filter: SpatialFilter) -> Self {
        let lattice = grid.lattice();
        let width = match filter {
            SpatialFilter::Trilinear => 2,
            SpatialFilter::Tricubic => 4,
        };
        let [nx, ny, _] = lattice.dims.map(usize::from);
        let mut support = Self {
            width,
            coords: [[0; 4]; 3],
            weights: [[0.0; 4]; 3],
            linear: [[1.0, 0.0]; 3],
            strides: [nx, nx * ny],
        };
        for axis in 0..3 {
            let last = lattice.dims[axis] - 1;
            let (base, fraction) = locate(p[axis], lattice.origin[axis], lattice.step[axis], last);
            support.linear[axis] = [1.0 - fraction, fraction];
            support.weights[axis] = match filter {
                SpatialFilter::Trilinear => [1.0 - fraction, fraction, 0.0, 0.0],
                SpatialFilter::Tricubic => cubic_weights(fraction),
            };
            let before = width / 2 - 1;
            support.coords[axis] = std::array::from_fn(|at| {
                let coord = i32::from(base) + at as i32 - before as i32;
                coord.clamp(0, i32::from(last)) as u16
            });
        }
        support
    }

    /// The local coordinates of a local number.
    fn split(&self, local: usize) -> [usize; 3] {
        let width = self.width;
        [local % width, local / width % width, local / width / width]
    }

    fn vertex(&self, local: usize) -> usize {
        let at = self.split(local);
        let [i, j, k] = std::array::from_fn(|axis| usize::from(self.coords[axis][at[axis]]));
        i + self.strides[0] * j + self.strides[1] * k
    }

    fn weight_of(&self, local: usize) -> f64 {
        let at = self.split(local);
        (0..3).map(|axis| self.weights[axis][at[axis]]).product()
    }

    fn weight(&self, set: u64) -> f64 {
        self.locals(set).map(|local| self.weight_of(local)).sum()
    }

    fn locals(&self, set: u64) -> impl Iterator<Item = usize> + use<> {
        (0..self.width.pow(3)).filter(move |local| set >> local & 1 == 1)
    }

    fn mask(&self, keep: impl Fn(usize) -> bool) -> u64 {
        self.locals(u64::MAX).filter(|&local| keep(self.vertex(local))).fold(0, |set, local| set | 1 << local)
    }

    /// The corners of the cell around the point, as a set, and the trilinear weight of one.
    fn corners(&self) -> u64 {
        let first = self.width / 2 - 1;
        let middle = |local: usize| self.split(local).iter().all(|&at| at == first || at == first + 1);
        self.locals(u64::MAX).filter(|&local| middle(local)).fold(0, |set, local| set | 1 << local)
    }

    fn linear_weight_of(&self, local: usize) -> f64 {
        let (at, first) = (self.split(local), self.width / 2 - 1);
        (0..3).map(|axis| self.linear[axis][at[axis] - first]).product()
    }

    /// The vertices of `within` that open edges join to those of `from`.
    fn reach(&self, grid: &IrradianceGrid, within: u64, from: u64) -> u64 {
        let mut reached = from & within;
        let mut pending = reached;
        while pending != 0 {
            let local = pending.trailing_zeros() as usize;
            pending &= pending - 1;
            let at = self.split(local);
            for (axis, &coord) in at.iter().enumerate() {
                let stride = self.width.pow(axis as u32);
                let below = (coord > 0).then(|| (local - stride, local - stride));
                let above = (coord + 1 < self.width).then(|| (local + stride, local));
                for (neighbour, low) in below.into_iter().chain(above) {
                    let bit = 1 << neighbour;
                    if within & bit != 0 && reached & bit == 0 && self.is_open(grid, low, axis) {
                        reached |= bit;
                        pending |= bit;
                    }
                }
            }
        }
        reached
    }

    /// Whether light passes from a local vertex to the next one along an axis.
    fn is_open(&self, grid: &IrradianceGrid, low: usize, axis: usize) -> bool {
        // Beyond the border the border vertex is repeated; it has no blocked edge outwards.
        grid.blocked_edges()[self.vertex(low)] >> axis & 1 == 0
    }

    /// The usable corners of the cell that lie on the lookup's side: step 2 of the module's rule.
    fn side(&self, grid: &IrradianceGrid, usable: u64, p: DVec3, n: Option<Vec3>) -> u64 {
        let corners = self.corners() & usable;
        let mut left = corners;
        let mut best = 0;
        let mut best_score = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        while left != 0 {
            let group = self.reach(grid, corners, left & left.wrapping_neg());
            left &= !group;
            let mut score = (0.0, 0.0);
            for local in self.locals(group) {
                let weight = self.linear_weight_of(local);
                score.0 += weight * n.map_or(0.0, |n| self.facing(grid, local, p, n));
                score.1 += weight;
            }
            if score > best_score {
                (best, best_score) = (group, score);
            }
        }
        best
    }

    /// `max(0, cos)` of the angle between the normal and the direction from the point to a vertex.
    fn facing(&self, grid: &IrradianceGrid, local: usize, p: DVec3, n: Vec3) -> f64 {
        let at = self.split(local);
        let [i, j, k] = std::array::from_fn(|axis| self.coords[axis][at[axis]]);
        let way = DVec3::from(grid.lattice().position(i, j, k)) - p;
        way.normalize_or_zero().dot(n.as_dvec3()).max(0.0)
    }
}

/// The vertex at or before a position along one axis, but not the last one if there is another, and how far the
/// position lies past it in steps, 0 to 1. Positions outside the lattice are moved to its nearest end.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the lattice before")]
pub(crate) fn locate(position: f64, origin: f64, step: f64, last: u16) -> (u16, f64) {
    if last == 0 {
        return (0, 0.0);
    }
    // `max` before `min` also sends a position that is not a number to the first vertex.
    let at = ((position - origin) / step).max(0.0).min(f64::from(last));
    let base = (at.floor() as u16).min(last - 1);
    (base, at - f64::from(base))
}

#[cfg(test)]
mod tests;
