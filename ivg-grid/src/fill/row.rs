//! The arithmetic of filling on the numbers of one vertex: means that cannot leave the range of what goes into them.

use glam::Vec4;

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
            mend(to, rows);
        }
    }
}

/// Computes those numbers again that overflowed on the way to the mean of `rows`.
#[cold]
#[inline(never)]
fn mend<const W: usize>(to: &mut Row<W>, rows: &[&Row<W>]) {
    for (i, number) in to.iter_mut().enumerate().filter(|(_, number)| !number.is_finite()) {
        let all = || rows.iter().map(|row| row[i]);
        let mean = (all().map(f64::from).sum::<f64>() / rows.len() as f64) as f32;
        *number = mean.clamp(all().fold(f32::MAX, f32::min), all().fold(f32::MIN, f32::max));
    }
}

/// The mean of rows, into `to`.
///
/// It stays between the smallest and the largest value, whatever the rounding. A mean of two, four or eight rows is a
/// tree of sums and one multiplication: a sum of n numbers, n a power of two, is rounded to one between n times the
/// smallest and n times the largest, for these are binary32 themselves and rounding is monotone; so is the product with
/// 1/n, for what it would be of those is exact. Every other mean is put together from two that stay in the range: one
/// moves by a share of at most a half of the way to the other. The difference and the product are rounded by less than
/// 2^-22 together, so the exact sum does not pass that other value; rounding is monotone, so the rounded sum does not
/// either.
///
/// # Panics
///
/// If there is no row.
#[inline]
pub(super) fn mean<const W: usize>(to: &mut Row<W>, rows: &[&Row<W>], range: Range) {
    const THIRD: f32 = 1.0 / 3.0;
    let towards = |from: Vec4, share: f32, other: Vec4| from + share * (other - from);
    match *rows {
        [a] => *to = *a,
        [a, b] => write(to, |i| mean_of_2(block(a, i), block(b, i))),
        [a, b, c] => write(to, |i| towards(mean_of_2(block(a, i), block(b, i)), THIRD, block(c, i))),
        [a, b, c, d] => write(to, |i| mean_of_4([block(a, i), block(b, i), block(c, i), block(d, i)])),
        [a, b, c, d, e] => write(to, |i| {
            towards(mean_of_4([block(a, i), block(b, i), block(c, i), block(d, i)]), 0.2, block(e, i))
        }),
        [a, b, c, d, e, f] => {
            write(to, |i| {
                towards(
                    mean_of_4([block(a, i), block(b, i), block(c, i), block(d, i)]),
                    THIRD,
                    mean_of_2(block(e, i), block(f, i)),
                )
            });
        }
        [a, b, c, d, e, f, g] => write(to, |i| {
            let of_three = towards(mean_of_2(block(e, i), block(f, i)), THIRD, block(g, i));
            towards(mean_of_4([block(a, i), block(b, i), block(c, i), block(d, i)]), 3.0 / 7.0, of_three)
        }),
        [a, b, c, d, e, f, g, h] => {
            write(to, |i| {
                mean_of_8(
                    [block(a, i), block(b, i), block(c, i), block(d, i)],
                    [block(e, i), block(f, i), block(g, i), block(h, i)],
                )
            });
        }
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

#[inline(always)]
fn mean_of_2(a: Vec4, b: Vec4) -> Vec4 {
    0.5 * (a + b)
}

#[inline(always)]
fn mean_of_4([a, b, c, d]: [Vec4; 4]) -> Vec4 {
    0.25 * ((a + b) + (c + d))
}

#[inline(always)]
fn mean_of_8([a, b, c, d]: [Vec4; 4], [e, f, g, h]: [Vec4; 4]) -> Vec4 {
    0.125 * (((a + b) + (c + d)) + ((e + f) + (g + h)))
}

/// The mean of four rows, as in [`mean`]: linear interpolation a quarter of a step along each axis from the first
/// towards the others.
#[inline(always)]
pub(super) fn interpolate<const W: usize>(
    to: &mut Row<W>,
    own: &Row<W>,
    [x, y, z]: [&Row<W>; 3],
    range: Range,
) {
    write(to, |i| mean_of_4([block(own, i), block(x, i), block(y, i), block(z, i)]));
    range.mend(to, &[own, x, y, z]);
}

/// Two such means at once that differ along the first axis alone.
#[inline(always)]
pub(super) fn interpolate_both<const W: usize>(
    [low, high]: &mut [Row<W>; 2],
    own: &Row<W>,
    [x_low, x_high]: [&Row<W>; 2],
    [y, z]: [&Row<W>; 2],
    range: Range,
) {
    write(low, |i| mean_of_4([block(own, i), block(x_low, i), block(y, i), block(z, i)]));
    write(high, |i| mean_of_4([block(own, i), block(x_high, i), block(y, i), block(z, i)]));
    range.mend(low, &[own, x_low, y, z]);
    range.mend(high, &[own, x_high, y, z]);
}

/// A quarter of a value and three quarters of the mean of its six neighbours: the mean of eight rows, as in [`mean`].
#[inline(always)]
pub(super) fn smooth<const W: usize>(to: &mut Row<W>, own: &Row<W>, neighbours: [&Row<W>; 6], range: Range) {
    let [a, b, c, d, e, f] = neighbours;
    write(to, |i| {
        let twice = block(own, i) + block(own, i);
        let pairs = ((block(a, i) + block(b, i)) + twice)
            + ((block(c, i) + block(d, i)) + (block(e, i) + block(f, i)));
        0.125 * pairs
    });
    range.mend(to, &[own, own, a, b, c, d, e, f]);
}

/// Numbers that are computed at once.
const BLOCK: usize = 4;

/// The block of a row that begins with number `at`.
#[inline(always)]
fn block<const W: usize>(row: &Row<W>, at: usize) -> Vec4 {
    let [x, y, z, w] = row[at..at + BLOCK] else { unreachable!("a block is that long") };
    Vec4::new(x, y, z, w)
}

/// Computes the numbers of a row block by block; the last one reaches back where the blocks do not come out even.
#[inline(always)]
fn write<const W: usize>(to: &mut Row<W>, value: impl Fn(usize) -> Vec4) {
    const { assert!(W >= BLOCK, "at least one block") };
    let mut store = |at: usize, block: Vec4| to[at..at + BLOCK].copy_from_slice(&block.to_array());
    // Two at once: nothing is stored while there is something to load.
    let mut at = 0;
    while at + 2 * BLOCK <= W {
        let both = [value(at), value(at + BLOCK)];
        store(at, both[0]);
        store(at + BLOCK, both[1]);
        at += 2 * BLOCK;
    }
    if at + BLOCK <= W {
        store(at, value(at));
    }
    if !W.is_multiple_of(BLOCK) {
        store(W - BLOCK, value(W - BLOCK));
    }
}

/// Stores a row and says whether it has other bits than the one before.
#[inline]
pub(super) fn replace<const W: usize>(to: &mut Row<W>, row: &Row<W>) -> bool {
    let differing = to.iter().zip(row).fold(0, |bits, (a, b)| bits | (a.to_bits() ^ b.to_bits()));
    *to = *row;
    differing != 0
}
