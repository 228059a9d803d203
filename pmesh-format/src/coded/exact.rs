//! Positions as binary32 numbers: whole numbers of a unit, and which of the numbers between it is (PMESH-COD-11).

use super::geometry::{Cell, raw};
use super::rans::Coder;

/// Bits that the difference of two cells has at most.
const BITS: u32 = 20;

/// Cells of binary32 numbers: intervals of the length of a unit, a power of two.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exact {
    /// The unit \[m\].
    unit: f64,
    /// What cell 0 is in units, along each axis.
    first: [i64; 3],
    /// The greatest cell along each axis.
    top: [u32; 3],
    bounds: [[f32; 3]; 2],
}

impl Exact {
    /// For positions in that box.
    pub(super) fn new(bounds: [[f32; 3]; 2]) -> Self {
        let greatest = bounds.as_flattened().iter().fold(0.0, |all: f32, x| all.max(x.abs()));
        // The step between numbers as great as that: then every multiple of the unit up to there is a number.
        let exponent = (greatest.to_bits() >> 23).saturating_sub(23).max(1);
        let mut unit = f64::from(f32::from_bits(exponent << 23));
        if greatest.to_bits() >> 23 < 24 {
            unit = f64::from(f32::from_bits(1));
        }
        loop {
            let [low, high] = bounds.map(|corner| corner.map(|x| floor(f64::from(x) / unit)));
            let top: [i64; 3] = core::array::from_fn(|k| high[k] - low[k]);
            if top.iter().all(|&top| top < 1 << BITS) {
                return Self { unit, first: low, top: top.map(|top| top as u32), bounds };
            }
            unit *= 2.0;
        }
    }

    /// The greatest cell along each axis.
    pub(super) fn top(&self) -> [u32; 3] {
        self.top
    }

    /// The cell of a position inside the box.
    pub(super) fn cell(&self, position: [f32; 3]) -> Cell {
        core::array::from_fn(|k| (floor(f64::from(position[k]) / self.unit) - self.first[k]) as i32)
    }

    /// A position in a cell; `None` if it is not in the box.
    pub(super) fn code(&self, coder: &mut impl Coder, cell: Cell, position: [f32; 3]) -> Option<[f32; 3]> {
        let mut found = [0.0; 3];
        for (k, found) in found.iter_mut().enumerate() {
            let units = self.first[k] + i64::from(cell[k]);
            // The lowest cell may begin at −2¹²⁸, below all numbers.
            let ends =
                [units, units + 1].map(|units| rank(((units as f64 * self.unit) as f32).max(f32::MIN)));
            // Both zeros are in the cell that begins with them.
            let [first, last] =
                [(units, ends[0]), (units + 1, ends[1])].map(|(units, rank)| rank - i64::from(units == 0));
            let most = (last - 1 - first).max(0) as u32;
            let bits = u32::BITS - most.leading_zeros();
            let place = raw(coder, bits, (rank(position[k]) - first) as u32);
            *found = number(first + i64::from(place.min(most)));
            let inside = self.bounds[0][k] <= *found && *found <= self.bounds[1][k];
            if place > most || !inside {
                return None;
            }
        }
        Some(found)
    }
}

/// The place of a number among all, 0 that of +0, −1 that of −0.
fn rank(x: f32) -> i64 {
    let size = i64::from(x.to_bits() & 0x7FFF_FFFF);
    if x.is_sign_negative() { -1 - size } else { size }
}

/// The number in that place.
fn number(rank: i64) -> f32 {
    f32::from_bits(if rank < 0 { (-1 - rank) as u32 | 1 << 31 } else { rank as u32 })
}

/// The greatest whole number that is not greater.
fn floor(x: f64) -> i64 {
    let whole = x as i64;
    whole - i64::from(whole as f64 > x)
}
