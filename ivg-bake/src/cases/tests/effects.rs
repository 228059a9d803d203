//! What a plan leaves out makes no difference, and what it does not leave out does.

use glam::{DVec3, Vec3};
use ivg_scene::plan::{PlanOptions, analyse};
use ivg_scene::{Effect, EffectPlan, FlatScene, Material, Need, Scene};

use crate::cases::{SceneBuilder, difference};
use crate::{BakeOptions, BakeResult, Silent, bake, pilot};

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
