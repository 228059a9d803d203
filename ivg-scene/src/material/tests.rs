use super::*;

fn texture(width: u32, height: u32, texels: &[[u8; 3]]) -> Texture {
    Texture { name: "t".into(), width, height, format: TextureFormat::Srgb8, texels: texels.concat() }
}

#[test]
fn codes_are_decoded_by_the_srgb_curve() {
    // IEC 61966-2-1: 188 is the code nearest to half the light; 10 lies on the linear part: 10 / 255 / 12.92.
    let t = texture(3, 1, &[[0, 188, 255], [10, 10, 10], [128, 128, 128]]);
    assert_eq!((t.texel(0, 0).x, t.texel(0, 0).z), (0.0, 1.0));
    assert!((t.texel(0, 0).y - 0.502_886_5).abs() < 1e-6);
    assert!((t.texel(1, 0).x - 0.003_035_27).abs() < 1e-9);
    assert!((t.texel(2, 0).x - 0.215_860_5).abs() < 1e-6);
}

#[test]
fn light_gets_the_nearest_code() {
    for code in 0..=255u8 {
        let light = SRGB_TO_LINEAR[usize::from(code)];
        assert_eq!(srgb_code(light), code);
        let next = SRGB_TO_LINEAR[usize::from(code.saturating_add(1))];
        assert_eq!(srgb_code(light + 0.49 * (next - light)), code);
        assert_eq!(srgb_code(light + 0.51 * (next - light)), code.saturating_add(1));
    }
    assert_eq!([-1.0, 2.0, f32::INFINITY, f32::NEG_INFINITY, f32::NAN].map(srgb_code), [0, 255, 255, 0, 0]);
}

#[test]
fn lookup_is_bilinear_in_linear_light_and_repeats() {
    let t = texture(2, 1, &[[0, 0, 0], [255, 255, 255]]);
    assert_eq!(t.sample(Vec2::new(0.25, 0.5)), Vec3::ZERO);
    assert_eq!(t.sample(Vec2::new(0.75, 0.5)), Vec3::ONE);
    assert_eq!(t.sample(Vec2::new(0.5, 0.5)), Vec3::splat(0.5));
    // Across the border lies the other end of the image.
    assert_eq!(t.sample(Vec2::new(0.0, 0.5)), Vec3::splat(0.5));
    for turns in [-3.0, 1.0, 1000.0] {
        assert_eq!(t.sample(Vec2::new(0.75 + turns, 0.5 - turns)), Vec3::ONE);
    }
}

#[test]
fn row_zero_is_the_upper_one() {
    let t = texture(1, 2, &[[255, 0, 0], [0, 0, 255]]);
    assert_eq!(t.sample(Vec2::new(0.5, 0.25)), Vec3::X);
    assert_eq!(t.sample(Vec2::new(0.5, 0.75)), Vec3::Z);
}

#[test]
fn strange_coordinates_still_read_a_texel() {
    let t = texture(3, 3, &[[9, 9, 9]; 9]);
    for x in [f32::NAN, f32::INFINITY, f32::MAX, -f32::MAX, -f32::MIN_POSITIVE, 1.0 - f32::EPSILON / 2.0] {
        assert!((t.sample(Vec2::new(x, x)) - t.texel(0, 0)).abs().max_element() < 1e-9, "{x}");
    }
}

#[test]
fn the_mean_is_taken_of_light_not_of_codes() {
    let t = texture(2, 1, &[[0, 0, 255], [255, 0, 255]]);
    assert_eq!(t.mean(), Vec3::new(0.5, 0.0, 1.0));
}
