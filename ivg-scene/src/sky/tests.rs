use super::*;

/// Four columns and two rows, each texel its own number.
fn numbered(rotation: f32) -> SkyImage {
    let texels = (0..8).map(|n| [n as f32, 0.0, 1.0]).collect();
    SkyImage { name: "n".into(), width: 4, height: 2, rotation, texels }
}

#[test]
fn directions_find_their_texels() {
    let sky = numbered(0.0);
    let at = |x, y, z| sky.radiance(Vec3::new(x, y, z).normalize()).x;
    // Columns from the left: behind to the left (−x, +z), left (−x, −z), right (+x, −z), behind to the right.
    assert_eq!(
        [at(-1.0, 0.5, 1.0), at(-1.0, 0.5, -1.0), at(1.0, 0.5, -1.0), at(1.0, 0.5, 1.0)],
        [0.0, 1.0, 2.0, 3.0]
    );
    assert_eq!([at(-1.0, -0.5, 1.0), at(1.0, -0.5, 1.0)], [4.0, 7.0]);
    // A quarter turn counter-clockwise seen from above takes what was at −z to −x.
    let turned = numbered(core::f32::consts::FRAC_PI_2);
    assert_eq!(
        turned.radiance(Vec3::new(-1.0, 0.5, -0.1).normalize()).x,
        sky.radiance(Vec3::new(0.1, 0.5, -1.0).normalize()).x
    );
}

#[test]
fn directions_of_places_lead_back_to_them() {
    for rotation in [0.0, 1.0, -4.0] {
        let sky = numbered(rotation);
        for n in 0..8u32 {
            let [upper, lower] = sky.row_cosines(n / 4);
            let towards = sky.direction((f64::from(n % 4) + 0.3) / 4.0, upper + (lower - upper) * 0.6);
            assert!(towards.is_normalized());
            assert_eq!(sky.radiance(towards).x, n as f32, "{rotation}");
        }
    }
    for pole in [Vec3::Y, Vec3::NEG_Y] {
        assert_eq!(numbered(0.0).radiance(pole).z, 1.0);
    }
}

#[test]
fn means_are_over_solid_angles() {
    let sky = numbered(0.0);
    assert!((4.0 * (sky.solid_angle(0) + sky.solid_angle(1)) - 4.0 * PI).abs() < 1e-12);
    assert_eq!(sky.mean(), Vec3::new(3.5, 0.0, 1.0));
    let small = sky.reduced(2);
    assert_eq!((small.width, small.height), (2, 1));
    assert_eq!(small.texels, [[2.5, 0.0, 1.0], [4.5, 0.0, 1.0]]);
}
