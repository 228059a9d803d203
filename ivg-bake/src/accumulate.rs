//! Exact sums: light deposited as integers.
//!
//! A deposit is a few numbers in a row (for irradiance vectors nine: three channels times three axes; for radiance 27: three
//! channels times nine harmonics), each at most [`MAX_QUANTA`] quanta. The quantum is fixed by the estimator: for track
//! lengths it follows from the cell's diagonal, so that the longest stretch of a photon of full power is at most
//! [`MAX_QUANTA`]; components of a unit vector and spherical harmonics to degree 2 are at most 1. Every flight of a photon
//! adds at most once to a number, and [`MAX_FLIGHTS`] bounds photons times flights, so that no sum exceeds
//! 2²² · 2⁴⁰ = 2⁶² in size and i64 never overflows. Integer addition commutes: any number of threads, any order and any split gives the same sums.

use std::sync::atomic::{AtomicI64, Ordering};

/// The largest size of one number of a deposit, in quanta.
pub(crate) const MAX_QUANTA: f32 = 4_194_304.0;

/// The most flights (photons times flights of a photon) that the sums hold.
pub(crate) const MAX_FLIGHTS: u64 = 1 << 40;

/// Sums that are kept once a thread as long as they all fit into this many bytes; beyond, threads share one.
const PRIVATE_BYTES: usize = 512 << 20;

/// Where deposits go.
pub(crate) trait Sums {
    /// Adds to the `N` sums from `first` on; each number in quanta, at most [`MAX_QUANTA`] in size, rounded to the nearest
    /// whole number.
    fn add<const N: usize>(&mut self, first: usize, quanta: &[f32; N]);
}

/// The sums of one thread.
#[derive(Debug)]
pub(crate) struct Private(Vec<i64>);

impl Sums for Private {
    #[inline]
    fn add<const N: usize>(&mut self, first: usize, quanta: &[f32; N]) {
        let sums = &mut self.0[first..][..N];
        for (sum, &number) in sums.iter_mut().zip(quanta) {
            *sum += round(number);
        }
    }
}

/// Sums that all threads add to.
#[derive(Debug)]
pub(crate) struct Shared<'a>(&'a [AtomicI64]);

impl Sums for Shared<'_> {
    #[inline]
    fn add<const N: usize>(&mut self, first: usize, quanta: &[f32; N]) {
        let sums = &self.0[first..][..N];
        for (sum, &number) in sums.iter().zip(quanta) {
            sum.fetch_add(round(number), Ordering::Relaxed);
        }
    }
}

/// All sums of a bake, kept once a thread or once for all.
#[derive(Debug)]
pub(crate) enum Store {
    /// One set for each thread while it works, added up here.
    Private {
        /// Numbers in a set.
        len: usize,
        /// The total.
        total: std::sync::Mutex<Vec<i64>>,
    },
    /// One set for all.
    Shared(Vec<AtomicI64>),
}

impl Store {
    /// `len` sums for `threads` threads.
    pub(crate) fn new(len: usize, threads: usize) -> Self {
        if len.saturating_mul(size_of::<i64>()).saturating_mul(threads) <= PRIVATE_BYTES {
            Self::Private { len, total: std::sync::Mutex::new(vec![0; len]) }
        } else {
            Self::shared(len)
        }
    }

    /// `len` sums that all threads share.
    pub(crate) fn shared(len: usize) -> Self {
        Self::Shared((0..len).map(|_| AtomicI64::new(0)).collect())
    }

    /// An empty set for one thread.
    pub(crate) fn private(len: usize) -> Private {
        Private(vec![0; len])
    }

    /// The set that all threads add to.
    pub(crate) fn view(sums: &[AtomicI64]) -> Shared<'_> {
        Shared(sums)
    }

    /// Adds the set of one thread to the total.
    pub(crate) fn merge(total: &std::sync::Mutex<Vec<i64>>, part: &Private) {
        let mut total = total.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        for (sum, part) in total.iter_mut().zip(&part.0) {
            *sum += part;
        }
    }

    /// The sums.
    pub(crate) fn into_sums(self) -> Vec<i64> {
        match self {
            Self::Private { total, .. } => {
                total.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner)
            }
            Self::Shared(sums) => sums.into_iter().map(AtomicI64::into_inner).collect(),
        }
    }
}

/// The nearest whole number to `x`, |x| <= 2²²; halves to even.
///
/// Adding 1.5 · 2²³ puts the whole part into the low bits of the mantissa, which is faster than asking for a rounding
/// instruction that the baseline x86-64 does not have.
#[inline]
fn round(x: f32) -> i64 {
    const SHIFT: f32 = 12_582_912.0;
    i64::from((x + SHIFT).to_bits() as i32 - SHIFT.to_bits() as i32)
}

#[cfg(test)]
mod tests;
