use glam::{DVec3, Vec3};

use super::{BakeOptions, Estimator, automatic_bounds, dims_for};
use crate::BakeError;
use crate::cases::SceneBuilder;

#[test]
fn automatic_bounds_lie_one_step_outside_the_scene() {
    let mut builder = SceneBuilder::default();
    let grey = builder.material(0.5, 0.0, true);
    builder.cuboid(Vec3::new(1.0, 0.0, -2.0), Vec3::new(3.0, 1.0, 4.0), grey, false);
    let (_, flat) = builder.build();
    let dims = [16, 4, 2];
    let lattice = BakeOptions { dims, ..BakeOptions::default() }.lattice(&flat).unwrap();
    let step = DVec3::from(lattice.step);
    assert!(
        (lattice.origin[0] + step.x - 1.0).abs() < 1e-6 && (lattice.position(14, 0, 0)[0] - 3.0).abs() < 1e-6
    );
    assert!((lattice.origin[1] + step.y).abs() < 1e-6 && (lattice.position(0, 2, 0)[1] - 1.0).abs() < 1e-6);
    // Two vertices: 5 % of the extent outside.
    assert!((lattice.origin[2] + 2.3).abs() < 1e-6 && (lattice.position(0, 0, 1)[2] - 4.3).abs() < 1e-6);
}

#[test]
fn flat_scenes_get_bounds_with_a_volume() {
    let mut builder = SceneBuilder::default();
    let grey = builder.material(0.5, 0.0, true);
    builder.quad(Vec3::new(-1.0, 5.0, -2.0), Vec3::X * 2.0, Vec3::Z * 4.0, grey);
    let (_, flat) = builder.build();
    let (min, max) = automatic_bounds(&flat, [8; 3]).unwrap();
    assert!((min.y - 3.0).abs() < 1e-6 && (max.y - 7.0).abs() < 1e-6, "{min} {max}");
    let (_, nothing) = SceneBuilder::default().build();
    assert!(automatic_bounds(&nothing, [8; 3]).is_err());
}

#[test]
fn dims_follow_the_aspect() {
    assert_eq!(dims_for(DVec3::ZERO, DVec3::new(4.0, 2.0, 1.0), 17), [17, 9, 5]);
    assert_eq!(dims_for(DVec3::ZERO, DVec3::new(4.0, 0.0, 4.0), 5), [5, 2, 5]);
    assert_eq!(dims_for(DVec3::ZERO, DVec3::ZERO, 5), [2; 3]);
}

#[test]
fn estimators_are_found_by_their_names() {
    for estimator in Estimator::ALL {
        assert_eq!(Estimator::from_name(estimator.name()), Some(estimator));
    }
    assert_eq!(Estimator::from_name("gathering"), None);
    assert_eq!(Estimator::default(), Estimator::ALL[0]);
}

#[test]
fn bounds_far_beyond_the_scene_are_refused_at_once() {
    let mut builder = SceneBuilder::default();
    let grey = builder.material(0.5, 0.0, true);
    builder.cuboid(Vec3::ZERO, Vec3::ONE, grey, false);
    let (_, flat) = builder.build();
    let lattice = |max: f64| {
        let bounds = Some((DVec3::ZERO, DVec3::new(max, 1.0, 1.0)));
        BakeOptions { bounds, ..BakeOptions::default() }.lattice(&flat)
    };
    assert!(lattice(1e4).is_ok());
    for far in [2e4, 1e30, 1e300] {
        assert_eq!(lattice(far), Err(BakeError::FarBounds), "{far}");
    }
    assert!(matches!(lattice(f64::INFINITY), Err(BakeError::Lattice(_))));
}
