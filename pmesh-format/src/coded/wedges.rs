//! Where the attributes of a new wedge are expected (PMESH-COD-15): an affine map of positions, fitted to what is around it.

use super::geometry::Cell;

/// The most neighbours that are looked at: two for each face.
pub(super) const MOST: usize = 32;

/// Bits of the coordinates that the map is fitted to.
const FIT_BITS: u32 = 8;

/// Bits behind the point of a weight.
const WEIGHT_BITS: u32 = 10;

/// The greatest sum of the magnitudes of weights: with more, neighbours say too little of where the wedge is.
const WEIGHTS_MOST: i64 = 2 << WEIGHT_BITS;

/// By how much each neighbour counts beside the mean of all.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weights {
    weights: [i64; MOST],
    count: usize,
}

impl Weights {
    /// For up to [`MOST`] neighbours in these cells, one at least, of a wedge in the cell `here`; `normal`: of the faces there.
    pub(super) fn new(around: &[Cell], here: Cell, normal: [i64; 3]) -> Self {
        let count = around.len().min(MOST);
        let around = &around[..count];
        let mut weights = [0; MOST];
        let none = Self { weights, count };
        let k = count.max(1) as i64;
        let mean: [i64; 3] = core::array::from_fn(|axis| {
            let sum: i64 = around.iter().map(|cell| i64::from(cell[axis])).sum();
            (2 * sum + k).div_euclid(2 * k)
        });
        let [x, y, z] = normal.map(i64::unsigned_abs);
        let main = if x >= y && x >= z {
            0
        } else if y >= z {
            1
        } else {
            2
        };
        let axes = [(main + 1) % 3, (main + 2) % 3];
        let flat = |cell: Cell| axes.map(|axis| i64::from(cell[axis]) - mean[axis]);
        let apart = flat(here);
        let size = around.iter().map(|&cell| flat(cell)).chain([apart]);
        let size = size.fold(0, |all, [x, y]| all | x.unsigned_abs() | y.unsigned_abs());
        let shift = (u64::BITS - size.leading_zeros()).saturating_sub(FIT_BITS);
        let flat = |cell: Cell| flat(cell).map(|x| x >> shift);
        // |x|, |y| ≤ 2⁸ and at most 32 neighbours: a, b, c ≤ 2²¹, and what is divided below is less than 2⁵¹.
        let (mut a, mut b, mut c) = (0, 0, 0);
        for [x, y] in around.iter().map(|&cell| flat(cell)) {
            a += x * x;
            b += x * y;
            c += y * y;
        }
        let [x, y] = apart.map(|x| x >> shift);
        let (along, across, area) = (c * x - b * y, a * y - b * x, a * c - b * b);
        if area <= 0 {
            return none;
        }
        let mut sum = 0;
        for (weight, &cell) in weights.iter_mut().zip(around) {
            let [x, y] = flat(cell);
            *weight = ((x * along + y * across) << WEIGHT_BITS).div_euclid(area);
            sum += weight.abs();
        }
        if sum > WEIGHTS_MOST { none } else { Self { weights, count } }
    }

    /// What is expected where the neighbours have these values, each less than 2²⁰.
    pub(super) fn expected<const N: usize>(&self, value: impl Fn(usize) -> [i32; N]) -> [i64; N] {
        let k = self.count.max(1) as i64;
        let mut mean = [0i64; N];
        for place in 0..self.count {
            mean.iter_mut().zip(value(place)).for_each(|(sum, x)| *sum += i64::from(x));
        }
        let mean = mean.map(|sum| (2 * sum + k).div_euclid(2 * k));
        let mut more = [0i64; N];
        for (place, weight) in self.weights.iter().enumerate().take(self.count) {
            let value = value(place);
            for n in 0..N {
                more[n] += weight * (i64::from(value[n]) - mean[n]);
            }
        }
        core::array::from_fn(|n| mean[n] + ((more[n] + (1 << (WEIGHT_BITS - 1))) >> WEIGHT_BITS))
    }
}
