//! How surfaces send light on where there is more than even reflection: mirrors, rough metals, glass.
//!
//! A surface is a mixture of [`Lobes`]; one is chosen by its share, and then what the chosen one keeps is a colour of at most 1
//! in each channel. So no photon grows, whatever the mixture. A scene without such surfaces has no [`LobeTable`], and its
//! rays are followed by code that does not know of it.

mod dielectric;
mod facets;

use glam::{Vec2, Vec3};
use ivg_scene::{FlatScene, Lobes, Scene, Side};

use crate::accel::Hit;
use crate::sampling::hemisphere;
use crate::sampling::rng::{Stream, unit};
use crate::stage::Effects;
use crate::surface::{SurfacePoint, Surfaces};
use facets::Facets;

/// Share of glass from which on a surface does not stop sight: more light passes it than it keeps apart.
const SEE_THROUGH: f32 = 0.5;

/// What all materials of a scene do with light, and which of its glass is solid.
#[derive(Debug)]
pub(crate) struct LobeTable {
    materials: Vec<Prepared>,
    /// What lies behind each triangle; empty without glass.
    sides: Vec<Side>,
}

#[derive(Debug)]
struct Prepared {
    lobes: Lobes,
    /// Nothing but even reflection.
    diffuse: bool,
    /// The rough mirror, where the material is one.
    facets: Option<Facets>,
    thin: bool,
}

/// What light does next at a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scattered {
    /// What is kept, each channel in [0, 1].
    pub(crate) colour: Vec3,
    /// Unit direction of flight.
    pub(crate) direction: Vec3,
    /// The side of the surface that the light leaves from: its normal or the opposite.
    pub(crate) side: Vec3,
    /// In what way.
    pub(crate) way: Way,
}

/// In what way light leaves a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Way {
    /// Reflected evenly.
    Even,
    /// Reflected by the facets of a rough mirror, or back and forth between them.
    Facets {
        /// Whether more than once.
        again: bool,
    },
    /// Reflected as by a mirror.
    Mirror,
    /// Passed on without a bend.
    Straight,
    /// Passed on into the medium behind a solid's border.
    Refracted {
        /// Square of the index of refraction there, inverse: what the radiance is divided by to be that outside.
        basic: f32,
    },
}

impl LobeTable {
    /// The lobes of a scene whose triangles have been checked; `None` where neither mirrors nor glass are simulated.
    pub(crate) fn new(scene: &Scene, flat: &FlatScene, effects: Effects) -> Option<Self> {
        if !(effects.mirrors || effects.glass) {
            return None;
        }
        let mut used = vec![false; scene.materials.len()];
        flat.triangle_materials.iter().for_each(|&material| used[material as usize] = true);
        let mut materials: Vec<Prepared> = Vec::new();
        for (material, used) in scene.materials.iter().zip(used) {
            let lobes = material.lobes(effects.mirrors, effects.glass);
            let facets = (used && lobes.mirror > 0.0 && lobes.alpha > 0.0).then(|| Facets::new(lobes.alpha));
            let diffuse = lobes.is_diffuse() || !used;
            materials.push(Prepared { lobes, diffuse, facets, thin: material.thin });
        }
        let glass = |triangle: usize| {
            let material = &materials[flat.triangle_materials[triangle] as usize];
            !material.diffuse && material.lobes.glass > 0.0
        };
        let any = (0..flat.triangles.len()).any(glass);
        let sides = if any { flat.sides(glass) } else { Vec::new() };
        Some(Self { materials, sides })
    }

    /// Whether most light goes past a triangle.
    pub(crate) fn lets_light_through(&self, flat: &FlatScene, triangle: usize) -> bool {
        let material = &self.materials[flat.triangle_materials[triangle] as usize];
        !material.diffuse && material.lobes.glass >= SEE_THROUGH
    }

    /// Whether most light goes straight past a triangle, as past a pane.
    pub(crate) fn is_pane(&self, flat: &FlatScene, triangle: usize) -> bool {
        let thin = self.materials[flat.triangle_materials[triangle] as usize].thin;
        self.lets_light_through(flat, triangle) && (thin || self.side(triangle as u32) == Side::Sheet)
    }

    /// Whether a material reflects light or lets it through, apart from what it reflects evenly.
    pub(crate) fn is_more_than_diffuse(&self, material: u32) -> bool {
        !self.materials[material as usize].diffuse
    }

    fn side(&self, triangle: u32) -> Side {
        self.sides.get(triangle as usize).copied().unwrap_or_default()
    }
}

impl Prepared {
    /// What the mirror reflects at cosine `cos`, where the texture has the colour `texture`.
    fn mirrored(&self, texture: Vec3, cos: f32) -> Vec3 {
        let lobes = &self.lobes;
        if lobes.metallic { schlick(lobes.mirror_colour * texture, cos) } else { lobes.mirror_colour }
    }

    /// The mean of [`Prepared::mirrored`] over even light: Schlick's term has the mean 1/21.
    fn mirrored_on_average(&self, texture: Vec3) -> Vec3 {
        let lobes = &self.lobes;
        if lobes.metallic {
            (lobes.mirror_colour * texture).lerp(Vec3::ONE, 1.0 / 21.0)
        } else {
            lobes.mirror_colour
        }
    }
}

/// Fresnel's reflectance of a metal that reflects `straight` head-on (C. Schlick, "An inexpensive BRDF model", 1994).
fn schlick(straight: Vec3, cos: f32) -> Vec3 {
    let away = (1.0 - cos).clamp(0.0, 1.0);
    straight.lerp(Vec3::ONE, away * away * away * away * away)
}

impl Surfaces<'_> {
    /// What light that flies along `direction` does next at the surface it hit. The `words` are those of the reflection: the
    /// first is left to the caller, the others are the same that even reflection uses alone.
    #[inline]
    pub(crate) fn scatter(
        &self,
        table: &LobeTable,
        (hit, point): (&Hit, &SurfacePoint),
        direction: Vec3,
        words: [u32; 4],
        (stream, step): (&Stream, u32),
    ) -> Scattered {
        let side = point.facing(-direction);
        let material = &table.materials[self.material_index(hit.triangle) as usize];
        let even = |colour: Vec3| Scattered {
            colour,
            direction: hemisphere::cosine(side, [unit(words[1]), unit(words[2])]),
            side,
            way: Way::Even,
        };
        if material.diffuse {
            return even(self.albedo(hit));
        }
        let lobes = &material.lobes;
        let texture = self.texture(hit);
        let mut choice = unit(words[3]);
        if choice < lobes.diffuse {
            return even(lobes.diffuse_colour * texture);
        }
        choice -= lobes.diffuse;
        if choice < lobes.mirror {
            let Some(facets) = &material.facets else {
                let cos = -direction.dot(side);
                return mirror(direction, side, material.mirrored(texture, cos));
            };
            let u = Vec2::new(unit(words[1]), unit(words[2]));
            return match facets.reflect(-direction, side, u, choice / lobes.mirror) {
                Some((reflected, cos)) => Scattered {
                    colour: material.mirrored(texture, cos),
                    direction: reflected,
                    side,
                    way: Way::Facets { again: false },
                },
                None => Scattered {
                    colour: material.mirrored_on_average(texture),
                    direction: facets.reflect_again(side, stream, step),
                    side,
                    way: Way::Facets { again: true },
                },
            };
        }
        choice -= lobes.mirror;
        if choice < lobes.glass {
            return self.pass(table, (hit, point), direction, choice / lobes.glass);
        }
        // Nothing sends on the rest.
        even(Vec3::ZERO)
    }

    /// Reflection or transmission at glass; `choice` decides, uniform in [0, 1).
    fn pass(
        &self,
        table: &LobeTable,
        (hit, point): (&Hit, &SurfacePoint),
        direction: Vec3,
        choice: f32,
    ) -> Scattered {
        let side = point.facing(-direction);
        let material = &table.materials[self.material_index(hit.triangle) as usize];
        let (n, colour) = (material.lobes.refractive_index, material.lobes.glass_colour);
        let cos = -direction.dot(side);
        let outside = match table.side(hit.triangle) {
            _ if material.thin => None,
            Side::Sheet => None,
            Side::SolidBehind => Some(point.normal),
            Side::SolidBefore => Some(-point.normal),
        };
        let Some(outside) = outside else {
            let reflected = dielectric::pane(cos, n, table.side(hit.triangle) == Side::Sheet);
            if choice < reflected {
                return mirror(direction, side, Vec3::ONE);
            }
            return Scattered { colour, direction, side: -side, way: Way::Straight };
        };
        let enters = outside.dot(side) > 0.0;
        let eta = if enters { 1.0 / n } else { n };
        match dielectric::interface(cos, eta) {
            (reflected, Some(cos_behind)) if choice >= reflected => Scattered {
                colour,
                direction: (direction * eta + side * (eta * cos - cos_behind)).normalize(),
                side: -side,
                way: Way::Refracted { basic: if enters { 1.0 / (n * n) } else { 1.0 } },
            },
            _ => mirror(direction, side, Vec3::ONE),
        }
    }

    /// What passes a surface without a bend, of light along `direction`: zero unless it is a pane.
    pub(crate) fn passed_straight(&self, table: &LobeTable, hit: &Hit, direction: Vec3) -> Vec3 {
        let material = &table.materials[self.material_index(hit.triangle) as usize];
        let closed = table.side(hit.triangle) != Side::Sheet;
        if material.diffuse || material.lobes.glass <= 0.0 || closed && !material.thin {
            return Vec3::ZERO;
        }
        let cos = self.normal(hit.triangle).dot(direction).abs();
        let reflected = dielectric::pane(cos, material.lobes.refractive_index, !closed);
        material.lobes.glass_colour * (material.lobes.glass * (1.0 - reflected))
    }

    /// Light reflected from the unit direction `from` (pointing to the light) towards the unit direction `towards` by the rough
    /// mirror of a surface with normal `side`, times the cosine at which it arrives, per unit of radiance and solid angle
    /// \[1/sr\]. Zero for surfaces that are none.
    pub(crate) fn reflected_by_facets(
        &self,
        table: &LobeTable,
        hit: &Hit,
        side: Vec3,
        (from, towards): (Vec3, Vec3),
    ) -> Vec3 {
        let material = &table.materials[self.material_index(hit.triangle) as usize];
        let Some(facets) = &material.facets else { return Vec3::ZERO };
        let (factor, cos) = facets.evaluate(side, from, towards);
        material.mirrored(self.texture(hit), cos) * (material.lobes.mirror * factor)
    }

    /// Density of light that facets reflected more than once, for the direction `from` of a surface with normal `side`, as a
    /// multiple of that of even reflection. A sample whose mean is right.
    pub(crate) fn reflected_again(
        &self,
        table: &LobeTable,
        hit: &Hit,
        (side, from): (Vec3, Vec3),
        (stream, step): (&Stream, u32),
    ) -> f32 {
        let material = &table.materials[self.material_index(hit.triangle) as usize];
        material.facets.as_ref().map_or(0.0, |facets| facets.share_again(side, from, stream, step))
    }
}

/// Reflection at a plane with normal `side`, which faces against `direction`.
fn mirror(direction: Vec3, side: Vec3, colour: Vec3) -> Scattered {
    let reflected = (direction - side * (2.0 * direction.dot(side))).normalize();
    Scattered { colour, direction: reflected, side, way: Way::Mirror }
}

#[cfg(test)]
mod tests;
