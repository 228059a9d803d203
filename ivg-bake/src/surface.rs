//! What a ray finds where it hits: position with its error bound, geometric normal, albedo, emission.

use glam::{Vec2, Vec3};
use ivg_scene::{FlatScene, Material, Scene};

use crate::BakeError;
use crate::accel::Hit;
use crate::lobes::LobeTable;
use crate::space::Space;
use crate::stage::Effects;

/// The surfaces of a scene in bake space.
///
/// Every surface reflects on both sides in the same way, whatever way its triangles are wound: a wall seen from behind is a
/// wall. Where the plan needs mirrors or glass and there are any, `lobes` tells what surfaces do besides reflecting evenly. [`Material::two_sided`] decides about emission only: a one-sided emitter is dark
/// behind. A black one (a rectangle of a lights file) therefore stops light on both sides like a black panel of its
/// size.
#[derive(Debug)]
pub(crate) struct Surfaces<'a> {
    scene: &'a Scene,
    flat: &'a FlatScene,
    triangles: Vec<[Vec3; 3]>,
    normals: Vec<Vec3>,
    textured: bool,
    /// What surfaces do with light, where some do more than reflect it evenly.
    lobes: Option<LobeTable>,
}

/// A point of a surface, and how far its computed position may be from the true one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurfacePoint {
    /// Position in bake space.
    pub(crate) position: Vec3,
    /// Geometric normal, unit length, out of the front.
    pub(crate) normal: Vec3,
    /// Bound of the error of each coordinate, and of the distance of a hit from a ray that starts nearby.
    error: f32,
}

/// Roundings in interpolating a position from three corners (Pharr, Jakob, Humphreys, "Physically based rendering",
/// 4th edition, section 6.8.4: gamma(7)), relative to the largest coordinate of the corners. A bound for each axis by itself
/// would be zero for a wall in a coordinate plane, but the sheared triangle test mixes the axes, so that its error is
/// as large as that of the worst one.
const POSITION_ROUNDINGS: f32 = 7.0;

/// How much farther than the error bound a new ray starts, so that the rounding of the next triangle test is covered as well:
/// its coordinates are differences, up to twice as large, and are multiplied and added twice more.
const ORIGIN_MARGIN: f32 = 8.0;

impl<'a> Surfaces<'a> {
    /// Takes the scene's triangles into bake space, with the `effects` that are simulated.
    ///
    /// # Errors
    ///
    /// [`BakeError::BadIndex`] and [`BakeError::BadNumber`] name what in the scene cannot be used.
    pub(crate) fn new(
        scene: &'a Scene,
        flat: &'a FlatScene,
        space: Space,
        effects: Effects,
    ) -> Result<Self, BakeError> {
        check(scene, flat)?;
        let place = |index: u32| space.to_bake(flat.origin + flat.positions[index as usize].as_dvec3());
        let triangles: Vec<[Vec3; 3]> = flat.triangles.iter().map(|t| t.map(place)).collect();
        let normals = triangles.iter().map(geometric_normal).collect();
        let lobes = LobeTable::new(scene, flat, effects);
        Ok(Self { scene, flat, triangles, normals, textured: effects.textures, lobes })
    }

    /// All triangles in bake space.
    pub(crate) fn triangles(&self) -> &[[Vec3; 3]] {
        &self.triangles
    }

    /// Area of a triangle \[bake units²\].
    pub(crate) fn area(&self, triangle: u32) -> f64 {
        let [a, b, c] = self.triangles[triangle as usize].map(Vec3::as_dvec3);
        0.5 * (b - a).cross(c - a).length()
    }

    /// What surfaces do with light besides reflecting it evenly; `None` if none does anything else.
    #[inline]
    pub(crate) fn lobes(&self) -> Option<&LobeTable> {
        self.lobes.as_ref()
    }

    /// Index of the material of a triangle.
    #[inline]
    pub(crate) fn material_index(&self, triangle: u32) -> u32 {
        self.flat.triangle_materials[triangle as usize]
    }

    /// The material of a triangle.
    #[inline]
    pub(crate) fn material(&self, triangle: u32) -> &'a Material {
        &self.scene.materials[self.material_index(triangle) as usize]
    }

    /// The triangles that stop sight, each in its place; those that do not, panes, are points. `None` if all do.
    pub(crate) fn without_panes(&self) -> Option<Vec<[Vec3; 3]>> {
        let lobes = self.lobes.as_ref()?;
        self.without(|triangle| lobes.is_pane(self.flat, triangle))
    }

    /// The triangles that stop light, each in its place; those that do not, glass, are points. `None` if all do.
    pub(crate) fn without_glass(&self) -> Option<Vec<[Vec3; 3]>> {
        let lobes = self.lobes.as_ref()?;
        self.without(|triangle| lobes.lets_light_through(self.flat, triangle))
    }

    fn without(&self, which: impl Fn(usize) -> bool) -> Option<Vec<[Vec3; 3]>> {
        let keep = |(t, corners): (usize, &[Vec3; 3])| if which(t) { [Vec3::ZERO; 3] } else { *corners };
        let any = (0..self.triangles.len()).any(&which);
        any.then(|| self.triangles.iter().enumerate().map(keep).collect())
    }

    /// Whether any light goes on from a hit.
    pub(crate) fn sends_on(&self, hit: &Hit) -> bool {
        self.albedo(hit).max_element() > 0.0
            || self.lobes.as_ref().is_some_and(|l| l.is_more_than_diffuse(self.material_index(hit.triangle)))
    }

    /// The point of a triangle with barycentric `weights`.
    #[inline]
    pub(crate) fn point(&self, triangle: u32, weights: [f32; 3]) -> SurfacePoint {
        SurfacePoint::new(&self.triangles[triangle as usize], self.normals[triangle as usize], weights)
    }

    /// Unit normal of a triangle's front.
    pub(crate) fn normal(&self, triangle: u32) -> Vec3 {
        self.normals[triangle as usize]
    }

    /// The diffuse albedo at a point of a triangle, linear RGB.
    #[inline]
    pub(crate) fn albedo(&self, hit: &Hit) -> Vec3 {
        let material = self.material(hit.triangle);
        match material.albedo_texture {
            Some(texture) if self.textured => material.albedo * self.sample(texture, hit),
            _ => material.albedo,
        }
    }

    /// The colour of the albedo texture at a point of a triangle, linear RGB; white without one.
    pub(crate) fn texture(&self, hit: &Hit) -> Vec3 {
        match self.material(hit.triangle).albedo_texture {
            Some(texture) if self.textured => self.sample(texture, hit),
            _ => Vec3::ONE,
        }
    }

    #[inline]
    fn sample(&self, texture: u32, hit: &Hit) -> Vec3 {
        let corners = self.flat.triangles[hit.triangle as usize];
        let uv = corners
            .iter()
            .zip(hit.weights)
            .fold(Vec2::ZERO, |uv, (&corner, weight)| uv + self.flat.uvs[corner as usize] * weight);
        self.scene.textures[texture as usize].sample(uv)
    }

    /// Radiance that a triangle emits towards the unit direction `towards` \[W/(m² sr)\].
    #[inline]
    pub(crate) fn emission(&self, triangle: u32, normal: Vec3, towards: Vec3) -> Vec3 {
        let material = self.material(triangle);
        if material.two_sided || normal.dot(towards) > 0.0 { material.emission } else { Vec3::ZERO }
    }
}

impl SurfacePoint {
    /// The point of a triangle with unit `normal` that has barycentric `weights`.
    #[inline]
    pub(crate) fn new([a, b, c]: &[Vec3; 3], normal: Vec3, weights: [f32; 3]) -> Self {
        let reach = a.abs().max(b.abs()).max(c.abs()).max_element();
        let gamma = POSITION_ROUNDINGS * (f32::EPSILON / 2.0);
        let position = a * weights[0] + b * weights[1] + c * weights[2];
        Self { position, normal, error: reach * gamma }
    }

    /// The normal on the side of `towards`.
    #[inline]
    pub(crate) fn facing(&self, towards: Vec3) -> Vec3 {
        if self.normal.dot(towards) < 0.0 { -self.normal } else { self.normal }
    }

    /// Where a ray that leaves on the side of the unit vector `side` (the normal or its opposite) starts: far enough
    /// out that rounding cannot put it behind the surface.
    #[inline]
    pub(crate) fn origin(&self, side: Vec3) -> Vec3 {
        self.position + side * (ORIGIN_MARGIN * self.error)
    }
}

/// Unit normal of a triangle's front; in f64, since the area of a tiny triangle may be less than f32 holds.
fn geometric_normal([a, b, c]: &[Vec3; 3]) -> Vec3 {
    let [a, b, c] = [a.as_dvec3(), b.as_dvec3(), c.as_dvec3()];
    (b - a).cross(c - a).normalize_or_zero().as_vec3()
}

/// Checks what the tracer relies on.
fn check(scene: &Scene, flat: &FlatScene) -> Result<(), BakeError> {
    for material in &scene.materials {
        let object = || format!("material {}", material.name);
        usable(material.albedo, 1.0, "albedo", object)?;
        usable(material.emission, f32::MAX, "emission", object)?;
        usable(material.specular_colour * material.specular, 1.0, "mirror reflection", object)?;
        usable(Vec3::splat(material.roughness), 1.0, "roughness", object)?;
        usable(material.transmission_colour, 1.0, "colour of transmission", object)?;
        usable(Vec3::splat(material.transmission), 1.0, "transmission", object)?;
        usable(Vec3::splat(material.refractive_index - 1.0), f32::MAX, "index of refraction less 1", object)?;
    }
    if let Some(sky) = scene.sky {
        usable(sky, f32::MAX, "radiance", || "sky".into())?;
    }
    if let Some(sky) = &scene.sky_image {
        let object = || format!("sky image {}", sky.name);
        if sky.texels.is_empty() || sky.texels.len() as u64 != u64::from(sky.width) * u64::from(sky.height) {
            let value = format!("{} texels", sky.texels.len());
            return Err(BakeError::BadNumber { object: object(), what: "size", value });
        }
        usable(Vec3::splat(sky.rotation.abs()), f32::MAX, "rotation", object)?;
        sky.texels.iter().try_for_each(|t| usable(Vec3::from_array(*t), f32::MAX, "radiance", object))?;
    }
    if let Some((index, position)) = flat.positions.iter().enumerate().find(|(_, p)| !p.is_finite()) {
        let object = format!("vertex {index}");
        return Err(BakeError::BadNumber { object, what: "position", value: position.to_string() });
    }
    for (triangle, corners) in flat.triangles.iter().enumerate() {
        if let Some(&index) = corners.iter().find(|&&i| i as usize >= flat.positions.len()) {
            return Err(BakeError::BadIndex { triangle, what: "vertex", index });
        }
        let index = flat.triangle_materials.get(triangle).copied().unwrap_or(u32::MAX);
        let Some(material) = scene.materials.get(index as usize) else {
            return Err(BakeError::BadIndex { triangle, what: "material", index });
        };
        match material.albedo_texture {
            Some(index) if index as usize >= scene.textures.len() => {
                return Err(BakeError::BadIndex { triangle, what: "texture", index });
            }
            Some(_) if flat.uvs.len() < flat.positions.len() => {
                return Err(BakeError::BadIndex { triangle, what: "texture coordinate", index: corners[0] });
            }
            _ => {}
        }
    }
    Ok(())
}

/// Checks that each channel is a number from 0 to `most`.
pub(crate) fn usable(
    colour: Vec3,
    most: f32,
    what: &'static str,
    object: impl FnOnce() -> String,
) -> Result<(), BakeError> {
    let good = colour.is_finite() && colour.min_element() >= 0.0 && colour.max_element() <= most;
    if good {
        Ok(())
    } else {
        Err(BakeError::BadNumber { object: object(), what, value: colour.to_string() })
    }
}
