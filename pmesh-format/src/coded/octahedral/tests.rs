use ivg_wire::splitmix64;

use super::{Octahedral, root};

#[test]
fn roots_are_those_of_the_processor() {
    let numbers = (1..5000).chain((0..20_000).map(|k| 1 + (splitmix64(3, k) % ((1 << 30) - 1)) as u32));
    for x in numbers {
        assert_eq!(root(x).to_bits(), f64::from(x).sqrt().to_bits(), "{x}");
    }
}

/// Codes are the points of a triangular lattice with edges of √2 on faces whose distance from the middle is M / √3; no place of a
/// triangle is farther from its nearest corner than √2 / √3, which is seen from the middle under at most √2 / M. Rounding to
/// binary32 adds less than 1e-6.
#[test]
fn the_nearest_code_is_near_and_found_again() {
    for bits in [4, 7, 10, 12, 16] {
        let map = Octahedral::new(bits);
        for k in 0..4000 {
            let part = |n: u64| (splitmix64(n, k) % 2001) as f32 / 1000.0 - 1.0;
            let normal = [part(1), part(2), if k % 3 == 0 { 0.0 } else { part(3) }];
            let code = map.nearest(normal);
            assert!(map.contains(code));
            let found = map.direction(code).map(f64::from);
            let length = normal.iter().map(|&x| f64::from(x).powi(2)).sum::<f64>().sqrt();
            let apart =
                (0..3).map(|i| (f64::from(normal[i]) / length - found[i]).powi(2)).sum::<f64>().sqrt();
            assert!(apart <= 2f64.sqrt() / f64::from(map.most()) + 1e-6, "{bits} bits, {normal:?}: {apart}");
            assert_eq!(map.nearest(map.direction(code)), code, "{bits} bits, {normal:?}");
            assert_eq!(map.turned(map.turned(code)), code);
            assert_eq!(
                map.project(map.point(code).map(i64::from)).map(|c| map.direction(c)),
                Some(map.direction(code))
            );
        }
    }
}

#[test]
fn axes_are_exact_and_what_has_no_direction_points_up() {
    let map = Octahedral::new(10);
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            let mut normal = [0.0f32; 3];
            normal[axis] = sign;
            assert_eq!(map.direction(map.nearest(normal)), normal);
            assert_eq!(map.nearest(normal.map(|x| x * f32::MIN_POSITIVE)), map.nearest(normal));
            assert_eq!(map.nearest(normal.map(|x| x * f32::MAX)), map.nearest(normal));
        }
    }
    assert_eq!(map.nearest([0.0, -0.0, 0.0]), [0, 0]);
    assert_eq!(map.project([0; 3]), None);
    assert_eq!(map.nearest([0.0, 0.0, -1.0]), [511, 511]);
}

/// Test values of PMESH-COD-16.
#[test]
fn directions_have_the_bits_of_the_specification() {
    let bits = |code| Octahedral::new(10).direction(code).map(f32::to_bits);
    assert_eq!(bits([0, 0]), [0, 0, 0x3F80_0000]);
    assert_eq!(bits([511, 511]), [0, 0, 0xBF80_0000]);
    assert_eq!(bits([100, -200]), [0x3EA6_88FD, 0xBF26_88FD, 0x3F2F_B1CD]);
    assert_eq!(bits([-300, 400]), [0xBEBA_CC82, 0x3F31_8B06, 0xBF1F_080E]);
}
