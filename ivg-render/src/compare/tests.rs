use glam::Vec3;

use super::*;

fn linear(value: f32) -> Image {
    Image::new(4, 3, vec![Vec3::splat(value); 12])
}

fn display(pixel: [u8; 3]) -> DisplayImage {
    DisplayImage::new(4, 3, vec![pixel; 12])
}

#[test]
fn equal_pictures_are_zero_apart() {
    assert_eq!(rmse(&linear(0.3), &linear(0.3)), Ok(0.0));
    assert_eq!(rmse_display(&display([9, 8, 7]), &display([9, 8, 7])), Ok(0.0));
    assert_eq!(cie76(&display([9, 8, 7]), &display([9, 8, 7])), Ok(0.0));
    assert_eq!(difference(&linear(0.3), &linear(0.3), 0.0, 0.0).unwrap().beyond_tolerance, 0);
}

#[test]
fn a_wrong_picture_fails_every_comparison() {
    let wrong = linear(0.4);
    assert!((rmse(&linear(0.3), &wrong).unwrap() - 0.1).abs() < 1e-7);
    assert_eq!(rmse_display(&display([10; 3]), &display([13; 3])), Ok(3.0));
    assert!(cie76(&display([10; 3]), &display([13; 3])).unwrap() > 0.005);
    assert!(cie76_exposed(&linear(0.3), &wrong, 1.0).unwrap() > 0.05);
    let apart = difference(&linear(0.3), &wrong, 0.05, 0.0).unwrap();
    assert_eq!(apart.beyond_tolerance, 12);
    assert!((apart.largest - 0.1).abs() < 1e-6);
}

#[test]
fn one_wrong_pixel_is_found_where_it_is() {
    let mut pixels = vec![Vec3::splat(0.3); 12];
    pixels[6].y = 0.9;
    let wrong = Image::new(4, 3, pixels);
    let apart = difference(&linear(0.3), &wrong, 0.1, 0.1).unwrap();
    assert_eq!((apart.beyond_tolerance, apart.at), (1, (2, 1)));
    assert!(rmse(&linear(0.3), &wrong).unwrap() > 0.0);
}

#[test]
fn not_a_number_is_never_within_a_bound() {
    let broken = linear(f32::NAN);
    assert!(rmse(&linear(0.3), &broken).unwrap().is_nan());
    let apart = difference(&broken, &broken, 1e9, 1e9).unwrap();
    assert_eq!((apart.beyond_tolerance, apart.largest), (12, f32::INFINITY));
}

#[test]
fn sizes_must_agree() {
    let other = Image::new(3, 4, vec![Vec3::ZERO; 12]);
    let error = rmse(&linear(0.0), &other).unwrap_err();
    assert_eq!(error, SizeMismatch { first: (4, 3), second: (3, 4) });
    assert!(error.to_string().contains("4 x 3 and 3 x 4"));
    assert!(difference(&linear(0.0), &other, 1.0, 1.0).is_err());
}

#[test]
fn lab_has_the_published_values() {
    // White is (100, 0, 0); the sRGB primary red is (53.24, 80.09, 67.20), blue (32.30, 79.19, -107.86).
    for (pixel, expected) in [
        ([255, 255, 255], [100.0, 0.0, 0.0]),
        ([255, 0, 0], [53.24, 80.09, 67.20]),
        ([0, 0, 255], [32.30, 79.19, -107.86]),
        ([0, 0, 0], [0.0, 0.0, 0.0]),
    ] {
        for (found, expected) in lab(pixel).into_iter().zip(expected) {
            // Half a unit of the last published digit, and the f32 transfer curve.
            assert!((found - expected).abs() < 0.011, "{pixel:?}: {found} instead of {expected}");
        }
    }
    assert!((cie76(&display([0; 3]), &display([255; 3])).unwrap() - 1.0).abs() < 1e-4);
}
