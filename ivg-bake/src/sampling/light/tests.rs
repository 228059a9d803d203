use super::AliasTable;
use crate::sampling::rng::{Purpose, Stream};

/// Binomial counts: five standard deviations of n·p·(1 − p).
#[test]
fn draws_follow_the_weights() {
    let weights = [0.0, 3.0, 1e-3, 5.0, 0.5, 1.5];
    let total: f64 = weights.iter().sum();
    let table = AliasTable::new(&weights);
    let mut counts = [0u32; 6];
    let draws = 400_000;
    for item in 0..draws {
        let w = Stream::new(5, item).words(0, Purpose::Light);
        counts[table.draw(w[0], w[1])] += 1;
    }
    assert_eq!(counts[0], 0, "a weight of zero is never drawn");
    for (count, weight) in counts.iter().zip(weights) {
        let p = weight / total;
        let sigma = (draws as f64 * p * (1.0 - p)).sqrt();
        assert!((f64::from(*count) - draws as f64 * p).abs() <= 5.0 * sigma, "{count} draws for {p}");
    }
}

#[test]
fn one_weight_takes_every_draw_and_none_makes_an_empty_table() {
    let table = AliasTable::new(&[0.0, 2.0, 0.0]);
    assert!((0..1000).all(|i| table.draw(i << 22, u32::MAX - i) == 1));
    assert!(AliasTable::new(&[]).is_empty());
    assert!(AliasTable::new(&[0.0, 0.0]).is_empty());
    assert!(AliasTable::new(&[f64::NAN, 1.0]).is_empty());
}
