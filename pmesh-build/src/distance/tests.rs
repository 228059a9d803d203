use super::*;

/// A right triangle, and a point near each of its corners, edges and its inside.
#[test]
fn every_region_of_a_triangle() {
    let triangle = [DVec3::ZERO, DVec3::new(4.0, 0.0, 0.0), DVec3::new(0.0, 4.0, 0.0)];
    for (point, expected) in [
        ([-3.0, -4.0, 0.0], 25.0),
        ([7.0, -1.0, 0.0], 10.0),
        ([-1.0, 6.0, 2.0], 9.0),
        ([1.0, -2.0, 0.0], 4.0),
        ([-3.0, 3.0, 1.0], 10.0),
        ([3.0, 3.0, 0.0], 2.0),
        ([1.0, 1.0, 3.0], 9.0),
        ([1.0, 2.0, 0.0], 0.0),
    ] {
        // From every corner and on both sides of the plane.
        for turn in 0..3 {
            let mut turned = triangle;
            turned.rotate_left(turn);
            for corners in [turned, [turned[1], turned[0], turned[2]]] {
                let found = squared_distance(DVec3::from(point), corners);
                // Sums of a few products below 64: 2⁻⁴⁶ is more than their rounding.
                assert!((found - expected).abs() < 1e-13, "{point:?} {corners:?}: {found}");
            }
        }
    }
}

/// Triangles without an area are their edges.
#[test]
fn triangles_that_are_edges_and_points() {
    let (a, b, c) = (DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0), DVec3::new(4.0, 0.0, 0.0));
    let above = DVec3::new(3.0, 1.0, 0.0);
    for (triangle, expected) in [
        ([a, b, c], 1.0),
        ([c, a, b], 1.0),
        ([a, b, b], 2.0),
        ([b, a, a], 2.0),
        ([a, b, a], 2.0),
        ([a; 3], 10.0),
    ] {
        assert_eq!(squared_distance(above, triangle), expected, "{triangle:?}");
    }
}
