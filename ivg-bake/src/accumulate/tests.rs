use super::{MAX_FLIGHTS, MAX_QUANTA, Store, Sums, round};

#[test]
fn rounding_is_to_the_nearest_over_the_whole_range() {
    for x in [0.0f32, 0.25, 0.5, 0.75, 1.5, 2.5, 1234.4, 4_194_303.5, MAX_QUANTA] {
        assert_eq!(round(x), x.round_ties_even() as i64, "{x}");
        assert_eq!(round(-x), -(x.round_ties_even() as i64), "{}", -x);
    }
    for step in 0..100_000 {
        let x = (step as f32 - 50_000.0) * 83.884_1;
        assert_eq!(round(x), x.round_ties_even() as i64, "{x}");
    }
}

#[test]
fn the_most_flights_of_the_largest_deposits_do_not_overflow() {
    // One quantum more for rounding up at the bound.
    let largest = i128::from(round(MAX_QUANTA)) + 1;
    assert!(largest * i128::from(MAX_FLIGHTS) < i128::from(i64::MAX));
}

#[test]
fn shared_and_private_sums_are_the_same() {
    let deposits: Vec<(usize, [f32; 9])> = (0..1000)
        .map(|n| (n * 7 % 5 * 9, core::array::from_fn(|k| ((n * 31 + k * 17) % 1000) as f32 * 3.3 - 1500.0)))
        .collect();
    let shared = Store::shared(45);
    let private = Store::new(45, 2);
    assert!(matches!(private, Store::Private { .. }));
    let Store::Shared(sums) = &shared else { panic!("not shared") };
    let Store::Private { len, sets } = &private else { panic!("not private") };
    let (mut a, mut b) = (Store::take(sets, *len), Store::take(sets, *len));
    for (n, (first, quanta)) in deposits.iter().enumerate() {
        Store::view(sums).add(*first, quanta);
        if n % 3 == 0 { a.add(*first, quanta) } else { b.add(*first, quanta) }
    }
    Store::give_back(sets, b);
    Store::give_back(sets, a);
    let again = Store::take(sets, *len);
    assert!(again.0.iter().any(|&s| s != 0), "a set with deposits is used again");
    Store::give_back(sets, again);
    let (mut shared, mut private) = (shared, private);
    let numbers: [[i64; 45]; 2] = [shared.total().get(0), private.total().get(0)];
    assert_eq!(numbers[0], numbers[1]);
    let sums = shared.into_sums();
    assert!(sums.iter().any(|&s| s != 0));
    assert_eq!(sums, private.into_sums());
}

#[test]
fn large_grids_share_one_set() {
    assert!(matches!(Store::new(64 * 64 * 64 * 8 * 9, 16), Store::Shared(_)));
}
