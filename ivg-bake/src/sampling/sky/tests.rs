use super::*;

/// A sky of 16 x 8 texels, one of them a sun.
fn sunny() -> SkyImage {
    let mut texels = vec![[0.1, 0.2, 0.4]; 128];
    texels[37] = [50.0, 40.0, 30.0];
    SkyImage { name: "s".into(), width: 16, height: 8, rotation: 0.7, texels }
}

/// The mean of radiance over density is the integral of the radiance, here 4π times its mean, in every channel; of that
/// times the direction too. 20,000 draws of weights that differ by less than their mean: 5 / √20,000 = 4 %.
#[test]
fn draws_are_in_proportion_to_what_comes_from_each_direction() {
    let image = sunny();
    let table = SkyTable::new(&image);
    let (mut sum, mut sun) = (Vec3::ZERO, 0);
    for n in 0..20_000 {
        let (towards, colour) = table.draw(&Stream::new(4, n), 2);
        assert!(towards.is_normalized() && colour.max_element() == 1.0);
        let seen = image.radiance(towards);
        assert!((seen / seen.max_element() - colour).abs().max_element() < 1e-6, "the texel that was drawn");
        sun += u32::from(seen.x > 1.0);
        sum += colour * (table.brightest() / 20_000.0) as f32;
    }
    let expected = image.mean() * 4.0 * core::f32::consts::PI;
    assert!(((sum - expected) / expected).abs().max_element() < 0.04, "{sum} {expected}");
    let share = 50.0 * image.solid_angle(37 / 16) / table.brightest();
    assert!((f64::from(sun) / 20_000.0 - share).abs() < 5.0 * (share * (1.0 - share) / 20_000.0).sqrt());
}
