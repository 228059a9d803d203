use glam::Vec3;

use super::{RadianceTracks, VectorTracks};
use crate::accumulate::{MAX_QUANTA, Sums, Total};
use crate::dual::Boxes;
use crate::estimate::{Estimate, Flight};
use crate::region::Regions;

/// Sums as a bake has them.
#[derive(Default)]
struct List(Vec<i64>);

impl Sums for List {
    fn add<const N: usize>(&mut self, first: usize, quanta: &[f32; N]) {
        for (n, &number) in quanta.iter().enumerate() {
            assert!(number.abs() <= MAX_QUANTA, "a deposit of {number} quanta");
            self.0[first + n] += number.round_ties_even() as i64;
        }
    }
}

#[test]
fn a_flight_adds_its_length_to_the_three_hemispheres_it_comes_from() {
    let cells = Boxes { low: [0.0; 3], step: [2.0, 4.0, 8.0], count: [3, 2, 1] };
    let regions = Regions::new((0..6).map(|_| None));
    let estimate = VectorTracks::new(cells, &regions);
    let mut sums = List(vec![0; estimate.sums()]);
    // Down through the second column of the first row; the light comes from above and a little from −x.
    let direction = Vec3::new(0.6, -0.8, 0.0);
    let power = Vec3::new(1.0, 0.5, 0.25);
    estimate.deposit(&Flight { origin: Vec3::new(2.1, 4.0, 3.0), direction, length: 2.0, power }, &mut sums);
    let vectors = estimate.value(&Total::of(&sums.0), 1, 64.0);
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
        assert_eq!(estimate.value(&Total::of(&sums.0), other, 64.0), ivg_grid::HemisphereVectors::default());
    }
}

/// The radiance is power times length over volume from one direction, so that each coefficient is that times its basis
/// function: every sign and every place is told apart by a direction without symmetry.
#[test]
fn a_flight_adds_its_length_to_the_nine_harmonics_of_where_it_comes_from() {
    let cells = Boxes { low: [0.0; 3], step: [2.0, 4.0, 8.0], count: [3, 2, 1] };
    let regions = Regions::new((0..6).map(|_| None));
    let estimate = RadianceTracks::new(cells, &regions);
    let mut sums = List(vec![0; estimate.sums()]);
    let direction = Vec3::new(2.0, -3.0, -6.0) / 7.0;
    let power = Vec3::new(1.0, 0.5, 0.25);
    let flight = Flight { origin: Vec3::new(2.1, 3.9, 3.0), direction, length: 0.5, power };
    estimate.deposit(&flight, &mut sums);
    let radiance = estimate.value(&Total::of(&sums.0), 1, 64.0);
    // As in the test above.
    let quantum = 64.0 * 16.0 / 64.0 / 4_194_304.0;
    let expected = ivg_grid::harmonics::basis(-direction.as_dvec3());
    for c in 0..3 {
        for (n, y) in expected.iter().enumerate() {
            let coefficient = *y as f32 * power[c] * 0.5;
            assert!((radiance[c][n] - coefficient).abs() < quantum, "{c} {n}: {}", radiance[c][n]);
        }
    }
    for other in [0, 2, 3, 4, 5] {
        assert_eq!(estimate.value(&Total::of(&sums.0), other, 64.0), ivg_grid::RadianceHarmonics::default());
    }
}

#[test]
fn the_longest_stretch_of_a_whole_photon_fits() {
    for step in [[1.0, 1.0, 1.0], [0.3, 77.0, 1300.0], [1.154_700_5; 3]] {
        let cells = Boxes { low: [-5.0, 3.0, 900.0], step, count: [2; 3] };
        let regions = Regions::new((0..8).map(|_| None));
        let direction = Vec3::from(step).normalize();
        let origin = Vec3::from(cells.low) - direction * 50.0;
        let flight = Flight { origin, direction, length: f32::INFINITY, power: Vec3::ONE };
        let vectors = VectorTracks::new(cells, &regions);
        let radiance = RadianceTracks::new(cells, &regions);
        let [mut a, mut b] = [vectors.sums(), radiance.sums()].map(|len| List(vec![0; len]));
        vectors.deposit(&flight, &mut a);
        radiance.deposit(&flight, &mut b);
        for sums in [a, b] {
            let largest = sums.0.iter().map(|s| s.unsigned_abs()).max();
            assert!(largest.is_some_and(|s| s as f32 > MAX_QUANTA / 8.0), "quanta are not wasted");
        }
    }
}

#[test]
fn many_cells_in_one_flight_are_all_added() {
    let cells = Boxes { low: [0.0; 3], step: [1.0; 3], count: [300, 1, 1] };
    let regions = Regions::new((0..300).map(|_| None));
    let estimate = VectorTracks::new(cells, &regions);
    let mut sums = List(vec![0; estimate.sums()]);
    let flight = Flight {
        origin: Vec3::new(-4.0, 0.5, 0.5),
        direction: Vec3::X,
        length: f32::INFINITY,
        power: Vec3::ONE,
    };
    estimate.deposit(&flight, &mut sums);
    for vertex in 0..300 {
        // Distances near 300 are rounded to 2^-16.
        assert!(
            (estimate.value(&Total::of(&sums.0), vertex, 1.0)[1][0][0] + 1.0).abs() < 1e-4,
            "cell {vertex}"
        );
    }
}

/// The vectors take the place of the sums while those of other vertices are still read.
#[test]
fn all_values_at_once_are_those_of_each_vertex() {
    let cells = Boxes { low: [0.0; 3], step: [1.0; 3], count: [5, 3, 2] };
    let regions = Regions::new((0..30).map(|_| None));
    let estimate = VectorTracks::new(cells, &regions);
    let sums: Vec<i64> = (0..estimate.sums() as i64).map(|n| (n * 7919) % 10_007 - 5000).collect();
    let each: Vec<_> = (0..30).map(|vertex| estimate.value(&Total::of(&sums), vertex, 3.0)).collect();
    assert_eq!(estimate.values(sums, 30, 3.0), each);
}
