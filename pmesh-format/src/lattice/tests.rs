use std::vec;
use std::vec::Vec;

use quickcheck::quickcheck;

use super::*;

/// Numbers of any size that occurs, both signs.
fn number(bits: u32) -> f32 {
    f32::from_bits(bits & 0xBFFF_FFFF)
}

quickcheck! {
    fn quantised_positions_are_near_and_stay(given: Vec<(u32, u32, u32)>, bits: u8) -> bool {
        let positions: Vec<[f32; 3]> =
            given.into_iter().map(|(x, y, z)| [x, y, z].map(number)).filter(|p| p.iter().all(|x| x.is_finite())).collect();
        let how = Positions::Quantised(10 + bits % 7);
        let stored = how.quantised(&positions);
        let [low, high] = bounds(&positions);
        let longest = (0..3).map(|k| f64::from(high[k]) - f64::from(low[k])).fold(0.0, f64::max);
        let step = longest / f64::from((1u32 << (10 + bits % 7)) - 1);
        let near = positions.iter().zip(&stored).all(|(p, q)| {
            (0..3).all(|k| {
                // Half a step to the nearest point, and half a unit in the last place of binary32: 2^-24 of the number, or
                // half the least number there is.
                let rounding = f64::from(q[k]).abs() * 2f64.powi(-24) + f64::from(f32::from_bits(1)) / 2.0;
                // The sums and products in binary64 are off by 2^-53 of what they are made of, a few times.
                let sums = 2f64.powi(-50) * (f64::from(low[k]).abs() + longest);
                (f64::from(p[k]) - f64::from(q[k])).abs() <= step / 2.0 + rounding + sums
            })
        });
        near && how.quantised(&stored) == stored
    }
}

#[test]
fn the_lattice_is_that_of_the_specification() {
    // The longest side is 1023 steps of 2 m; the others end at the nearest point.
    let lattice = Lattice::new([[-1.0, 0.0, 5.0], [2045.0, 100.9, 5.0]], 10);
    assert_eq!(lattice.top(), [1023, 50, 0]);
    assert_eq!(lattice.position([1023, 50, 0]), [2045.0, 100.0, 5.0]);
    assert_eq!(lattice.nearest([2.0, 100.9, 5.0]), [2, 50, 0], "of two the greater");
    assert_eq!(lattice.nearest([1.9, 0.9, 5.0]), [1, 0, 0]);
    // All in one place: one point.
    let point = Lattice::new([[3.0; 3]; 2], 16);
    assert_eq!((point.top(), point.nearest([3.0; 3]), point.position([0; 3])), ([0; 3], [0; 3], [3.0; 3]));
    assert_eq!(Positions::F32.quantised(&[[0.1, -0.0, 3.0]]), vec![[0.1, -0.0, 3.0]]);
}

/// The last point of the short side would be beyond the greatest number: the one before is taken, so that readers take it too.
#[test]
fn positions_up_to_the_greatest_number_stay_finite() {
    let low = (f64::from(f32::MAX) - 1.6 * 3e38 / 1023.0) as f32;
    let positions = [[0.0, low, 0.0], [3e38, low, 0.0], [0.0, f32::MAX, 0.0]];
    let lattice = Lattice::new(bounds(&positions), 10);
    assert!(lattice.top()[1] == 2 && lattice.position([0, 2, 0])[1].is_infinite());
    assert_eq!(positions.map(|p| lattice.nearest(p)), [[0, 0, 0], [1023, 0, 0], [0, 1, 0]]);
}
