use super::{LONG_BOUNCES, MOST_BOUNCES, SURE_BOUNCES, kept};

/// Paths go on for sure, then with what surfaces keep, then with less than 1 whatever these keep: so they end.
#[test]
fn roulette_ends_paths_between_white_sheets() {
    for share in [0.0, 0.5, 1.0] {
        assert_eq!(kept(SURE_BOUNCES, share).to_bits(), 1.0_f64.to_bits());
        assert_eq!(kept(SURE_BOUNCES + 1, share).to_bits(), share.to_bits());
        assert_eq!(kept(LONG_BOUNCES, share).to_bits(), share.to_bits());
        assert_eq!(kept(LONG_BOUNCES + 1, share).to_bits(), share.min(63.0 / 64.0).to_bits());
        assert_eq!(kept(MOST_BOUNCES, share).to_bits(), share.min(63.0 / 64.0).to_bits());
    }
    // Reflections of a path between sheets that keep everything: 64, then 64 on average (a geometric series).
    let mut alive = 1.0;
    let mut reflections = 0.0;
    for bounce in 1..=MOST_BOUNCES {
        reflections += alive;
        alive *= kept(bounce, 1.0);
    }
    assert!((reflections - 128.0).abs() < 1e-9, "{reflections}");
}
