//! What a plan leaves out makes no difference, and what it does not leave out does.

use glam::{DVec3, Vec3};
use ivg_scene::plan::{PlanOptions, analyse};
use ivg_scene::{Effect, EffectPlan, FlatScene, LightKind, Material, Need, Scene, Texture, TextureFormat};

use crate::cases::{SceneBuilder, difference};
use crate::stage::{Effects, Stage};
use crate::{BakeOptions, BakeResult, Estimator, Silent, bake, pilot};

/// A room with a lamp and a block; `material` adds what the block is made of.
fn room(material: Material) -> (Scene, FlatScene) {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.6, 0.0, true);
    let lamp = builder.material(0.0, 9.0, false);
    let block = builder.any_material(material);
    builder.cuboid(Vec3::ZERO, Vec3::splat(2.0), wall, true);
    builder.cuboid(Vec3::new(0.2, 0.2, 0.2), Vec3::new(1.8, 0.4, 1.8), block, false);
    builder.quad(Vec3::new(0.7, 1.95, 0.7), Vec3::X * 0.6, Vec3::Z * 0.6, lamp);
    builder.build()
}

fn options() -> BakeOptions {
    BakeOptions { dims: [6; 3], photons: 30_000, ..BakeOptions::default() }
}

fn planned((scene, flat): &(Scene, FlatScene), planning: PlanOptions) -> EffectPlan {
    let mut plan = analyse(scene, flat, &planning);
    pilot(scene, flat, &mut plan, &options()).unwrap();
    plan
}

fn baked((scene, flat): &(Scene, FlatScene), plan: &EffectPlan) -> BakeResult {
    bake(scene, flat, plan, &options(), &Silent).unwrap()
}

const ALL: PlanOptions = PlanOptions { energy_cutoff: 0.5, all_effects: true };

#[test]
fn what_a_plan_leaves_out_changes_less_than_the_accuracy_asked_for() {
    // A bright room, and one so dark that what is cut is little of the emitted light but much of the reflected.
    for albedo in [0.6, 0.05] {
        let mut scene = room(Material { albedo: Vec3::splat(albedo), ..Material::default() });
        scene.0.materials[0].albedo = Vec3::splat(albedo);
        let all = baked(&scene, &planned(&scene, ALL));
        // Where no surface reflects as much as the accuracy, none of the light is: not a case of this.
        for accuracy in [0.04, 0.01] {
            let plan = planned(&scene, PlanOptions { energy_cutoff: accuracy, ..PlanOptions::default() });
            for effect in [Effect::Mirrors, Effect::Glass, Effect::Textures, Effect::Sky] {
                assert_eq!(plan.get(effect).map(|e| e.need), Some(Need::NotNeeded), "{effect}");
            }
            // The same photons: the difference is what was left out, and nothing else.
            let off = difference(&baked(&scene, &plan).grid, &all.grid);
            assert!(off < accuracy, "albedo {albedo}, accuracy {accuracy}: {off}");
        }
    }
}

#[test]
fn effects_that_are_absent_change_not_one_bit() {
    let scene = room(Material::default());
    let plan = planned(&scene, PlanOptions::default());
    let all = EffectPlan { max_bounces: plan.max_bounces, ..planned(&scene, ALL) };
    assert!(all.needs(Effect::Mirrors) && !plan.needs(Effect::Mirrors));
    assert_eq!(baked(&scene, &plan), baked(&scene, &all));
}

#[test]
fn effects_that_are_there_are_not_left_out() {
    let metal = Material {
        specular: 1.0,
        specular_colour: Vec3::splat(0.9),
        metallic: true,
        albedo: Vec3::splat(0.9),
        roughness: 0.0,
        ..Material::default()
    };
    let glass = Material { transmission: 1.0, albedo: Vec3::ZERO, ..Material::default() };
    for (material, effect) in [(metal, Effect::Mirrors), (glass, Effect::Glass)] {
        let scene = room(material);
        let plan = planned(&scene, PlanOptions::default());
        assert!(plan.needs(effect));
        let mut without = plan.clone();
        for line in without.effects.iter_mut().filter(|line| line.effect == effect) {
            line.need = Need::NotNeeded;
        }
        let off = difference(&baked(&scene, &without).grid, &baked(&scene, &plan).grid);
        assert!(off > 0.05, "{effect}: {off}");
        assert!(difference(&baked(&scene, &plan).grid, &baked(&scene, &planned(&scene, ALL)).grid) < 0.01);
    }
}

/// What a plan leaves out is not looked at, be it there or not: a texture that would make all black, a sky, a mirror, glass.
#[test]
fn nothing_of_an_effect_that_is_left_out_is_simulated() {
    let clear = Material { transmission: 1.0, albedo: Vec3::splat(0.5), ..Material::default() };
    let metal = Material { specular: 1.0, specular_colour: Vec3::ONE, ..Material::default() };
    for (effect, material) in [
        (Effect::Textures, Material { albedo_texture: Some(0), ..Material::default() }),
        (Effect::Sky, Material::default()),
        (Effect::Mirrors, metal),
        (Effect::Glass, clear),
    ] {
        let mut with = room(material.clone());
        with.0.textures.push(Texture {
            name: "black".into(),
            width: 1,
            height: 1,
            format: TextureFormat::Srgb8,
            texels: vec![0; 3],
        });
        with.0.sky = (effect == Effect::Sky).then_some(Vec3::ONE);
        let mut plan = planned(&with, PlanOptions::default());
        assert!(plan.needs(effect), "{effect}");
        let found = baked(&with, &plan);
        plan.effects
            .iter_mut()
            .filter(|line| line.effect == effect)
            .for_each(|line| line.need = Need::NotNeeded);
        let plain = Material { albedo_texture: None, transmission: 0.0, specular: 0.0, ..material };
        let without = room(plain);
        let left_out = baked(&with, &plan);
        assert_ne!(left_out, found, "{effect}");
        if matches!(effect, Effect::Textures | Effect::Sky) {
            assert_eq!(left_out, baked(&without, &plan), "{effect}");
        } else {
            let stage = |plan: &EffectPlan| {
                Stage::new(&with.0, &with.1, Effects::of(plan), None).unwrap().surfaces.lobes().is_some()
            };
            assert!(!stage(&plan), "{effect}: photons follow the code that knows even reflection alone");
            assert!(stage(&planned(&with, PlanOptions::default())), "{effect}");
        }
    }
}

/// Paths from the vertices ask whether something stands before a light only where something can.
#[test]
fn shadows_are_looked_for_only_where_something_can_cast_one() {
    let gather = |scene: &(Scene, FlatScene), plan: &EffectPlan| {
        let options = BakeOptions { estimator: Estimator::Gather, paths: 512, dims: [4; 3], ..options() };
        bake(&scene.0, &scene.1, plan, &options, &Silent).unwrap().grid
    };
    let looking = |plan: &EffectPlan, need: Need| {
        let mut plan = plan.clone();
        plan.effects
            .iter_mut()
            .filter(|line| line.effect == Effect::Shadows)
            .for_each(|line| line.need = need);
        plan
    };
    let mut empty = SceneBuilder::default();
    let wall = empty.material(0.6, 0.0, true);
    empty.cuboid(Vec3::ZERO, Vec3::splat(2.0), wall, true);
    empty.light(LightKind::Point { position: DVec3::new(1.0, 1.7, 0.8), intensity: Vec3::ONE });
    for (scene, needed) in [(empty.build(), false), (room(Material::default()), true)] {
        let plan = planned(&scene, PlanOptions::default());
        assert_eq!(plan.needs(Effect::Shadows), needed);
        let [with, without] =
            [Need::Needed, Need::NotNeeded].map(|need| gather(&scene, &looking(&plan, need)));
        // In the empty room nothing is lost by not looking; where a block is, light would pass it.
        let off = difference(&without, &with);
        assert!(if needed { off > 0.05 } else { off < 1e-3 }, "{needed}: {off}");
    }
}

/// The lattice of a room divided by glass: a pane is not there, a slab is a wall that light passes.
#[test]
fn panes_do_not_divide_a_room_and_solids_do() {
    let glass = |thin| Material { transmission: 1.0, albedo: Vec3::ZERO, thin, ..Material::default() };
    for (thin, width, blocked) in [(true, 0.0, 0), (true, 0.05, 0), (false, 0.05, 16)] {
        let mut builder = SceneBuilder::default();
        let wall = builder.material(0.6, 0.0, true);
        let lamp = builder.material(0.0, 9.0, false);
        let divider = builder.any_material(glass(thin));
        builder.cuboid(Vec3::ZERO, Vec3::splat(2.0), wall, true);
        builder.quad(Vec3::new(0.2, 1.95, 0.7), Vec3::X * 0.4, Vec3::Z * 0.4, lamp);
        let (low, high) = (Vec3::new(0.9, 0.01, 0.01), Vec3::new(0.9 + width, 1.99, 1.99));
        if width > 0.0 {
            builder.cuboid(low, high, divider, false);
        } else {
            builder.quad(low, Vec3::Y * 1.98, Vec3::Z * 1.98, divider);
        }
        let (scene, flat) = builder.build();
        let bounds = Some((DVec3::splat(0.25), DVec3::splat(1.75)));
        let options = BakeOptions { dims: [4; 3], bounds, photons: 50_000, ..BakeOptions::default() };
        let grid = bake(&scene, &flat, &crate::cases::plan(&scene, 64), &options, &Silent).unwrap().grid;
        assert_eq!(grid.blocked_edge_count(), blocked, "thin {thin}, width {width}");
        for vertex in 0..grid.vertex_count() {
            assert!(grid.is_valid(vertex), "the lamp shines through the glass on vertex {vertex}");
            // Behind the glass as well.
            assert!(grid.vectors()[vertex][3][1][1] < 0.0, "vertex {vertex}");
        }
    }
}
