use super::*;
use crate::quant::unit::tests::is_nearest;
use quickcheck::{TestResult, quickcheck};

const AXES: [[i32; 3]; 6] = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];

#[test]
fn every_code_decodes_to_the_nearest_number_or_is_forbidden() {
    for code in 0..1u32 << 24 {
        let halves = [code & 0xFFF, code >> 12];
        let decoded = decode_octahedral24(code);
        let Some(direction) = decoded else {
            assert!(halves.contains(&4095), "{code:#08x} was refused");
            continue;
        };
        assert!(!halves.contains(&4095), "{code:#08x} is forbidden");
        // The definition of the map, written differently from the code under test.
        let [u, v] = halves.map(|h| h as i32 - 2047);
        let z = 2047 - (u.abs() + v.abs());
        let t = (-z).max(0);
        let point = [u - t * u.signum(), v - t * v.signum(), z];
        let squared = point.iter().map(|c| c * c).sum();
        for (c, d) in point.into_iter().zip(direction) {
            assert!(is_nearest(c, squared, d), "{code:#08x}: {c} / sqrt({squared}) became {d:e}");
        }
    }
}

#[test]
fn many_codes_at_once_give_what_each_gives_alone() {
    for first in (0..1u32 << 24).step_by(64) {
        let codes: [u32; 64] = core::array::from_fn(|n| first + n as u32);
        let mut directions = [[0.0; 64]; 3];
        Octahedral24::directions(&codes, &mut directions);
        for (n, code) in codes.into_iter().enumerate().filter(|&(_, code)| is_valid(code)) {
            let one = decode_valid(code).map(f32::to_bits);
            assert_eq!(directions.map(|c| c[n].to_bits()), one, "{code:#08x}");
        }
        assert!(codes.iter().all(|&code| (Octahedral24::fault(code) == 0) == is_valid(code)));
    }
}

#[test]
fn the_axes_are_exact() {
    for axis in AXES {
        let code = encode_octahedral24(axis.map(f64::from)).unwrap();
        assert_eq!(decode_octahedral24(code).unwrap(), axis.map(|c| c as f32));
    }
}

#[test]
fn the_nearest_code_of_all_is_found() {
    // Directions on faces, edges and near the seams of the map, above and below the equator.
    let vectors: [[f64; 3]; 12] = [
        [1.0, 1.0, 1.0],
        [-1.0, 1.0, -1.0],
        [1.0, -1.0, 0.0],
        [0.6, 0.8, 1e-9],
        [0.6, -0.8, -1e-9],
        [1e-5, 1e-5, -1.0],
        [-0.3, 0.001, -0.9],
        [0.999, 0.0001, -0.02],
        [0.1, 0.2, 0.3],
        [-0.7, -0.2, 0.4],
        [0.000_2, -0.95, -0.3],
        [0.333_3, 0.333_4, -0.333_2],
    ];
    let goals = vectors.map(|v| {
        let length = libm::sqrt(v.iter().map(|c| c * c).sum());
        v.map(|c| c / length)
    });
    let mut most = [-1.0f64; 12];
    for v in -SCALE..=SCALE {
        for u in -SCALE..=SCALE {
            let point = fold(u, v).map(f64::from);
            let length = libm::sqrt(point.iter().map(|c| c * c).sum());
            for (most, goal) in most.iter_mut().zip(&goals) {
                *most = most.max(point.iter().zip(goal).map(|(a, b)| a * b).sum::<f64>() / length);
            }
        }
    }
    for (vector, (goal, most)) in vectors.iter().zip(goals.iter().zip(most)) {
        let code = encode_octahedral24(*vector).unwrap();
        let point = fold((code & 0xFFF) as i32 - SCALE, (code >> 12) as i32 - SCALE).map(f64::from);
        let length = libm::sqrt(point.iter().map(|c| c * c).sum());
        let cosine = point.iter().zip(goal).map(|(a, b)| a * b).sum::<f64>() / length;
        // Sums of three products in binary64 differ by some units of 2^-53 between the two ways.
        assert!(most - cosine <= 1e-15, "{vector:?}: a code is nearer by {:e}", most - cosine);
    }
}

#[test]
fn what_has_no_direction_has_no_code() {
    for vector in [[0.0; 3], [-0.0; 3], [f64::NAN, 1.0, 0.0], [f64::INFINITY, 0.0, 0.0]] {
        assert_eq!(encode_octahedral24(vector), None);
        assert_eq!(encode_octahedral24_in_hemisphere(vector, 0, true), None);
    }
    assert_eq!(encode_octahedral24_in_hemisphere([1.0; 3], 3, true), None, "there is no such axis");
}

#[test]
fn vectors_of_any_length_have_a_direction() {
    for length in [f64::MAX, 1e-308, 5e-324] {
        assert_eq!(encode_octahedral24([0.0, -length, 0.0]), encode_octahedral24([0.0, -1.0, 0.0]));
    }
}

/// A vector from integers: all directions, some of them on axes, edges and seams.
fn vector(x: i8, y: i8, z: i16) -> Option<[f64; 3]> {
    (x != 0 || y != 0 || z != 0).then(|| [f64::from(x), f64::from(y), f64::from(z) / 256.0])
}

quickcheck! {
    fn the_angle_is_within_the_bound(x: i8, y: i8, z: i16) -> TestResult {
        let Some(v) = vector(x, y, z) else { return TestResult::discard() };
        let d = decode_octahedral24(encode_octahedral24(v).unwrap()).unwrap().map(f64::from);
        let cross = [v[1] * d[2] - v[2] * d[1], v[2] * d[0] - v[0] * d[2], v[0] * d[1] - v[1] * d[0]];
        let length = |a: [f64; 3]| libm::sqrt(a.iter().map(|c| c * c).sum());
        // Codes are the points of a triangular lattice with edges of sqrt(2) on an octahedron whose faces lie
        // 2047/sqrt(3) from the centre: no point of a face is farther than the circumradius sqrt(2/3) from the
        // nearest, and seen from the centre that is at most sqrt(2)/2047 rad. Plus rounding to binary32.
        let angle = (length(cross) / length(v) / length(d)).asin();
        TestResult::from_bool(angle <= core::f64::consts::SQRT_2 / 2047.0 + f64::from(f32::EPSILON))
    }

    fn the_lowest_of_equal_codes_is_chosen(code: u32) -> TestResult {
        // Half of the cases on the rim of the map, where directions have two codes.
        let code = if code & 1 == 0 { code & 0xFF_F000 | 4094 } else { code & 0xFF_FFFF };
        match decode_octahedral24(code) {
            None => TestResult::discard(),
            Some(d) => TestResult::from_bool(encode_octahedral24(d.map(f64::from)).unwrap() <= code),
        }
    }

    fn decoded_directions_keep_their_direction(code: u32) -> TestResult {
        match decode_octahedral24(code & 0xFF_FFFF) {
            None => TestResult::discard(),
            Some(d) => {
                let again = encode_octahedral24(d.map(f64::from)).unwrap();
                TestResult::from_bool(decode_octahedral24(again) == Some(d))
            }
        }
    }

    fn directions_stay_strictly_in_their_hemisphere(x: i8, y: i8, z: i16, hemisphere: u8) -> TestResult {
        let Some(v) = vector(x, y, z) else { return TestResult::discard() };
        let (axis, positive) = (usize::from(hemisphere % 3), hemisphere >= 128);
        let code = encode_octahedral24_in_hemisphere(v, axis, positive).unwrap();
        let d = decode_octahedral24(code).unwrap();
        let along = if positive { d[axis] } else { -d[axis] };
        // A component of 1 on the octahedron is at least 1/2047 of the length.
        let inside = along >= 1.0 / 2047.0;
        // Where the vector is well inside, the restriction must not change the code.
        let clear = if positive { v[axis] } else { -v[axis] } > v.iter().map(|c| c.abs()).sum::<f64>() / 500.0;
        TestResult::from_bool(inside && (!clear || Some(code) == encode_octahedral24(v)))
    }
}
