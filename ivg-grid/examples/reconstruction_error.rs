//! Prints how far each reconstruction is off under kinds of light from uniform to narrow.
//!
//! ```text
//! cargo run -p ivg-grid --release --example reconstruction_error
//! ```
//!
//! Each kind is an ensemble of environments made of random lobes, the same in every run. The irradiance vectors and
//! the exact irradiance are integrated numerically over the same directions, so what remains is the formula's error.
//! Relative RMSE is the root mean square error over normals, channels and environments divided by the mean irradiance;
//! "negative" is the share of values below zero before they are cut off.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use ivg_grid::integrate::{fibonacci_sphere, hemisphere_vectors, irradiance};
use ivg_grid::{HemisphereVectors, IrradianceError, Reconstruction, reconstruct_signed, three_vector};

/// Directions of the integration: the rule itself is good to some 0.1 % (see the tests of `integrate`).
const DIRECTIONS: usize = 6_000;
/// Normals at which each environment's irradiance is compared.
const NORMALS: usize = 300;
/// Environments of an ensemble.
const ENVIRONMENTS: u64 = 24;

/// A kind of light.
struct Ensemble {
    name: &'static str,
    lobes: u64,
    /// Radiance from everywhere, beside the lobes' of about 1.
    ambient: f64,
    /// Concentration κ of a lobe exp(κ (w·d − 1)): 2 spreads over a hemisphere, 200 over 8 degrees.
    concentration: f64,
    /// 0 grey lobes, 1 lobes of one channel each.
    saturation: f64,
}

const ENSEMBLES: [Ensemble; 5] = [
    Ensemble { name: "uniform", lobes: 0, ambient: 1.0, concentration: 0.0, saturation: 0.0 },
    Ensemble { name: "broad, coloured", lobes: 4, ambient: 0.3, concentration: 2.0, saturation: 0.6 },
    Ensemble { name: "3 lobes, grey", lobes: 3, ambient: 0.05, concentration: 8.0, saturation: 0.0 },
    Ensemble { name: "3 lobes, saturated", lobes: 3, ambient: 0.05, concentration: 8.0, saturation: 1.0 },
    Ensemble { name: "narrow, saturated", lobes: 3, ambient: 0.0, concentration: 200.0, saturation: 1.0 },
];

fn main() {
    let directions = fibonacci_sphere(DIRECTIONS);
    let normals: Vec<Vec3> = fibonacci_sphere(NORMALS).iter().map(|n| n.as_vec3()).collect();
    println!(
        "{:<20} {:>16} {:>10} {:>9} {:>9} {:>9}",
        "light", "formula", "rel. RMSE", "bias", "worst", "negative"
    );
    for ensemble in &ENSEMBLES {
        let environments: Vec<Environment> =
            (0..ENVIRONMENTS).map(|index| Environment::new(ensemble, index, &directions, &normals)).collect();
        for method in Reconstruction::OF_VECTORS {
            print_row(ensemble.name, method.name(), &environments, &normals, |v, n| {
                reconstruct_signed(method, v, n)
            });
        }
        for share in [0.6, 0.8] {
            let name = format!("three, t = {share}");
            print_row(ensemble.name, &name, &environments, &normals, |v, n| three_vector(v, n, share));
        }
    }
}

/// The vectors of one environment and its exact irradiance for each normal.
struct Environment {
    vectors: HemisphereVectors,
    exact: Vec<DVec3>,
}

impl Environment {
    fn new(ensemble: &Ensemble, index: u64, directions: &[DVec3], normals: &[Vec3]) -> Self {
        let mut random = Random::new(index);
        let lobes: Vec<(DVec3, DVec3)> = (0..ensemble.lobes)
            .map(|lobe| {
                let grey = DVec3::splat(0.5 + random.next());
                let mut pure = DVec3::ZERO;
                pure[(lobe % 3) as usize] = 3.0 * grey.x;
                (random.direction(), grey.lerp(pure, ensemble.saturation))
            })
            .collect();
        let radiance = |w: DVec3| {
            let sum: DVec3 = lobes
                .iter()
                .map(|&(d, colour)| colour * (ensemble.concentration * (w.dot(d) - 1.0)).exp())
                .sum();
            sum + ensemble.ambient
        };
        let vectors = hemisphere_vectors(directions, radiance);
        let exact = normals.iter().map(|&n| irradiance(directions, radiance, n)).collect();
        Self { vectors, exact }
    }
}

fn print_row(
    light: &str,
    formula: &str,
    environments: &[Environment],
    normals: &[Vec3],
    reconstruct: impl Fn(&HemisphereVectors, Vec3) -> Vec3,
) {
    let mut error = IrradianceError::default();
    for environment in environments {
        for (&n, &exact) in normals.iter().zip(&environment.exact) {
            error.add(reconstruct(&environment.vectors, n), exact);
        }
    }
    println!(
        "{light:<20} {formula:>16} {:>9.2}% {:>8.2}% {:>8.1}% {:>8.2}%",
        100.0 * error.relative_rmse(),
        100.0 * error.relative_bias(),
        100.0 * error.relative_maximum(),
        100.0 * error.negative_share()
    );
}

/// SplitMix64 (Steele, Lea and Flood, 2014): small, and the same in every run.
struct Random(u64);

impl Random {
    fn new(index: u64) -> Self {
        Self(index.wrapping_mul(0xD1B5_4A32_D192_ED03))
    }

    /// 0 to 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A direction evenly distributed over the sphere.
    fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.next() - 1.0;
        let (sin, cos) = (2.0 * PI * self.next()).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        DVec3::new(radius * cos, radius * sin, z)
    }
}
