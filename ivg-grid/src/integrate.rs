//! Irradiance, irradiance vectors and spherical harmonics of a radiance function, by plain numerical integration.
//!
//! Slow and obvious: the oracle that reconstruction, packing and bakes are measured against.

use glam::{DVec3, Vec3};
use ivg_format::RadianceHarmonics;

use crate::HemisphereVectors;
use crate::harmonics::{COEFFICIENTS, basis};

/// `count` unit directions spread evenly over the sphere (Fibonacci lattice); each stands for a solid angle of
/// `4π / count`.
#[must_use]
pub fn fibonacci_sphere(count: usize) -> Vec<DVec3> {
    // The golden angle, 2π (1 − 1/φ): successive directions never line up.
    let golden_angle = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    (0..count)
        .map(|index| {
            let z = 1.0 - (2.0 * index as f64 + 1.0) / count as f64;
            let radius = (1.0 - z * z).sqrt();
            let (sin, cos) = (golden_angle * index as f64).sin_cos();
            DVec3::new(radius * cos, radius * sin, z)
        })
        .collect()
}

/// The six irradiance vectors of a radiance function \[W/m²\]: the integrals of `radiance(w) w` over the hemispheres
/// (Web3D 2008, equation 1).
///
/// `directions` are spread evenly over the sphere; `radiance` gives the radiance \[W/(m² sr)\] that arrives from
/// where `w` points.
#[must_use]
pub fn hemisphere_vectors(directions: &[DVec3], radiance: impl Fn(DVec3) -> DVec3) -> HemisphereVectors {
    let mut sums = [[DVec3::ZERO; 3]; 6];
    for &w in directions {
        let light = radiance(w).to_array();
        for axis in 0..3 {
            if w[axis] != 0.0 {
                let vectors = &mut sums[2 * axis + usize::from(w[axis] < 0.0)];
                (0..3).for_each(|channel| vectors[channel] += light[channel] * w);
            }
        }
    }
    let solid_angle = solid_angle(directions);
    sums.map(|vectors| vectors.map(|vector| (vector * solid_angle).as_vec3().to_array()))
}

/// The spherical harmonics to degree 2 of a radiance function \[W/(m² sr)\]: the integrals of `radiance(w) Y(w)` over the
/// sphere.
///
/// `directions` and `radiance` as in [`hemisphere_vectors`].
#[must_use]
pub fn radiance_harmonics(directions: &[DVec3], radiance: impl Fn(DVec3) -> DVec3) -> RadianceHarmonics {
    let mut sums = [[0.0; COEFFICIENTS]; 3];
    for &w in directions {
        let (light, basis) = (radiance(w).to_array(), basis(w));
        for (sums, light) in sums.iter_mut().zip(light) {
            sums.iter_mut().zip(basis).for_each(|(sum, y)| *sum += light * y);
        }
    }
    let solid_angle = solid_angle(directions);
    sums.map(|channel| channel.map(|sum| (sum * solid_angle) as f32))
}

/// The irradiance \[W/m²\] of a surface with unit normal `n` under a radiance function: the integral of
/// `radiance(w) w·n` over the directions in front of it.
#[must_use]
pub fn irradiance(directions: &[DVec3], radiance: impl Fn(DVec3) -> DVec3, n: Vec3) -> DVec3 {
    let n = n.as_dvec3();
    let sum: DVec3 = directions.iter().filter(|w| w.dot(n) > 0.0).map(|&w| radiance(w) * w.dot(n)).sum();
    sum * solid_angle(directions)
}

fn solid_angle(directions: &[DVec3]) -> f64 {
    4.0 * std::f64::consts::PI / directions.len().max(1) as f64
}

#[cfg(test)]
mod tests;
