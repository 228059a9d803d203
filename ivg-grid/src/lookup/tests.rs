use ivg_format::Lattice;

use super::*;
use crate::reconstruct_signed;

/// A cube of 4³ vertices with steps of 1, 2 and 4 m, whose light is π along each axis times a factor that grows by
/// one a metre along x.
fn grid() -> IrradianceGrid {
    let lattice = Lattice::new([4; 3], [0.0; 3], [3.0, 6.0, 12.0]).expect("a box");
    let mut grid = IrradianceGrid::new(lattice).expect("small");
    for index in 0..64 {
        let factor = f32::from(lattice.coords(index as u64)[0]) + 1.0;
        let mut vectors = [[[0.0; 3]; 3]; 6];
        for (hemisphere, channels) in vectors.iter_mut().enumerate() {
            let sign = if hemisphere % 2 == 0 { 1.0 } else { -1.0 };
            channels
                .iter_mut()
                .for_each(|vector| vector[hemisphere / 2] = sign * factor * std::f32::consts::PI);
        }
        grid.set(index, &vectors);
    }
    grid
}

#[test]
fn irradiance_is_the_reconstruction_of_the_interpolated_vectors() {
    let grid = grid();
    let p = DVec3::new(1.3, 2.7, 9.1);
    for n in [Vec3::X, Vec3::new(0.6, -0.8, 0.0), Vec3::new(-2.0, 1.0, -2.0) / 3.0] {
        for filter in SpatialFilter::ALL {
            for method in Reconstruction::OF_VECTORS {
                let vectors = grid.vectors_at(p, Some(n), filter);
                let expected = reconstruct_signed(method, &vectors, n).max(Vec3::ZERO);
                assert_eq!(grid.irradiance(p, n, method, filter), expected);
            }
        }
    }
}

#[test]
fn uniform_light_that_grows_gives_its_closed_form() {
    let n = Vec3::new(1.0, 2.0, -2.0) / 3.0;
    let found = grid().irradiance(
        DVec3::new(1.25, 3.0, 5.0),
        n,
        Reconstruction::ThreeVector,
        SpatialFilter::Trilinear,
    );
    // Eight products and three squares in f32: some 16 roundings of 6e-8.
    assert!((found / std::f32::consts::PI - Vec3::splat(2.25)).abs().max_element() < 2.25e-6, "{found}");
}

#[test]
fn the_bias_moves_the_point_along_the_normal_by_a_share_of_the_smallest_step() {
    let grid = grid();
    let (p, n) = (DVec3::new(1.0, 3.0, 5.0), Vec3::NEG_X);
    let (method, filter) = (Reconstruction::SixVector, SpatialFilter::Trilinear);
    let moved = grid.surface_irradiance(p, n, SURFACE_BIAS, method, filter);
    assert_eq!(moved, grid.irradiance(DVec3::new(0.9, 3.0, 5.0), n, method, filter));
    assert!(moved.x < grid.irradiance(p, n, method, filter).x);
    assert_eq!(grid.surface_irradiance(p, n, 0.0, method, filter), grid.irradiance(p, n, method, filter));

    // An axis of one vertex has no step to be the smallest.
    let row = Lattice::new([4, 1, 1], [0.0; 3], [3.0, 0.0, 0.0]).expect("a row");
    let mut flat = IrradianceGrid::new(row).expect("small");
    (0..4).for_each(|index| flat.set(index, &grid.vectors()[index]));
    let moved = flat.surface_irradiance(p, n, SURFACE_BIAS, method, filter);
    assert_eq!(moved, flat.irradiance(DVec3::new(0.9, 0.0, 0.0), n, method, filter));

    let point = Lattice::new([1; 3], [0.0; 3], [0.0; 3]).expect("a point");
    let mut single = IrradianceGrid::new(point).expect("small");
    single.set(0, &grid.vectors()[0]);
    let light = single.surface_irradiance(p, n, SURFACE_BIAS, method, filter);
    assert!((light.x - std::f32::consts::PI).abs() < 1e-6, "a lattice without a step has no bias: {light}");
}
