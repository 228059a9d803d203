//! Exact sums: light deposited as integers.
//!
//! A deposit is a few numbers in a row (for irradiance vectors nine: three channels times three axes; for radiance 27: three
//! channels times nine harmonics), each at most [`MAX_QUANTA`] quanta. The quantum is fixed by the estimator: for track
//! lengths it follows from the cell's diagonal, so that the longest stretch of a photon of full power is at most
//! [`MAX_QUANTA`]; components of a unit vector and spherical harmonics to degree 2 are at most 1. Every flight of a photon
//! adds at most once to a number, and [`MAX_FLIGHTS`] bounds photons times flights, so that no sum exceeds
//! 2²² · 2⁴⁰ = 2⁶² in size and i64 never overflows. Integer addition commutes: any number of threads, any order and any split gives the same sums.

use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Mutex, PoisonError};

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
            *sum = sum.wrapping_add(round(number));
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

/// All sums of a bake, kept once a thread or once for all. They stay where they are between stretches of work, so that they
/// can be read there.
#[derive(Debug)]
pub(crate) enum Store {
    /// A set for each thread that ever worked at the same time as others.
    Private {
        /// Numbers in a set.
        len: usize,
        /// Sets that no thread works with at the moment.
        sets: Mutex<Vec<Private>>,
    },
    /// One set for all.
    Shared(Vec<AtomicI64>),
}

impl Store {
    /// `len` sums for `threads` threads.
    pub(crate) fn new(len: usize, threads: usize) -> Self {
        if len.saturating_mul(size_of::<i64>()).saturating_mul(threads) <= PRIVATE_BYTES {
            Self::Private { len, sets: Mutex::default() }
        } else {
            Self::shared(len)
        }
    }

    /// Adds sums of photons traced before.
    pub(crate) fn add(&mut self, sums: Vec<i64>) {
        match self {
            Self::Private { sets, .. } => {
                sets.get_mut().unwrap_or_else(PoisonError::into_inner).push(Private(sums));
            }
            Self::Shared(all) => {
                all.iter_mut()
                    .zip(sums)
                    .for_each(|(sum, part)| *sum.get_mut() = sum.get_mut().wrapping_add(part));
            }
        }
    }

    /// `len` sums that all threads share.
    pub(crate) fn shared(len: usize) -> Self {
        Self::Shared((0..len).map(|_| AtomicI64::new(0)).collect())
    }

    /// A set of `len` sums for one thread: one of the `sets`, or an empty one.
    pub(crate) fn take(sets: &Mutex<Vec<Private>>, len: usize) -> Private {
        lock(sets).pop().unwrap_or_else(|| Private(vec![0; len]))
    }

    /// Puts a set back that [`Store::take`] gave.
    pub(crate) fn give_back(sets: &Mutex<Vec<Private>>, set: Private) {
        lock(sets).push(set);
    }

    /// The set that all threads add to.
    pub(crate) fn view(sums: &[AtomicI64]) -> Shared<'_> {
        Shared(sums)
    }

    /// The sums as they are now.
    pub(crate) fn total(&mut self) -> Total<'_> {
        match self {
            Self::Private { sets, .. } => {
                let sets = sets.get_mut().unwrap_or_else(PoisonError::into_inner);
                Total::Sets(sets.iter().map(|set| set.0.as_slice()).collect())
            }
            Self::Shared(sums) => Total::Shared(sums),
        }
    }

    /// The sums.
    pub(crate) fn into_sums(self) -> Vec<i64> {
        match self {
            Self::Private { len, sets } => {
                let mut sets = sets.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter();
                let mut total = sets.next().map_or_else(|| vec![0; len], |set| set.0);
                for set in sets {
                    total.iter_mut().zip(&set.0).for_each(|(sum, part)| *sum = sum.wrapping_add(*part));
                }
                total
            }
            // The same memory: an atomic has the size of its number.
            Self::Shared(sums) => sums.into_iter().map(AtomicI64::into_inner).collect(),
        }
    }
}

fn lock(sets: &Mutex<Vec<Private>>) -> std::sync::MutexGuard<'_, Vec<Private>> {
    sets.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Sums to read, wherever they are kept.
#[derive(Debug)]
pub(crate) enum Total<'a> {
    /// To be added up.
    Sets(Vec<&'a [i64]>),
    /// One set.
    Shared(&'a [AtomicI64]),
}

impl<'a> Total<'a> {
    /// The sums of a finished bake.
    pub(crate) fn of(sums: &'a [i64]) -> Self {
        Self::Sets(vec![sums])
    }

    /// `N` sums from `first` on.
    #[inline]
    pub(crate) fn get<const N: usize>(&self, first: usize) -> [i64; N] {
        match self {
            Self::Sets(sets) => {
                let mut sums = [0i64; N];
                for set in sets {
                    let part = set[first..][..N].iter();
                    sums.iter_mut().zip(part).for_each(|(sum, part)| *sum = sum.wrapping_add(*part));
                }
                sums
            }
            Self::Shared(sums) => {
                let sums = &sums[first..][..N];
                core::array::from_fn(|n| sums[n].load(Ordering::Relaxed))
            }
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
