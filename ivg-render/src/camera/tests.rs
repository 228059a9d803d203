use glam::{Vec3, Vec4};

use super::*;

fn camera() -> Camera {
    Camera {
        eye: DVec3::new(1e6, 2.0, 5.0),
        target: DVec3::new(1e6, 2.0, 0.0),
        up: DVec3::Y,
        vertical_fov: std::f32::consts::FRAC_PI_2,
    }
}

#[test]
fn points_land_where_a_pinhole_puts_them() {
    let origin = DVec3::new(1e6, 0.0, 0.0);
    let matrix = view_projection(&camera(), origin, 2.0, 0.1).unwrap();
    // 4 m in front of the eye, 4 m up and 8 m to the right: the upper right corner of a picture twice as wide as high.
    let clip: Vec4 = matrix * Vec3::new(8.0, 6.0, 1.0).extend(1.0);
    assert!((clip / clip.w - Vec4::new(1.0, 1.0, 0.1 / 4.0, 1.0)).abs().max_element() < 1e-6);
}

#[test]
fn an_up_direction_along_the_view_axis_still_gives_a_picture() {
    let mut camera = camera();
    camera.up = DVec3::Z;
    assert!(view_projection(&camera, DVec3::ZERO, 1.0, 0.1).unwrap().is_finite());
}

#[test]
fn cameras_that_see_nothing_are_errors() {
    let mut blind = camera();
    blind.target = blind.eye;
    assert!(matches!(view_projection(&blind, DVec3::ZERO, 1.0, 0.1), Err(RenderError::Camera { .. })));
    let mut wide = camera();
    wide.vertical_fov = std::f32::consts::PI;
    assert!(matches!(view_projection(&wide, DVec3::ZERO, 1.0, 0.1), Err(RenderError::Camera { .. })));
    let mut broken = camera();
    broken.eye.x = f64::NAN;
    assert!(matches!(view_projection(&broken, DVec3::ZERO, 1.0, 0.1), Err(RenderError::NotFinite { .. })));
}
