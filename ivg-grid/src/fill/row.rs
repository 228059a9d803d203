//! The arithmetic of filling on the numbers of one vertex: means that cannot leave the range of what goes into them.

/// The numbers of one vertex: 54 of irradiance vectors, 27 of radiance harmonics.
pub(super) type Row<const W: usize> = [f32; W];

/// Largest absolute number of which sums of eight cannot overflow: 2^124.
const ORDINARY: f32 = f32::from_bits((124 + 127) << 23);

/// How large the numbers may be that means are made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Range {
    /// At most 2^124: nothing overflows.
    Ordinary,
    /// All of binary32.
    Whole,
}

impl Range {
    /// The range that holds these numbers too.
    pub(super) fn with<const W: usize>(self, row: &Row<W>) -> Self {
        let ordinary = row.iter().fold(true, |all, number| all & (number.abs() <= ORDINARY));
        if ordinary { self } else { Self::Whole }
    }

    /// Computes those numbers again that overflowed on the way to the mean of `rows`.
    #[inline]
    fn mend<const W: usize>(self, to: &mut Row<W>, rows: &[&Row<W>]) {
        if self == Self::Whole {
            for (i, number) in to.iter_mut().enumerate().filter(|(_, number)| !number.is_finite()) {
                let all = || rows.iter().map(|row| row[i]);
                let mean = (all().map(f64::from).sum::<f64>() / rows.len() as f64) as f32;
                *number = mean.clamp(all().fold(f32::MAX, f32::min), all().fold(f32::MIN, f32::max));
            }
        }
    }
}

/// The mean of rows, into `to`.
///
/// It stays between the smallest and the largest value, whatever the rounding: each row moves the mean by a share t of
/// the way to it, the whole way for the first, which is exact, and at most half of it for the others. The difference
/// and the product are rounded by less than 2^-22 together, so the exact sum does not pass the new value; rounding is
/// monotone, so the rounded sum does not either.
///
/// # Panics
///
/// If there is no row.
#[inline]
pub(super) fn mean<const W: usize>(to: &mut Row<W>, rows: &[&Row<W>], range: Range) {
    match *rows {
        [a] => *to = *a,
        [a, b] => chain(to, [a, b]),
        [a, b, c] => chain(to, [a, b, c]),
        [a, b, c, d] => chain(to, [a, b, c, d]),
        [a, b, c, d, e] => chain(to, [a, b, c, d, e]),
        [a, b, c, d, e, f] => chain(to, [a, b, c, d, e, f]),
        [a, b, c, d, e, f, g] => chain(to, [a, b, c, d, e, f, g]),
        [a, b, c, d, e, f, g, h] => chain(to, [a, b, c, d, e, f, g, h]),
        _ => {
            let mut mean = *rows[0];
            for (n, row) in (2..).zip(&rows[1..]) {
                let share = 1.0 / n as f32;
                mean.iter_mut().zip(*row).for_each(|(mean, value)| *mean += share * (value - *mean));
            }
            *to = mean;
        }
    }
    range.mend(to, rows);
}

/// The same for a number of rows that the compiler knows, so that it keeps the mean in registers.
#[inline]
fn chain<const N: usize, const W: usize>(to: &mut Row<W>, rows: [&Row<W>; N]) {
    let shares: [f32; N] = std::array::from_fn(|n| 1.0 / (n + 1) as f32);
    write(to, |i| {
        let mut mean = rows[0][i];
        for n in 1..N {
            mean += shares[n] * (rows[n][i] - mean);
        }
        mean
    });
}

/// The mean of four rows, as in [`mean`]: linear interpolation a quarter of a step along each axis from the first
/// towards the others.
///
/// Partial sums of two and four terms are rounded to numbers between so many times the smallest and so many times the
/// largest term, for these are exact.
#[inline]
pub(super) fn interpolate<const W: usize>(
    to: &mut Row<W>,
    own: &Row<W>,
    [x, y, z]: [&Row<W>; 3],
    range: Range,
) {
    write(to, |i| 0.25 * ((own[i] + x[i]) + (y[i] + z[i])));
    range.mend(to, &[own, x, y, z]);
}

/// A quarter of a value and three quarters of the mean of its six neighbours, as in [`mean`]: eight terms in a tree,
/// as in [`interpolate`]. Says whether `to` had other bits before.
#[inline]
pub(super) fn smooth<const W: usize>(
    to: &mut Row<W>,
    own: &Row<W>,
    neighbours: [&Row<W>; 6],
    range: Range,
) -> bool {
    let [a, b, c, d, e, f] = neighbours;
    let value = |i: usize| 0.125 * (((a[i] + b[i]) + (own[i] + own[i])) + ((c[i] + d[i]) + (e[i] + f[i])));
    if range == Range::Ordinary {
        return exchange(to, value);
    }
    let mut row = *own;
    write(&mut row, value);
    range.mend(&mut row, &[own, own, a, b, c, d, e, f]);
    replace(to, &row)
}

#[inline(always)]
fn write<const W: usize>(to: &mut Row<W>, value: impl Fn(usize) -> f32) {
    for (i, to) in to.iter_mut().enumerate() {
        *to = value(i);
    }
}

/// Stores a row and says whether it has other bits than the one before.
#[inline]
pub(super) fn replace<const W: usize>(to: &mut Row<W>, row: &Row<W>) -> bool {
    exchange(to, |i| row[i])
}

/// Stores numbers and says whether any has other bits than the one before.
#[inline(always)]
fn exchange<const W: usize>(to: &mut Row<W>, value: impl Fn(usize) -> f32) -> bool {
    let mut differing = 0;
    for (i, to) in to.iter_mut().enumerate() {
        let new = value(i);
        differing |= to.to_bits() ^ new.to_bits();
        *to = new;
    }
    differing != 0
}
