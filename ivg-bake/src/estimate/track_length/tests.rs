use glam::Vec3;

use super::TrackLength;
use crate::accumulate::{MAX_QUANTA, NUMBERS, Sums};
use crate::dual::Boxes;
use crate::estimate::{Estimate, Flight};
use crate::region::Regions;

/// Sums as a bake has them.
#[derive(Default)]
struct List(Vec<i64>);

impl Sums for List {
    fn add(&mut self, bucket: usize, quanta: &[f32; NUMBERS]) {
        for (n, &number) in quanta.iter().enumerate() {
            assert!(number.abs() <= MAX_QUANTA, "a deposit of {number} quanta");
            self.0[bucket * NUMBERS + n] += number.round_ties_even() as i64;
        }
    }
}

#[test]
fn a_flight_adds_its_length_to_the_three_hemispheres_it_comes_from() {
    let cells = Boxes { low: [0.0; 3], step: [2.0, 4.0, 8.0], count: [3, 2, 1] };
    let regions = Regions::new((0..6).map(|_| None));
    let estimate = TrackLength::new(cells, &regions);
    let mut sums = List(vec![0; estimate.buckets() * NUMBERS]);
    // Down through the second column of the first row; the light comes from above and a little from −x.
    let direction = Vec3::new(0.6, -0.8, 0.0);
    let power = Vec3::new(1.0, 0.5, 0.25);
    estimate.deposit(&Flight { origin: Vec3::new(2.1, 4.0, 3.0), direction, length: 2.0, power }, &mut sums);
    let vectors = estimate.vectors(&sums.0, 1, 64.0);
    // Each deposit is rounded to 2^-22 of the next power of two above the diagonal, 16; over a volume of 64.
    let quantum = 64.0 * 16.0 / 64.0 / 4_194_304.0;
    for (h, hemisphere) in vectors.iter().enumerate() {
        for c in 0..3 {
            for k in 0..3 {
                let w = -direction[k] * power[c] * 2.0;
                // From −x, from +y, and z: +0 counts as +z.
                let expected = if [1, 2, 4].contains(&h) { w } else { 0.0 };
                assert!((hemisphere[c][k] - expected).abs() < quantum, "{h} {c} {k}: {}", hemisphere[c][k]);
            }
        }
    }
    for other in [0, 2, 3, 4, 5] {
        assert_eq!(estimate.vectors(&sums.0, other, 64.0), ivg_grid::HemisphereVectors::default());
    }
}

#[test]
fn the_longest_stretch_of_a_whole_photon_fits() {
    for step in [[1.0, 1.0, 1.0], [0.3, 77.0, 1300.0], [1.154_700_5; 3]] {
        let cells = Boxes { low: [-5.0, 3.0, 900.0], step, count: [2; 3] };
        let regions = Regions::new((0..8).map(|_| None));
        let estimate = TrackLength::new(cells, &regions);
        let mut sums = List(vec![0; estimate.buckets() * NUMBERS]);
        let direction = Vec3::from(step).normalize();
        let origin = Vec3::from(cells.low) - direction * 50.0;
        estimate.deposit(&Flight { origin, direction, length: f32::INFINITY, power: Vec3::ONE }, &mut sums);
        assert!(sums.0.iter().any(|s| s.unsigned_abs() as f32 > MAX_QUANTA / 8.0), "quanta are not wasted");
    }
}

#[test]
fn many_cells_in_one_flight_are_all_added() {
    let cells = Boxes { low: [0.0; 3], step: [1.0; 3], count: [300, 1, 1] };
    let regions = Regions::new((0..300).map(|_| None));
    let estimate = TrackLength::new(cells, &regions);
    let mut sums = List(vec![0; estimate.buckets() * NUMBERS]);
    let flight = Flight {
        origin: Vec3::new(-4.0, 0.5, 0.5),
        direction: Vec3::X,
        length: f32::INFINITY,
        power: Vec3::ONE,
    };
    estimate.deposit(&flight, &mut sums);
    for vertex in 0..300 {
        // Distances near 300 are rounded to 2^-16.
        assert!((estimate.vectors(&sums.0, vertex, 1.0)[1][0][0] + 1.0).abs() < 1e-4, "cell {vertex}");
    }
}
