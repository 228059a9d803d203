use glam::Vec3;
use ivg_scene::{Effect, Need, PlannedEffect};

use super::{bounces_worth_following, measure_reflections, pilot};
use crate::cases::{SceneBuilder, plan};
use crate::{BakeOptions, Estimator, Silent, bake, bake_measured};

#[test]
fn bounces_stop_where_the_rest_is_below_the_cutoff() {
    let energy = [1.0, 0.5, 0.25, 0.125, 0.0625];
    assert_eq!(bounces_worth_following(&energy, 0.21), 2);
    assert_eq!(bounces_worth_following(&energy, 0.1874), 3);
    assert_eq!(bounces_worth_following(&energy, 0.01), 4);
    assert_eq!(bounces_worth_following(&energy, 0.99), 1);
    // A hundredth of the emitted energy, but a tenth of the reflected.
    assert_eq!(bounces_worth_following(&[1.0, 0.1, 0.01, 0.001], 0.02), 2);
}

/// In a closed room of albedo ρ = 0.6 a share ρ^k flies on after k reflections: Σ beyond B is 0.6^(B+1) / 0.4. At 2000 photons
/// a share is off by at most five times sqrt(0.6 0.4 / 2000) = 0.055.
#[test]
fn a_pilot_finds_the_reflections_of_a_furnace_and_fills_costs() {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.6, 1.0, false);
    builder.cuboid(Vec3::ZERO, Vec3::ONE, wall, true);
    let (scene, flat) = builder.build();
    let mut plan = plan(&scene, 999);
    plan.energy_cutoff = 0.04;
    plan.effects.push(PlannedEffect {
        effect: Effect::DirectLight,
        need: Need::Needed,
        reason: String::new(),
        cost: None,
    });
    let options = BakeOptions { dims: [5; 3], photons: 200_000, ..BakeOptions::default() };
    let report = pilot(&scene, &flat, &mut plan, &options).unwrap();
    assert_eq!(report.photons, 2000);
    assert!((report.flights_per_photon - 2.5).abs() < 0.25, "{}", report.flights_per_photon);
    assert!((report.energy_by_bounce[1] - 0.6).abs() < 0.055 && report.energy_by_bounce[0] == 1.0);
    assert_eq!(report.max_bounces, plan.max_bounces);
    // 0.6^(B+1) / 0.4 = 0.02, half of the cutoff, at B = 8.4; the tail of 2000 photons is known to a factor of about two, an octave of 1.4.
    assert!((7..=11).contains(&plan.max_bounces), "{}", plan.max_bounces);
    let cost = |effect| plan.effects.iter().find(|e| e.effect == effect).unwrap().cost;
    let (indirect, direct) = (cost(Effect::DiffuseIndirect).unwrap(), cost(Effect::DirectLight).unwrap());
    assert!((indirect.energy_share + direct.energy_share - 1.0).abs() < 1e-12);
    assert!((direct.energy_share - 0.4).abs() < 0.04, "{direct:?}");
    assert!((indirect.seconds + direct.seconds - report.total_seconds()).abs() < 1e-9);
    assert_eq!(cost(Effect::Sky), None, "a sky that is not there costs nothing");
    // The difference of two times, of which nothing is known but that it is not negative.
    let mirrors = cost(Effect::Mirrors).expect("what it would cost is measured");
    assert!(mirrors.seconds >= 0.0 && mirrors.energy_share == 0.0, "{mirrors:?}");
}

/// A pilot of path tracing tells energies as that of photons does, and a bake follows as many reflections as either finds.
#[test]
fn path_tracing_has_a_pilot_and_bakes_follow_what_it_finds() {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.6, 1.0, false);
    builder.cuboid(Vec3::ZERO, Vec3::ONE, wall, true);
    let (scene, flat) = builder.build();
    let options = BakeOptions { dims: [4; 3], photons: 3_000, paths: 512, ..BakeOptions::default() };
    let gather = BakeOptions { estimator: Estimator::Gather, ..options.clone() };
    let (mut a, mut b) = (plan(&scene, 999), plan(&scene, 999));
    let photons = pilot(&scene, &flat, &mut a, &options).unwrap();
    let paths = pilot(&scene, &flat, &mut b, &gather).unwrap();
    assert_eq!(photons.energy_by_bounce, paths.energy_by_bounce);
    assert!(paths.ray_seconds > 0.0 && paths.deposit_seconds == 0.0, "{paths:?}");
    assert!(a.max_bounces == b.max_bounces && a.max_bounces < 64);
    let mut c = plan(&scene, 64);
    measure_reflections(&scene, &flat, &mut c, &options).unwrap();
    assert_eq!(c.max_bounces, a.max_bounces);
    let mut d = plan(&scene, 64);
    let result = bake_measured(&scene, &flat, &mut d, &options, &Silent).unwrap();
    assert_eq!(d.max_bounces, a.max_bounces);
    assert_eq!(result, bake(&scene, &flat, &c, &options, &Silent).unwrap());
}
