use super::*;
use crate::quant::unit::tests::is_nearest;
use quickcheck::{TestResult, quickcheck};

#[test]
fn every_code_decodes_to_the_nearest_number_or_is_forbidden() {
    for code in 0..1u32 << 24 {
        let [x, y, z, _] = code.to_le_bytes().map(|byte| i32::from(byte as i8));
        let forbidden = [x, y, z].contains(&-128) || [x, y, z] == [0; 3];
        let Some(direction) = decode_xyz24(code) else {
            assert!(forbidden, "{code:#08x} was refused");
            continue;
        };
        assert!(!forbidden, "{code:#08x} is forbidden");
        let squared = x * x + y * y + z * z;
        for (c, d) in [x, y, z].into_iter().zip(direction) {
            assert!(is_nearest(c, squared, d), "{code:#08x}: {c} / sqrt({squared}) became {d:e}");
        }
    }
}

#[test]
fn many_codes_at_once_give_what_each_gives_alone() {
    for first in (0..1u32 << 24).step_by(64) {
        let codes: [u32; 64] = core::array::from_fn(|n| first + n as u32);
        let mut directions = [[0.0; 64]; 3];
        Xyz24::directions(&codes, &mut directions);
        for (n, code) in codes.into_iter().enumerate() {
            match decode_xyz24(code) {
                None => assert!(Xyz24::fault(code) != 0, "{code:#08x}"),
                Some(one) => {
                    assert_eq!(directions.map(|c| c[n].to_bits()), one.map(f32::to_bits), "{code:#08x}");
                }
            }
        }
    }
}

#[test]
fn the_axes_are_exact() {
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            let mut unit = [0.0; 3];
            unit[axis] = sign;
            let code = encode_xyz24_in_hemisphere(unit, axis, sign > 0.0).unwrap();
            assert_eq!(decode_xyz24(code).unwrap().map(f64::from), unit);
        }
    }
}

#[test]
fn what_has_no_direction_has_no_code() {
    for vector in [[0.0; 3], [f64::NAN, 1.0, 0.0], [0.0, f64::INFINITY, 1.0]] {
        assert_eq!(encode_xyz24(vector), None);
        assert_eq!(encode_xyz24_in_hemisphere(vector, 0, true), None);
    }
    assert_eq!(encode_xyz24_in_hemisphere([1.0; 3], 3, true), None, "there is no such axis");
}

quickcheck! {
    fn coordinates_are_the_nearest_whole_numbers(x: i16, y: i16, z: i16) -> TestResult {
        let v = [x, y, z].map(f64::from);
        let Some(code) = encode_xyz24(v) else { return TestResult::discard() };
        let length = libm::sqrt(v.iter().map(|c| c * c).sum());
        let [x, y, z, _] = code.to_le_bytes().map(|byte| f64::from(byte as i8));
        // Half a step, and what rounding in binary64 adds.
        TestResult::from_bool([x, y, z].iter().zip(v).all(|(c, v)| (c - v / length * 127.0).abs() <= 0.5 + 1e-12))
    }

    fn directions_stay_strictly_in_their_hemisphere(x: i8, y: i8, z: i8, hemisphere: u8) -> TestResult {
        let v = [x, y, z].map(f64::from);
        let (axis, positive) = (usize::from(hemisphere % 3), hemisphere >= 128);
        let Some(code) = encode_xyz24_in_hemisphere(v, axis, positive) else { return TestResult::discard() };
        let along = code.to_le_bytes()[axis] as i8;
        let inside = if positive { along >= 1 } else { along <= -1 };
        // The other coordinates are as they would be without the restriction.
        let free = encode_xyz24(v).unwrap().to_le_bytes();
        let others = (0..3).filter(|&i| i != axis).all(|i| free[i] == code.to_le_bytes()[i]);
        TestResult::from_bool(inside && others)
    }
}
