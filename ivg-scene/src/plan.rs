//! The effect plan: which light effects a scene calls for, which are left out, and why.
//!
//! Baker and renderer take the plan and do only what it names. An effect is left out only if the scene proves that it
//! makes no difference; in doubt it is needed. What a scene asks for and this release cannot do is named, with what is
//! done instead.

mod analyse;
mod shadow;

use serde::Serialize;

pub use analyse::{PlanOptions, analyse};

/// A light effect that a scene may or may not call for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Effect {
    /// Light that reaches surfaces straight from a light.
    DirectLight,
    /// Geometry between a light and a surface.
    Shadows,
    /// Light reflected diffusely at least once: what the grid holds.
    DiffuseIndirect,
    /// Mirror reflection.
    Mirrors,
    /// Refraction and transmission.
    Glass,
    /// Albedo that varies over a surface.
    Textures,
    /// Colours of vertices, which would change the albedo from place to place.
    VertexColours,
    /// Light from outside the scene.
    Sky,
}

/// Whether an effect is simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Need {
    /// The scene calls for it and it is simulated.
    Needed,
    /// The scene does not call for it; no time is spent on it.
    NotNeeded,
    /// The scene calls for it and this release does not simulate it.
    Unsupported,
}

/// What an effect costs, measured by a pilot run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Cost {
    /// Expected time of the whole bake spent on this effect, all threads together \[s of CPU\].
    pub seconds: f64,
    /// Share of the light energy that this effect carries, in [0, 1].
    pub energy_share: f64,
}

/// One line of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlannedEffect {
    /// Which effect.
    pub effect: Effect,
    /// Whether it is simulated.
    pub need: Need,
    /// Why, in one sentence that names what in the scene decides it.
    pub reason: String,
    /// What it costs, of an effect that is left out what it would cost; `None` before a pilot run, and where nothing is spent.
    pub cost: Option<Cost>,
}

/// What is simulated for a scene, and why.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectPlan {
    /// One entry for each effect, in the order of [`Effect`].
    pub effects: Vec<PlannedEffect>,
    /// Largest number of reflections that are followed, >= 0.
    pub max_bounces: u32,
    /// Share of the emitted energy below which the rest is not followed, in (0, 1).
    pub energy_cutoff: f64,
}

impl EffectPlan {
    /// Whether `effect` is simulated.
    #[must_use]
    pub fn needs(&self, effect: Effect) -> bool {
        self.effects.iter().any(|e| e.effect == effect && e.need == Need::Needed)
    }

    /// The line about `effect`; `None` if the plan does not speak of it.
    #[must_use]
    pub fn get(&self, effect: Effect) -> Option<&PlannedEffect> {
        self.effects.iter().find(|e| e.effect == effect)
    }
}

impl Effect {
    /// All effects, in order.
    pub const ALL: [Self; 8] = [
        Self::DirectLight,
        Self::Shadows,
        Self::DiffuseIndirect,
        Self::Mirrors,
        Self::Glass,
        Self::Textures,
        Self::VertexColours,
        Self::Sky,
    ];

    /// The name in reports, as a reader would say it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::DirectLight => "direct light",
            Self::Shadows => "shadows",
            Self::DiffuseIndirect => "diffuse indirect light",
            Self::Mirrors => "mirrors",
            Self::Glass => "glass",
            Self::Textures => "textures",
            Self::VertexColours => "vertex colours",
            Self::Sky => "sky",
        }
    }
}

impl std::fmt::Display for Effect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

impl Need {
    /// The word in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Needed => "needed",
            Self::NotNeeded => "not needed",
            Self::Unsupported => "unsupported",
        }
    }
}

impl std::fmt::Display for Need {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

#[cfg(test)]
mod tests;
