use super::*;

#[test]
fn the_curve_has_the_values_of_the_standard() {
    // IEC 61966-2-1: 18 % grey is 8-bit code 118, half is 188, the ends are fixed.
    let image = Image::new(4, 1, [0.0, 0.18, 0.5, 1.0].map(Vec3::splat).to_vec());
    assert_eq!(tonemap(&image, 1.0).pixels(), [[0; 3], [118; 3], [188; 3], [255; 3]]);
}

#[test]
fn every_code_survives_the_way_to_linear_light_and_back() {
    for code in 0..=255u8 {
        let linear = linear_from_srgb(f32::from(code) / 255.0);
        assert_eq!(display_pixel(Vec3::splat(linear)), [code; 3]);
    }
}

#[test]
fn values_outside_the_range_clip_and_not_a_number_is_black() {
    let image = Image::new(3, 1, vec![Vec3::splat(-1.0), Vec3::splat(f32::INFINITY), Vec3::splat(f32::NAN)]);
    assert_eq!(tonemap(&image, 1.0).pixels(), [[0; 3], [255; 3], [0; 3]]);
}

#[test]
fn exposure_scales_linear_light() {
    let dark = Image::new(1, 1, vec![Vec3::splat(0.05)]);
    let bright = Image::new(1, 1, vec![Vec3::splat(0.2)]);
    assert_eq!(tonemap(&dark, 4.0), tonemap(&bright, 1.0));
}

#[test]
fn a_grey_picture_is_exposed_to_middle_grey_and_a_black_one_is_left_alone() {
    let grey = Image::new(10, 10, vec![Vec3::splat(3.0); 100]);
    assert!((auto_exposure(&grey) * 3.0 - KEY).abs() < 1e-6);
    let black = Image::new(2, 2, vec![Vec3::ZERO; 4]);
    assert_eq!(auto_exposure(&black), 1.0);
}
