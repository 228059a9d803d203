//! Hard cases: scenes whose light is known in closed form or must obey a law, and what a bake makes of them.
//!
//! Each case is a plain function that says how far off the result is and what the bound was, so that tests and reports can
//! use the same ones. Bounds are derived where they stand.

use core::f64::consts::PI;

use glam::{DAffine3, DVec3, Vec3};
use ivg_grid::IrradianceGrid;
use ivg_scene::{
    Effect, EffectPlan, FlatScene, Light, LightKind, Material, Mesh, Need, Node, PlannedEffect, Scene,
    SkyImage,
};

use crate::{BakeError, BakeOptions, BakeResult, Silent, bake};

mod closed_forms;

pub use closed_forms::{
    cross_coloured_grid, cross_coloured_walls, furnace_on_lattice, lit_disk, parallel_plates,
};

/// What a case found.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Name of the case, with its parameter.
    pub name: String,
    /// What is right.
    pub expected: f64,
    /// What was found: the mean over the bakes of the case.
    pub measured: f64,
    /// How far off: the relative difference of the two, absolute where nothing is expected.
    pub figure: f64,
    /// The most that is right.
    pub bound: f64,
}

impl Outcome {
    /// Whether the case holds.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.figure.abs() <= self.bound
    }
}

/// Standard errors that a mean may be off. The standard error itself is estimated from [`SEEDS`] bakes, so that this is
/// Student's t with 7 degrees of freedom: 8 is exceeded with probability 1e-4.
const SIGMAS: f64 = 8.0;

/// Bakes of a case, with different seeds.
const SEEDS: u64 = 8;

/// Reflections followed where nothing but absorption should end a photon.
const UNLIMITED: u32 = 100_000;

/// Root mean square of the difference of the components along the axes of two grids of vectors, relative to that of the
/// second's.
///
/// # Panics
///
/// If a grid holds radiance harmonics.
#[must_use]
pub fn difference(a: &IrradianceGrid, b: &IrradianceGrid) -> f64 {
    let (mut difference, mut square) = (0.0, 0.0);
    for (a, b) in a.vectors().iter().zip(b.vectors()) {
        for n in 0..18 {
            let [a, b] = [a, b].map(|v| f64::from(v[n / 3][n % 3][n / 6]));
            difference += (a - b) * (a - b);
            square += b * b;
        }
    }
    (difference / square).sqrt()
}

/// A scene of one mesh under construction.
#[derive(Debug, Default)]
pub struct SceneBuilder {
    mesh: Mesh,
    scene: Scene,
}

impl SceneBuilder {
    /// Adds a material and returns its index.
    pub fn material(&mut self, albedo: f32, emission: f32, two_sided: bool) -> u32 {
        self.scene.materials.push(Material {
            name: format!("material {}", self.scene.materials.len()),
            albedo: Vec3::splat(albedo),
            emission: Vec3::splat(emission),
            two_sided,
            ..Material::default()
        });
        (self.scene.materials.len() - 1) as u32
    }

    /// Adds a material of any kind and returns its index.
    pub fn any_material(&mut self, material: Material) -> u32 {
        self.scene.materials.push(material);
        (self.scene.materials.len() - 1) as u32
    }

    /// Adds a triangle.
    pub fn triangle(&mut self, corners: [Vec3; 3], material: u32) {
        let first = self.mesh.positions.len() as u32;
        self.mesh.positions.extend(corners);
        self.mesh.triangles.push([first, first + 1, first + 2]);
        self.mesh.triangle_materials.push(material);
    }

    /// Adds a parallelogram whose front is on the side of u × v.
    pub fn quad(&mut self, corner: Vec3, u: Vec3, v: Vec3, material: u32) {
        self.triangle([corner, corner + u, corner + u + v], material);
        self.triangle([corner, corner + u + v, corner + v], material);
    }

    /// Adds a closed box from `low` to `high`, its fronts outside or inside.
    pub fn cuboid(&mut self, low: Vec3, high: Vec3, material: u32, fronts_inside: bool) {
        let size = high - low;
        for axis in 0..3 {
            let (mut u, mut v, mut across) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
            u[(axis + 1) % 3] = size[(axis + 1) % 3];
            v[(axis + 2) % 3] = size[(axis + 2) % 3];
            across[axis] = size[axis];
            let (near, far) = if fronts_inside { ((u, v), (v, u)) } else { ((v, u), (u, v)) };
            self.quad(low, near.0, near.1, material);
            self.quad(low + across, far.0, far.1, material);
        }
    }

    /// Adds a closed sphere of 8 · 4^`levels` triangles, its fronts outside or inside.
    pub fn sphere(&mut self, centre: Vec3, radius: f32, levels: u32, material: u32, fronts_inside: bool) {
        let mut faces: Vec<[Vec3; 3]> = Vec::new();
        for signs in 0..8 {
            let [x, y, z] = [0, 1, 2].map(|axis| if signs >> axis & 1 == 0 { 1.0 } else { -1.0 });
            let face = [Vec3::X * x, Vec3::Y * y, Vec3::Z * z];
            faces.push(if x * y * z > 0.0 { face } else { [face[0], face[2], face[1]] });
        }
        for _ in 0..levels {
            faces = faces
                .into_iter()
                .flat_map(|[a, b, c]| {
                    let [ab, bc, ca] = [a + b, b + c, c + a].map(Vec3::normalize);
                    [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
                })
                .collect();
        }
        for [a, b, c] in faces {
            let [a, b, c] = [a, b, c].map(|p| centre + p * radius);
            self.triangle(if fronts_inside { [a, c, b] } else { [a, b, c] }, material);
        }
    }

    /// Adds a light without a surface.
    pub fn light(&mut self, kind: LightKind) {
        let name = format!("light {}", self.scene.lights.len());
        self.scene.lights.push(Light { name, kind });
    }

    /// Gives the scene a sky of even radiance \[W/(m² sr)\].
    pub fn sky(&mut self, radiance: f32) {
        self.scene.sky = Some(Vec3::splat(radiance));
    }

    /// Gives the scene a sky whose image is `texels` of 2 columns and 2 rows: above and below, each left and right \[W/(m² sr)\].
    pub fn sky_image(&mut self, texels: [f32; 4]) {
        let texels = texels.map(|radiance| [radiance; 3]).to_vec();
        self.scene.sky_image =
            Some(SkyImage { name: "quarters".into(), width: 2, height: 2, rotation: 0.0, texels });
    }

    /// The scene, and all its triangles in world space.
    #[must_use]
    pub fn build(mut self) -> (Scene, FlatScene) {
        if !self.mesh.triangles.is_empty() {
            self.scene.meshes.push(self.mesh);
            let transform = DAffine3::IDENTITY;
            self.scene.nodes.push(Node { name: "case".into(), mesh: 0, transform });
        }
        let flat = self.scene.flatten();
        (self.scene, flat)
    }
}

/// A plan for diffuse indirect light, and mirrors, glass and a sky where the scene has them, followed for `max_bounces` reflections.
#[must_use]
pub fn plan(scene: &Scene, max_bounces: u32) -> EffectPlan {
    let planned = |effect, needed| PlannedEffect {
        effect,
        need: if needed { Need::Needed } else { Need::NotNeeded },
        reason: "a case".into(),
        cost: None,
    };
    EffectPlan {
        effects: vec![
            planned(Effect::DiffuseIndirect, true),
            planned(Effect::Mirrors, scene.materials.iter().any(|m| m.specular > 0.0)),
            planned(Effect::Glass, scene.materials.iter().any(|m| m.transmission > 0.0)),
            planned(Effect::Sky, scene.mean_sky().is_some()),
        ],
        max_bounces,
        energy_cutoff: 1e-3,
    }
}

/// A closed cube from 0 to 1 m whose walls reflect `albedo` and emit 1 W/(m² sr), and a lattice well inside: all light is
/// even, the indirect irradiance of anything is π ρ / (1 − ρ).
///
/// # Errors
///
/// As [`bake`].
pub fn white_furnace(albedo: f32, photons: u64, estimator: crate::Estimator) -> Result<Outcome, BakeError> {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(albedo, 1.0, false);
    builder.cuboid(Vec3::ZERO, Vec3::ONE, wall, true);
    let (scene, flat) = builder.build();
    let options = BakeOptions {
        dims: [4; 3],
        bounds: Some((DVec3::splat(0.2), DVec3::splat(0.8))),
        photons,
        estimator,
        ..BakeOptions::default()
    };
    let rho = f64::from(albedo);
    let expected = PI * rho / (1.0 - rho);
    let name = format!("white furnace of albedo {albedo}, {}", estimator.name());
    let plan = plan(&scene, UNLIMITED);
    // Light is even, so averaging over cells changes nothing: what is left is noise.
    compare_axes(name, expected, |seed| {
        bake(&scene, &flat, &plan, &BakeOptions { seed, ..options.clone() }, &Silent)
    })
}

/// An object of `albedo` in the open under an even sky of 1 W/(m² sr): light is even everywhere only if nothing is absorbed;
/// for other albedos the irradiance on a vertex far above is still at most π. At albedo 1 it is π everywhere.
///
/// # Errors
///
/// As [`bake`].
pub fn sky_furnace(photons: u64) -> Result<Outcome, BakeError> {
    let mut builder = SceneBuilder::default();
    let white = builder.material(1.0, 0.0, true);
    builder.sphere(Vec3::ZERO, 0.4, 3, white, false);
    builder.sky(1.0);
    let (scene, flat) = builder.build();
    let plan = plan(&scene, UNLIMITED);
    let options = BakeOptions {
        dims: [4; 3],
        bounds: Some((DVec3::splat(-0.9), DVec3::splat(0.9))),
        photons,
        ..BakeOptions::default()
    };
    compare_axes("white object under an even sky".into(), PI, |seed| {
        bake(&scene, &flat, &plan, &BakeOptions { seed, ..options.clone() }, &Silent)
    })
}

/// A ball of radius 0.4 m under an even sky of 1 W/(m² sr) that sends back a share `albedo` of the light, in whatever way.
///
/// From every direction comes radiance 1, but `albedo` from where the ball is; what is missing adds up to
/// (1 − a) π (R / D)² along the way from the ball, at a distance D from its middle, exactly. Returned is the share
/// missing, found from the net flux at all vertices that are 0.2 m or more off the ball, less 1 − a. Means over dual cells keep such a flux up to the
/// fourth order of their size.
///
/// # Errors
///
/// As [`bake`].
pub fn ball_under_sky(
    name: &str,
    material: Material,
    albedo: f64,
    photons: u64,
) -> Result<Outcome, BakeError> {
    const RADIUS: f64 = 0.4;
    let mut builder = SceneBuilder::default();
    let ball = builder.any_material(material);
    builder.sphere(Vec3::ZERO, RADIUS as f32, 4, ball, false);
    builder.sky(1.0);
    let (scene, flat) = builder.build();
    let plan = plan(&scene, UNLIMITED);
    let bounds = Some((DVec3::splat(-0.9), DVec3::splat(0.9)));
    let values = (1..=SEEDS)
        .map(|seed| {
            let options = BakeOptions { dims: [10; 3], bounds, photons, seed, ..BakeOptions::default() };
            let result = bake(&scene, &flat, &plan, &options, &Silent)?;
            let (mut product, mut square) = (0.0, 0.0);
            for (index, vectors) in result.grid.vectors().iter().enumerate() {
                let [i, j, k] = result.grid.lattice().coords(index as u64);
                let place = DVec3::from(result.grid.lattice().position(i, j, k));
                if place.length() < RADIUS + 0.2 {
                    continue;
                }
                let net = DVec3::from_array(core::array::from_fn(|axis| {
                    f64::from(vectors[2 * axis][1][axis] + vectors[2 * axis + 1][1][axis])
                }));
                let missing = place * (PI * RADIUS * RADIUS / place.length().powi(3));
                product += net.dot(missing);
                square += missing.length_squared();
            }
            Ok(product / square)
        })
        .collect::<Result<Vec<f64>, BakeError>>()?;
    // A ball of 2048 triangles is inside the round one by up to 0.4 % of the radius.
    let roundness = 0.01 * (1.0 - albedo);
    let mut found = outcome(name.into(), &values, 1.0 - albedo, 0.0);
    let unit = if albedo < 1.0 { 1.0 - albedo } else { 1.0 };
    // Of the light that the ball could take away.
    (found.figure, found.bound) = (found.figure * unit, found.bound * unit + roundness);
    Ok(found)
}

/// A spherical cavity of radius 1 m and albedo ρ with a black source of 5 cm in the middle: after the first reflection light
/// is even but for the source's shadow.
///
/// Exact for the polyhedron that stands for the sphere up to how far it is from round: the power balance uses its own
/// area, and 2048 faces deviate from the sphere by less than 0.4 % of the radius.
///
/// # Errors
///
/// As [`bake`].
pub fn spherical_cavity(albedo: f32, photons: u64) -> Result<Outcome, BakeError> {
    cavity_with_source(albedo, 0.05, 100.0, photons)
}

/// A [`spherical_cavity`] with a source of any radius \[m\] and radiance \[W/(m² sr)\], as small and as bright as you like.
///
/// # Errors
///
/// As [`bake`].
pub fn cavity_with_source(
    albedo: f32,
    source_radius: f64,
    radiance: f32,
    photons: u64,
) -> Result<Outcome, BakeError> {
    const ROUNDNESS: f64 = 4e-3;
    let mut builder = SceneBuilder::default();
    let wall = builder.material(albedo, 0.0, true);
    let source = builder.material(0.0, radiance, false);
    builder.sphere(Vec3::ZERO, 1.0, 4, wall, true);
    builder.sphere(Vec3::ZERO, source_radius as f32, 2, source, false);
    let (scene, flat) = builder.build();
    let areas: Vec<f64> = (0..flat.triangles.len()).map(|t| flat.area(t)).collect();
    let area = |material: u32| -> f64 {
        areas.iter().zip(&flat.triangle_materials).filter(|(_, m)| **m == material).map(|(a, _)| a).sum()
    };
    let (wall_area, source_area) = (area(wall), area(source));
    let (rho, power) = (f64::from(albedo), PI * source_area * f64::from(radiance));
    let radiosity = rho * power / wall_area / (1.0 - rho * (1.0 - source_area / wall_area));
    let plan = plan(&scene, UNLIMITED);
    let options = BakeOptions {
        dims: [3; 3],
        bounds: Some((DVec3::splat(0.2), DVec3::splat(0.5))),
        photons,
        ..BakeOptions::default()
    };
    // The source, 0.15 to 0.95 m away, takes less than a² / D² of the axis irradiance.
    let shadow = (source_radius / 0.2f64.hypot(0.2).hypot(0.2)).powi(2);
    let name = format!("spherical cavity of albedo {albedo}, source of {source_radius} m");
    let mut outcome = compare_axes(name, radiosity, |seed| {
        bake(&scene, &flat, &plan, &BakeOptions { seed, ..options.clone() }, &Silent)
    })?;
    outcome.bound += shadow + ROUNDNESS;
    Ok(outcome)
}

/// A rectangle of 1 × 0.5 m and albedo 1 lit squarely by parallel light of 1 W/m², and a vertex 1 m above its middle: what it
/// reflects there in closed form. The vertex has a small dual cell, over which the light changes by less than 0.1 %.
///
/// # Errors
///
/// As [`bake`].
pub fn lit_rectangle(photons: u64) -> Result<Outcome, BakeError> {
    let (scene, flat) = lit_rectangle_scene();
    let plan = plan(&scene, UNLIMITED);
    let around = DVec3::new(0.5, 0.25, 1.0);
    let options = BakeOptions {
        dims: [2; 3],
        // A dual cell as long as the bounds is the whole lattice's: the mean over eight of them is about the middle.
        bounds: Some((around - 0.025, around + 0.025)),
        photons,
        ..BakeOptions::default()
    };
    let expected = lit_rectangle_irradiance();
    let down = |result: &BakeResult| {
        let vectors = result.grid.vectors();
        -vectors.iter().map(|v| f64::from(v[5][1][2])).sum::<f64>() / vectors.len() as f64
    };
    let values = (1..=SEEDS)
        .map(|seed| bake(&scene, &flat, &plan, &BakeOptions { seed, ..options.clone() }, &Silent))
        .map(|result| result.map(|r| down(&r)))
        .collect::<Result<Vec<_>, _>>()?;
    // Over the block of cells, 0.1 m wide, E = E(1 m) (1 + c z + …): the second derivatives at this distance are of the
    // order of E itself, times 0.05² / 6 along three axes.
    Ok(outcome("rectangle in parallel light".into(), &values, expected, 3.0 * 0.05f64.powi(2) / 6.0 * 4.0))
}

/// The scene of [`lit_rectangle`].
#[must_use]
pub fn lit_rectangle_scene() -> (Scene, FlatScene) {
    let mut builder = SceneBuilder::default();
    let white = builder.material(1.0, 0.0, true);
    builder.quad(Vec3::ZERO, Vec3::X, Vec3::Y * 0.5, white);
    builder.light(LightKind::Directional { direction: Vec3::NEG_Z, irradiance: Vec3::ONE });
    builder.build()
}

/// Irradiance of a surface facing the rectangle of [`lit_rectangle`] from 1 m above its middle \[W/m²\].
#[must_use]
pub fn lit_rectangle_irradiance() -> f64 {
    let (x, y) = (0.5f64, 0.25f64);
    let term = |a: f64, b: f64| {
        let root = (1.0 + a * a).sqrt();
        a / root * libm::atan(b / root)
    };
    // Reflected radiance is 1/π.
    2.0 / PI * (term(x, y) + term(y, x))
}

/// Two closed rooms side by side, one lit red and one lit green, with a wall of `thickness` steps between them (0: a single
/// sheet): the mean red irradiance in the green room over that in the red one.
///
/// # Errors
///
/// As [`bake`].
pub fn leak_between_rooms(thickness: f64, photons: u64) -> Result<Outcome, BakeError> {
    const STEPS: u16 = 16;
    // The first vertex lies beyond the wall on its side, so that the wall between the rooms passes a third off the middle of a
    // cell and not between two.
    const FIRST: f64 = -1.04;
    let step = (1.0 - FIRST) / f64::from(STEPS - 1);
    let half = (0.5 * thickness * step) as f32;
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.7, 0.0, true);
    let [red, green] = [Vec3::X, Vec3::Y].map(|colour| {
        let lamp = builder.material(0.0, 10.0, false);
        builder.scene.materials[lamp as usize].emission *= colour;
        lamp
    });
    builder.cuboid(Vec3::new(-1.0, 0.0, 0.0), Vec3::new(-half, 1.0, 1.0), wall, true);
    builder.cuboid(Vec3::new(half, 0.0, 0.0), Vec3::ONE, wall, true);
    builder.quad(Vec3::new(-0.7, 0.8, 0.3), Vec3::X * 0.4, Vec3::Z * 0.4, red);
    builder.quad(Vec3::new(0.3, 0.8, 0.3), Vec3::X * 0.4, Vec3::Z * 0.4, green);
    let (scene, flat) = builder.build();
    let plan = plan(&scene, 64);
    let options = BakeOptions {
        dims: [STEPS, 8, 8],
        bounds: Some((DVec3::new(FIRST, 0.0, 0.0), DVec3::ONE)),
        photons,
        ..BakeOptions::default()
    };
    let result = bake(&scene, &flat, &plan, &options, &Silent)?;
    let lattice = result.grid.lattice();
    let (mut leaked, mut lit) = ((0.0, 0u32), (0.0, 0u32));
    for (index, vectors) in result.grid.vectors().iter().enumerate() {
        let [i, j, k] = lattice.coords(index as u64);
        let x = lattice.position(i, j, k)[0];
        // Vertices inside the wall are invalid.
        if !result.grid.is_valid(index) {
            continue;
        }
        let room = if x > 0.0 { &mut leaked } else { &mut lit };
        room.0 += (0..6).map(|h| f64::from(vectors[h][0][h / 2].abs())).sum::<f64>();
        room.1 += 1;
    }
    let mean = |(sum, count): (f64, u32)| sum / f64::from(count);
    // Nothing may be counted through a wall: what is left are flights that end a rounding of f32 too late.
    let name = format!("wall of {thickness} steps between rooms");
    let measured = mean(leaked) / mean(lit);
    Ok(Outcome { name, expected: 0.0, measured, figure: measured, bound: 1e-4 })
}

/// Compares the components along the hemispheres' axes, averaged over all valid vertices, with `expected` \[W/m²\].
fn compare_axes(
    name: String,
    expected: f64,
    bake: impl Fn(u64) -> Result<BakeResult, BakeError>,
) -> Result<Outcome, BakeError> {
    let values = (1..=SEEDS)
        .map(|seed| {
            let result = bake(seed)?;
            let (mut sum, mut count) = (0.0, 0u32);
            for (index, vectors) in result.grid.vectors().iter().enumerate() {
                if result.grid.is_valid(index) {
                    sum += (0..6).map(|h| f64::from(vectors[h][1][h / 2].abs())).sum::<f64>();
                    count += 6;
                }
            }
            Ok(sum / f64::from(count))
        })
        .collect::<Result<Vec<f64>, BakeError>>()?;
    Ok(outcome(name, &values, expected, 0.0))
}

/// The relative difference of a mean from what is expected, and [`SIGMAS`] standard errors and `bias` as its bound. Where
/// nothing is expected the difference is absolute.
fn outcome(name: String, values: &[f64], expected: f64, bias: f64) -> Outcome {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let unit = if expected == 0.0 { 1.0 } else { expected };
    let error = (variance / count).sqrt();
    let bound = SIGMAS * error / unit + bias;
    Outcome { name, expected, measured: mean, figure: (mean - expected) / unit, bound }
}

#[cfg(test)]
mod tests;
