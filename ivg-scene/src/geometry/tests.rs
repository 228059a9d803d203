use super::*;

#[test]
fn a_scene_near_the_origin_keeps_its_coordinates() {
    assert_eq!(snapped_origin(DVec3::ZERO, DVec3::new(0.556, 0.5488, 0.5592)), DVec3::ZERO);
    assert_eq!(snapped_origin(DVec3::splat(-0.4), DVec3::splat(0.5)), DVec3::ZERO);
}

#[test]
fn a_distant_scene_gets_an_origin_within_its_own_extent() {
    let (min, max) = (DVec3::splat(1e6 + 0.3), DVec3::splat(1e6 + 1.1));
    let origin = snapped_origin(min, max);
    assert!((origin - min).abs().max_element() <= 1.0, "{origin}");
}

#[test]
fn scaling_by_a_power_of_two_scales_the_origin() {
    let (min, max) = (DVec3::new(5.3, -7.1, 90.0), DVec3::new(6.9, -3.0, 91.5));
    let origin = snapped_origin(min, max);
    for scale in [2f64.powi(-20), 2f64.powi(20)] {
        assert_eq!(snapped_origin(scale * min, scale * max), scale * origin);
    }
}

#[test]
fn flat_empty_and_infinite_boxes_have_an_origin() {
    assert_eq!(snapped_origin(DVec3::splat(3.0), DVec3::splat(3.0)), DVec3::splat(3.0));
    assert_eq!(snapped_origin(DVec3::INFINITY, DVec3::NEG_INFINITY), DVec3::ZERO);
    assert_eq!(snapped_origin(DVec3::ZERO, DVec3::INFINITY), DVec3::ZERO);
    assert!(snapped_origin(DVec3::splat(-f64::MAX), DVec3::splat(f64::MAX)).is_finite());
}

#[test]
fn tiny_and_huge_vectors_still_have_a_direction() {
    for length in [1e-300, 1e300] {
        assert_eq!(unit_or(DVec3::new(0.0, length, 0.0), Vec3::Z), Vec3::Y);
    }
    assert_eq!(unit_or(DVec3::ZERO, Vec3::X), Vec3::X);
}

#[test]
fn normals_weigh_faces_by_area() {
    // Vertex 0 has a face of area 2 towards +z and one of area 0.5 towards +x.
    let positions = [Vec3::ZERO, Vec3::X * 2.0, Vec3::Y * 2.0, Vec3::Y, Vec3::Z];
    let normals = area_weighted_normals(&positions, &[[0, 1, 2], [0, 3, 4]]);
    let expected = Vec3::new(0.5, 0.0, 2.0).normalize();
    // One rounding of each component.
    assert!((normals[0] - expected).abs().max_element() <= f32::EPSILON, "{}", normals[0]);
}
