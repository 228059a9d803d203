use quickcheck::quickcheck;

use super::*;

const REQUEST: u64 = 1000;

/// Drives a scheduler over requests of the given sizes (1..=REQUEST) while both kinds are wanted, and gives the
/// bytes of geometry and light after each.
fn run(schedule: Schedule, sizes: &[u64]) -> Vec<(Kind, u64, u64)> {
    let mut scheduler = Scheduler::new(schedule);
    sizes
        .iter()
        .map(|size| {
            let kind = scheduler.next(true, true).unwrap();
            scheduler.note(kind, size % REQUEST + 1);
            (kind, scheduler.bytes(Kind::Geometry), scheduler.bytes(Kind::Light))
        })
        .collect()
}

quickcheck! {
    /// The deficit of light, share * all - light, changes by at most share * request when geometry is asked for
    /// (only done while it is <= 0) and falls by at most (1 - share) * request when light is (only done while it
    /// is > 0). So it never leaves one request. The last bit is for rounding of sums below 2^53.
    fn light_keeps_its_share_to_within_one_request(share: u8, sizes: Vec<u64>) -> bool {
        let share = f32::from(share) / 255.0;
        run(Schedule::Proportion { light: share }, &sizes).iter().all(|&(_, geometry, light)| {
            let deficit = f64::from(share) * (geometry + light) as f64 - light as f64;
            deficit.abs() <= REQUEST as f64 * (1.0 + 1e-9)
        })
    }

    fn alternating_never_asks_for_the_same_kind_twice(sizes: Vec<u64>) -> bool {
        run(Schedule::Alternate, &sizes).windows(2).all(|pair| pair[0].0 != pair[1].0)
    }

    fn one_kind_first_asks_for_nothing_else(sizes: Vec<u64>) -> bool {
        run(Schedule::GeometryFirst, &sizes).iter().all(|step| step.0 == Kind::Geometry)
            && run(Schedule::LightFirst, &sizes).iter().all(|step| step.0 == Kind::Light)
    }

    fn only_what_is_wanted_is_asked_for(share: f32, noted: Vec<(bool, u16)>) -> bool {
        let schedules =
            [Schedule::Alternate, Schedule::Proportion { light: share }, Schedule::GeometryFirst, Schedule::LightFirst];
        schedules.into_iter().all(|schedule| {
            let mut scheduler = Scheduler::new(schedule);
            for &(light, bytes) in &noted {
                scheduler.note(if light { Kind::Light } else { Kind::Geometry }, u64::from(bytes));
            }
            scheduler.next(false, false).is_none()
                && scheduler.next(true, false) == Some(Kind::Geometry)
                && scheduler.next(false, true) == Some(Kind::Light)
                && scheduler.next(true, true).is_some()
        })
    }
}

#[test]
fn the_ends_of_the_share_are_one_kind_only() {
    let sizes = vec![10; 50];
    assert!(run(Schedule::Proportion { light: 0.0 }, &sizes).iter().all(|step| step.0 == Kind::Geometry));
    assert!(run(Schedule::Proportion { light: 1.0 }, &sizes).iter().all(|step| step.0 == Kind::Light));
    assert!(
        run(Schedule::Proportion { light: f32::NAN }, &sizes).iter().all(|step| step.0 == Kind::Geometry)
    );
}

#[test]
fn a_share_missed_while_one_kind_was_not_wanted_is_made_up_for() {
    let mut scheduler = Scheduler::new(Schedule::Proportion { light: 0.5 });
    scheduler.note(Kind::Geometry, 5000);
    let mut light_first = 0;
    while scheduler.next(true, true) == Some(Kind::Light) {
        scheduler.note(Kind::Light, 1000);
        light_first += 1;
    }
    assert_eq!(light_first, 5);
}
