use super::*;
use crate::harmonics::{hemisphere_vectors, irradiance_signed};
use crate::integrate::fibonacci_sphere;

fn normals() -> Vec<Vec3> {
    fibonacci_sphere(60).iter().map(|n| n.as_vec3()).collect()
}

/// Coefficients without any symmetry.
fn uneven() -> RadianceHarmonics {
    std::array::from_fn(|channel| {
        std::array::from_fn(|k| if k == 0 { 4.0 } else { ((k * 7 + channel * 5) % 11) as f32 / 8.0 - 0.6 })
    })
}

#[test]
fn the_ambient_cube_is_exact_on_the_axes_and_in_uniform_light() {
    let vectors = hemisphere_vectors(&uneven());
    for hemisphere in 0..6 {
        let n = Vec3::AXES[hemisphere / 2] * if hemisphere % 2 == 0 { 1.0 } else { -1.0 };
        assert!((ambient_cube(&vectors, n) - irradiance_signed(&uneven(), n)).abs().max_element() < 1e-5);
    }
    let even = [[2.0 * PI.sqrt(), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]; 3];
    for n in normals() {
        assert!((ambient_cube(&hemisphere_vectors(&even), n) - Vec3::splat(PI)).abs().max_element() < 2e-6);
    }
}

#[test]
fn the_linear_ones_are_all_harmonics_but_degree_two() {
    let mut linear = uneven();
    linear.iter_mut().for_each(|channel| channel[4..].fill(0.0));
    for n in normals() {
        let off = (linear_harmonics(&uneven(), n) - irradiance_signed(&linear, n)).abs().max_element();
        assert!(off < 1e-5, "{off}");
    }
}

/// Light that is the same all around an axis, whatever its colour there, is what three bands of zonal harmonics hold.
#[test]
fn zonal_light_is_kept_and_only_that() {
    let axis = DVec3::new(2.0, -3.0, 6.0) / 7.0;
    let at_axis = basis(axis).map(|y| y as f32);
    let zonal: RadianceHarmonics = [[3.0, 1.0, 0.5], [2.0, 1.5, -0.3], [1.0, 0.2, 0.4]]
        .map(|bands: [f32; 3]| std::array::from_fn(|k| at_axis[k] * bands[[0, 1, 1, 1, 2, 2, 2, 2, 2][k]]));
    for n in normals() {
        let off = (zonal_harmonics(&zonal, n) - irradiance_signed(&zonal, n)).abs().max_element();
        assert!(off < 1e-5, "{off}");
    }
    assert!(normals().iter().any(|&n| {
        (zonal_harmonics(&uneven(), n) - irradiance_signed(&uneven(), n)).abs().max_element() > 0.1
    }));
    let dark = RadianceHarmonics::default();
    assert_eq!(zonal_harmonics(&dark, Vec3::X), Vec3::ZERO, "no direction to turn to");
}
