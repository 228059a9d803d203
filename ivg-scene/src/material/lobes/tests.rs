use glam::Vec3;

use super::*;

/// The most light that can be sent on in a channel.
fn most(l: &Lobes) -> f32 {
    let edge = if l.metallic { Vec3::ONE } else { l.mirror_colour };
    (l.diffuse * l.diffuse_colour + l.mirror * edge + l.glass * Vec3::ONE).max_element()
}

#[test]
fn a_plain_material_reflects_its_albedo_evenly() {
    let grey = Material { albedo: Vec3::new(0.2, 0.5, 1.0), ..Material::default() };
    let lobes = grey.lobes(true, true);
    assert!(lobes.is_diffuse());
    assert_eq!((lobes.diffuse, lobes.diffuse_colour), (1.0, grey.albedo));
}

#[test]
fn a_metal_takes_the_place_of_the_albedo_and_a_layer_adds_to_it() {
    let gold = Vec3::new(1.0, 0.8, 0.4);
    let metal = Material {
        albedo: gold,
        specular: 0.75,
        specular_colour: gold,
        metallic: true,
        roughness: 0.5,
        ..Material::default()
    };
    let lobes = metal.lobes(true, true);
    assert_eq!((lobes.mirror, lobes.mirror_colour, lobes.alpha), (0.75, gold, 0.25));
    assert_eq!((lobes.diffuse, lobes.diffuse_colour), (0.25, gold));
    assert_eq!(metal.lobes(false, true).diffuse_colour * metal.lobes(false, true).diffuse, gold);

    let layer = Material { albedo: Vec3::splat(0.25), specular: 0.5, roughness: 0.1, ..Material::default() };
    let lobes = layer.lobes(true, true);
    assert_eq!((lobes.mirror, lobes.alpha), (0.5, 0.0));
    assert_eq!(lobes.diffuse * lobes.diffuse_colour, layer.albedo);
}

#[test]
fn glass_takes_its_share_of_what_does_not_mirror() {
    // As read from glTF: base 0.5, half of it let through, half of all metal.
    let mixture = Material {
        albedo: Vec3::splat(0.25),
        transmission: 0.5,
        specular: 0.5,
        specular_colour: Vec3::splat(0.5),
        metallic: true,
        ..Material::default()
    };
    let lobes = mixture.lobes(true, true);
    assert_eq!((lobes.diffuse, lobes.mirror, lobes.glass), (0.25, 0.5, 0.25));
    assert_eq!(lobes.diffuse_colour, Vec3::splat(0.5));
    assert!(!mixture.lobes(true, false).is_diffuse() && mixture.lobes(false, false).is_diffuse());
    let pane = Material { albedo: Vec3::ZERO, transmission: 1.0, ..Material::default() };
    assert_eq!((pane.lobes(true, true).diffuse, pane.lobes(true, true).glass), (0.0, 1.0));
}

#[test]
fn no_mixture_sends_on_more_than_it_gets() {
    for albedo in [0.0, 0.3, 0.9, 1.0] {
        for specular in [0.0, 0.04, 0.5, 1.0] {
            for transmission in [0.0, 0.5, 1.0] {
                for metallic in [false, true] {
                    let albedo = Vec3::new(albedo, 0.5 * albedo, 0.0) * (1.0 - transmission);
                    let m = Material { albedo, specular, transmission, metallic, ..Material::default() };
                    let lobes = m.lobes(true, true);
                    // Three products and two sums, each rounded by at most 2^-24.
                    assert!(most(&lobes) <= 1.0 + 5.0 * f32::EPSILON, "{m:?}: {lobes:?}");
                    assert!(lobes.diffuse_colour.max_element() <= 1.0);
                }
            }
        }
    }
}
