/// A light effect that a scene may or may not call for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
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
    /// Light from outside the scene.
    Sky,
}

/// Whether an effect is simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// The scene calls for it and it is simulated.
    Needed,
    /// The scene does not call for it; no time is spent on it.
    NotNeeded,
    /// The scene calls for it and this release does not simulate it.
    Unsupported,
}

/// What an effect costs, measured by a pilot run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Expected time of the whole bake spent on this effect, all threads together \[s of CPU\].
    pub seconds: f64,
    /// Share of the light energy that this effect carries, in [0, 1].
    pub energy_share: f64,
}

/// One line of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedEffect {
    /// Which effect.
    pub effect: Effect,
    /// Whether it is simulated.
    pub need: Need,
    /// Why, in one sentence that names what in the scene decides it.
    pub reason: String,
    /// What it costs; `None` before a pilot run, and where nothing is spent.
    pub cost: Option<Cost>,
}

/// What is simulated for a scene, and why.
#[derive(Debug, Clone, PartialEq)]
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
}
