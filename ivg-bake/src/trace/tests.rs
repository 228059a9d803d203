use glam::{DVec3, Vec3};
use ivg_scene::Material;

use super::{Books, Tracer};
use crate::cases::SceneBuilder;
use crate::estimate::Flight;
use crate::sampling::hemisphere;
use crate::sampling::rng::{Purpose, Stream};
use crate::stage::{Effects, Stage};

const DIFFUSE: Effects = Effects { textures: false, sky: false, mirrors: false, glass: false };

/// Counts flights, and remembers the largest power.
#[derive(Default)]
struct Count {
    flights: u64,
    largest: f32,
}

fn trace(builder: SceneBuilder, photons: u64, max_bounces: u32) -> (Books, Count) {
    trace_with(builder, DIFFUSE, photons, max_bounces)
}

fn trace_with(builder: SceneBuilder, effects: Effects, photons: u64, max_bounces: u32) -> (Books, Count) {
    let (scene, flat) = builder.build();
    let stage = Stage::new(&scene, &flat, effects, None).unwrap();
    let tracer = Tracer { stage: &stage, seed: 3, max_bounces };
    let (mut books, mut count) = (Books::default(), Count::default());
    let mut deposit = |flight: Flight| {
        count.flights += 1;
        count.largest = count.largest.max(flight.power.max_element());
    };
    (0..photons).for_each(|photon| tracer.trace(photon, &mut deposit, &mut books));
    (books, count)
}

fn room(albedo: f32) -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(albedo, 1.0, false);
    builder.cuboid(Vec3::new(-1.0, -0.7, -1.3), Vec3::ONE, wall, true);
    builder
}

fn assert_balanced(books: &Books) {
    for c in 0..3 {
        let spent = books.absorbed[c] + books.escaped[c] + books.cut[c];
        assert_eq!(books.emitted[c], spent, "channel {c} of {books:?}");
    }
    assert!(books.emitted[1] > 0);
}

#[test]
fn energy_books_balance_to_the_last_quantum() {
    let mut open = SceneBuilder::default();
    let white = open.material(0.8, 0.0, true);
    let lamp = open.material(0.1, 3.0, true);
    open.quad(Vec3::ZERO, Vec3::X, Vec3::Y, white);
    open.quad(Vec3::new(0.2, 0.2, 1.0), Vec3::X * 0.5, Vec3::Y * 0.5, lamp);
    let (books, _) = trace(open, 20_000, 6);
    assert_balanced(&books);
    assert!(books.escaped[0] > 0 && books.absorbed[0] > 0);
}

/// A photon of a furnace is reflected with probability ρ each time, so a share ρ of the energy flies on after every
/// reflection; five standard deviations of a binomial share of 20,000.
#[test]
fn every_reflection_keeps_the_albedo_and_nothing_escapes_a_closed_room() {
    let (books, _) = trace(room(0.6), 20_000, 1000);
    assert_balanced(&books);
    assert_eq!(books.escaped, [0; 3], "light left a closed room");
    assert_eq!(books.cut, [0; 3]);
    for k in 0..3 {
        let (before, after) = (books.after_bounces[k] as f64, books.after_bounces[k + 1] as f64);
        let photons = 20_000.0 * 0.6f64.powi(k as i32);
        let sigma = (0.6 * 0.4 / photons).sqrt();
        assert!((after / before - 0.6).abs() < 5.0 * sigma, "reflection {k}: {}", after / before);
    }
}

#[test]
fn a_closed_room_of_albedo_one_ends_at_the_bounce_cap_and_says_so() {
    let (books, count) = trace(room(1.0), 300, 500);
    assert_balanced(&books);
    assert_eq!(books.cut, books.emitted);
    assert_eq!(books.escaped, [0; 3]);
    assert_eq!(books.flights, 300 * 501);
    // All but the first flight of each photon.
    assert_eq!(count.flights, 300 * 500);
}

#[test]
fn no_photon_grows_and_first_flights_are_not_deposited() {
    let (books, count) = trace(room(0.9), 2000, 100);
    assert!(count.largest <= 1.0, "{}", count.largest);
    assert_eq!(count.flights, books.flights - 2000);
    let (_, none) = trace(room(0.9), 2000, 0);
    assert_eq!(none.flights, 0);
}

/// Walls in coordinate planes of bake space, where a bound of the error relative to the coordinate would be zero: a ray
/// that starts on such a wall must not meet it again from behind.
#[test]
fn paths_stay_inside_a_closed_box_on_a_floor() {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.9, 1.0, false);
    builder.cuboid(Vec3::ZERO, Vec3::splat(2.0), wall, true);
    builder.cuboid(Vec3::new(0.3, 0.0, 0.4), Vec3::new(0.9, 1.2, 1.0), wall, false);
    let (scene, flat) = builder.build();
    let stage = Stage::new(&scene, &flat, DIFFUSE, None).unwrap();
    let (low, high) = (DVec3::new(0.299, -0.001, 0.399), DVec3::new(0.901, 1.201, 1.001));
    for path in 0..3000 {
        let stream = Stream::new(3, path);
        let mut origin = stage.space.to_bake(DVec3::new(0.6, 0.6, 0.7));
        let u = stream.uniforms(0, Purpose::Gather);
        let mut direction = hemisphere::sphere([u[0], u[1]]);
        for bounce in 1..40 {
            let hit = stage.accel.closest_hit(origin, direction, f32::MAX).expect("the room is closed");
            let point = stage.surfaces.point(hit.triangle, hit.weights);
            let place = stage.space.to_world(point.position);
            assert!(place.cmpge(low).all() && place.cmple(high).all(), "path {path} got out to {place}");
            let side = point.facing(-direction);
            origin = point.origin(side);
            let u = stream.uniforms(bounce, Purpose::Reflection);
            direction = hemisphere::cosine(side, [u[0], u[1]]);
        }
    }
}

/// A room with everything that surfaces can do, in colours that differ from channel to channel.
fn mixed_room() -> SceneBuilder {
    let mut builder = room(0.6);
    let gold = Vec3::new(1.0, 0.8, 0.3);
    let metal = |roughness, specular| Material {
        albedo: gold,
        specular,
        specular_colour: gold,
        metallic: true,
        roughness,
        ..Material::default()
    };
    let tinted = Vec3::new(0.9, 1.0, 0.5);
    let glass = Material {
        albedo: Vec3::ZERO,
        transmission: 1.0,
        transmission_colour: tinted,
        ..Material::default()
    };
    let materials = [
        metal(0.0, 1.0),
        metal(0.6, 0.7),
        glass.clone(),
        Material { thin: true, ..glass },
        Material {
            albedo: Vec3::new(0.5, 0.1, 0.0),
            specular: 0.4,
            specular_colour: Vec3::new(0.0, 0.3, 1.0),
            roughness: 0.4,
            ..Material::default()
        },
    ];
    for (n, material) in materials.into_iter().enumerate() {
        let index = builder.any_material(material);
        builder.sphere(Vec3::new(-0.7 + 0.35 * n as f32, 0.1, -0.2), 0.15, 2, index, false);
    }
    builder
}

#[test]
fn books_balance_and_no_photon_grows_whatever_surfaces_do() {
    let (books, count) = trace_with(mixed_room(), Effects::ALL, 20_000, 200);
    assert_balanced(&books);
    assert!(count.largest <= 1.0, "{}", count.largest);
    assert_eq!(books.escaped, [0; 3], "light left a closed room");
}

/// All effects in a scene that has none of them: not one bit is different.
#[test]
fn what_is_not_there_changes_nothing() {
    let (with, flights) = trace_with(room(0.7), Effects::ALL, 2000, 100);
    let (without, same) = trace(room(0.7), 2000, 100);
    assert_eq!((with, flights.flights, flights.largest), (without, same.flights, same.largest));
}

/// The code for mixtures, given surfaces that reflect evenly, makes of every photon what the plain code makes of it.
#[test]
fn even_reflection_is_the_same_in_a_scene_with_a_mirror() {
    let traced = |effects| {
        let mut builder = room(0.7);
        let mirror = builder.any_material(Material { specular: 1.0, ..Material::default() });
        // Behind the room, where no light comes.
        builder.sphere(Vec3::splat(50.0), 1.0, 0, mirror, false);
        trace_with(builder, effects, 2000, 100)
    };
    let (with, without) = (traced(Effects::ALL), traced(DIFFUSE));
    assert_eq!(with.0, without.0);
    assert_eq!((with.1.flights, with.1.largest), (without.1.flights, without.1.largest));
}
