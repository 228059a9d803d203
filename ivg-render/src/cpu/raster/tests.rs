use super::*;

/// Number of times each sample of a picture is covered.
fn coverage(size: [u32; 2], triangles: &[[[f32; 2]; 3]]) -> Vec<u32> {
    let mut counts = vec![0; (size[0] * size[1]) as usize];
    for (index, corners) in triangles.iter().enumerate() {
        let corners = corners.map(|[x, y]| {
            // From pixels to clip space.
            Vec4::new(2.0 * x / size[0] as f32 - 1.0, 1.0 - 2.0 * y / size[1] as f32, 0.5, 1.0)
        });
        clip_and_project(index as u32, corners, size, |triangle| {
            let region = Region { x: [0, size[0]], y: [0, size[1]] };
            triangle.fill(region, |x, y, _| counts[(y * size[0] + x) as usize] += 1);
        });
    }
    counts
}

#[test]
fn triangles_around_a_point_cover_every_sample_once() {
    // A fan around a point that lies on the middle of a pixel, so edges run through sample points.
    let rim = [
        [0.0, 0.0],
        [8.0, 0.0],
        [16.0, 0.0],
        [16.0, 8.0],
        [16.0, 16.0],
        [8.0, 16.0],
        [0.0, 16.0],
        [0.0, 8.0],
    ];
    for centre in [[7.5, 7.5], [8.0, 8.0], [3.25, 9.5], [7.49, 8.51]] {
        let fan: Vec<_> = (0..8).map(|i| [centre, rim[i], rim[(i + 1) % 8]]).collect();
        assert_eq!(coverage([16, 16], &fan), vec![1; 256], "centre {centre:?}");
    }
}

#[test]
fn the_top_left_rule_holds() {
    // A square from one pixel middle to another: left and top samples belong to it, right and bottom ones do not.
    let square = [[[1.5, 1.5], [1.5, 3.5], [3.5, 3.5]], [[1.5, 1.5], [3.5, 3.5], [3.5, 1.5]]];
    let counts = coverage([5, 5], &square);
    for y in 0..5 {
        for x in 0..5 {
            let inside = (1..3).contains(&x) && (1..3).contains(&y);
            assert_eq!(counts[y * 5 + x], u32::from(inside), "({x}, {y})");
        }
    }
}

#[test]
fn a_floor_through_the_eye_is_cut_at_the_near_plane() {
    // Clip space of an infinite reversed projection with 90 degrees: (x, y, near, distance). The floor lies one below
    // the eye and reaches from behind it to far in front.
    let near = 0.01;
    let corner = |x: f32, distance: f32| Vec4::new(x, -1.0, near, distance);
    let corners = [corner(0.0, -50.0), corner(200.0, 100.0), corner(-200.0, 100.0)];
    let mut rows = [0u32; 64];
    clip_and_project(0, corners, [64, 64], |triangle| {
        triangle.fill(Region { x: [0, 64], y: [0, 64] }, |_, y, depth| {
            rows[y as usize] += 1;
            // The plane is at distance 1 / (slope of the view ray).
            let slope = (f64::from(y) + 0.5) / 32.0 - 1.0;
            assert!((f64::from(depth) - 0.01 * slope).abs() < 1e-6, "row {y}: depth {depth}");
        });
    });
    // The horizon at 100 is in row 32 (slope 1/100 is a third of a pixel below the middle); all below is floor.
    assert_eq!(rows[..32], [0; 32]);
    assert!(rows[33..].iter().all(|count| *count == 64), "{rows:?}");
}

#[test]
fn what_lies_outside_or_has_no_area_emits_nothing() {
    let mut emitted = 0;
    for corners in [
        [Vec4::new(2.0, 0.0, 0.5, 1.0), Vec4::new(3.0, 0.0, 0.5, 1.0), Vec4::new(2.0, 1.0, 0.5, 1.0)],
        [Vec4::new(0.0, 0.0, 0.5, -1.0), Vec4::new(1.0, 0.0, 0.5, -1.0), Vec4::new(0.0, 1.0, 0.5, -1.0)],
        [Vec4::new(0.0, 0.0, 0.5, 1.0); 3],
        [Vec4::NAN; 3],
    ] {
        clip_and_project(0, corners, [64, 64], |_| emitted += 1);
    }
    assert_eq!(emitted, 0);
}

#[test]
fn rows_hold_all_that_is_filled() {
    let corners =
        [Vec4::new(-0.5, 0.7, 0.1, 1.0), Vec4::new(0.1, -0.2, 0.9, 1.0), Vec4::new(0.6, 0.3, 0.2, 1.0)];
    clip_and_project(0, corners, [40, 30], |triangle| {
        let [first, end] = triangle.rows(30);
        let (mut low, mut high) = (u32::MAX, 0);
        triangle.fill(Region { x: [0, 40], y: [0, 30] }, |_, y, _| (low, high) = (low.min(y), high.max(y)));
        assert!(first <= low && high < end && end <= 30);
    });
}
