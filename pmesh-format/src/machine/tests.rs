use quickcheck::quickcheck;

use super::{Lanes, approach, not_above, portable};

/// Sixteen numbers from any eight, ascending.
fn ascending(numbers: [u64; 4]) -> Lanes {
    let number = |k: usize| (numbers[k / 4] >> (16 * (k % 4))) as i16 & i16::MAX;
    let mut lanes: Lanes = [core::array::from_fn(number), core::array::from_fn(|k| number(8 + k))];
    lanes.as_flattened_mut().sort_unstable();
    lanes
}

quickcheck! {
    /// What a processor does is what is said.
    fn the_same_as_one_by_one(numbers: (u64, u64, u64, u64), targets: (u64, u64, u64, u64), most: u16, shift: u8) -> bool {
        let lanes = ascending([numbers.0, numbers.1, numbers.2, numbers.3]);
        let targets = ascending([targets.0, targets.1, targets.2, targets.3]);
        let most = (most & 0x7FFF) as i16;
        let (mut one, mut other) = (lanes, lanes);
        approach(&mut one, &targets, u32::from(shift % 16));
        portable::approach(&mut other, &targets, u32::from(shift % 16));
        one == other && not_above(&lanes, most) == portable::not_above(&lanes, most)
    }
}

/// Numbers that are met, and both ends.
#[test]
fn equal_numbers_are_not_above() {
    let lanes: Lanes =
        [[0, 100, 200, 300, 400, 500, 600, 700], [800, 900, 1000, 1100, 1200, 1300, 1400, 1500]];
    for (most, count) in [(-1, 0), (0, 1), (99, 1), (100, 2), (1499, 15), (1500, 16), (i16::MAX, 16)] {
        assert_eq!(not_above(&lanes, most), count, "{most}");
    }
}
