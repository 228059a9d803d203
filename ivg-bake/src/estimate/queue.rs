//! Flights that wait until many of one octant of directions can be deposited one after the other.
//!
//! Waiting for memory is most of what a deposit costs, and the sums of an octant lie together: an eighth of all, which a processor's
//! caches rather hold. Sums are whole numbers, so that the order of deposits does not matter.

use super::{Estimate, Flight};
use crate::accumulate::Sums;

/// Flights that wait in an octant: 40 bytes each, 40 KiB in all.
const WAITING: usize = 128;

/// Octants of directions.
pub(crate) const OCTANTS: usize = 8;

/// Which of the octants the light of a flight comes from: bits 0, 1, 2 are set where it comes from −x, −y, −z.
#[inline]
pub(crate) fn octant(flight: &Flight) -> usize {
    let towards = -flight.direction;
    usize::from(towards.x < 0.0) | usize::from(towards.y < 0.0) << 1 | usize::from(towards.z < 0.0) << 2
}

/// Takes flights and deposits them, in an order of its own; all are deposited when it is [emptied](Queue::empty).
#[derive(Debug)]
pub(crate) struct Queue<'a, E, S> {
    estimate: &'a E,
    sums: &'a mut S,
    waiting: [Vec<Flight>; OCTANTS],
}

impl<'a, E: Estimate, S: Sums> Queue<'a, E, S> {
    /// Nothing waits.
    pub(crate) fn new(estimate: &'a E, sums: &'a mut S) -> Self {
        Self { estimate, sums, waiting: core::array::from_fn(|_| Vec::with_capacity(WAITING)) }
    }

    /// Deposits a flight, now or later.
    #[inline]
    pub(crate) fn push(&mut self, flight: Flight) {
        let waiting = &mut self.waiting[octant(&flight)];
        waiting.push(flight);
        if waiting.len() == WAITING {
            waiting.drain(..).for_each(|flight| self.estimate.deposit(&flight, self.sums));
        }
    }

    /// Deposits all flights that wait.
    pub(crate) fn empty(mut self) {
        for waiting in &mut self.waiting {
            waiting.drain(..).for_each(|flight| self.estimate.deposit(&flight, self.sums));
        }
    }
}

#[cfg(test)]
mod tests;
