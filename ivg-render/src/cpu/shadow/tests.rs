use super::*;

const PERSPECTIVE: FaceRecord =
    FaceRecord { matrix: [[0.0; 4]; 4], perspective: 1, bias: 0.002, cap: 0.06, padding: 0 };
const PARALLEL: FaceRecord =
    FaceRecord { matrix: [[0.0; 4]; 4], perspective: 0, bias: 0.001, cap: 0.03, padding: 0 };

#[test]
fn the_limit_is_the_middle_within_its_bounds() {
    // Reach 1: distances 10 and 10.4, middle 10.2.
    let near_second = shadow_limit(&PERSPECTIVE, 1.0 / 10.0, 1.0 / 10.4);
    assert!((1.0 / near_second - 10.2).abs() < 1e-4);
    let far_second = shadow_limit(&PERSPECTIVE, 1.0 / 10.0, 1.0 / 100.0);
    assert!((1.0 / far_second - 10.6).abs() < 1e-4);
    let touching = shadow_limit(&PERSPECTIVE, 1.0 / 10.0, 1.0 / 10.001);
    assert!((1.0 / touching - 10.02).abs() < 1e-4);
    assert!((shadow_limit(&PARALLEL, 0.5, 0.46) - 0.48).abs() < 1e-6);
    assert!((shadow_limit(&PARALLEL, 0.5, 0.1) - 0.47).abs() < 1e-6);
    assert!((shadow_limit(&PARALLEL, 0.5, 0.4999) - 0.499).abs() < 1e-6);
}

#[test]
fn without_surfaces_everything_is_lit() {
    for face in [PERSPECTIVE, PARALLEL] {
        assert_eq!(shadow_limit(&face, 0.0, 0.0), 0.0);
        let alone = shadow_limit(&face, 0.5, 0.0);
        assert!(alone > 0.4 && alone < 0.5);
    }
}

#[test]
fn the_limit_rises_with_the_second_surface() {
    // The GPU keeps the largest limit drawn, so this is what makes it the nearest second surface.
    for face in [PERSPECTIVE, PARALLEL] {
        let mut before = shadow_limit(&face, 0.5, 0.0);
        for step in 1..500 {
            let limit = shadow_limit(&face, 0.5, step as f32 * 0.001);
            assert!(limit >= before, "{step}");
            before = limit;
        }
    }
}

#[test]
fn the_two_nearest_surfaces_are_kept_in_any_order() {
    let depths = [0.3, 0.9, 0.5, 0.9, 0.1];
    for rotation in 0..depths.len() {
        let (mut first, mut second) = (0.0, 0.0);
        for index in 0..depths.len() {
            insert(&mut first, &mut second, depths[(index + rotation) % depths.len()]);
        }
        assert_eq!((first, second), (0.9, 0.5));
    }
}
