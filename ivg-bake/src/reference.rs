//! The oracle: a slow, obvious path tracer for irradiance at points and for pictures.
//!
//! It shares rays and materials with the baker, and nothing else: light is followed from the eye to the lights, lights
//! are sampled at every surface, and nothing is averaged over cells. Its results carry their standard error and depend
//! on the seed alone, not on threads.

use core::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};
use ivg_grid::harmonics::COEFFICIENTS;
use ivg_scene::{Camera, FlatScene, Scene};

use crate::estimate::gather::{Batches, Known, Mean};
use crate::estimate::vertex_gather::{self, RADIANCE_NUMBERS, VECTOR_NUMBERS};
use crate::overlap::closest_point;
use crate::sampling::rng::{Purpose, Stream};
use crate::stage::{Effects, Stage};
use crate::workers::{Workers, map};
use crate::{BakeError, Monitor};

mod brightness;

pub use brightness::{Brightness, DARKEST, LitPlace, brightness_of};

/// A path tracer over a scene.
#[derive(Debug)]
pub struct Oracle<'a> {
    stage: Stage<'a>,
}

/// How much to sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sampling {
    /// Paths for each point or pixel, at least 2 where a standard error is wanted.
    pub paths: u32,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Worker threads, at least 1; `None`: one for each core.
    pub threads: Option<usize>,
}

/// Irradiance vectors at a point, `[hemisphere][rgb][xyz]` \[W/m²\], hemispheres +x −x +y −y +z −z.
#[derive(Debug, Clone, PartialEq)]
pub struct GatheredVectors {
    /// The estimate.
    pub vectors: [[[f64; 3]; 3]; 6],
    /// Its standard error, component by component.
    pub standard_error: [[[f64; 3]; 3]; 6],
}

/// Irradiance of a surface at a point, linear RGB \[W/m²\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GatheredIrradiance {
    /// The estimate.
    pub irradiance: DVec3,
    /// Its standard error.
    pub standard_error: DVec3,
}

/// Indirect light at a point, all of it gathered from the same paths.
#[derive(Debug, Clone, PartialEq)]
pub struct GatheredLight {
    /// Irradiance vectors, `[hemisphere][rgb][xyz]` \[W/m²\].
    pub vectors: [[[f64; 3]; 3]; 6],
    /// Spherical harmonics of the radiance to degree 2, `[rgb][coefficient]` \[W/(m² sr)\].
    pub radiance: [[f64; COEFFICIENTS]; 3],
    /// Irradiance for each of the normals asked for \[W/m²\].
    pub irradiance: Vec<DVec3>,
    /// Standard error of the irradiance for each of the normals \[W/m²\].
    pub irradiance_error: Vec<DVec3>,
}

/// Batches that the paths of a point are divided into: the standard error is that of the means of so many.
const BATCHES: u32 = 16;

/// Which light a picture shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    /// Everything.
    All,
    /// Only what the grid stands for: light reflected at least once before the surface seen, and the sky's.
    Indirect,
}

/// Indirect light that is known at surfaces, as from a grid: what [`Oracle::render_gathering`] ends its paths with.
pub struct KnownLight<'a> {
    /// Indirect irradiance of a surface at a point in world space \[m\] with a unit normal, light of the sky included: linear RGB
    /// \[W/m²\].
    pub irradiance: &'a (dyn Fn(DVec3, Vec3) -> Vec3 + Sync),
    /// A flight shorter than this goes on from the surface that it meets \[m\]. An edge of a grid's cell keeps the grid's errors
    /// in corners out of the picture.
    pub shortest_flight: f64,
}

impl core::fmt::Debug for KnownLight<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("KnownLight").field("shortest_flight", &self.shortest_flight).finish_non_exhaustive()
    }
}

/// A picture: linear RGB radiance \[W/(m² sr)\], row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Width \[pixels\].
    pub width: u32,
    /// Height \[pixels\].
    pub height: u32,
    /// `width * height` pixels.
    pub pixels: Vec<[f32; 3]>,
}

impl<'a> Oracle<'a> {
    /// A tracer over a scene, with everything in it: textures, sky, mirrors, glass.
    ///
    /// What it cannot find is light of point, spot and directional lights that a mirror or a solid of glass sends on: no
    /// path from a point meets such a light by chance. It finds it through panes.
    ///
    /// # Errors
    ///
    /// [`BakeError::NoLight`], [`BakeError::BadNumber`], [`BakeError::BadIndex`], [`BakeError::TreeTooDeep`].
    pub fn new(scene: &'a Scene, flat: &'a FlatScene) -> Result<Self, BakeError> {
        Ok(Self { stage: Stage::new(scene, flat, Effects::of_scene(scene, flat), None)? })
    }

    /// The indirect irradiance vectors at points in world space \[m\].
    ///
    /// # Errors
    ///
    /// [`BakeError::Cancelled`]; the monitor's progress counts points.
    pub fn irradiance_vectors(
        &self,
        points: &[DVec3],
        sampling: Sampling,
        monitor: &dyn Monitor,
    ) -> Result<Vec<GatheredVectors>, BakeError> {
        self.points(points.len(), sampling, monitor, |index| {
            let point = self.stage.space.to_bake(points[index]);
            let mut mean = Mean::<54>::default();
            for path in 0..sampling.paths {
                mean.add(&self.stage.sample_vectors(point, &stream(sampling, index, path)));
            }
            let shape = |flat: [f64; 54]| {
                core::array::from_fn(|h| {
                    core::array::from_fn(|c| core::array::from_fn(|k| flat[9 * h + 3 * c + k]))
                })
            };
            GatheredVectors { vectors: shape(mean.mean()), standard_error: shape(mean.standard_error()) }
        })
    }

    /// The indirect irradiance of surfaces with unit normals at points in world space \[m\]: pairs (point, normal). A
    /// point should lie a little off its surface.
    ///
    /// # Errors
    ///
    /// [`BakeError::Cancelled`]; the monitor's progress counts points.
    pub fn irradiance(
        &self,
        places: &[(DVec3, Vec3)],
        sampling: Sampling,
        monitor: &dyn Monitor,
    ) -> Result<Vec<GatheredIrradiance>, BakeError> {
        self.points(places.len(), sampling, monitor, |index| {
            let (point, normal) = places[index];
            let point = self.stage.space.to_bake(point);
            let mut mean = Mean::<3>::default();
            for path in 0..sampling.paths {
                let sample = self.stage.sample_irradiance(point, normal, &stream(sampling, index, path));
                mean.add(&sample.to_array());
            }
            GatheredIrradiance {
                irradiance: mean.mean().into(),
                standard_error: mean.standard_error().into(),
            }
        })
    }

    /// The indirect light at points in world space \[m\]: irradiance vectors, spherical harmonics and the irradiance for each of
    /// some unit `normals`, from the same paths.
    ///
    /// The paths are divided into 16 batches (so their number is rounded up to a multiple of 16), in each of which the
    /// first directions are spread evenly over the sphere.
    ///
    /// # Errors
    ///
    /// [`BakeError::Cancelled`]; the monitor's progress counts points.
    pub fn light(
        &self,
        points: &[DVec3],
        normals: &[Vec3],
        sampling: Sampling,
        monitor: &dyn Monitor,
    ) -> Result<Vec<GatheredLight>, BakeError> {
        let normals: Vec<DVec3> = normals.iter().map(|n| n.as_dvec3()).collect();
        let count = sampling.paths.div_ceil(BATCHES);
        self.points(points.len(), sampling, monitor, |index| {
            let point = self.stage.space.to_bake(points[index]);
            let mut batches = Batches::new(VECTOR_NUMBERS + RADIANCE_NUMBERS + 3 * normals.len());
            for batch in 0..BATCHES {
                let first = stream(sampling, index, batch * count);
                let [_, _, u, v] = first.uniforms(0, Purpose::Gather);
                batches.add(count, |path, sums| {
                    let stream = stream(sampling, index, batch * count + path);
                    let (w, radiance) = self.stage.sample_even(point, (path, count), [u, v], &stream);
                    add_light(sums, w, radiance * (4.0 * PI), &normals);
                });
            }
            gathered(&batches)
        })
    }

    /// Distance from a point in world space to the nearest surface \[m\]; infinite without triangles. Looks at every
    /// triangle.
    #[must_use]
    pub fn clearance(&self, point: DVec3) -> f64 {
        let point = self.stage.space.to_bake(point);
        let nearest =
            self.stage.surfaces.triangles().iter().fold(f32::INFINITY, |nearest, t| {
                nearest.min(closest_point(t, point).distance_squared(point))
            });
        f64::from(nearest.sqrt()) / self.stage.space.scale()
    }

    /// A picture of `width` × `height` pixels.
    ///
    /// # Errors
    ///
    /// [`BakeError::Cancelled`]; the monitor's progress counts pixels.
    pub fn render(
        &self,
        camera: &Camera,
        (width, height): (u32, u32),
        shown: Shown,
        sampling: Sampling,
        monitor: &dyn Monitor,
    ) -> Result<Picture, BakeError> {
        let eye = self.stage.space.to_bake(camera.eye);
        self.picture(camera, (width, height), sampling, monitor, |direction, stream| match shown {
            Shown::All => self.stage.radiance(eye, direction, stream, true),
            Shown::Indirect => self.reflected_indirect(eye, direction, stream),
        })
    }

    /// A picture of `width` × `height` pixels of all light, whose paths end at the second surface with light that is known
    /// there (final gathering, as RR-6983 has it): the errors of a grid are blurred by a reflection, for a fraction of the work
    /// of [`Oracle::render`].
    ///
    /// # Errors
    ///
    /// [`BakeError::Cancelled`]; the monitor's progress counts pixels.
    pub fn render_gathering(
        &self,
        camera: &Camera,
        size: (u32, u32),
        light: &KnownLight<'_>,
        sampling: Sampling,
        monitor: &dyn Monitor,
    ) -> Result<Picture, BakeError> {
        let space = self.stage.space;
        let eye = space.to_bake(camera.eye);
        let known = Known {
            irradiance: &|point, normal| (light.irradiance)(space.to_world(point), normal),
            shortest_flight: (light.shortest_flight * space.scale()) as f32,
        };
        self.picture(camera, size, sampling, monitor, |direction, stream| {
            self.stage.radiance_until(eye, direction, stream, true, Some(&known))
        })
    }

    /// A picture of which each pixel is the mean of `sample`, given a direction from the eye.
    fn picture(
        &self,
        camera: &Camera,
        (width, height): (u32, u32),
        sampling: Sampling,
        monitor: &dyn Monitor,
        sample: impl Fn(Vec3, &Stream) -> DVec3 + Sync,
    ) -> Result<Picture, BakeError> {
        let view = View::new(camera, f64::from(width) / f64::from(height.max(1)));
        let pixels = self.points(width as usize * height as usize, sampling, monitor, |pixel| {
            let (x, y) = (pixel as u32 % width, pixel as u32 / width);
            let mut sum = DVec3::ZERO;
            for path in 0..sampling.paths {
                let stream = stream(sampling, pixel, path);
                let u = stream.uniforms(0, Purpose::Gather);
                let place = |at: u32, jitter: f32, size: u32| {
                    (f64::from(at) + f64::from(jitter)) / f64::from(size) * 2.0 - 1.0
                };
                let direction = view.direction(place(x, u[0], width), -place(y, u[1], height));
                sum += sample(direction, &stream);
            }
            (sum / f64::from(sampling.paths)).as_vec3().to_array()
        })?;
        Ok(Picture { width, height, pixels })
    }

    /// Indirect light that the surface seen reflects, as the client draws it from the grid.
    fn reflected_indirect(&self, eye: Vec3, direction: Vec3, stream: &Stream) -> DVec3 {
        let Some(hit) = self.stage.accel.closest_hit(eye, direction, f32::MAX) else { return DVec3::ZERO };
        let point = self.stage.surfaces.point(hit.triangle, hit.weights);
        let albedo = self.stage.surfaces.albedo(&hit).as_dvec3();
        let side = point.facing(-direction);
        // Step 0 of the purpose "gather" chose the pixel's place; the words beyond are free for the direction.
        let u = stream.uniforms(0, Purpose::Gather);
        let next = crate::sampling::hemisphere::cosine(side, [u[2], u[3]]);
        albedo * self.stage.radiance(point.origin(side), next, stream, false)
    }

    fn points<T: Send>(
        &self,
        count: usize,
        sampling: Sampling,
        monitor: &dyn Monitor,
        function: impl Fn(usize) -> T + Sync,
    ) -> Result<Vec<T>, BakeError> {
        let cores = || std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let threads = sampling.threads.unwrap_or_else(cores).max(1);
        let workers = Workers { threads, monitor, total_photons: count as u64 };
        let done = std::sync::atomic::AtomicU64::new(0);
        map(&workers, count, |index| {
            let value = function(index);
            let done = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
            monitor.progress(done, count as u64);
            value
        })
    }
}

/// Adds light from direction `w` \[W/m²\] to the numbers of a point: vectors, harmonics, irradiance for each normal.
fn add_light(sums: &mut [f64], w: DVec3, light: DVec3, normals: &[DVec3]) {
    let (numbers, irradiance) = sums.split_at_mut(VECTOR_NUMBERS + RADIANCE_NUMBERS);
    vertex_gather::add_light(numbers, w, light);
    for (sums, normal) in irradiance.chunks_exact_mut(3).zip(normals) {
        let cos = normal.dot(w).max(0.0);
        sums.iter_mut().zip(light.to_array()).for_each(|(sum, light)| *sum += light * cos);
    }
}

fn gathered(batches: &Batches) -> GatheredLight {
    let mean = batches.mean();
    let (vectors, rest) = mean.split_at(VECTOR_NUMBERS);
    let (harmonics, irradiance) = rest.split_at(RADIANCE_NUMBERS);
    let triples = |numbers: &[f64]| numbers.chunks_exact(3).map(DVec3::from_slice).collect();
    GatheredLight {
        vectors: core::array::from_fn(|h| {
            core::array::from_fn(|c| core::array::from_fn(|k| vectors[9 * h + 3 * c + k]))
        }),
        radiance: core::array::from_fn(|c| core::array::from_fn(|n| harmonics[COEFFICIENTS * c + n])),
        irradiance: triples(irradiance),
        irradiance_error: triples(&batches.standard_error()[VECTOR_NUMBERS + RADIANCE_NUMBERS..]),
    }
}

fn stream(sampling: Sampling, index: usize, path: u32) -> Stream {
    Stream::new(sampling.seed, (index as u64) << 32 | u64::from(path))
}

/// Axes of a camera.
struct View {
    forward: DVec3,
    right: DVec3,
    up: DVec3,
}

impl View {
    fn new(camera: &Camera, aspect: f64) -> Self {
        let forward = (camera.target - camera.eye).normalize();
        let right =
            forward.cross(camera.up).try_normalize().unwrap_or_else(|| forward.any_orthonormal_vector());
        let half = libm::tan(0.5 * f64::from(camera.vertical_fov).min(TAU / 2.0));
        Self { forward, right: right * (half * aspect), up: right.cross(forward) * half }
    }

    /// Through a place of the picture: x to the right and y upwards, both in [-1, 1].
    fn direction(&self, x: f64, y: f64) -> Vec3 {
        (self.forward + self.right * x + self.up * y).normalize().as_vec3()
    }
}

#[cfg(test)]
mod tests;
