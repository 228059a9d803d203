//! Prints how far each reconstruction and each encoding is off under kinds of light from uniform to a single direction,
//! beside other forms that engines store in a probe.
//!
//! ```text
//! cargo run -p ivg-grid --release --example reconstruction_error
//! ```
//!
//! Each kind is an ensemble of environments, the same in every run. Irradiance vectors, harmonics and the exact irradiance are
//! sums over the same directions, so that what remains is the error of the form itself. Encodings go through a file.
//!
//! Error: root mean square over normals, channels and environments, relative to the root mean square of the irradiance. Bias
//! and worst: relative to its mean. Negative: the share of values below zero before they are cut off. Bytes a vertex; of forms
//! that are no encoding in binary16, though they are not rounded.
//!
//! | column | light |
//! |---|---|
//! | uniform | the same from everywhere |
//! | broad | 4 lobes about a hemisphere wide, coloured, over an even light of a third |
//! | grey, saturated | 3 lobes some 40 degrees wide, of all channels or of one each, over a little even light |
//! | narrow | 3 lobes of 8 degrees of one channel each |
//! | HDR | 64 lobes of 8 to 80 degrees, half saturated, over a little even light; powers p distributed like p^-2.2 |
//! | one light | a single direction |
//! | opposite | two opposite directions, of different colours |
//!
//! Every environment has the same mean irradiance over all normals and channels.

#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use ivg_format::{EncodeOptions, Encoding, GridSource, Lattice, Limits, encode};
use ivg_grid::integrate::{fibonacci_sphere, hemisphere_vectors, irradiance, radiance_harmonics};
use ivg_grid::{
    HemisphereVectors, IrradianceError, IrradianceGrid, Quantity, RadianceHarmonics, Reconstruction,
    VertexValues, alternatives, harmonics, reconstruct_signed,
};

/// Directions that light comes from.
const DIRECTIONS: usize = 6_000;
/// Normals at which each environment's irradiance is compared.
const NORMALS: usize = 300;
/// Environments of an ensemble.
const ENVIRONMENTS: u16 = 24;
/// The exponent of the distribution of the lobes' powers in the HDR ensemble: the share of lobes brighter than p falls like
/// p^-1.2, so that few lobes carry most of the light, as with windows and lamps.
const POWER_LAW: f64 = 1.2;

/// A kind of light.
struct Ensemble {
    name: &'static str,
    lobes: u64,
    /// Radiance from everywhere, beside the lobes' of about 1.
    ambient: f64,
    /// Concentration κ of a lobe exp(κ (w·d − 1)), the least and the most: 2 spreads over a hemisphere, 200 over 8 degrees;
    /// infinite: a single direction.
    concentration: [f64; 2],
    /// 0 grey lobes, 1 lobes of one channel each.
    saturation: f64,
    /// Whether the powers of lobes follow a power law.
    power_law: bool,
}

const PLAIN: Ensemble = Ensemble {
    name: "uniform",
    lobes: 0,
    ambient: 1.0,
    concentration: [0.0; 2],
    saturation: 0.0,
    power_law: false,
};

const ENSEMBLES: [Ensemble; 8] = [
    PLAIN,
    Ensemble { name: "broad", lobes: 4, ambient: 0.3, concentration: [2.0; 2], saturation: 0.6, ..PLAIN },
    Ensemble { name: "grey", lobes: 3, ambient: 0.05, concentration: [8.0; 2], ..PLAIN },
    Ensemble {
        name: "saturated",
        lobes: 3,
        ambient: 0.05,
        concentration: [8.0; 2],
        saturation: 1.0,
        ..PLAIN
    },
    Ensemble { name: "narrow", lobes: 3, ambient: 0.0, concentration: [200.0; 2], saturation: 1.0, ..PLAIN },
    Ensemble {
        name: "HDR",
        lobes: 64,
        ambient: 0.02,
        concentration: [2.0, 200.0],
        saturation: 0.5,
        power_law: true,
    },
    Ensemble { name: "one light", lobes: 1, ambient: 0.0, concentration: [f64::INFINITY; 2], ..PLAIN },
    Ensemble {
        name: "opposite",
        lobes: 2,
        ambient: 0.0,
        concentration: [f64::INFINITY; 2],
        saturation: 0.6,
        ..PLAIN
    },
];

type AnyError = Box<dyn std::error::Error>;

/// One of the figures of an error.
type Figure = fn(&IrradianceError) -> f64;

/// Name, bytes a vertex and error of a form.
type Row = (String, u64, IrradianceError);

fn main() -> Result<(), AnyError> {
    let directions = fibonacci_sphere(DIRECTIONS);
    let normals: Vec<Vec3> = fibonacci_sphere(NORMALS).iter().map(|n| n.as_vec3()).collect();
    let mut names = Vec::new();
    let mut columns = Vec::new();
    for ensemble in &ENSEMBLES {
        let environments: Vec<Environment> =
            (0..ENVIRONMENTS).map(|index| Environment::new(ensemble, index, &directions, &normals)).collect();
        let rows = rows(&environments, &normals)?;
        names = rows.iter().map(|(name, bytes, _)| (name.clone(), *bytes)).collect();
        columns.push(rows.into_iter().map(|(_, _, error)| error).collect::<Vec<_>>());
    }
    let tables: [(&str, Figure); 4] = [
        ("error", IrradianceError::relative_rmse),
        ("bias", IrradianceError::relative_bias),
        ("worst", IrradianceError::relative_maximum),
        ("negative", IrradianceError::negative_share),
    ];
    for (title, figure) in tables {
        print!("{:<26}{:>6}", format!("{title} [%]"), "bytes");
        ENSEMBLES.iter().for_each(|ensemble| print!("{:>11}", ensemble.name));
        println!();
        for (row, (name, bytes)) in names.iter().enumerate() {
            print!("{name:<26}{bytes:>6}");
            columns.iter().for_each(|column| print!("{:>11.2}", 100.0 * figure(&column[row])));
            println!();
        }
        println!();
    }
    Ok(())
}

/// All forms.
fn rows(environments: &[Environment], normals: &[Vec3]) -> Result<Vec<Row>, AnyError> {
    let lattice = Lattice::new([ENVIRONMENTS, 1, 1], [0.0; 3], [1.0, 0.0, 0.0])?;
    let vectors: Vec<HemisphereVectors> = environments.iter().map(|e| e.vectors).collect();
    let radiance: Vec<RadianceHarmonics> = environments.iter().map(|e| e.radiance).collect();
    let mut rows = Vec::new();
    for &encoding in Encoding::ALL {
        let source = match encoding.quantity() {
            Quantity::Vectors => GridSource::new(lattice, &vectors[..]),
            Quantity::Radiance => GridSource::new(lattice, &radiance[..]),
        };
        let file = encode(&source, &EncodeOptions { encoding, ..EncodeOptions::new() })?;
        let (grid, _) = IrradianceGrid::from_file(&file, &Limits::default())?;
        for method in Reconstruction::ALL.into_iter().filter(|m| m.fits(encoding.quantity())) {
            let error = error(environments, normals, |index, n| match grid.get(index) {
                Some(VertexValues::Vectors(vectors)) => reconstruct_signed(method, &vectors, n),
                Some(VertexValues::Radiance(radiance)) => harmonics::irradiance_signed(&radiance, n),
                None => unreachable!("the file has every vertex"),
            });
            rows.push((
                format!("{}, {}", encoding.name(), method.name()),
                encoding.bytes_per_vertex(),
                error,
            ));
        }
    }
    let mut other = |name: &str, numbers: u64, form: &dyn Fn(usize, Vec3) -> Vec3| {
        rows.push((name.to_owned(), 2 * numbers, error(environments, normals, form)));
    };
    other("ambient cube", 18, &|index, n| alternatives::ambient_cube(&vectors[index], n));
    other("SH L1", 12, &|index, n| alternatives::linear_harmonics(&radiance[index], n));
    other("ZH3", 15, &|index, n| alternatives::zonal_harmonics(&radiance[index], n));
    other("SH L2", 27, &|index, n| harmonics::irradiance_signed(&radiance[index], n));
    Ok(rows)
}

fn error(
    environments: &[Environment],
    normals: &[Vec3],
    form: impl Fn(usize, Vec3) -> Vec3,
) -> IrradianceError {
    let mut error = IrradianceError::default();
    for (index, environment) in environments.iter().enumerate() {
        for (&n, &exact) in normals.iter().zip(&environment.exact) {
            error.add(form(index, n), exact);
        }
    }
    error
}

/// What is stored of one environment, and its exact irradiance for each normal.
struct Environment {
    vectors: HemisphereVectors,
    radiance: RadianceHarmonics,
    exact: Vec<DVec3>,
}

impl Environment {
    fn new(ensemble: &Ensemble, index: u16, directions: &[DVec3], normals: &[Vec3]) -> Self {
        let mut random = Random::new(u64::from(index));
        let mut lobes: Vec<Lobe> =
            (0..ensemble.lobes).map(|lobe| Lobe::new(ensemble, lobe, &mut random)).collect();
        if ensemble.concentration[0].is_infinite() {
            // The second light is opposite to the first.
            let turned: Vec<DVec3> = lobes.iter().map(|_| lobes[0].direction).collect();
            for (n, lobe) in lobes.iter_mut().enumerate() {
                lobe.direction = if n == 0 { turned[n] } else { -turned[n] };
            }
            // Each comes from a single direction, and the sum over directions is the sum over lights.
            let exact: Vec<DVec3> = lobes.iter().map(|lobe| lobe.direction).collect();
            return Self::of(&exact, normals, |w| {
                lobes.iter().filter(|lobe| lobe.direction == w).map(|lobe| lobe.colour).sum()
            });
        }
        Self::of(directions, normals, |w| {
            lobes.iter().map(|lobe| lobe.radiance(w)).sum::<DVec3>() + ensemble.ambient
        })
    }

    fn of(directions: &[DVec3], normals: &[Vec3], radiance: impl Fn(DVec3) -> DVec3) -> Self {
        let power: f64 = directions.iter().map(|&w| radiance(w).element_sum()).sum();
        let scale = directions.len() as f64 / power;
        let radiance = |w| radiance(w) * scale;
        Self {
            vectors: hemisphere_vectors(directions, radiance),
            radiance: radiance_harmonics(directions, radiance),
            exact: normals.iter().map(|&n| irradiance(directions, radiance, n)).collect(),
        }
    }
}

/// Light from around a direction.
struct Lobe {
    direction: DVec3,
    concentration: f64,
    colour: DVec3,
}

impl Lobe {
    fn new(ensemble: &Ensemble, lobe: u64, random: &mut Random) -> Self {
        let grey = DVec3::splat(0.5 + random.next());
        let mut pure = DVec3::ZERO;
        pure[(lobe % 3) as usize] = 3.0 * grey.x;
        let mut colour = grey.lerp(pure, ensemble.saturation);
        let direction = random.direction();
        let [least, most] = ensemble.concentration;
        let mut concentration = least;
        if ensemble.power_law {
            concentration = least * (most / least).powf(random.next());
            // The integral of a lobe is 2π / κ: the power, not the radiance, follows the law.
            colour *= concentration * (1.0 - random.next()).powf(-1.0 / POWER_LAW);
        }
        Self { direction, concentration, colour }
    }

    fn radiance(&self, w: DVec3) -> DVec3 {
        self.colour * (self.concentration * (w.dot(self.direction) - 1.0)).exp()
    }
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
