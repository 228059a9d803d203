use super::*;

/// Looks along −z with a right angle of view.
fn camera() -> Camera {
    Camera {
        eye: DVec3::new(3.0, 4.0, 5.0),
        target: DVec3::new(3.0, 4.0, 0.0),
        up: DVec3::Y,
        vertical_fov: std::f32::consts::FRAC_PI_2,
    }
}

/// 64 × 32 texels; a texel's red is the column, its green the row.
fn numbered() -> SkyImage {
    let texels =
        (0..32).flat_map(|row| (0..64).map(move |column| [column as f32, row as f32, 0.0])).collect();
    SkyImage { name: "n".into(), width: 64, height: 32, rotation: 0.0, texels }
}

#[test]
fn samples_see_the_sky_in_their_direction() {
    let sky = numbered();
    let background =
        Background { even: Vec3::Z, image: Some(Panorama::new(&sky, &camera(), [200, 100]).unwrap()) };
    // What the pinhole puts at a sample, by hand: x from −2 to 2, y from 1 to −1, at distance 1 along −z.
    for (column, row) in [(0, 0), (199, 0), (0, 99), (199, 99), (20, 70), (150, 10), (101, 52)] {
        let [x, y] = [f64::from(column) + 0.5 - 100.0, 50.0 - f64::from(row) - 0.5].map(|n| n / 50.0);
        let turn = x.atan2(1.0);
        let rise = (y / (x * x + y * y + 1.0).sqrt()).asin();
        let texel = [(turn / std::f64::consts::TAU + 0.5) * 64.0, (0.5 - rise / std::f64::consts::PI) * 32.0]
            .map(f64::floor);
        let seen = background.radiance(row as usize * 200 + column as usize);
        assert_eq!(seen.to_array(), [texel[0] as f32, texel[1] as f32, 1.0], "{column}, {row}");
    }
}

#[test]
fn without_an_image_it_is_even() {
    let background = Background { even: Vec3::new(1.0, 2.0, 3.0), image: None };
    assert_eq!(background.radiance(0), background.radiance(12_345));
    assert_eq!(background.radiance(7), Vec3::new(1.0, 2.0, 3.0));
}
