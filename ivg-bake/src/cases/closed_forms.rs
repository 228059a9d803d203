//! Light that is known in closed form (`Outcome::expected`), baked.

use core::f64::consts::PI;

use glam::{DVec3, Vec3};
use ivg_grid::IrradianceGrid;
use ivg_scene::{LightKind, Material};

use super::{Outcome, SEEDS, SceneBuilder, UNLIMITED, compare_axes, outcome, plan};
use crate::{BakeError, BakeOptions, Silent, bake};

/// A closed cube from 0 to 1 m whose walls reflect half and emit 1 W/(m² sr), and any lattice in it: π from everywhere, also
/// on walls, in edges and corners, where walls lie in planes between cells, and for few vertices.
///
/// # Errors
///
/// As [`bake`].
pub fn furnace_on_lattice(
    name: &str,
    dims: [u16; 3],
    bounds: (DVec3, DVec3),
    photons: u64,
) -> Result<Outcome, BakeError> {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.5, 1.0, false);
    builder.cuboid(Vec3::ZERO, Vec3::ONE, wall, true);
    let (scene, flat) = builder.build();
    let plan = plan(&scene, UNLIMITED);
    compare_axes(format!("white furnace, {name}"), PI, |seed| {
        let options = BakeOptions { dims, bounds: Some(bounds), photons, seed, ..BakeOptions::default() };
        bake(&scene, &flat, &plan, &options, &Silent)
    })
}

/// Two parallel plates 1 m apart, the lower of which emits 1 W/(m² sr): between side walls that are perfect mirrors they are
/// infinite. Their radiosities are B₁ = π / (1 − r₁ r₂) and B₂ = r₂ B₁. From above comes B₂ everywhere (`from_above`); from
/// below B₁, less what the lower plate itself, not its mirror images, sends directly: the mean of that over the lattice's
/// cells is integrated with the closed form of a rectangle.
///
/// # Errors
///
/// As [`bake`].
pub fn parallel_plates(from_above: bool, photons: u64) -> Result<Outcome, BakeError> {
    const ALBEDOS: [f64; 2] = [0.5, 0.8];
    let mut builder = SceneBuilder::default();
    let lower = builder.material(ALBEDOS[0] as f32, 1.0, false);
    let upper = builder.material(ALBEDOS[1] as f32, 0.0, false);
    let mirror = builder.any_material(Material {
        albedo: Vec3::ZERO,
        specular: 1.0,
        roughness: 0.0,
        ..Material::default()
    });
    builder.quad(Vec3::ZERO, Vec3::X, Vec3::Y, lower);
    builder.quad(Vec3::Z, Vec3::Y, Vec3::X, upper);
    builder.quad(Vec3::ZERO, Vec3::Y, Vec3::Z, mirror);
    builder.quad(Vec3::X, Vec3::Z, Vec3::Y, mirror);
    builder.quad(Vec3::ZERO, Vec3::Z, Vec3::X, mirror);
    builder.quad(Vec3::Y, Vec3::X, Vec3::Z, mirror);
    let (scene, flat) = builder.build();
    let plan = plan(&scene, UNLIMITED);
    let (low, step) = (0.2, 0.2);
    let bounds = Some((DVec3::splat(low), DVec3::splat(low + 3.0 * step)));
    let b1 = PI / (1.0 - ALBEDOS[0] * ALBEDOS[1]);
    let expected = if from_above {
        ALBEDOS[1] * b1
    } else {
        // The dual cells of the lattice fill the cube from 0.1 to 0.9; midpoints of 16 strata an axis.
        let strata = || (0..16).map(|n| low - 0.5 * step + (f64::from(n) + 0.5) * 4.0 * step / 16.0);
        let direct = strata().flat_map(|x| strata().map(move |y| (x, y)));
        let direct = direct.flat_map(|(x, y)| strata().map(move |z| unit_square_irradiance(x, y, z)));
        b1 - direct.sum::<f64>() / 16f64.powi(3)
    };
    let hemisphere = if from_above { 4 } else { 5 };
    let name = format!("parallel plates, from {}", if from_above { "above" } else { "below" });
    let values = seeds(|seed| {
        let options = BakeOptions { dims: [4; 3], bounds, photons, seed, ..BakeOptions::default() };
        bake(&scene, &flat, &plan, &options, &Silent).map(|result| mean_along(&result.grid, hemisphere))
    })?;
    // From above light is even. From below the midpoint rule over 16 strata of 0.05 m is off by step² / 24 times second
    // derivatives of the order of the value over (0.3 m)²: 0.1 %; and cells are carried to their vertices by a fitted
    // gradient, which a mean over the cube nearly undoes.
    Ok(outcome(name, &values, expected, if from_above { 0.0 } else { 0.01 }))
}

/// Irradiance from the unit square at z = 0 of radiance 1 on a surface facing it at (x, y, z) above it \[W/m²\].
fn unit_square_irradiance(x: f64, y: f64, z: f64) -> f64 {
    let corner = |a: f64, b: f64| {
        let (a, b) = (a / z, b / z);
        let term = |a: f64, b: f64| {
            let root = (1.0 + a * a).sqrt();
            a / root * libm::atan(b / root)
        };
        0.5 * (term(a, b) + term(b, a))
    };
    corner(x, y) + corner(1.0 - x, y) + corner(x, 1.0 - y) + corner(1.0 - x, 1.0 - y)
}

/// A white disk of radius 0.5 m lit squarely by parallel light of 1 W/m², and vertices 1 m above its middle: r² / (r² + h²).
///
/// # Errors
///
/// As [`bake`].
pub fn lit_disk(photons: u64) -> Result<Outcome, BakeError> {
    const TRIANGLES: u32 = 256;
    let mut builder = SceneBuilder::default();
    let white = builder.material(1.0, 0.0, true);
    let rim = |n: u32| {
        let angle = f64::from(n) / f64::from(TRIANGLES) * 2.0 * PI;
        (DVec3::new(libm::cos(angle), libm::sin(angle), 0.0) * 0.5).as_vec3()
    };
    (0..TRIANGLES).for_each(|n| builder.triangle([Vec3::ZERO, rim(n), rim(n + 1)], white));
    builder.light(LightKind::Directional { direction: Vec3::NEG_Z, irradiance: Vec3::ONE });
    let (scene, flat) = builder.build();
    let plan = plan(&scene, UNLIMITED);
    let bounds = Some((DVec3::new(-0.05, -0.05, 0.95), DVec3::new(0.05, 0.05, 1.05)));
    let values = seeds(|seed| {
        let options = BakeOptions { dims: [2; 3], bounds, photons, seed, ..BakeOptions::default() };
        bake(&scene, &flat, &plan, &options, &Silent).map(|result| mean_along(&result.grid, 5))
    })?;
    // The block of cells is 0.2 m wide: second derivatives of the order of the value over (1 m)² along three axes, four times
    // that for safety; and a disk of 256 triangles lacks 1e-4 of its area.
    Ok(outcome("disk in parallel light".into(), &values, 0.2, 3.0 * 0.1f64.powi(2) / 6.0 * 4.0 + 1e-4))
}

/// A red and a green wall face each other and a lamp is halfway between, all else black: what comes from one side is the
/// mirror image of what comes from the other, in the other colour, so that sums over the colours cancel along the axis
/// between. The figure is the mean of the light from the red side, in red, over that from the green side, in green, less 1.
///
/// # Errors
///
/// As [`bake`].
pub fn cross_coloured_walls(photons: u64) -> Result<Outcome, BakeError> {
    let values = seeds(|seed| {
        let grid = cross_coloured_grid(photons, seed)?;
        let mean = |hemisphere: usize, colour: usize| {
            grid.vectors().iter().map(|v| f64::from(v[hemisphere][colour][0].abs())).sum::<f64>()
        };
        Ok(mean(0, 0) / mean(1, 1))
    })?;
    // A ratio of two means of n independent numbers with a relative deviation s is off by s²/n, below a hundredth of its noise.
    Ok(outcome("cross-coloured walls".into(), &values, 1.0, 0.0))
}

/// The grid of [`cross_coloured_walls`]: red to +x, green to −x.
///
/// # Errors
///
/// As [`bake`].
pub fn cross_coloured_grid(photons: u64, seed: u64) -> Result<IrradianceGrid, BakeError> {
    let mut builder = SceneBuilder::default();
    let coloured = |albedo: Vec3| Material { albedo, two_sided: false, ..Material::default() };
    let [red, green, black] =
        [Vec3::X * 0.8, Vec3::Y * 0.8, Vec3::ZERO].map(|albedo| builder.any_material(coloured(albedo)));
    builder.quad(Vec3::X, Vec3::Z, Vec3::Y, red);
    builder.quad(Vec3::ZERO, Vec3::Y, Vec3::Z, green);
    builder.quad(Vec3::ZERO, Vec3::X, Vec3::Y, black);
    builder.quad(Vec3::Z, Vec3::Y, Vec3::X, black);
    builder.light(LightKind::Point { position: DVec3::splat(0.5), intensity: Vec3::ONE });
    let (scene, flat) = builder.build();
    let bounds = Some((DVec3::splat(0.2), DVec3::splat(0.8)));
    let options = BakeOptions { dims: [4; 3], bounds, photons, seed, ..BakeOptions::default() };
    bake(&scene, &flat, &plan(&scene, 1), &options, &Silent).map(|result| result.grid)
}

fn seeds(value: impl Fn(u64) -> Result<f64, BakeError>) -> Result<Vec<f64>, BakeError> {
    (1..=SEEDS).map(value).collect()
}

/// Mean over all vertices of I_d·d of a hemisphere, green.
fn mean_along(grid: &IrradianceGrid, hemisphere: usize) -> f64 {
    let values = grid.vectors().iter().map(|v| f64::from(v[hemisphere][1][hemisphere / 2].abs()));
    values.sum::<f64>() / grid.vertex_count() as f64
}
