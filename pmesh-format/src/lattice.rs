//! The lattice of quantised positions (PMESH-POS-03).

use crate::storage::Positions;

/// Points of whole numbers in a bounding box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lattice {
    low: [f64; 3],
    step: f64,
    /// The greatest number along each axis.
    top: [u32; 3],
}

impl Lattice {
    /// Of the box of a header, with that many bits along its longest side.
    pub(crate) fn new([low, high]: [[f32; 3]; 2], bits: u8) -> Self {
        let low = low.map(f64::from);
        let mut extent = high.map(f64::from);
        extent.iter_mut().zip(low).for_each(|(high, low)| *high -= low);
        let longest = extent.into_iter().fold(0.0, f64::max);
        let most = f64::from((1u32 << bits) - 1);
        let step = longest / most;
        let top = extent.map(|extent| nearest(extent / step).min(most as u32));
        Self { low, step, top }
    }

    /// The greatest number along each axis.
    pub(crate) fn top(&self) -> [u32; 3] {
        self.top
    }

    /// The position of a point \[m\].
    #[inline]
    pub(crate) fn position(&self, point: [u32; 3]) -> [f32; 3] {
        core::array::from_fn(|k| (self.low[k] + f64::from(point[k]) * self.step) as f32)
    }

    /// The point nearest to a position inside the box, among those whose coordinates are finite: the last one along a short side may
    /// lie beyond it, and beyond what binary32 has.
    pub(crate) fn nearest(&self, position: [f32; 3]) -> [u32; 3] {
        let mut point = core::array::from_fn(|k| {
            nearest((f64::from(position[k]) - self.low[k]) / self.step).min(self.top[k])
        });
        let found = self.position(point);
        point.iter_mut().zip(found).for_each(|(number, x)| *number -= u32::from(!x.is_finite()));
        point
    }
}

/// The nearest whole number, of two the greater; 0 for NaN, which a box without extent gives.
fn nearest(x: f64) -> u32 {
    (x + 0.5) as u32
}

/// The least and the greatest coordinates; 0 without positions.
pub(crate) fn bounds(positions: &[[f32; 3]]) -> [[f32; 3]; 2] {
    let first = positions.first().map_or([[0.0; 3]; 2], |&p| [p, p]);
    positions.iter().fold(first, |[low, high], p| {
        [core::array::from_fn(|k| low[k].min(p[k])), core::array::from_fn(|k| high[k].max(p[k]))]
    })
}

impl Positions {
    /// The positions as a reader will have them \[m\]: as given for [`Positions::F32`], otherwise the nearest points of the
    /// lattice in their bounding box (PMESH-POS-03). Doing it again changes nothing more, unless the two longest sides of the
    /// box are equal but for rounding: then the other one may become the longest, and a coordinate move by 2⁻²³ of the greatest.
    ///
    /// Whoever orders a mesh orders these, so that errors are measured from what is stored.
    ///
    /// # Panics
    ///
    /// If it is a number of bits that does not exist.
    #[must_use]
    pub fn quantised(self, positions: &[[f32; 3]]) -> alloc::vec::Vec<[f32; 3]> {
        assert!(self.exists(), "positions of {:?} bits", self.bits());
        let Some(bits) = self.bits() else { return positions.to_vec() };
        let lattice = Lattice::new(bounds(positions), bits);
        positions.iter().map(|&p| lattice.position(lattice.nearest(p))).collect()
    }
}

#[cfg(test)]
mod tests;
