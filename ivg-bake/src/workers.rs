//! Work on several threads whose result does not depend on how many there are.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use crate::{BakeError, Monitor};

/// Threads to work on, and who watches.
#[derive(Clone, Copy)]
pub(crate) struct Workers<'a> {
    pub(crate) threads: usize,
    pub(crate) monitor: &'a dyn Monitor,
    /// What a cancelled bake reports as asked for.
    pub(crate) total_photons: u64,
}

/// Items that a thread takes at a time in [`map`].
const BATCH: usize = 32;

impl Workers<'_> {
    /// Whether so much of the time, as a share of all that there is, has passed, or the monitor has enough.
    pub(crate) fn is_late(&self, share: f64) -> bool {
        self.monitor.time_spent().is_some_and(|spent| spent >= share) || self.monitor.enough()
    }

    /// Runs `work` on every thread. It asks for pieces of 0..`pieces` through the function it is given, until there is
    /// none left or the monitor cancels; each piece is handed out once.
    ///
    /// # Errors
    ///
    /// [`BakeError::Cancelled`], with `done` as it stands then.
    pub(crate) fn run(
        &self,
        pieces: u64,
        done: &AtomicU64,
        work: impl Fn(&dyn Fn() -> Option<u64>) + Sync,
    ) -> Result<(), BakeError> {
        let next = AtomicU64::new(0);
        let cancelled = AtomicBool::new(false);
        let take = || {
            if self.monitor.cancelled() {
                cancelled.store(true, Ordering::Relaxed);
            }
            let piece = next.fetch_add(1, Ordering::Relaxed);
            (piece < pieces && !cancelled.load(Ordering::Relaxed)).then_some(piece)
        };
        std::thread::scope(|scope| {
            for _ in 1..self.threads {
                scope.spawn(|| work(&take));
            }
            work(&take);
        });
        if cancelled.into_inner() {
            let done = done.load(Ordering::Relaxed);
            return Err(BakeError::Cancelled { done, total: self.total_photons });
        }
        Ok(())
    }
}

/// `function` of every index below `count`, in order.
///
/// # Errors
///
/// [`BakeError::Cancelled`].
pub(crate) fn map<T: Send>(
    workers: &Workers<'_>,
    count: usize,
    function: impl Fn(usize) -> T + Sync,
) -> Result<Vec<T>, BakeError> {
    let parts: Mutex<Vec<(u64, Vec<T>)>> = Mutex::new(Vec::new());
    workers.run(count.div_ceil(BATCH) as u64, &AtomicU64::new(0), |take| {
        while let Some(piece) = take() {
            let first = piece as usize * BATCH;
            let part = (first..(first + BATCH).min(count)).map(&function).collect();
            parts.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push((piece, part));
        }
    })?;
    let mut parts = parts.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    parts.sort_by_key(|(piece, _)| *piece);
    Ok(parts.into_iter().flat_map(|(_, part)| part).collect())
}

/// `function` of the indices below `count` one by one until [`Workers::is_late`]: what is begun is ended, so that the results
/// are those of the first few indices, in order.
///
/// # Errors
///
/// [`BakeError::Cancelled`].
pub(crate) fn map_until<T: Send>(
    workers: &Workers<'_>,
    share: f64,
    count: usize,
    function: impl Fn(usize) -> T + Sync,
) -> Result<Vec<T>, BakeError> {
    let results: Mutex<Vec<(u64, T)>> = Mutex::new(Vec::new());
    workers.run(count as u64, &AtomicU64::new(0), |take| {
        while let Some(index) = if workers.is_late(share) { None } else { take() } {
            let result = function(index as usize);
            results.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push((index, result));
        }
    })?;
    let mut results = results.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    results.sort_by_key(|(index, _)| *index);
    Ok(results.into_iter().map(|(_, result)| result).collect())
}

/// Items of a chunk of [`map_chunks`]: the chunks do not depend on how many threads there are.
const CHUNK: usize = 1024;

/// `function` of every chunk of `items`, given the index of its first item; the results in order.
///
/// # Errors
///
/// [`BakeError::Cancelled`].
pub(crate) fn map_chunks<T: Send, R: Send>(
    workers: &Workers<'_>,
    items: &mut [T],
    function: impl Fn(usize, &mut [T]) -> R + Sync,
) -> Result<Vec<R>, BakeError> {
    let chunks: Vec<Mutex<&mut [T]>> = items.chunks_mut(CHUNK).map(Mutex::new).collect();
    let results: Vec<Mutex<Option<R>>> = chunks.iter().map(|_| Mutex::new(None)).collect();
    workers.run(chunks.len() as u64, &AtomicU64::new(0), |take| {
        while let Some(number) = take() {
            let number = number as usize;
            let mut chunk = chunks[number].lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            let result = function(number * CHUNK, &mut chunk);
            *results[number].lock().unwrap_or_else(std::sync::PoisonError::into_inner) = Some(result);
        }
    })?;
    let results = results.into_iter();
    Ok(results.filter_map(|r| r.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner)).collect())
}
