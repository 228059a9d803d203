use super::*;

#[test]
fn normals_turn_to_the_seen_side_and_fall_back_to_the_triangle() {
    let smooth = Vec3::new(0.0, 3.0, 4.0);
    assert_eq!(shading_normal(smooth, Vec3::Z, true), Vec3::new(0.0, 0.6, 0.8));
    assert_eq!(shading_normal(smooth, Vec3::Z, false), Vec3::new(0.0, -0.6, -0.8));
    assert_eq!(shading_normal(Vec3::ZERO, Vec3::Z, true), Vec3::Z);
    assert_eq!(shading_normal(Vec3::ZERO, Vec3::Z, false), Vec3::NEG_Z);
}
