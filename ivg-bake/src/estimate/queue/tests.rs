use glam::Vec3;

use super::{OCTANTS, Queue, WAITING, octant};
use crate::accumulate::Store;
use crate::dual::Boxes;
use crate::estimate::track_length::VectorTracks;
use crate::estimate::{Estimate, Flight};
use crate::region::Regions;
use crate::sampling::hemisphere::sphere;
use crate::sampling::rng::{Purpose, Stream};

/// Octants fill at different times, and some flights are left at the end.
#[test]
fn every_flight_is_deposited_once() {
    let cells = Boxes { low: [-4.0; 3], step: [2.0; 3], count: [4; 3] };
    let regions = Regions::new((0..64).map(|_| None));
    let estimate = VectorTracks::new(cells, &regions);
    let flights: Vec<Flight> = (0..(OCTANTS * WAITING * 2 + 77) as u64)
        .map(|item| {
            let u = Stream::new(1, item).uniforms(0, Purpose::Gather);
            let direction = sphere([u[0], u[1]]);
            Flight {
                origin: -3.0 * direction,
                direction,
                length: 6.0 * u[2],
                power: Vec3::new(1.0, u[3], 0.5),
            }
        })
        .collect();
    let mut full = [0; OCTANTS];
    flights.iter().for_each(|flight| full[octant(flight)] += 1);
    assert!(full.iter().any(|&count| count > WAITING) && full.iter().all(|&count| count % WAITING != 0));

    let sums = |queued: bool| {
        let store = Store::new(estimate.sums(), 1);
        let Store::Private { len, sets } = &store else { panic!("few sums are each thread's own") };
        let mut sums = Store::take(sets, *len);
        if queued {
            let mut queue = Queue::new(&estimate, &mut sums);
            flights.iter().for_each(|flight| queue.push(*flight));
            queue.empty();
        } else {
            flights.iter().for_each(|flight| estimate.deposit(flight, &mut sums));
        }
        Store::give_back(sets, sums);
        store.into_sums()
    };
    assert_eq!(sums(true), sums(false));
}
