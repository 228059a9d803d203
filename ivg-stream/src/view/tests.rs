use glam::DQuat;
use ivg_scene::Node;

use super::*;
use crate::extensions::FileEntry;

/// A view along -z from the origin with a quarter turn of field: at distance d a picture of 100 rows shows 2 d.
fn view(pixels: f32) -> View {
    let camera = Camera {
        eye: DVec3::ZERO,
        target: DVec3::NEG_Z,
        up: DVec3::Y,
        vertical_fov: std::f32::consts::FRAC_PI_2,
    };
    View { camera, height: 100, pixels }
}

fn scene(transforms: &[DAffine3]) -> Scene {
    let node = |&transform: &DAffine3| Node { name: String::new(), mesh: 0, transform };
    Scene { nodes: transforms.iter().map(node).collect(), ..Scene::default() }
}

fn error(pixels: f32, transforms: &[DAffine3]) -> f32 {
    let mut header = Header::default();
    header.origin = [5.0, 0.0, 0.0];
    header.bounds = [[-1.0; 3], [1.0; 3]];
    let entry = MeshEntry {
        mesh: 0,
        file: FileEntry::of(String::new(), b""),
        origin: [5.0, 0.0, 0.0],
        materials: None,
    };
    view(pixels).error_of(&entry, &header, &scene(transforms))
}

/// Few operations in f64, one rounding to f32, and tan of an f32 angle: relative to 2^-22.
fn near(found: f32, expected: f32) -> bool {
    (found - expected).abs() <= expected * 2f32.powi(-22)
}

#[test]
fn a_pixel_is_as_large_as_it_is_far_away() {
    // The box reaches to 10 from the eye, where 100 rows show 20 m.
    let away = DAffine3::from_translation(DVec3::new(0.0, 0.0, -11.0));
    assert!(near(error(1.0, &[away]), 0.2), "{}", error(1.0, &[away]));
    assert!(near(error(0.5, &[away]), 0.1));
    // Behind the camera as before it: its shadow may be seen.
    let behind = DAffine3::from_translation(DVec3::new(0.0, 0.0, 11.0));
    assert!(near(error(1.0, &[behind]), 0.2));
    // Twice in the scene: the nearer one counts.
    let near_by = DAffine3::from_translation(DVec3::new(0.0, 0.0, -2.0));
    assert!(near(error(1.0, &[away, near_by]), 0.02));
    assert_eq!(error(1.0, &[DAffine3::IDENTITY]), 0.0, "the eye is inside");
    assert_eq!(error(1.0, &[]), f32::INFINITY, "the scene shows it nowhere");
}

#[test]
fn a_mesh_that_is_enlarged_must_be_more_exact() {
    let turned = |scale: f64, shift: f64| {
        DAffine3::from_scale_rotation_translation(
            DVec3::new(scale, 1.0, 1.0),
            DQuat::from_rotation_z(0.0),
            DVec3::new(0.0, 0.0, shift),
        )
    };
    assert!(near(error(1.0, &[turned(4.0, -11.0)]), 0.05));
    // A rotation lengthens nothing.
    let turn = DMat3::from_rotation_x(0.7) * DMat3::from_rotation_y(1.1);
    assert!((stretch(&turn) - 1.0).abs() < 1e-12);
    assert!((stretch(&(turn * 3.0)) - 3.0).abs() < 1e-12);
    // A shear: never less than what it does to any vector.
    let shear = DMat3::from_cols(DVec3::X, DVec3::new(2.0, 1.0, 0.0), DVec3::Z);
    let most = (0..1000)
        .map(|k| (shear * DVec3::new((f64::from(k) * 0.01).cos(), (f64::from(k) * 0.01).sin(), 0.0)).length())
        .fold(0.0, f64::max);
    assert!(stretch(&shear) >= most && stretch(&shear) <= most * 3f64.sqrt(), "{most}");
}
