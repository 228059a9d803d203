use glam::{DAffine3, DVec3, Vec2, Vec3};

use super::*;
use crate::{Light, LightKind, Material, Mesh, Node, Scene, Texture, TextureFormat};

/// Corners of the unit cube; bit `axis` of the number is the place along it.
fn cube(fronts_inside: bool) -> Mesh {
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let mut triangles: Vec<[u32; 3]> =
        faces.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).collect();
    if fronts_inside {
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    Mesh {
        name: "cube".into(),
        positions: (0..8).map(|n| Vec3::new((n & 1) as f32, (n >> 1 & 1) as f32, (n >> 2) as f32)).collect(),
        triangle_materials: vec![0; triangles.len()],
        triangles,
        ..Mesh::default()
    }
}

fn point(position: DVec3) -> Light {
    Light { name: "bulb".into(), kind: LightKind::Point { position, intensity: Vec3::ONE } }
}

fn scene(meshes: Vec<Mesh>, lights: Vec<Light>) -> Scene {
    let nodes = (0..meshes.len() as u32)
        .map(|mesh| Node { name: "n".into(), mesh, transform: DAffine3::IDENTITY })
        .collect();
    Scene { meshes, nodes, lights, materials: vec![Material::default()], ..Scene::default() }
}

fn plan(scene: &Scene) -> EffectPlan {
    scene.check().unwrap();
    analyse(scene, &scene.flatten(), &PlanOptions::default())
}

fn need(scene: &Scene, effect: Effect) -> (Need, String) {
    let plan = plan(scene);
    let line = plan.get(effect).expect("every effect has a line");
    (line.need, line.reason.clone())
}

#[test]
fn a_convex_room_with_its_light_inside_needs_no_shadows() {
    let room = scene(vec![cube(true)], vec![point(DVec3::splat(0.5))]);
    let (decided, why) = need(&room, Effect::Shadows);
    assert_eq!(decided, Need::NotNeeded, "{why}");
    assert!(why.contains("convex"), "{why}");
}

#[test]
fn anything_that_may_stand_in_the_way_needs_shadows() {
    let inside = point(DVec3::splat(0.5));
    let mut panel = cube(true);
    panel.positions.extend([Vec3::new(0.2, 0.2, 0.5), Vec3::new(0.8, 0.2, 0.5), Vec3::new(0.5, 0.8, 0.5)]);
    panel.triangles.push([8, 9, 10]);
    panel.triangle_materials.push(0);
    let outside = point(DVec3::new(0.5, 0.5, 3.0));
    let sun = Light {
        name: "sun".into(),
        kind: LightKind::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::ONE },
    };
    for (meshes, lights) in [
        (vec![panel], vec![inside.clone()]),
        (vec![cube(true)], vec![inside.clone(), outside]),
        (vec![cube(true)], vec![sun]),
    ] {
        assert_eq!(need(&scene(meshes, lights), Effect::Shadows).0, Need::Needed);
    }
    let mut sky = scene(vec![cube(true)], vec![inside]);
    sky.sky = Some(Vec3::ONE);
    assert_eq!(need(&sky, Effect::Shadows).0, Need::Needed);
}

#[test]
fn a_lone_plane_cannot_shade_itself() {
    let plane = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 0.0, 1.0), Vec3::Z],
        triangles: vec![[0, 2, 1], [0, 3, 2]],
        triangle_materials: vec![0; 2],
        ..Mesh::default()
    };
    let flat = scene(vec![plane], vec![point(DVec3::Y)]);
    assert_eq!(need(&flat, Effect::Shadows).0, Need::NotNeeded);
}

#[test]
fn without_light_nothing_is_needed() {
    let dark = plan(&scene(vec![cube(true)], Vec::new()));
    assert!(dark.effects.iter().all(|e| e.need == Need::NotNeeded), "{dark:?}");
    assert_eq!(dark.max_bounces, 0);
    assert_eq!(dark.effects.iter().map(|e| e.effect).collect::<Vec<_>>(), Effect::ALL);
}

#[test]
fn bounces_follow_from_the_largest_albedo() {
    // 0.5^7 is the first power below 0.01; 0.1^2 is 0.01 itself, which is not above the cutoff.
    for (albedo, expected) in [(0.5, 7), (0.9, 44), (1.0, 64), (0.05, 2)] {
        let mut room = scene(vec![cube(true)], vec![point(DVec3::splat(0.5))]);
        room.materials[0].albedo = Vec3::new(0.0, albedo, 0.0);
        let plan = plan(&room);
        assert!(plan.needs(Effect::DiffuseIndirect));
        assert_eq!(plan.max_bounces, expected, "albedo {albedo}");
    }
    let mut black = scene(vec![cube(true)], vec![point(DVec3::splat(0.5))]);
    black.materials[0].albedo = Vec3::splat(0.009);
    assert!(!plan(&black).needs(Effect::DiffuseIndirect));
    assert_eq!(plan(&black).max_bounces, 0);
}

#[test]
fn lights_are_named_with_their_power() {
    let mut room = scene(vec![cube(true)], vec![point(DVec3::splat(0.5))]);
    room.materials[0] =
        Material { name: "glow".into(), emission: Vec3::X, two_sided: false, ..Material::default() };
    let (decided, why) = need(&room, Effect::DirectLight);
    assert_eq!(decided, Need::Needed);
    // Six faces of 1 m² times pi; four pi for the point.
    assert!(
        why.contains("\"glow\" (18.85 0.00 0.00 W)") && why.contains("\"bulb\" (12.57 12.57 12.57 W)"),
        "{why}"
    );
}

#[test]
fn what_cannot_be_done_is_unsupported_and_named() {
    let mut room = scene(vec![cube(true)], vec![point(DVec3::splat(0.5))]);
    assert_eq!(need(&room, Effect::VertexColours).0, Need::NotNeeded);
    room.meshes[0].colours = vec![[9; 4]; room.meshes[0].positions.len()];
    room.meshes[0].name = "painted".into();
    let (decided, why) = need(&room, Effect::VertexColours);
    assert_eq!(decided, Need::Unsupported);
    assert!(why.contains("\"painted\"") && why.contains("materials alone"), "{why}");
    assert!(!plan(&room).needs(Effect::VertexColours));
}

#[test]
fn mirrors_and_glass_are_needed_where_the_scene_shows_them() {
    let mut room = scene(vec![cube(true), cube(true), cube(true)], vec![point(DVec3::splat(0.5))]);
    assert_eq!(need(&room, Effect::Mirrors).0, Need::NotNeeded);
    assert_eq!(need(&room, Effect::Glass).0, Need::NotNeeded);
    let named = |name: &str| Material { name: name.into(), ..Material::default() };
    let bounces = plan(&room).max_bounces;
    room.materials.extend([
        Material { specular: 0.5, roughness: 0.1, ..named("chrome") },
        Material { transmission: 0.9, roughness: 0.0, ..named("pane") },
        Material { specular: 0.5, roughness: 0.0, ..named("unused") },
        Material { specular: 1.0, metallic: true, roughness: 0.6, ..named("tin") },
    ]);
    room.meshes[1].triangle_materials.fill(1);
    room.meshes[2].triangle_materials.fill(2);
    let (decided, why) = need(&room, Effect::Mirrors);
    assert_eq!(decided, Need::Needed);
    assert!(why.contains("33.3 %") && why.contains("slightly rough ones (\"chrome\")"), "{why}");
    assert!(!why.contains("unused") && !why.contains("default") && !why.contains("facets"), "{why}");
    let (decided, why) = need(&room, Effect::Glass);
    assert_eq!(decided, Need::Needed);
    assert!(why.contains("\"pane\"") && !why.contains("approximated"), "{why}");
    // What passes glass is not lost.
    assert!(plan(&room).max_bounces > bounces);
    room.meshes[1].triangle_materials.fill(4);
    room.materials[2].roughness = 0.5;
    assert!(need(&room, Effect::Mirrors).1.contains("rough ones (\"tin\") by facets"));
    assert!(need(&room, Effect::Glass).1.contains("rough glass (\"pane\") as smooth"));
    room.lights.clear();
    assert_eq!(need(&room, Effect::Glass).0, Need::NotNeeded);
}

#[test]
fn all_effects_are_planned_when_asked_for() {
    let room = scene(vec![cube(true)], vec![point(DVec3::splat(0.5))]);
    let options = PlanOptions { all_effects: true, ..PlanOptions::default() };
    let plan = analyse(&room, &room.flatten(), &options);
    assert!(Effect::ALL.iter().all(|effect| plan.needs(*effect)), "{plan:?}");
    let why = &plan.get(Effect::Glass).expect("a line").reason;
    assert_eq!(why, "asked for, although no surface lets light through");
    assert_eq!(plan.max_bounces, 64);
}

#[test]
fn textures_and_sky_are_needed_where_the_scene_has_them() {
    let mut room = scene(vec![cube(true)], vec![point(DVec3::splat(0.5))]);
    assert_eq!(need(&room, Effect::Textures).0, Need::NotNeeded);
    assert_eq!(need(&room, Effect::Sky).0, Need::NotNeeded);
    room.textures.push(Texture {
        name: "t".into(),
        width: 1,
        height: 1,
        format: TextureFormat::Srgb8,
        texels: vec![255; 3],
    });
    room.materials[0].albedo_texture = Some(0);
    room.meshes[0].uvs = vec![Vec2::ZERO; 8];
    room.sky = Some(Vec3::new(1.0, 0.0, 0.0));
    let (decided, why) = need(&room, Effect::Textures);
    assert_eq!((decided, why.as_str()), (Need::Needed, "12 of 12 triangles have one of 1 albedo images"));
    let (decided, why) = need(&room, Effect::Sky);
    assert_eq!(decided, Need::Needed);
    assert!(why.contains("1.00 0.00 0.00"), "{why}");
}

#[test]
fn the_plan_is_json_with_stable_names() {
    let value = serde_json::to_value(plan(&scene(vec![cube(true)], Vec::new()))).expect("plain data");
    assert_eq!(value["effects"][0]["effect"], "direct-light");
    assert_eq!(value["effects"][0]["need"], "not-needed");
    assert_eq!(value["energy_cutoff"], 0.01);
}
