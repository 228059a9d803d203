use glam::DVec3;

use super::Space;

#[test]
fn longest_extent_lies_between_2048_and_4096_at_any_scale() {
    for exponent in -40..40 {
        let extent = libm::scalbn(1.37, exponent);
        let corner = DVec3::new(extent, 0.3 * extent, 0.0);
        let space = Space::new(DVec3::ZERO, corner);
        let length = space.scale() * extent;
        assert!((2048.0..4096.0).contains(&length), "{extent} m is {length} units long");
    }
}

#[test]
fn powers_of_two_and_shifts_give_the_same_coordinates() {
    let (min, max) = (DVec3::new(-1.0, 0.25, 3.0), DVec3::new(2.5, 1.0, 4.0));
    let point = DVec3::new(0.7, 0.31, 3.3);
    let here = Space::new(min, max).to_bake(point);
    for scale in [1.0 / 1024.0, 2.0, 1_048_576.0] {
        assert_eq!(Space::new(min * scale, max * scale).to_bake(point * scale), here);
    }
    // 2^20 m away f64 still resolves 1e-10 m of these few metres, 1e-7 bake units.
    let far = DVec3::splat(1_048_576.0);
    let there = Space::new(min + far, max + far).to_bake(point + far);
    assert!((there - here).abs().max_element() < 1e-3, "{there} {here}");
}

#[test]
fn a_single_point_has_a_space() {
    let space = Space::new(DVec3::ONE, DVec3::ONE);
    assert_eq!(space.to_world(space.to_bake(DVec3::new(1.0, 1.5, 1.0))), DVec3::new(1.0, 1.5, 1.0));
}
