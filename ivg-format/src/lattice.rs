//! The lattice: where the vertices of an irradiance grid are. Meaning only, no bytes.
//!
//! A lattice is `nx` × `ny` × `nz` vertices; the first lies at the minimum of the bounds, the last at the
//! maximum. Its authority is the chapter "Lattice" of `spec/ivg.md` (clauses `IVG-LAT-…`).

use core::fmt;

/// A regular lattice of grid vertices in world space.
///
/// World space is the source scene's frame scaled to metres, right-handed. The fields are public because
/// they are plain numbers; a lattice that was not made by [`Lattice::new`] or read from a file can be
/// checked with [`Lattice::check`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Vertices along x, y and z, each at least 1.
    pub dims: [u16; 3],
    /// Position of vertex (0, 0, 0) \[m\].
    pub origin: [f64; 3],
    /// Distance between neighbours along each axis \[m\]: positive, or 0 on an axis of one vertex.
    pub step: [f64; 3],
}

/// Why numbers do not make a lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LatticeError {
    /// An axis has no vertex.
    EmptyAxis {
        /// 0 = x, 1 = y, 2 = z.
        axis: u8,
    },
    /// A bound, an origin or a step is NaN or infinite, or the extent is too large for binary64.
    NotFinite {
        /// 0 = x, 1 = y, 2 = z.
        axis: u8,
    },
    /// An axis of two or more vertices has a step that is not positive, or an axis of one vertex has a step
    /// other than 0.
    Step {
        /// 0 = x, 1 = y, 2 = z.
        axis: u8,
    },
}

impl Lattice {
    /// The lattice of `dims` vertices that spans the box from `min` to `max` \[m\].
    ///
    /// Along an axis of `n ≥ 2` vertices the step is `(max − min) / (n − 1)`; an axis of one vertex has its
    /// vertex in the middle and step 0 (IVG-LAT-03).
    ///
    /// # Errors
    ///
    /// [`LatticeError`] names the axis that has no vertex, a bound that is not finite, or no extent although
    /// it has two vertices or more.
    pub fn new(dims: [u16; 3], min: [f64; 3], max: [f64; 3]) -> Result<Self, LatticeError> {
        let mut lattice = Self { dims, origin: min, step: [0.0; 3] };
        for (axis, name) in (0..3).zip(0u8..) {
            let (low, high) = (min[axis], max[axis]);
            if !low.is_finite() || !high.is_finite() {
                return Err(LatticeError::NotFinite { axis: name });
            }
            if dims[axis] > 1 {
                lattice.step[axis] = (high - low) / f64::from(dims[axis] - 1);
            } else {
                lattice.origin[axis] = low.midpoint(high);
            }
        }
        lattice.check()?;
        Ok(lattice)
    }

    /// Checks that the numbers make a lattice (IVG-LAT-01, IVG-LAT-02, IVG-LAT-03).
    ///
    /// # Errors
    ///
    /// [`LatticeError`] names the first axis that breaks a rule, and the rule.
    pub fn check(&self) -> Result<(), LatticeError> {
        for (axis, name) in (0..3).zip(0u8..) {
            let (count, origin, step) = (self.dims[axis], self.origin[axis], self.step[axis]);
            if count == 0 {
                return Err(LatticeError::EmptyAxis { axis: name });
            }
            let last = origin + f64::from(count - 1) * step;
            if !origin.is_finite() || !step.is_finite() || !last.is_finite() {
                return Err(LatticeError::NotFinite { axis: name });
            }
            if (count == 1) != (step == 0.0) || step < 0.0 {
                return Err(LatticeError::Step { axis: name });
            }
        }
        Ok(())
    }

    /// Number of vertices, at most 65,535³.
    #[must_use]
    pub fn vertex_count(&self) -> u64 {
        self.dims.iter().map(|&n| u64::from(n)).product()
    }

    /// Linear index `i + nx (j + ny k)` of a vertex (IVG-LAT-05). The coordinates must lie inside the lattice.
    #[must_use]
    pub fn index(&self, i: u16, j: u16, k: u16) -> u64 {
        debug_assert!(i < self.dims[0] && j < self.dims[1] && k < self.dims[2], "vertex outside the lattice");
        let [nx, ny, _] = self.dims.map(u64::from);
        u64::from(i) + nx * (u64::from(j) + ny * u64::from(k))
    }

    /// Coordinates of the vertex with linear index `index`: the inverse of [`Lattice::index`].
    ///
    /// `index` must be less than [`Lattice::vertex_count`]; otherwise the coordinates are meaningless.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "each remainder is less than a u16")]
    pub fn coords(&self, index: u64) -> [u16; 3] {
        let [nx, ny, nz] = self.dims.map(|n| u64::from(n.max(1)));
        [(index % nx) as u16, (index / nx % ny) as u16, (index / nx / ny % nz) as u16]
    }

    /// World position of a vertex \[m\]: `origin + index × step`, product and sum each rounded to binary64
    /// (IVG-LAT-04).
    #[must_use]
    pub fn position(&self, i: u16, j: u16, k: u16) -> [f64; 3] {
        let at = [i, j, k];
        core::array::from_fn(|axis| self.origin[axis] + f64::from(at[axis]) * self.step[axis])
    }

    /// The axis with the most vertices; of several, the lowest (IVG-ORD-02). 0 = x, 1 = y, 2 = z.
    #[must_use]
    pub fn longest_axis(&self) -> usize {
        let [nx, ny, nz] = self.dims;
        if nx >= ny && nx >= nz {
            0
        } else if ny >= nz {
            1
        } else {
            2
        }
    }

    /// Linear indices of the corner vertices, ascending: eight, or fewer where an axis has one vertex
    /// (IVG-ORD-01).
    pub fn corners(&self) -> impl Iterator<Item = u64> + Clone + use<> {
        let lattice = *self;
        let ends = self.dims.map(|n| if n > 1 { 2u16 } else { 1 });
        let last = self.dims.map(|n| n.saturating_sub(1));
        (0..ends[2]).flat_map(move |k| {
            (0..ends[1]).flat_map(move |j| {
                (0..ends[0]).map(move |i| lattice.index(i * last[0], j * last[1], k * last[2]))
            })
        })
    }

    /// Whether the vertex with linear index `index` is a corner.
    #[must_use]
    pub fn is_corner(&self, index: u64) -> bool {
        let at = self.coords(index);
        at.iter().zip(self.dims).all(|(&c, n)| c == 0 || c + 1 == n)
    }
}

impl fmt::Display for LatticeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = |axis: u8| ["x", "y", "z"].get(usize::from(axis)).copied().unwrap_or("?");
        match *self {
            Self::EmptyAxis { axis } => {
                write!(f, "the lattice has no vertex along {}; give at least 1", name(axis))
            }
            Self::NotFinite { axis } => {
                write!(f, "the lattice's bounds along {} are not finite numbers", name(axis))
            }
            Self::Step { axis } => write!(
                f,
                "the step along {0} does not fit: two or more vertices need a maximum above the minimum, \
                 one vertex has step 0",
                name(axis)
            ),
        }
    }
}

impl core::error::Error for LatticeError {}

#[cfg(test)]
mod tests;
