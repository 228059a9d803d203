use glam::Vec3;
use ivg_scene::Material;

use super::{
    Outcome, ball_under_sky, leak_between_rooms, lit_rectangle, sky_furnace, spherical_cavity, white_furnace,
};
use crate::Estimator;

mod closed_forms;
mod effects;
mod hard;

#[track_caller]
fn check(outcome: &Outcome, sharp: f64) {
    assert!(outcome.holds(), "{outcome:?}");
    // A bound that noise has blown up proves nothing.
    assert!(outcome.bound <= sharp, "not sharp: {outcome:?}");
}

#[test]
fn white_furnaces_have_their_closed_form() {
    for albedo in [0.0, 0.3, 0.7, 0.95] {
        check(&white_furnace(albedo, 20_000, Estimator::TrackLength).unwrap(), 0.06);
    }
    check(&white_furnace(0.7, 40_000, Estimator::FaceCrossing).unwrap(), 0.05);
}

/// The integral of |cos| cos over a hemisphere is two thirds of that of cos.
#[test]
fn the_printed_estimator_is_a_third_too_dark() {
    let outcome = white_furnace(0.7, 40_000, Estimator::FaceCrossingRr6983).unwrap();
    assert!((outcome.figure + 1.0 / 3.0).abs() < outcome.bound, "{outcome:?}");
    assert!(outcome.bound < 0.04, "{outcome:?}");
}

#[test]
fn a_white_object_under_an_even_sky_disappears() {
    check(&sky_furnace(100_000).unwrap(), 0.04);
}

/// A ball that absorbs nothing cannot be told from the sky, whatever it does with the light; others are as dark as they
/// absorb.
#[test]
fn balls_under_an_even_sky_are_as_dark_as_they_absorb() {
    let plain = |albedo| Material { albedo: Vec3::splat(albedo), ..Material::default() };
    let layer = |specular| Material { specular, roughness: 0.0, ..plain(0.0) };
    let metal = |roughness| Material { specular: 1.0, metallic: true, roughness, ..plain(1.0) };
    let glass = Material { transmission: 1.0, ..plain(0.0) };
    let cases = [
        ("black", plain(0.0), 0.0),
        ("grey", plain(0.5), 0.5),
        ("white", plain(1.0), 1.0),
        ("mirror that absorbs half", layer(0.5), 0.5),
        ("mirror", layer(1.0), 1.0),
        ("metal", metal(0.0), 1.0),
        ("rough metal", metal(0.5), 1.0),
        ("very rough metal", metal(1.0), 1.0),
        ("half metal, half white", Material { specular: 0.5, ..metal(0.3) }, 1.0),
        ("glass", glass.clone(), 1.0),
        ("bubble", Material { thin: true, ..glass.clone() }, 1.0),
        ("diamond", Material { refractive_index: 2.4, ..glass }, 1.0),
    ];
    for (name, material, albedo) in cases {
        check(&ball_under_sky(name, material, albedo, 40_000).unwrap(), 0.1);
    }
}

#[test]
fn a_spherical_cavity_has_its_closed_form() {
    check(&spherical_cavity(0.5, 100_000).unwrap(), 0.08);
}

#[test]
fn a_rectangle_in_parallel_light_has_its_closed_form() {
    check(&lit_rectangle(400_000).unwrap(), 0.12);
}

#[test]
fn no_light_passes_walls_of_any_thickness() {
    for thickness in [0.0, 0.05, 0.25, 0.5, 1.0, 2.0] {
        let outcome = leak_between_rooms(thickness, 60_000).unwrap();
        check(&outcome, 1e-4);
    }
}
