//! Looking at a scene: what decides each effect.

use glam::{DVec3, Vec3};

use super::shadow;
use crate::{Effect, EffectPlan, FlatScene, Material, Need, PlannedEffect, Scene, Texture};

/// What a plan depends on besides the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanOptions {
    /// Share of the emitted energy below which the rest is not followed, in (0, 1): a share of the error that is asked for,
    /// where one is.
    pub energy_cutoff: f64,
    /// Plan every effect, whether the scene calls for it or not, and follow light as far as it is followed at all: for
    /// comparison with what is left out.
    pub all_effects: bool,
}

impl Default for PlanOptions {
    /// One per cent: below what a picture of eight bits a channel shows. Only effects that the scene calls for.
    fn default() -> Self {
        Self { energy_cutoff: 0.01, all_effects: false }
    }
}

/// The energy cutoff of a plan of all effects: what sums in f32 resolve.
const SMALLEST_CUTOFF: f64 = 1e-7;

/// Most reflections that are followed: where surfaces reflect nearly everything, light never dies out by itself.
const MAX_BOUNCES: u32 = 64;

/// Names that a reason lists before it only counts the rest.
const NAMES: usize = 5;

/// Decides for each effect whether the scene needs it.
///
/// The number of reflections follows from the largest share a that a surface sends on: after n reflections at most a^n of the emitted energy is
/// left, and following ends when that is below the cutoff. A pilot run of the baker measures it more closely.
///
/// # Panics
///
/// Panics if `options.energy_cutoff` is not in (0, 1), or if `flat` was not made from `scene`.
#[must_use]
pub fn analyse(scene: &Scene, flat: &FlatScene, options: &PlanOptions) -> EffectPlan {
    let cutoff = options.energy_cutoff;
    assert!(cutoff > 0.0 && cutoff < 1.0, "energy cutoff {cutoff} is not in (0, 1)");
    let cutoff = if options.all_effects { SMALLEST_CUTOFF } else { cutoff };
    let areas = Areas::of(scene, flat);
    let lights = lights(scene, flat);
    let (indirect, max_bounces) = indirect(&areas, scene, !lights.is_empty(), cutoff);
    let lit = !lights.is_empty();
    let decide = |effect, (need, reason): (Need, String)| {
        let forced = options.all_effects && need == Need::NotNeeded;
        let (need, reason) =
            if forced { (Need::Needed, format!("asked for, although {reason}")) } else { (need, reason) };
        PlannedEffect { effect, need, reason, cost: None }
    };
    EffectPlan {
        effects: vec![
            decide(Effect::DirectLight, direct(&lights)),
            decide(Effect::Shadows, shadows(scene, flat, lit)),
            decide(Effect::DiffuseIndirect, indirect),
            decide(Effect::Mirrors, mirrors(scene, &areas, lit)),
            decide(Effect::Glass, glass(scene, &areas, lit)),
            decide(Effect::Textures, textures(scene, flat)),
            decide(Effect::VertexColours, vertex_colours(scene)),
            decide(Effect::Sky, sky(scene)),
        ],
        max_bounces: if options.all_effects { MAX_BOUNCES } else { max_bounces },
        energy_cutoff: cutoff,
    }
}

/// Area of each material \[m²\], and in all.
struct Areas {
    by_material: Vec<f64>,
    total: f64,
}

impl Areas {
    fn of(scene: &Scene, flat: &FlatScene) -> Self {
        let mut by_material = vec![0.0; scene.materials.len()];
        for (triangle, material) in flat.triangle_materials.iter().enumerate() {
            by_material[*material as usize] += flat.area(triangle);
        }
        let total = by_material.iter().sum();
        Self { by_material, total }
    }

    /// Materials that the scene shows and that meet a condition, and their share of all area.
    fn of_those<'a>(&self, scene: &'a Scene, meets: impl Fn(&Material) -> bool) -> (Vec<&'a str>, f64) {
        let those =
            || (scene.materials.iter().zip(&self.by_material)).filter(|(m, area)| **area > 0.0 && meets(m));
        let area: f64 = those().map(|(_, area)| area).sum();
        (
            those().map(|(m, _)| m.name.as_str()).collect(),
            if self.total > 0.0 { area / self.total } else { 0.0 },
        )
    }
}

/// Each light with what it radiates, for people.
fn lights(scene: &Scene, flat: &FlatScene) -> Vec<String> {
    let mut power_of = vec![DVec3::ZERO; scene.materials.len()];
    for (triangle, power) in flat.emitters(scene) {
        power_of[flat.triangle_materials[triangle] as usize] += power;
    }
    let mut lights: Vec<String> = (scene.materials.iter().zip(power_of))
        .filter(|(_, power)| *power != DVec3::ZERO)
        .map(|(m, power)| format!("surfaces of material \"{}\" ({} W)", m.name, rgb(power)))
        .collect();
    for light in &scene.lights {
        let strength = light.kind.strength();
        if strength == Vec3::ZERO {
            continue;
        }
        lights.push(match light.power() {
            Some(power) => format!("light \"{}\" ({} W)", light.name, rgb(power)),
            None => format!("light \"{}\" ({} W/m²)", light.name, rgb(strength.as_dvec3())),
        });
    }
    if let Some(sky) = scene.mean_sky().filter(|s| *s != Vec3::ZERO) {
        lights.push(format!("sky ({} W/(m² sr))", rgb(sky.as_dvec3())));
    }
    lights
}

fn direct(lights: &[String]) -> (Need, String) {
    if lights.is_empty() {
        (Need::NotNeeded, "nothing emits light".into())
    } else {
        (Need::Needed, list(lights))
    }
}

fn shadows(scene: &Scene, flat: &FlatScene, lit: bool) -> (Need, String) {
    if !lit {
        return (Need::NotNeeded, "nothing emits light".into());
    }
    match shadow::proof_of_none(scene, flat) {
        Some(why) => (Need::NotNeeded, why.into()),
        None => (Need::Needed, format!("{} triangles may stand in the way of light", flat.triangles.len())),
    }
}

fn indirect(areas: &Areas, scene: &Scene, lit: bool, cutoff: f64) -> ((Need, String), u32) {
    if !lit {
        return ((Need::NotNeeded, "nothing emits light".into()), 0);
    }
    let (mut sum, mut largest, mut name) = (Vec3::ZERO.as_dvec3(), 0.0f64, "");
    for (material, area) in scene.materials.iter().zip(&areas.by_material) {
        if *area == 0.0 {
            continue;
        }
        let texture = material.albedo_texture.and_then(|t| scene.textures.get(t as usize));
        // A bound for each texel, and the mean for the mean.
        let lobes = material.lobes(true, true);
        let most = f64::from(lobes.most());
        let mean = lobes.mean(texture.map_or(Vec3::ONE, Texture::mean));
        sum += *area * mean.as_dvec3();
        if most > largest {
            (largest, name) = (most, &material.name);
        }
    }
    let mean = (sum / areas.total.max(f64::MIN_POSITIVE)).max_element();
    if largest < cutoff {
        let why = format!("no surface reflects more than {largest:.3} of the light, the cutoff is {cutoff}");
        return ((Need::NotNeeded, why), 0);
    }
    let bounces = |albedo: f64| {
        if albedo >= 1.0 { f64::INFINITY } else { (cutoff.ln() / albedo.max(f64::MIN_POSITIVE).ln()).ceil() }
    };
    let exact = bounces(largest);
    let most = exact.min(f64::from(MAX_BOUNCES)).max(1.0) as u32;
    let capped = if exact > f64::from(MAX_BOUNCES) { ", ended there though more would be left" } else { "" };
    let why = format!(
        "mean reflectance {mean:.2}, largest {largest:.2} (material \"{name}\"): less than {cutoff} of the energy is left after \
         {} reflections on average and after {most} at most{capped}",
        bounces(mean).clamp(1.0, f64::from(MAX_BOUNCES)),
    );
    ((Need::Needed, why), most)
}

fn mirrors(scene: &Scene, areas: &Areas, lit: bool) -> (Need, String) {
    let mirrored = |m: &Material| m.lobes(true, true).mirror > 0.0;
    let (names, share) = areas.of_those(scene, mirrored);
    if !lit || names.is_empty() {
        let why = if lit {
            "no surface mirrors its surroundings; the few per cent of plain dielectrics count as diffuse"
        } else {
            "nothing emits light"
        };
        return (Need::NotNeeded, why.into());
    }
    let mut why = format!("{} of the area mirrors (materials {})", percent(share), quoted(&names));
    let (rough, _) = areas.of_those(scene, |m| mirrored(m) && m.lobes(true, true).alpha > 0.0);
    if !rough.is_empty() {
        why += &format!(
            "; approximated: rough ones ({}) by facets, what these shade is reflected on without loss",
            quoted(&rough)
        );
    }
    let (blurred, _) =
        areas.of_those(scene, |m| mirrored(m) && m.roughness > 0.0 && m.lobes(true, true).alpha == 0.0);
    if !blurred.is_empty() {
        why += &format!("; approximated: slightly rough ones ({}) as sharp mirrors", quoted(&blurred));
    }
    (Need::Needed, why)
}

fn glass(scene: &Scene, areas: &Areas, lit: bool) -> (Need, String) {
    let clear = |m: &Material| m.lobes(true, true).glass > 0.0;
    let (names, share) = areas.of_those(scene, clear);
    if !lit || names.is_empty() {
        let why = if lit { "no surface lets light through" } else { "nothing emits light" };
        return (Need::NotNeeded, why.into());
    }
    let mut why = format!(
        "{} of the area lets light through (materials {}): closed meshes bend it, others are panes",
        percent(share),
        quoted(&names)
    );
    let (rough, _) = areas.of_those(scene, |m| clear(m) && m.lobes(true, true).alpha > 0.0);
    if !rough.is_empty() {
        why += &format!("; approximated: rough glass ({}) as smooth", quoted(&rough));
    }
    (Need::Needed, why)
}

fn textures(scene: &Scene, flat: &FlatScene) -> (Need, String) {
    let count = (flat.triangle_materials.iter())
        .filter(|m| scene.materials[**m as usize].albedo_texture.is_some())
        .count();
    if count == 0 {
        (Need::NotNeeded, "no triangle has an albedo image".into())
    } else {
        let why = format!(
            "{count} of {} triangles have one of {} albedo images",
            flat.triangles.len(),
            scene.textures.len()
        );
        (Need::Needed, why)
    }
}

fn vertex_colours(scene: &Scene) -> (Need, String) {
    let coloured = scene.meshes.iter().filter(|mesh| !mesh.colours.is_empty());
    let names: Vec<&str> = coloured.map(|mesh| mesh.name.as_str()).collect();
    if names.is_empty() {
        return (Need::NotNeeded, "no vertex has a colour".into());
    }
    (Need::Unsupported, format!("meshes {} have them; they reflect by their materials alone", quoted(&names)))
}

fn sky(scene: &Scene) -> (Need, String) {
    let Some(mean) = scene.mean_sky().filter(|sky| *sky != Vec3::ZERO) else {
        return (Need::NotNeeded, "the scene has no sky".into());
    };
    let mean = rgb(mean.as_dvec3());
    let why = match &scene.sky_image {
        Some(image) => {
            format!("image \"{}\", radiance {mean} W/(m² sr) from outside on average", image.name)
        }
        None => format!("radiance {mean} W/(m² sr) from outside"),
    };
    (Need::Needed, why)
}

fn rgb(v: DVec3) -> String {
    let short = |x: f64| {
        if x == 0.0 || (0.01..10_000.0).contains(&x) { format!("{x:.2}") } else { format!("{x:.2e}") }
    };
    format!("{} {} {}", short(v.x), short(v.y), short(v.z))
}

fn percent(share: f64) -> String {
    if share >= 0.001 { format!("{:.1} %", 100.0 * share) } else { "less than 0.1 %".into() }
}

fn quoted(names: &[&str]) -> String {
    list(&names.iter().map(|n| format!("\"{n}\"")).collect::<Vec<_>>())
}

fn list(items: &[String]) -> String {
    let mut text = items[..items.len().min(NAMES)].join(", ");
    if items.len() > NAMES {
        text += &format!(" and {} more", items.len() - NAMES);
    }
    text
}
