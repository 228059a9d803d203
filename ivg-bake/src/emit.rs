//! Where light comes from: photons leaving the lights in proportion to power, and light sampled from a point.

use core::f64::consts::PI;

use glam::{DVec3, Vec3};
use ivg_scene::{LightKind, Scene};

use crate::BakeError;
use crate::sampling::hemisphere;
use crate::sampling::light::AliasTable;
use crate::sampling::rng::{Purpose, Stream, unit};
use crate::sampling::sky::SkyTable;
use crate::space::Space;
use crate::surface::{SurfacePoint, Surfaces, usable};

/// All lights of a scene.
#[derive(Debug)]
pub(crate) struct Emitters {
    lights: Vec<Emitter>,
    choice: AliasTable,
    /// Lights that a point can be lit by from one place or direction: all but an even sky.
    placed: Vec<usize>,
    placed_choice: AliasTable,
    placed_power: f64,
    total: f64,
    sky: Vec3,
    sky_image: Option<SkyTable>,
    /// Share of the power that comes from the sky.
    sky_share: f64,
    /// Metres per bake unit.
    metre: f64,
    near: f32,
    world: Sphere,
}

/// A sphere around everything, in bake space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sphere {
    pub(crate) centre: Vec3,
    pub(crate) radius: f32,
}

#[derive(Clone, Copy, Debug)]
struct Emitter {
    kind: Kind,
    /// Power of the brightest channel \[W\].
    power: f64,
    /// Power of each channel as a share of `power`, in [0, 1].
    colour: Vec3,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Triangle { corners: [Vec3; 3], normal: Vec3, two_sided: bool, radiance: Vec3, area: f64 },
    Point { position: Vec3, intensity: Vec3 },
    Spot { position: Vec3, axis: Vec3, intensity: Vec3, cos_inner: f32, cos_outer: f32 },
    Directional { direction: Vec3, irradiance: Vec3 },
    Sky,
    SkyImage,
}

/// A photon as it leaves a light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Emission {
    /// Start in bake space, off the light's own surface.
    pub(crate) origin: Vec3,
    /// Unit direction of flight.
    pub(crate) direction: Vec3,
    /// Power as a share of [`Emitters::total_power`] / photons, each channel in [0, 1].
    pub(crate) power: Vec3,
    /// Whether the flight up to the first surface belongs into the grid: only the sky's does.
    pub(crate) deposit_first: bool,
}

/// Light that would arrive at a point from a place on a light, if nothing is in between.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrival {
    /// Unit direction to where the light comes from.
    pub(crate) direction: Vec3,
    /// How far that is \[bake units\].
    pub(crate) distance: f32,
    /// Irradiance on a surface facing the direction, divided by the probability of the choice \[W/m²\].
    pub(crate) irradiance: Vec3,
    /// Cosine at which the light leaves its surface, in (0, 1]; 1 where it has none.
    pub(crate) cosine: f32,
    /// Whether it comes from the image of a sky.
    pub(crate) from_sky: bool,
    /// Whether it comes from a surface that is [near](Emitters::near).
    pub(crate) near: bool,
}

/// How much short of a light's surface a shadow ray ends, as a share of its length.
const SHADOW_END: f32 = 1.0 - 1e-4;

/// Surfaces that shine count as near at up to this share of the square root of all their area. Chosen from such a distance, the
/// whole of them at once makes at most 16 times as bright as their radiance everywhere around would.
const NEAR_SHARE: f64 = 0.25;

impl Emitters {
    /// Collects the lights of a scene. `world` must contain all triangles and the lattice; `with_sky`: whether the sky
    /// is simulated.
    ///
    /// # Errors
    ///
    /// [`BakeError::NoLight`], [`BakeError::BadNumber`].
    pub(crate) fn new(
        scene: &Scene,
        surfaces: &Surfaces<'_>,
        space: Space,
        world: Sphere,
        with_sky: bool,
    ) -> Result<Self, BakeError> {
        let metre = 1.0 / space.scale();
        let disk = PI * f64::from(world.radius).powi(2) * metre * metre;
        let mut lights = Vec::new();
        let mut shining = 0.0;
        let mut add = |kind: Kind, power: DVec3| {
            let brightest = power.max_element();
            if brightest > 0.0 {
                lights.push(Emitter { kind, power: brightest, colour: (power / brightest).as_vec3() });
            }
        };
        for index in (0u32..).take(surfaces.triangles().len()) {
            let material = surfaces.material(index);
            if material.emission != Vec3::ZERO {
                shining += surfaces.area(index);
                let area = surfaces.area(index) * metre * metre;
                let (radiance, two_sided) = (material.emission, material.two_sided);
                let (corners, normal) = (surfaces.triangles()[index as usize], surfaces.normal(index));
                let kind = Kind::Triangle { corners, normal, two_sided, radiance, area };
                add(kind, material.emitted_power(area));
            }
        }
        for light in &scene.lights {
            let (kind, power) = place(&light.kind, space, disk);
            let strength = match kind {
                Kind::Point { intensity, .. } | Kind::Spot { intensity, .. } => intensity,
                Kind::Directional { irradiance, .. } => irradiance,
                Kind::Triangle { .. } | Kind::Sky | Kind::SkyImage => Vec3::ZERO,
            };
            usable(strength, f32::MAX, "strength", || format!("light {}", light.name))?;
            add(kind, power);
        }
        let sky = if with_sky { scene.sky.unwrap_or(Vec3::ZERO) } else { Vec3::ZERO };
        // Radiance L from everywhere crosses a sphere's cross-section with 4 pi L from all directions together.
        add(Kind::Sky, 4.0 * PI * disk * sky.as_dvec3());
        let sky_image = scene.sky_image.as_ref().filter(|_| with_sky).map(SkyTable::new);
        let sky_image = sky_image.filter(|table| table.brightest() > 0.0);
        if let Some(table) = &sky_image {
            // Colours differ from texel to texel.
            add(Kind::SkyImage, DVec3::splat(disk * table.brightest()));
        }

        let powers: Vec<f64> = lights.iter().map(|l| l.power).collect();
        let placed: Vec<usize> =
            (0..lights.len()).filter(|&i| !matches!(lights[i].kind, Kind::Sky)).collect();
        let placed_powers: Vec<f64> = placed.iter().map(|&i| powers[i]).collect();
        let (choice, total) = (AliasTable::new(&powers), powers.iter().sum());
        if choice.is_empty() {
            return Err(BakeError::NoLight);
        }
        let (placed_choice, placed_power) = (AliasTable::new(&placed_powers), placed_powers.iter().sum());
        let outside = lights.iter().filter(|light| matches!(light.kind, Kind::Sky | Kind::SkyImage));
        let sky_share = outside.map(|light| light.power).sum::<f64>() / total;
        Ok(Self {
            lights,
            choice,
            placed,
            placed_choice,
            placed_power,
            total,
            sky,
            sky_image,
            sky_share,
            metre,
            near: (NEAR_SHARE * shining.sqrt()) as f32,
            world,
        })
    }

    /// Distance up to which a path had better meet surfaces that shine by chance: light from a place chosen on them grows
    /// with the inverse square of the distance, without bound where a light touches a wall \[bake units\].
    pub(crate) fn near(&self) -> f32 {
        self.near
    }

    /// The power that a photon of share 1 stands for, times the photon count \[W\]: the sum over lights of the power of
    /// the brightest channel.
    pub(crate) fn total_power(&self) -> f64 {
        self.total
    }

    /// Share of the photons that come from the sky, in [0, 1].
    pub(crate) fn sky_share(&self) -> f64 {
        self.sky_share
    }

    /// Radiance of the even sky that is simulated \[W/(m² sr)\].
    pub(crate) fn sky(&self) -> Vec3 {
        self.sky
    }

    /// Radiance of the image of a sky that is simulated, from the unit direction `towards` \[W/(m² sr)\]. It is among the
    /// lights of [`Emitters::arrive`].
    pub(crate) fn sky_image(&self, towards: Vec3) -> Vec3 {
        self.sky_image.as_ref().map_or(Vec3::ZERO, |table| table.radiance(towards))
    }

    /// A photon of `stream`. A light is chosen in proportion to the power of its brightest channel, so that no channel
    /// of a photon exceeds 1.
    #[inline]
    pub(crate) fn emit(&self, stream: &Stream) -> Emission {
        let [column, coin, side, _] = stream.words(0, Purpose::Light);
        let u = stream.uniforms(0, Purpose::Emission);
        let light = &self.lights[self.choice.draw(column, coin)];
        let (origin, direction, deposit_first) = match light.kind {
            Kind::Triangle { corners, normal, two_sided, .. } => {
                let point = SurfacePoint::new(&corners, normal, triangle_weights([u[0], u[1]]));
                let back = two_sided && side & 1 == 1;
                let normal = if back { -point.normal } else { point.normal };
                (point.origin(normal), hemisphere::cosine(normal, [u[2], u[3]]), false)
            }
            Kind::Point { position, .. } => (position, hemisphere::sphere([u[0], u[1]]), false),
            Kind::Spot { position, axis, cos_inner, cos_outer, .. } => {
                (position, hemisphere::about(axis, spot_cosine(u[0], cos_inner, cos_outer), u[1]), false)
            }
            Kind::Directional { direction, .. } => (self.start(direction, [u[0], u[1]]), direction, false),
            Kind::Sky => {
                let direction = hemisphere::sphere([u[0], u[1]]);
                (self.start(direction, [u[2], u[3]]), direction, true)
            }
            Kind::SkyImage => {
                let Some(table) = &self.sky_image else { unreachable!("the light comes with its table") };
                let (towards, colour) = table.draw(stream, 0);
                let origin = self.start(-towards, [u[2], u[3]]);
                return Emission { origin, direction: -towards, power: colour, deposit_first: true };
            }
        };
        Emission { origin, direction, power: light.colour, deposit_first }
    }

    /// A point on the disk of the world sphere's size, perpendicular to `direction` and before the sphere.
    fn start(&self, direction: Vec3, u: [f32; 2]) -> Vec3 {
        let [x, y] = hemisphere::disk(u);
        let (a, b) = hemisphere::basis(direction);
        self.world.centre + (a * x + b * y - direction) * self.world.radius
    }

    /// Light from one place on one light, chosen in proportion to power, as it arrives at `point` (bake space) if
    /// nothing is in between. `None` where that place sends nothing there. An even sky is not among these lights.
    #[inline]
    pub(crate) fn arrive(&self, point: Vec3, stream: &Stream, step: u32) -> Option<Arrival> {
        if self.placed_choice.is_empty() {
            return None;
        }
        let words = stream.words(step, Purpose::NextEvent);
        let light = &self.lights[self.placed[self.placed_choice.draw(words[0], words[1])]];
        let weight = self.placed_power / light.power;
        let towards = |place: Vec3| {
            let way = place - point;
            let distance = way.length();
            (distance > 0.0).then(|| (way / distance, distance))
        };
        let metres = |distance: f32| f64::from(distance) * self.metre;
        let mut cosine = 1.0;
        let (direction, distance, strength, factor) = match light.kind {
            Kind::Triangle { corners, normal, two_sided, radiance, area } => {
                let u = [words[2], words[3]].map(unit);
                let place = SurfacePoint::new(&corners, normal, triangle_weights(u));
                let (direction, distance) = towards(place.position)?;
                let cos = -place.normal.dot(direction);
                cosine = if two_sided { cos.abs() } else { cos.max(0.0) };
                (
                    direction,
                    distance * SHADOW_END,
                    radiance,
                    f64::from(cosine) * area / metres(distance).powi(2),
                )
            }
            Kind::Point { position, intensity } => {
                let (direction, distance) = towards(position)?;
                (direction, distance, intensity, 1.0 / metres(distance).powi(2))
            }
            Kind::Spot { position, axis, intensity, cos_inner, cos_outer } => {
                let (direction, distance) = towards(position)?;
                let factor = f64::from(spot_falloff(-axis.dot(direction), cos_inner, cos_outer));
                (direction, distance, intensity, factor / metres(distance).powi(2))
            }
            Kind::Directional { direction, irradiance } => (-direction, f32::MAX, irradiance, 1.0),
            Kind::SkyImage => {
                let table = self.sky_image.as_ref()?;
                let (towards, colour) = table.draw(stream, step);
                (towards, f32::MAX, colour, table.brightest())
            }
            Kind::Sky => return None,
        };
        let near = matches!(light.kind, Kind::Triangle { .. }) && distance < self.near * SHADOW_END;
        let irradiance = (strength.as_dvec3() * (factor * weight)).as_vec3();
        let from_sky = matches!(light.kind, Kind::SkyImage);
        (irradiance.max_element() > 0.0).then_some(Arrival {
            direction,
            distance,
            irradiance,
            cosine,
            from_sky,
            near,
        })
    }
}

/// A light of the scene file in bake space, with its power \[W\]; `disk` is the cross-section of the world \[m²\].
fn place(kind: &LightKind, space: Space, disk: f64) -> (Kind, DVec3) {
    match *kind {
        LightKind::Point { position, intensity } => {
            (Kind::Point { position: space.to_bake(position), intensity }, 4.0 * PI * intensity.as_dvec3())
        }
        LightKind::Spot { position, direction, intensity, inner_angle, outer_angle } => {
            let (inner, outer) = (libm::cos(f64::from(inner_angle)), libm::cos(f64::from(outer_angle)));
            // Full up to the inner angle; beyond, the mean of a squared ramp is a third.
            let solid_angle = 2.0 * PI * ((1.0 - inner) + (inner - outer).max(0.0) / 3.0);
            let kind = Kind::Spot {
                position: space.to_bake(position),
                axis: direction.normalize_or_zero(),
                intensity,
                cos_inner: inner as f32,
                cos_outer: outer.min(inner) as f32,
            };
            (kind, solid_angle * intensity.as_dvec3())
        }
        LightKind::Directional { direction, irradiance } => (
            Kind::Directional { direction: direction.normalize_or_zero(), irradiance },
            disk * irradiance.as_dvec3(),
        ),
    }
}

/// Barycentric weights of a point uniform over a triangle.
#[inline]
fn triangle_weights(u: [f32; 2]) -> [f32; 3] {
    let root = u[0].sqrt();
    [1.0 - root, root * (1.0 - u[1]), root * u[1]]
}

/// Share of the axial intensity at cosine `cos` from a spot's axis (`KHR_lights_punctual`).
fn spot_falloff(cos: f32, cos_inner: f32, cos_outer: f32) -> f32 {
    if cos >= cos_inner {
        1.0
    } else if cos <= cos_outer {
        0.0
    } else {
        ((cos - cos_outer) / (cos_inner - cos_outer)).powi(2)
    }
}

/// The cosine from a spot's axis, with density in proportion to [`spot_falloff`]: the inverse of its integral.
fn spot_cosine(u: f32, cos_inner: f32, cos_outer: f32) -> f32 {
    let (full, ramp) = (1.0 - cos_inner, (cos_inner - cos_outer) / 3.0);
    let at = u * (full + ramp);
    if at < ramp {
        cos_outer + (cos_inner - cos_outer) * libm::cbrtf(at / ramp)
    } else {
        cos_inner + (at - ramp)
    }
}

#[cfg(test)]
mod tests;
