use super::*;
use alloc::vec::Vec;
use quickcheck::{TestResult, quickcheck};

#[test]
fn the_axes_are_exact() {
    for hemisphere in 0..6 {
        let (axis, positive) = (hemisphere / 2, hemisphere % 2 == 0);
        let mut unit = [0.0f32; 3];
        unit[axis] = if positive { 1.0 } else { -1.0 };
        let vector = unit.map(|c| f64::from(c) * 1e-30);
        let half = HalfDirection::encode(vector, axis, positive).unwrap();
        assert_eq!(HalfDirection::decode(&half), unit);
        assert_eq!(SingleDirection::encode(vector, axis, positive), Some(unit));
    }
}

#[test]
fn what_has_no_direction_has_no_code() {
    for vector in [[0.0; 3], [f64::NAN, 1.0, 0.0], [0.0, f64::INFINITY, 1.0]] {
        assert_eq!(HalfDirection::encode(vector, 0, true), None);
        assert_eq!(SingleDirection::encode(vector, 0, true), None);
    }
    assert_eq!(SingleDirection::encode([1.0; 3], 3, true), None, "there is no such axis");
}

/// A vector of integers, a hemisphere's axis and side.
fn case(v: (i8, i8, i8), hemisphere: u8) -> Option<([f64; 3], usize, bool)> {
    let vector = [v.0, v.1, v.2].map(f64::from);
    (vector != [0.0; 3]).then_some((vector, usize::from(hemisphere % 3), hemisphere >= 128))
}

quickcheck! {
    fn the_component_along_the_axis_is_at_least_the_least(v: (i8, i8, i8), hemisphere: u8) -> TestResult {
        let Some((v, axis, positive)) = case(v, hemisphere) else { return TestResult::discard() };
        let half = HalfDirection::decode(&HalfDirection::encode(v, axis, positive).unwrap());
        let single = SingleDirection::encode(v, axis, positive).unwrap();
        let along = |d: [f32; 3]| if positive { d[axis] } else { -d[axis] };
        TestResult::from_bool(along(half) >= LEAST && along(single) >= LEAST)
    }

    fn components_are_rounded_to_nearest(v: (i8, i8, i8), hemisphere: u8) -> TestResult {
        let Some((v, axis, positive)) = case(v, hemisphere) else { return TestResult::discard() };
        let half = HalfDirection::decode(&HalfDirection::encode(v, axis, positive).unwrap());
        let single = SingleDirection::encode(v, axis, positive).unwrap();
        let length = libm::sqrt(v.iter().map(|c| c * c).sum());
        TestResult::from_bool((0..3).filter(|&i| i != axis).all(|i| {
            let exact = v[i] / length;
            // Half a unit of the last place of numbers up to 1: 2^-25 of binary32; 2^-12 of binary16, after the former.
            (f64::from(single[i]) - exact).abs() <= 2.0_f64.powi(-25) * 1.001
                && (f64::from(half[i]) - exact).abs() <= 2.0_f64.powi(-12) * 1.001
        }))
    }
}

quickcheck! {
    fn many_at_once_give_what_each_gives_alone(vectors: Vec<(f32, f32, f32)>, hemisphere: u8) -> bool {
        let (axis, positive) = (usize::from(hemisphere % 3), hemisphere >= 128);
        // Numbers of every size, and some that are not finite; zeros where there are fewer than sixteen.
        let vector = |n: usize| vectors.get(n).map_or([0.0; 3], |&(x, y, z)| [x, y, z].map(f64::from));
        let columns: [[f64; 16]; 3] = core::array::from_fn(|i| core::array::from_fn(|n| vector(n)[i]));
        let (mut singles, mut halves, mut along) = ([[0.0; 3]; 16], [[0; 3]; 16], [[0.0; 16]; 2]);
        SingleDirection::encode_all(&columns, axis, positive, &mut singles, &mut along[0]);
        HalfDirection::encode_all(&columns, axis, positive, &mut halves, &mut along[1]);
        (0..16).all(|n| {
            singles[n] == SingleDirection::encode_or_axis(vector(n), axis, positive)
                && halves[n] == HalfDirection::encode_or_axis(vector(n), axis, positive)
                && along[0][n] == f64::from(singles[n][axis])
                && along[1][n] == f64::from(HalfDirection::decode(&halves[n])[axis])
        })
    }
}
