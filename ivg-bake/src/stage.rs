//! A scene made ready for rays: geometry, surfaces, lights, and the space they are in.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use ivg_scene::{Effect, EffectPlan, FlatScene, Need, Scene};

use crate::BakeError;
use crate::accel::TraceScene;
use crate::emit::{Emitters, Sphere};
use crate::lobes::LobeTable;
use crate::space::Space;
use crate::surface::Surfaces;

/// Everything that rays need to know.
#[derive(Debug)]
pub(crate) struct Stage<'a> {
    pub(crate) space: Space,
    pub(crate) surfaces: Surfaces<'a>,
    pub(crate) accel: Arc<TraceScene>,
    pub(crate) emitters: Emitters,
    world: Sphere,
    /// What stops sight, where that is not all that stops rays: without panes.
    sight: Option<TraceScene>,
    /// What stops light: without glass.
    clear: Option<TraceScene>,
    /// Whether anything can stand between a surface and a light that it faces.
    shadows: bool,
}

/// Which effects cost something only where they are simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Effects {
    /// Look up albedo textures.
    pub(crate) textures: bool,
    /// Light from outside.
    pub(crate) sky: bool,
    /// Mirror reflection.
    pub(crate) mirrors: bool,
    /// Light that passes surfaces.
    pub(crate) glass: bool,
}

impl Effects {
    /// What a plan asks for.
    pub(crate) fn of(plan: &EffectPlan) -> Self {
        Self {
            textures: plan.needs(Effect::Textures),
            sky: plan.needs(Effect::Sky),
            mirrors: plan.needs(Effect::Mirrors),
            glass: plan.needs(Effect::Glass),
        }
    }

    /// What a scene shows.
    pub(crate) fn of_scene(scene: &Scene, flat: &FlatScene) -> Self {
        let mut used = vec![false; scene.materials.len()];
        for &material in &flat.triangle_materials {
            // An index out of range is refused by name where surfaces are made.
            used.get_mut(material as usize).into_iter().for_each(|used| *used = true);
        }
        let lobes =
            || scene.materials.iter().zip(&used).filter(|(_, used)| **used).map(|(m, _)| m.lobes(true, true));
        let (mirrors, glass) = (lobes().any(|l| l.mirror > 0.0), lobes().any(|l| l.glass > 0.0));
        Self { textures: true, sky: true, mirrors, glass }
    }

    /// All of them, whether they are there or not.
    #[cfg(test)]
    pub(crate) const ALL: Self = Self { textures: true, sky: true, mirrors: true, glass: true };
}

/// Panes that light is followed through to a light; behind more there is none.
const MOST_PANES: u32 = 64;

/// Radius of the sphere that light from outside starts on, relative to half the diagonal of everything.
const WORLD_MARGIN: f32 = 1.001;

impl<'a> Stage<'a> {
    /// Makes a scene ready. `around` is a box in world space \[m\] that matters besides the scene.
    ///
    /// # Errors
    ///
    /// [`BakeError::NoLight`], [`BakeError::BadNumber`], [`BakeError::BadIndex`], [`BakeError::TreeTooDeep`].
    pub(crate) fn new(
        scene: &'a Scene,
        flat: &'a FlatScene,
        effects: Effects,
        around: Option<(DVec3, DVec3)>,
    ) -> Result<Self, BakeError> {
        let (mut min, mut max) = bounds(flat).or(around).unwrap_or((DVec3::ZERO, DVec3::ONE));
        if let Some((low, high)) = around {
            (min, max) = (min.min(low), max.max(high));
        }
        let space = Space::new(min, max);
        let surfaces = Surfaces::new(scene, flat, space, effects)?;
        let accel = Arc::new(TraceScene::new(surfaces.triangles())?);
        let world = Sphere { centre: Vec3::ZERO, radius: space.to_bake(max).length() * WORLD_MARGIN };
        let emitters = Emitters::new(scene, &surfaces, space, world, effects.sky)?;
        let tree = |triangles: Option<Vec<_>>| triangles.map(|t| TraceScene::new(&t)).transpose();
        let (sight, clear) = (tree(surfaces.without_panes())?, tree(surfaces.without_glass())?);
        Ok(Self { space, surfaces, accel, emitters, world, sight, clear, shadows: true })
    }

    /// The same scene with other effects, for photons; who looks around sees what stops rays.
    ///
    /// # Errors
    ///
    /// As [`Stage::new`].
    pub(crate) fn with_effects(
        &self,
        scene: &'a Scene,
        flat: &'a FlatScene,
        effects: Effects,
    ) -> Result<Self, BakeError> {
        let (space, world, accel) = (self.space, self.world, Arc::clone(&self.accel));
        let surfaces = Surfaces::new(scene, flat, space, effects)?;
        let emitters = Emitters::new(scene, &surfaces, space, world, effects.sky)?;
        let shadows = self.shadows;
        Ok(Self { space, surfaces, accel, emitters, world, sight: None, clear: None, shadows })
    }

    /// The same, where surfaces are lit by all lights that they face if the plan has found that nothing can cast a shadow
    /// ([`Effect::Shadows`]); no ray looks for what could.
    pub(crate) fn with_shadows_of(self, plan: &EffectPlan) -> Self {
        let shadows = plan.get(Effect::Shadows).is_none_or(|planned| planned.need != Need::NotNeeded);
        Self { shadows, ..self }
    }

    /// Whether something stands between a point of a surface and a light that the surface faces.
    #[inline]
    pub(crate) fn is_shadowed(&self, origin: Vec3, direction: Vec3, distance: f32) -> bool {
        self.shadows && self.accel.occluded(origin, direction, distance)
    }

    /// What stops sight: all surfaces but panes. The inside of a solid of glass is apart from the air around it.
    #[inline]
    pub(crate) fn sight(&self) -> &TraceScene {
        self.sight.as_ref().unwrap_or(&self.accel)
    }

    /// What stops light: all surfaces but those that let most of it through.
    #[inline]
    pub(crate) fn clear(&self) -> &TraceScene {
        self.clear.as_ref().unwrap_or(&self.accel)
    }

    /// Share of light that goes straight on from `origin` along `direction` for `distance`, past panes.
    pub(crate) fn passed(&self, lobes: &LobeTable, origin: Vec3, direction: Vec3, distance: f32) -> Vec3 {
        let (mut share, mut origin, mut direction, mut left) = (Vec3::ONE, origin, direction, distance);
        let end = origin + direction * distance;
        for _ in 0..MOST_PANES {
            let Some(hit) = self.accel.closest_hit(origin, direction, left) else { return share };
            share *= self.surfaces.passed_straight(lobes, &hit, direction);
            if share == Vec3::ZERO {
                break;
            }
            let point = self.surfaces.point(hit.triangle, hit.weights);
            origin = point.origin(point.facing(direction));
            if distance < f32::MAX {
                // The end stays where it is: by as much as the start moves off the pane, the same flight would end beyond a light
                // that it meets at a grazing angle.
                let way = end - origin;
                if way.dot(direction) <= 0.0 {
                    return share;
                }
                left = way.length();
                direction = way / left;
            }
        }
        Vec3::ZERO
    }
}

/// Bounds of all triangles in world space \[m\]; `None` without triangles, or if a position is not a number.
pub(crate) fn bounds(flat: &FlatScene) -> Option<(DVec3, DVec3)> {
    let mut bounds = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for position in flat.triangles.iter().flatten().filter_map(|&i| flat.positions.get(i as usize)) {
        let world = flat.origin + position.as_dvec3();
        bounds = (bounds.0.min(world), bounds.1.max(world));
    }
    (bounds.0.is_finite() && bounds.1.is_finite()).then_some(bounds)
}
