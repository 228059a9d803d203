use super::*;
use crate::quant::direction::{decode_valid, encode_octahedral24_in_hemisphere};

/// Vectors are whole numbers below this, so that comparisons of cosines fit into 128 bits: squares of 11 + 38 + 1 bits, times 22.
const LARGEST: i64 = 1 << 37;

/// A generator of test vectors: Knuth's MMIX.
struct Random(u64);

impl Random {
    fn below(&mut self, limit: i64) -> i64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 24) as i64) % limit
    }

    /// Vectors of all kinds: anywhere, next to axes and planes, of few digits, with equal coordinates, on codes and halfway
    /// between two.
    fn vector(&mut self) -> [i64; 3] {
        let mut vector = [0; 3].map(|_: i64| self.below(2 * LARGEST) - LARGEST);
        let (one, other) = (self.below(3) as usize, self.below(3) as usize);
        match self.below(12) {
            0 => vector[one] = self.below(2 * LARGEST / 512) - LARGEST / 512,
            1 => vector[one] = 0,
            2 => (vector[one], vector[other]) = (0, 0),
            3 => vector[one] = vector[other],
            4 => vector[one] = -vector[other],
            5 => {
                vector[one] >>= 12;
                vector[other] >>= self.below(20);
            }
            6 => vector = vector.map(|c| c % 100),
            7 => vector = vector.map(|c| c % 3000),
            8 | 9 => {
                // The middle of two codes, or of four, on any face.
                let mut code = || self.below(2048);
                let [a, b] = [code(), code()].map(|c| c / 2);
                let signs = [0; 3].map(|_: i64| self.below(2) * 2 - 1);
                let (half_a, half_b) = (self.below(2), self.below(2));
                vector = [2 * a + half_a, 2 * b + half_b, 4094 - 2 * a - 2 * b - half_a - half_b];
                vector.rotate_left(one);
                (0..3).for_each(|i| vector[i] *= signs[i]);
            }
            _ => {}
        }
        if vector == [0; 3] { [1, 0, 0] } else { vector }
    }
}

/// The lowest of the nearest codes among 64 around a place, in whole numbers.
fn searched(vector: [i64; 3], place: [i64; 3], allowed: impl Fn([i32; 3]) -> bool) -> Option<u32> {
    let [x, y, z] = place.map(|c| c as f64);
    let scale = f64::from(SCALE) / (x.abs() + y.abs() + z.abs());
    let (mut u, mut v) = (x * scale, y * scale);
    if z < 0.0 {
        let (a, b) = (f64::from(SCALE) - v.abs(), f64::from(SCALE) - u.abs());
        (u, v) = (if x < 0.0 { -a } else { a }, if y < 0.0 { -b } else { b });
    }
    let (u, v) = (libm::floor(u) as i32, libm::floor(v) as i32);
    let mut best: Option<([i128; 2], u32)> = None;
    for (u, v) in (u - 3..=u + 4).flat_map(|u| (v - 3..=v + 4).map(move |v| (u, v))) {
        let point = fold(u, v);
        if u.abs() > SCALE || v.abs() > SCALE || !allowed(point) {
            continue;
        }
        let dot: i128 = point.iter().zip(vector).map(|(&p, c)| i128::from(p) * i128::from(c)).sum();
        let squared = i128::from(point.iter().map(|c| c * c).sum::<i32>());
        assert!(dot > 0, "the window reaches around the sphere");
        let cosine = [dot * dot, squared];
        let found = (cosine, lowest_code(u, v));
        // By cross-multiplied squares.
        let better = best.is_none_or(|(most, code)| {
            let (here, there) = (cosine[0] * most[1], most[0] * cosine[1]);
            here > there || here == there && found.1 < code
        });
        if better {
            best = Some(found);
        }
    }
    best.map(|(_, code)| code)
}

#[test]
fn four_candidates_are_enough() {
    let mut random = Random(1);
    for _ in 0..300_000 {
        let vector = random.vector();
        let found = nearest(vector.map(|c| c as f64));
        assert_eq!(found, searched(vector, vector, |_| true), "{vector:?}");
    }
}

#[test]
fn many_at_once_give_what_each_gives_alone() {
    let mut random = Random(2);
    let mut doubts = 0;
    for round in 0..60_000 {
        let (axis, positive) = (round % 3, round % 2 == 0);
        let vectors: [[f64; 3]; 16] = core::array::from_fn(|_| random.vector().map(|c| c as f64));
        // Off by up to 2^-24 of each coordinate, less than is allowed.
        let columns: [[f32; 16]; 3] = core::array::from_fn(|i| vectors.map(|v| v[i] as f32));
        let Together { codes, along, squared, doubt } = encode_all(&columns, axis, positive);
        for (n, vector) in vectors.into_iter().enumerate() {
            doubts += u32::from(doubt[n] != 0);
            if doubt[n] == 0 {
                let one = encode_octahedral24_in_hemisphere(vector, axis, positive);
                assert_eq!(Some(codes[n]), one, "{vector:?}");
                let direction = f64::from(along[n]) / f64::from(squared[n]).sqrt();
                assert_eq!(direction as f32, decode_valid(codes[n])[axis], "{vector:?}");
            }
        }
    }
    // Half of them are outside the hemisphere, and many halfway between two codes.
    assert!((480_000..860_000).contains(&doubts), "{doubts}");
}

#[test]
fn next_to_the_tangent_plane_the_nearest_code_inside_is_found() {
    let mut random = Random(3);
    for round in 0..50_000 {
        let (axis, positive) = (round % 3, round % 2 == 0);
        let sign = if positive { 1 } else { -1 };
        let mut vector = random.vector();
        // At most one and a half steps above the plane.
        let most = vector.iter().map(|c| c.abs()).sum::<i64>() / 1365;
        vector[axis] = random.below(most.max(1)) * sign;
        if vector == [0; 3] {
            continue;
        }
        let found = encode_octahedral24_in_hemisphere(vector.map(|c| c as f64), axis, positive).unwrap();
        // On the plane itself the map may have two places; one inside is meant.
        let mut place = vector;
        place[axis] = sign * (vector[axis] * sign).max(most / 2).max(1);
        let exact = searched(vector, place, |point| i64::from(point[axis]) * sign >= 1).unwrap();
        // The search there is by cosines in binary64, whose last digits are five parts in 10^9 of the distance.
        let distance = |code| {
            let d = decode_valid(code).map(f64::from);
            let cross = |i: usize, j: usize| vector[i] as f64 * d[j] - vector[j] as f64 * d[i];
            cross(0, 1).powi(2) + cross(1, 2).powi(2) + cross(2, 0).powi(2)
        };
        assert!(
            found == exact || distance(found) <= distance(exact) * (1.0 + 1e-3),
            "{vector:?}: {found:#x}, {exact:#x}"
        );
    }
}

#[test]
fn what_has_no_direction_is_in_doubt() {
    let strange = [0.0, f32::NAN, -f32::NAN, f32::INFINITY, f32::from_bits(0x7FC0_FFFF)];
    for hemisphere in 0..6 {
        let columns = [strange, [0.0; 5], [0.0; 5]];
        let found = encode_all(&columns, hemisphere / 2, hemisphere % 2 == 0);
        assert_eq!(found.doubt, [-1; 5]);
    }
}

#[test]
fn an_axis_has_the_code_that_is_nearest_to_it() {
    for hemisphere in 0..6 {
        let (axis, positive) = (hemisphere / 2, hemisphere % 2 == 0);
        let mut vector = [0.0; 3];
        vector[axis] = if positive { 1.0 } else { -1.0 };
        assert_eq!(nearest(vector), Some(axis_code(axis, positive)));
    }
}
