use glam::DVec3;
use ivg_format::Lattice;
use ivg_scene::{
    Camera, Effect, EffectPlan, Light, LightKind, Material, Need, PlannedEffect, Texture, TextureFormat,
};

use super::*;
use crate::RenderMesh;

/// A textured triangle under a point light, with a grid and a sky.
fn scene() -> RenderScene {
    let mesh = RenderMesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        triangles: vec![[0, 1, 2]],
        triangle_materials: vec![0],
        ..RenderMesh::default()
    };
    let lattice = Lattice::new([2; 3], [0.0; 3], [1.0; 3]).unwrap();
    let vectors = vec![[[[0.0; 3]; 3]; 6]; 8];
    RenderScene {
        origin: DVec3::ZERO,
        meshes: vec![mesh],
        materials: vec![Material { albedo_texture: Some(0), ..Material::default() }],
        textures: vec![Texture {
            name: "t".into(),
            width: 1,
            height: 1,
            format: TextureFormat::Srgb8,
            texels: vec![255; 3],
        }],
        lights: vec![Light {
            name: "lamp".into(),
            kind: LightKind::Point { position: DVec3::Z, intensity: Vec3::ONE },
        }],
        sky: Some(Vec3::ONE),
        sky_image: None,
        camera: Camera { eye: DVec3::Z, target: DVec3::ZERO, up: DVec3::Y, vertical_fov: 1.0 },
        grid: Some(IrradianceGrid::from_parts(lattice, vectors, vec![255; 8], vec![0; 8]).unwrap()),
    }
}

fn options_for(needed: &[Effect]) -> RenderOptions {
    let all = [Effect::DirectLight, Effect::Shadows, Effect::DiffuseIndirect, Effect::Textures, Effect::Sky];
    let effects = all
        .map(|effect| PlannedEffect {
            effect,
            need: if needed.contains(&effect) { Need::Needed } else { Need::NotNeeded },
            reason: String::new(),
            cost: None,
        })
        .into();
    RenderOptions::for_plan(&EffectPlan { effects, max_bounces: 1, energy_cutoff: 0.01 }, 8, 8)
}

#[test]
fn a_frame_holds_only_what_the_effect_plan_names() {
    let scene = scene();
    let parts = |needed: &[Effect]| {
        let plan = FramePlan::new(&scene, &options_for(needed)).unwrap();
        (
            plan.lights.len(),
            plan.faces.len(),
            plan.grid.is_some(),
            plan.material_textures.iter().flatten().count(),
            plan.background.radiance(0) != Vec3::ZERO,
        )
    };
    assert_eq!(parts(&[]), (0, 0, false, 0, false));
    assert_eq!(parts(&[Effect::DirectLight]), (1, 0, false, 0, false));
    assert_eq!(parts(&[Effect::Shadows]), (0, 0, false, 0, false));
    assert_eq!(parts(&[Effect::DirectLight, Effect::Shadows]), (1, 6, false, 0, false));
    assert_eq!(parts(&[Effect::DiffuseIndirect]), (0, 0, true, 0, false));
    assert_eq!(parts(&[Effect::Textures, Effect::Sky]), (0, 0, false, 1, true));
}

#[test]
fn shadow_passes_come_before_shading_and_in_pairs() {
    let scene = scene();
    let plan = FramePlan::new(&scene, &RenderOptions::new(8, 8)).unwrap();
    let passes: Vec<Pass> = plan.passes().collect();
    assert_eq!(passes.len(), 13);
    for layer in 0..6 {
        assert_eq!(passes[2 * layer as usize], Pass::ShadowFirst { layer });
        assert_eq!(passes[2 * layer as usize + 1], Pass::ShadowLimit { layer });
    }
    assert_eq!(passes[12], Pass::Shade);
}

#[test]
fn options_out_of_range_are_errors_that_name_them() {
    let scene = scene();
    let error = |change: fn(&mut RenderOptions)| {
        let mut options = RenderOptions::new(8, 8);
        change(&mut options);
        FramePlan::new(&scene, &options).unwrap_err()
    };
    assert!(matches!(error(|o| o.width = 0), RenderError::Size { .. }));
    assert!(matches!(error(|o| o.height = 8193), RenderError::Size { .. }));
    assert!(matches!(error(|o| o.supersampling = 0), RenderError::Size { .. }));
    assert!(matches!(error(|o| o.width = u32::MAX), RenderError::Size { .. }));
    assert!(matches!(error(|o| o.area_samples = 0), RenderError::Option { .. }));
    assert!(error(|o| o.shadow_size = 16).to_string().contains("32 to 4096"));
}

#[test]
fn triangles_are_grouped_by_material_and_keep_their_order() {
    let mut scene = scene();
    scene.materials = vec![Material::default(); 3];
    scene.meshes[0].triangles = vec![[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1]];
    scene.meshes[0].triangle_materials = vec![2, 0, 2, 0];
    let geometry = FramePlan::new(&scene, &RenderOptions::new(8, 8)).unwrap().geometry;
    assert_eq!(geometry.triangles, [[1, 2, 0], [0, 2, 1], [0, 1, 2], [2, 0, 1]]);
    let draws: Vec<_> = geometry.draws.iter().map(|draw| (draw.material, draw.triangles.clone())).collect();
    assert_eq!(draws, [(0, 0..2), (2, 2..4)]);
}

#[test]
fn an_empty_scene_has_a_plan() {
    let mut scene = scene();
    scene.meshes.clear();
    let plan = FramePlan::new(&scene, &RenderOptions::new(8, 8)).unwrap();
    assert!(plan.geometry.triangles.is_empty());
    assert!(plan.faces.iter().all(|face| face.matrix.as_flattened().iter().all(|value| value.is_finite())));
}
