use super::*;
use crate::quant::direction::{Octahedral24, decode_octahedral24};
use quickcheck::{TestResult, quickcheck};

fn packed(vectors: [[f32; 3]; 3], hemisphere: usize) -> ([f32; 3], [f64; 3]) {
    let p = pack_hemisphere::<Octahedral24>(&vectors, hemisphere).unwrap();
    (decode_octahedral24(p.direction).unwrap(), p.colour)
}

#[test]
fn light_along_the_axis_is_exact() {
    for hemisphere in 0..6 {
        let mut axis = [0.0; 3];
        axis[hemisphere / 2] = if hemisphere % 2 == 0 { 1.0 } else { -1.0 };
        let vectors = [2.0, 0.5, 0.0].map(|c: f32| axis.map(|a| a * c));
        // c = I·axis / d·axis, and I·axis is negative on the negative side, as d·axis is.
        assert_eq!(packed(vectors, hemisphere), (axis, [2.0, 0.5, 0.0]));
    }
}

#[test]
fn no_light_is_the_axis_with_colour_zero() {
    for hemisphere in 0..6 {
        let (direction, colour) = packed([[0.0; 3]; 3], hemisphere);
        assert_eq!(direction[hemisphere / 2], if hemisphere % 2 == 0 { 1.0 } else { -1.0 });
        assert_eq!(colour, [0.0; 3]);
    }
}

#[test]
fn channels_that_cancel_are_the_axis_with_colour_zero() {
    let vectors = [[0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0; 3]];
    assert_eq!(packed(vectors, 0), ([1.0, 0.0, 0.0], [0.0; 3]));
}

#[test]
fn a_channel_that_points_elsewhere_is_not_amplified() {
    // The sum grazes the tangent plane of +x; red alone points along the axis. Without the cap, red would come
    // out as 0.1 / (d.x), about ten times its length.
    let vectors = [[0.1, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 10.0, 0.0]];
    let (direction, colour) = packed(vectors, 0);
    let uncapped = 0.1 / f64::from(direction[0]);
    assert!(uncapped > 10.0, "{uncapped}");
    assert_eq!(colour[0], 1.5 * f64::from(0.1f32));
}

#[test]
fn light_below_the_tangent_plane_does_not_become_negative() {
    let (direction, colour) = packed([[-1.0, 0.5, 0.0]; 3], 0);
    assert!(direction[0] >= 1.0 / 2047.0);
    assert_eq!(colour, [0.0; 3]);
}

#[test]
fn what_is_not_finite_is_refused() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(pack_hemisphere::<Octahedral24>(&[[0.0; 3], [0.0, 0.0, bad], [0.0; 3]], 3), None);
    }
}

#[test]
fn the_largest_and_smallest_numbers_do_not_overflow_or_vanish() {
    for size in [f32::MAX, f32::from_bits(1)] {
        let (direction, colour) = packed([[0.0, 0.0, size]; 3], 4);
        assert_eq!((direction, colour), ([0.0, 0.0, 1.0], [f64::from(size); 3]));
    }
}

quickcheck! {
    fn the_component_along_the_axis_survives_unless_capped(
        r: (i8, i8, u8), g: (i8, i8, u8), b: (i8, i8, u8)
    ) -> TestResult {
        let vectors = [r, g, b].map(|(x, y, z)| [f32::from(x), f32::from(y), f32::from(z)]);
        let (direction, colour) = packed(vectors, 4);
        TestResult::from_bool((0..3).all(|k| {
            let length = libm::sqrt(vectors[k].iter().map(|&c| f64::from(c).powi(2)).sum());
            let stored = colour[k] * f64::from(direction[2]);
            // One division and one product in binary64.
            let exact = (stored - f64::from(vectors[k][2])).abs() <= 4.0 * f64::EPSILON * length;
            exact || colour[k] == 1.5 * length && stored < f64::from(vectors[k][2])
        }))
    }
}
