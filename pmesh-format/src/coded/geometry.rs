//! Where the next vertex is, in whole numbers: predictions, and how far from them (PMESH-COD-10).

use super::Point;
use super::models::Symbols;
use super::priors::{HEIGHTS, SPREADS};
use super::rans::Coder;
use super::ring::MOST;

/// A point of the lattice, or the difference of two.
pub(super) type Cell = [i32; 3];

/// Contexts of a residual; from class 24 on the lowest bits are coded as they are.
pub(super) const CONTEXTS: usize = 24;

/// The models of residuals.
#[derive(Clone, Debug)]
pub(super) struct Residuals {
    /// Of the two coordinates along the surface.
    pub(super) along: [Symbols; CONTEXTS],
    /// Of the third one.
    pub(super) height: [Symbols; CONTEXTS],
}

impl Residuals {
    pub(super) fn new() -> Self {
        Self { along: SPREADS.map(Symbols::new), height: HEIGHTS.map(Symbols::new) }
    }
}

/// Four classes an octave: 0 for 1, 4 for 2, 5 for 2.5, 8 for 4 and so on.
#[inline(always)]
pub(super) fn class(x: u64) -> u32 {
    let x = x.max(1);
    let octave = x.ilog2();
    4 * octave + ((x << 2 >> octave) & 3) as u32
}

/// Numbers that [`divide`] divides by without dividing, and one more.
const DIVISORS: usize = 2 * MOST + 8;

/// Bits behind the point of a reciprocal.
const RECIPROCAL_BITS: u32 = 36;

/// 2³⁶ / m, rounded up.
const RECIPROCALS: [u64; DIVISORS] = {
    let mut reciprocals = [0; DIVISORS];
    let mut m = 1;
    while m < DIVISORS {
        reciprocals[m] = (1u64 << RECIPROCAL_BITS).div_ceil(m as u64);
        m += 1;
    }
    reciprocals
};

/// ⌊x / m⌋ for m from 1 on, x < 2²⁹ and x / m < 2²⁷.
///
/// A reciprocal is too great by less than 2⁻³⁶, so that x times it is too great by less than 2²⁹ / 2³⁶ = 2⁻⁷, which is less than
/// the 1 / m that a fraction is short of the next whole number.
#[inline(always)]
pub(super) fn divide(x: u32, m: u32) -> u32 {
    debug_assert!(x < 1 << 29 && m > 0 && x / m < 1 << 27, "{x} / {m}");
    match RECIPROCALS.get(m as usize) {
        Some(&reciprocal) => ((u64::from(x) * reciprocal) >> RECIPROCAL_BITS) as u32,
        None => x / m,
    }
}

#[inline(always)]
pub(super) fn difference(a: Cell, b: Cell) -> [i64; 3] {
    core::array::from_fn(|k| i64::from(a[k]) - i64::from(b[k]))
}

/// The sum of the magnitudes of the coordinates of the difference of two cells.
#[inline(always)]
pub(super) fn apart(a: Cell, b: Cell) -> i32 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).abs() + (a[2] - b[2]).abs()
}

#[inline(always)]
pub(super) fn cross(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A number of up to 32 equally probable bits.
#[inline(always)]
pub(super) fn raw(coder: &mut impl Coder, bits: u32, value: u32) -> u32 {
    coder.raw(bits, value)
}

/// A residual of that class.
#[inline(always)]
pub(super) fn residual<C: Coder>(
    coder: &mut C,
    models: &mut [Symbols; CONTEXTS],
    class: u32,
    value: i32,
) -> i32 {
    let shift = (class / 4).max(5) - 5;
    let context = class.min(20 + class % 4) as usize;
    let half = (1i64 << shift) >> 1;
    let moved = i64::from(value) + half;
    let (whole, low) = (moved >> shift, (moved & ((1 << shift) - 1)) as u32);
    let size = whole.unsigned_abs() as u32;
    let (symbol, extra) = match size {
        0..4 => (size, 0),
        4..128 => {
            let octave = size.ilog2();
            (2 * octave + (size >> (octave - 1) & 1), octave - 1)
        }
        128..256 => (14, 7),
        _ => (15, size.ilog2()),
    };
    let symbol = coder.symbol(&mut models[context], symbol as usize);
    // For the reader, what the symbol says; the writer's numbers are the same.
    let (mut first, mut extra_is) = FIRSTS[symbol & 15];
    if symbol == 15 {
        extra_is = coder.raw(5, extra).min(27);
        first = 1 << extra_is;
    }
    // The bits of the size, those below, the sign: all at once.
    let signed = u32::from(first > 0);
    let given = u64::from(size.wrapping_sub(first)) & ((1 << extra_is) - 1)
        | u64::from(low) << extra_is
        | u64::from(whole < 0) << (extra_is + shift);
    let bits = coder.raw_long(extra_is + shift + signed, given);
    let size_is = first + (bits as u32 & ((1 << extra_is) - 1));
    let low = (bits >> extra_is) as u32 & ((1 << shift) - 1);
    let negative = (bits >> (extra_is + shift)) as i64;
    let whole = (i64::from(size_is) ^ -negative) + negative;
    ((whole << shift) + i64::from(low) - half) as i32
}

/// The least size of each symbol but the last, and how many bits follow it.
const FIRSTS: [(u32, u32); 16] = {
    let mut firsts = [(0, 0); 16];
    let mut symbol = 0;
    while symbol < 15 {
        firsts[symbol as usize] = match symbol {
            0..4 => (symbol, 0),
            4..14 => ((2 + symbol % 2) << (symbol / 2 - 1), symbol / 2 - 1),
            _ => (128, 7),
        };
        symbol += 1;
    }
    firsts
};

/// What is known of the place of a new vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// The mean of its neighbours, the parent counted twice.
    mean: Cell,
    /// How far they are from it along each axis, as classes.
    spreads: [u32; 3],
    /// The normal of the plane that it is expected in, through the parent.
    normal: [i64; 3],
    parent: Cell,
    /// The class of the height above the plane.
    height: u32,
    /// The mean of how far they are from their mean, along all axes together.
    apart: u32,
}

impl Place {
    /// From the neighbours, the parent one of them, their sum, and the normal of the faces that switch.
    #[inline(always)]
    pub(super) fn new(neighbours: &[Point], sum: Point, parent: Cell, normal: [i64; 3]) -> Self {
        let count = neighbours.len().max(1) as u32;
        // Cells that are there are not negative; at most 35 × 2²⁰ × 2, which fits.
        let mean = |k: usize| divide(2 * (sum[k] + parent[k]) as u32 + count + 1, 2 * count + 2) as i32;
        let mean = [mean(0), mean(1), mean(2), 0];
        let mut apart = [0u32; 4];
        for neighbour in neighbours {
            for k in 0..4 {
                apart[k] += neighbour[k].abs_diff(mean[k]);
            }
        }
        let spread = |k: usize| class(u64::from(divide(8 * apart[k], count)) + 1);
        let spreads = [spread(0), spread(1), spread(2)];
        let height = divide((sum[3] >> 16) as u32, count);
        let apart = divide(apart[0] + apart[1] + apart[2], count);
        let mean = [mean[0], mean[1], mean[2]];
        // At most 24 bits are left of each component, so that every product below fits in 53.
        let bits = normal.iter().fold(0, |all, n| all | n.unsigned_abs()).max(1).ilog2() + 1;
        let normal = normal.map(|n| n >> bits.saturating_sub(24));
        Self { mean, spreads, normal, parent, height, apart }
    }

    /// About how far the neighbours are from a vertex in that cell.
    #[inline(always)]
    pub(super) fn reach(&self, cell: Cell) -> u32 {
        self.apart + apart(self.mean, cell) as u32
    }

    /// The cell of the vertex, and the class of its height.
    #[inline(always)]
    pub(super) fn code<C: Coder>(&self, coder: &mut C, models: &mut Residuals, cell: Cell) -> (Cell, u8) {
        let [x, y, z] = self.normal.map(i64::unsigned_abs);
        let main = if x >= y && x >= z {
            0
        } else if y >= z {
            1
        } else {
            2
        };
        let (a, b) = ((main + 1) % 3, (main + 2) % 3);
        let mut found = [0; 3];
        for k in [a, b] {
            let from = cell[k].wrapping_sub(self.mean[k]);
            found[k] = self.mean[k].wrapping_add(residual(coder, &mut models.along, self.spreads[k], from));
        }
        let expected = if self.normal[main] == 0 {
            self.mean[main]
        } else {
            let along = |k: usize| self.normal[k] * (i64::from(found[k]) - i64::from(self.parent[k]));
            let (over, under) = (-along(a) - along(b), self.normal[main]);
            let (over, under) = if under < 0 { (-over, -under) } else { (over, under) };
            self.parent[main].wrapping_add((2 * over + under).div_euclid(2 * under) as i32)
        };
        let from = cell[main].wrapping_sub(expected);
        let height = residual(coder, &mut models.height, self.height, from);
        found[main] = expected.wrapping_add(height);
        (found, class(2 * u64::from(height.unsigned_abs()) + 1) as u8)
    }
}
