use glam::Vec3;
use ivg_scene::Material;

use super::*;
use crate::cases::SceneBuilder;
use crate::sampling::rng::Purpose;
use crate::stage::Stage;

fn glass() -> Material {
    Material { albedo: Vec3::ZERO, transmission: 1.0, ..Material::default() }
}

/// A cube of edge 2 around the origin, of a material, and a light so that there is one.
fn cube(material: Material, fronts_inside: bool) -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    let index = builder.any_material(material);
    builder.cuboid(Vec3::splat(-1.0), Vec3::ONE, index, fronts_inside);
    builder.sky(1.0);
    builder
}

/// What happens to light along a direction that starts at a point, so often in each way, and the last direction of each.
fn meet(builder: SceneBuilder, from: Vec3, direction: Vec3) -> Vec<(Way, u32, Vec3)> {
    let (scene, flat) = builder.build();
    let stage = Stage::new(&scene, &flat, Effects::ALL, None).unwrap();
    let lobes = stage.surfaces.lobes().expect("there is glass");
    let hit =
        stage.accel.closest_hit(stage.space.to_bake(from.as_dvec3()), direction, f32::MAX).expect("a hit");
    let point = stage.surfaces.point(hit.triangle, hit.weights);
    let mut ways: Vec<(Way, u32, Vec3)> = Vec::new();
    for n in 0..4000 {
        let stream = Stream::new(1, n);
        let words = stream.words(1, Purpose::Reflection);
        let found = stage.surfaces.scatter(lobes, (&hit, &point), direction, words, (&stream, 1));
        assert!(found.direction.dot(found.side) >= 0.0 && found.direction.is_normalized());
        match ways.iter_mut().find(|(way, ..)| *way == found.way) {
            Some(known) => known.1 += 1,
            None => ways.push((found.way, 1, found.direction)),
        }
    }
    ways
}

fn share(ways: &[(Way, u32, Vec3)], way: Way) -> f64 {
    ways.iter().find(|(found, ..)| *found == way).map_or(0.0, |(_, count, _)| f64::from(*count) / 4000.0)
}

/// Snell's law into glass and out, whichever way the faces are wound: sin 30° / 1.5 and back. 4000 draws: five standard
/// deviations of a share of 0.04 are 0.016.
#[test]
fn solids_bend_light_whichever_way_they_are_wound() {
    let slanted = Vec3::new(0.5, 0.0, -0.75f32.sqrt());
    for inside_out in [false, true] {
        let ways = meet(cube(glass(), inside_out), Vec3::new(0.0, 0.0, 2.0), slanted);
        let entered =
            ways.iter().find(|(way, ..)| *way == Way::Refracted { basic: 1.0 / 2.25 }).expect("enters");
        assert!((entered.2.x - 0.5 / 1.5).abs() < 1e-5 && entered.2.z < 0.0, "{ways:?}");
        assert!((share(&ways, Way::Mirror) - 0.0415).abs() < 0.016, "{ways:?}");
        let ways = meet(cube(glass(), inside_out), Vec3::ZERO, Vec3::new(0.5, 0.0, -0.75f32.sqrt()));
        let left = ways.iter().find(|(way, ..)| *way == Way::Refracted { basic: 1.0 }).expect("leaves");
        assert!((left.2.x - 0.75).abs() < 1e-5, "{ways:?}");
        // sin 45° · 1.5 > 1.
        let flat = Vec3::new(-1.0, 0.0, -1.0).normalize();
        let ways = meet(cube(glass(), inside_out), Vec3::new(0.3, 0.1, 0.1), flat);
        assert_eq!(share(&ways, Way::Mirror), 1.0, "{ways:?}");
    }
}

#[test]
fn what_is_thin_or_open_is_a_pane() {
    let thin = Material { thin: true, ..glass() };
    let ways = meet(cube(thin, false), Vec3::new(0.0, 0.0, 3.0), Vec3::NEG_Z);
    let (mirror, straight) = (share(&ways, Way::Mirror), share(&ways, Way::Straight));
    // One of two faces.
    assert!((mirror - 0.04).abs() < 0.016 && (mirror + straight - 1.0).abs() < 1e-9, "{ways:?}");
    let mut sheet = SceneBuilder::default();
    let index = sheet.any_material(glass());
    sheet.quad(Vec3::new(-1.0, -1.0, 0.0), Vec3::X * 2.0, Vec3::Y * 2.0, index);
    sheet.sky(1.0);
    let ways = meet(sheet, Vec3::new(0.1, 0.0, 3.0), Vec3::NEG_Z);
    let mirror = share(&ways, Way::Mirror);
    assert!((mirror - 0.0769).abs() < 0.022 && share(&ways, Way::Straight) == 1.0 - mirror, "{ways:?}");
}

#[test]
fn shares_of_a_mixture_are_chosen_in_proportion() {
    let mixture = Material {
        albedo: Vec3::splat(0.4),
        transmission: 0.5,
        specular: 0.5,
        metallic: true,
        roughness: 0.0,
        thin: true,
        refractive_index: 1.0,
        ..Material::default()
    };
    let ways = meet(cube(mixture, false), Vec3::new(0.0, 0.0, 3.0), Vec3::NEG_Z);
    // Five standard deviations of a share of a half of 4000 draws: 0.04. Index 1 reflects nothing.
    for (way, expected) in [(Way::Mirror, 0.5), (Way::Straight, 0.25), (Way::Even, 0.25)] {
        assert!((share(&ways, way) - expected).abs() < 0.04, "{ways:?}");
    }
}

#[test]
fn what_is_not_simulated_is_not_there() {
    let table = |material: &Material, effects: Effects| {
        let (scene, flat) = cube(material.clone(), false).build();
        LobeTable::new(&scene, &flat, effects).map(|table| table.is_more_than_diffuse(0))
    };
    let metal = Material { specular: 1.0, metallic: true, ..Material::default() };
    let (no_mirrors, no_glass) =
        (Effects { mirrors: false, ..Effects::ALL }, Effects { glass: false, ..Effects::ALL });
    assert_eq!(table(&glass(), Effects { mirrors: false, ..no_glass }), None);
    assert_eq!((table(&glass(), no_glass), table(&glass(), no_mirrors)), (Some(false), Some(true)));
    assert_eq!((table(&metal, no_glass), table(&metal, no_mirrors)), (Some(true), Some(false)));
}
