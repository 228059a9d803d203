use glam::Vec3;

use super::FaceCrossing;
use crate::accumulate::{MAX_QUANTA, Sums, Total};
use crate::dual::Boxes;
use crate::estimate::{Estimate, Flight};
use crate::region::Regions;

#[derive(Default)]
struct List(Vec<i64>, u32);

impl Sums for List {
    fn add<const N: usize>(&mut self, first: usize, quanta: &[f32; N]) {
        self.1 += 1;
        for (n, &number) in quanta.iter().enumerate() {
            assert!(number.abs() <= MAX_QUANTA, "a deposit of {number} quanta");
            self.0[first + n] += number.round_ties_even() as i64;
        }
    }
}

const CELLS: Boxes = Boxes { low: [-0.5; 3], step: [1.0; 3], count: [3, 4, 5] };

fn deposit(estimate: &FaceCrossing<'_>, flights: &[Flight]) -> List {
    let mut sums = List(vec![0; estimate.sums()], 0);
    flights.iter().for_each(|flight| estimate.deposit(flight, &mut sums));
    sums
}

#[test]
fn a_crossing_adds_to_the_nearest_vertex_on_the_side_the_light_comes_from() {
    let regions = Regions::new((0..60).map(|_| None));
    let direction = Vec3::new(0.6, 0.0, 0.8);
    let flight = Flight { origin: Vec3::new(0.9, 2.2, 1.9), direction, length: 0.25, power: Vec3::ONE };
    for (estimate, divisor) in
        [(FaceCrossing::unbiased(CELLS, &regions), 0.8), (FaceCrossing::as_printed(CELLS), 1.0)]
    {
        // Crosses z = 2 after 0.125 at x = 0.975, and x = 1 after 1/6 at z = 2.03.
        let sums = deposit(&estimate, &[flight]);
        assert_eq!(sums.1, 2);
        let vertex = CELLS.index([1, 2, 2]);
        let vectors = estimate.value(&Total::of(&sums.0), vertex, 1.0);
        for k in 0..3 {
            assert!((vectors[5][0][k] + direction[k] / divisor).abs() < 1e-3, "{vectors:?}");
        }
        let divisor = if divisor == 1.0 { 1.0 } else { 0.6 };
        assert!((vectors[1][0][2] + 0.8 / divisor).abs() < 1e-3);
        assert_eq!(vectors[0], [[0.0; 3]; 3]);
        assert_eq!(vectors[4], [[0.0; 3]; 3]);
    }
}

#[test]
fn a_flight_crosses_each_plane_once() {
    let regions = Regions::new((0..60).map(|_| None));
    let estimate = FaceCrossing::unbiased(CELLS, &regions);
    let up = Flight {
        origin: Vec3::new(1.1, 0.9, -3.0),
        direction: Vec3::Z,
        length: f32::INFINITY,
        power: Vec3::ONE,
    };
    assert_eq!(deposit(&estimate, &[up]).1, 5);
    let short = Flight { length: 3.5, ..up };
    assert_eq!(deposit(&estimate, &[short]).1, 1, "the planes at 0 (a 64th of a step inside) and 1");
    let beside = Flight { origin: Vec3::new(3.0, 0.9, -3.0), ..up };
    assert_eq!(deposit(&estimate, &[beside]).1, 0);
}

#[test]
fn grazing_crossings_are_bounded() {
    let regions = Regions::new((0..60).map(|_| None));
    let estimate = FaceCrossing::unbiased(CELLS, &regions);
    let direction = Vec3::new(1.0, 1e-6, 0.0).normalize();
    let flight = Flight { origin: Vec3::new(-1.0, 0.999_999, 1.2), direction, length: 9.0, power: Vec3::ONE };
    let sums = deposit(&estimate, &[flight]);
    assert!(sums.0.iter().any(|s| s.unsigned_abs() as f32 == MAX_QUANTA));
}

/// RR-6983 halves the area of border vertices and quarters that of corners, and counts no crossing beyond the lattice.
#[test]
fn the_printed_estimator_treats_borders_as_printed() {
    let estimate = FaceCrossing::as_printed(CELLS);
    let through = |x: f32, y: f32| Flight {
        origin: Vec3::new(x, y, -2.0),
        direction: Vec3::Z,
        length: f32::INFINITY,
        power: Vec3::ONE,
    };
    assert_eq!(deposit(&estimate, &[through(-0.2, 1.0)]).1, 0);
    for (place, at, share) in
        [((1.0, 1.0), [1, 1, 2], 1.0), ((0.2, 1.0), [0, 1, 2], 2.0), ((0.2, 0.2), [0, 0, 2], 4.0)]
    {
        let sums = deposit(&estimate, &[through(place.0, place.1)]);
        let found = estimate.value(&Total::of(&sums.0), CELLS.index(at), 1.0)[5][0][2];
        assert!((found + share).abs() < 1e-3, "{found} at {at:?}");
    }
}
