//! Photons traced so far, and what they left: sums and books. Tracing can stop after any photon and go on later.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use crate::BakeError;
use crate::accumulate::{Store, Total};
use crate::estimate::Estimate;
use crate::estimate::queue::Queue;
use crate::trace::{Books, Tracer};
use crate::workers::Workers;

/// Photons that a thread takes at a time, and the pieces that shards are dealt.
pub(crate) const PHOTONS_A_PIECE: u64 = 2048;

/// Photons between two questions whether there are enough: so many, then a share of those traced, in whole pieces.
const PHOTONS_A_STRETCH: u64 = 32 * PHOTONS_A_PIECE;

/// One part in so many of the photons traced: a time that is up is exceeded by no more than that.
const STRETCHES: u64 = 32;

/// The end of the stretch of photons that begins at `first`, of `last` in all, for each of `shards`.
pub(crate) fn stretch(first: u64, last: u64, shards: u64) -> u64 {
    let longer = first / STRETCHES / PHOTONS_A_PIECE * PHOTONS_A_PIECE;
    let photons = PHOTONS_A_STRETCH.saturating_mul(shards).max(longer);
    first.saturating_add(photons).min(last)
}

/// Some of the photons of a bake: of every `of` pieces in turn, counted from photon 0, the one numbered `share`, as far as it
/// lies in `first..last`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Photons {
    pub(crate) first: u64,
    pub(crate) last: u64,
    pub(crate) share: u64,
    pub(crate) of: u64,
}

impl Photons {
    /// All photons of a range.
    pub(crate) fn all(first: u64, last: u64) -> Self {
        Self { first, last, share: 0, of: 1 }
    }

    /// The pieces that hold some of the photons: the first and how many.
    fn pieces(&self) -> (u64, u64) {
        let dealt = |pieces: u64| pieces.saturating_sub(self.share).div_ceil(self.of);
        let first = dealt(self.first / PHOTONS_A_PIECE);
        (first, dealt(self.last.div_ceil(PHOTONS_A_PIECE)).saturating_sub(first))
    }

    /// The photons of a piece.
    fn piece(&self, number: u64) -> core::ops::Range<u64> {
        let start = (number * self.of + self.share) * PHOTONS_A_PIECE;
        start.max(self.first)..(start + PHOTONS_A_PIECE).min(self.last)
    }
}

/// Sums and books of the photons traced so far.
#[derive(Debug)]
pub(crate) struct Tally<'a, E> {
    tracer: &'a Tracer<'a>,
    pub(crate) estimate: &'a E,
    store: Store,
    books: Books,
    /// Photons traced.
    photons: u64,
}

impl<'a, E: Estimate> Tally<'a, E> {
    /// Nothing traced.
    pub(crate) fn new(tracer: &'a Tracer<'a>, estimate: &'a E, threads: usize) -> Self {
        let store = Store::new(estimate.sums(), threads);
        Self { tracer, estimate, store, books: Books::default(), photons: 0 }
    }

    /// Goes on from sums and books of photons traced before.
    pub(crate) fn resume(&mut self, sums: Vec<i64>, books: Books) {
        self.store.add(sums);
        self.books = books;
    }

    /// Sums and books as they are now.
    pub(crate) fn copy(&mut self) -> (Vec<i64>, Books) {
        let len = self.estimate.sums();
        let total = self.store.total();
        ((0..len).map(|n| total.get::<1>(n)[0]).collect(), self.books.clone())
    }

    /// Photons traced.
    pub(crate) fn photons(&self) -> u64 {
        self.photons
    }

    /// The sums so far.
    pub(crate) fn total(&mut self) -> Total<'_> {
        self.store.total()
    }

    /// Traces some more photons on all threads.
    pub(crate) fn trace(&mut self, photons: Photons, workers: &Workers<'_>) -> Result<(), BakeError> {
        let Self { tracer, estimate, store, .. } = self;
        let books = Mutex::new(core::mem::take(&mut self.books));
        let done = AtomicU64::new(self.photons);
        let (first, pieces) = photons.pieces();
        workers.run(pieces, &done, |take| {
            let mut own = Books::default();
            let mut trace = |one: &mut dyn FnMut(u64, &mut Books)| {
                while let Some(piece) = take() {
                    let piece = photons.piece(first + piece);
                    let count = piece.end.saturating_sub(piece.start);
                    piece.for_each(|photon| one(photon, &mut own));
                    let done = done.fetch_add(count, Ordering::Relaxed) + count;
                    workers.monitor.progress(done, workers.total_photons);
                }
            };
            match &*store {
                Store::Private { len, sets } => {
                    let mut sums = Store::take(sets, *len);
                    let mut queue = Queue::new(*estimate, &mut sums);
                    trace(&mut |photon, books| tracer.trace(photon, &mut |flight| queue.push(flight), books));
                    queue.empty();
                    Store::give_back(sets, sums);
                }
                Store::Shared(cells) => {
                    let mut sums = Store::view(cells);
                    let mut queue = Queue::new(*estimate, &mut sums);
                    trace(&mut |photon, books| tracer.trace(photon, &mut |flight| queue.push(flight), books));
                    queue.empty();
                }
            }
            books.lock().unwrap_or_else(PoisonError::into_inner).merge(&own);
        })?;
        self.books = books.into_inner().unwrap_or_else(PoisonError::into_inner);
        self.photons = done.into_inner();
        Ok(())
    }

    /// Ends tracing.
    pub(crate) fn finish(self) -> Traced {
        Traced { sums: self.store.into_sums(), books: self.books, photons: self.photons }
    }
}

/// What tracing left.
#[derive(Debug)]
pub(crate) struct Traced {
    pub(crate) sums: Vec<i64>,
    /// Where the energy went.
    pub(crate) books: Books,
    /// Photons traced.
    pub(crate) photons: u64,
}

/// Traces `photons` photons on all threads.
pub(crate) fn run(
    tracer: &Tracer<'_>,
    estimate: &impl Estimate,
    photons: u64,
    workers: &Workers<'_>,
) -> Result<Traced, BakeError> {
    let mut tally = Tally::new(tracer, estimate, workers.threads);
    tally.trace(Photons::all(0, photons), workers)?;
    Ok(tally.finish())
}

#[cfg(test)]
mod tests;
