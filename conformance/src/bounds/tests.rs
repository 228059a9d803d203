use super::{Bound, Budget};
use std::hint::black_box;

const BUDGET: Budget =
    Budget { held: Bound { fixed: 100, per_byte: 2 }, allocated: Bound { fixed: 200, per_byte: 4 } };

#[test]
fn what_is_within_the_budget_passes() {
    let length = BUDGET.spend("test", 50, || black_box(Vec::<u8>::with_capacity(200)).capacity());
    assert_eq!(length, 200);
}

#[test]
#[should_panic(expected = "201 bytes held at once for 50 bytes of input, at most 200")]
fn one_byte_too_many_at_once_fails() {
    BUDGET.spend("test", 50, || drop(black_box(Vec::<u8>::with_capacity(201))));
}

#[test]
#[should_panic(expected = "450 bytes allocated for 50 bytes of input, at most 400")]
fn too_many_bytes_one_after_the_other_fail() {
    BUDGET.spend("test", 50, || {
        for _ in 0..3 {
            drop(black_box(Vec::<u8>::with_capacity(150)));
        }
    });
}
