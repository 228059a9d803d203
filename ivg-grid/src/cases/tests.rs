use super::*;

#[test]
fn every_case_is_within_its_bound() {
    for case in CASES {
        let outcome = (case.run)();
        assert!(
            outcome.passed(),
            "{}: {} is {} > {}",
            case.name,
            case.figure,
            outcome.measured,
            outcome.bound
        );
    }
}

#[test]
fn an_outcome_beyond_its_bound_or_without_a_number_fails() {
    assert!(Outcome { measured: 1.0, bound: 1.0 }.passed());
    assert!(!Outcome { measured: 1.0 + 1e-12, bound: 1.0 }.passed());
    assert!(!Outcome { measured: f64::NAN, bound: 1.0 }.passed());
}

#[test]
fn names_are_unique() {
    for (index, case) in CASES.iter().enumerate() {
        assert!(CASES[..index].iter().all(|other| other.name != case.name), "{}", case.name);
    }
}

#[test]
fn the_cases_see_what_they_are_about() {
    // The furnace tells the formulas apart, and the figure is the one derived: 1 - 1/√3 on the nearest normals.
    let printed = furnace(Reconstruction::NSquared, 0.4227).measured;
    assert!(printed > 0.41, "{printed}");
}
