use super::*;

#[test]
fn bits_are_spread() {
    for x in [0u64, 1, 2, 3, 0x5555, 0x8000, 0xFFFF] {
        let expected: u64 = (0..BITS).map(|k| (x >> k & 1) << (3 * k)).sum();
        assert_eq!(spread(x), expected, "{x:x}");
    }
}

#[test]
fn small_cubes_come_one_after_the_other() {
    // 4 x 4 x 4 points: the first eight on the curve are those of the lowest cube, and so on.
    let points: Vec<[f32; 3]> =
        (0..64u8).map(|v| [v % 4, v / 4 % 4, v / 16].map(|x| f32::from(x) * 2.0 - 100.0)).collect();
    let places = along_curve(&points);
    let mut order: Vec<usize> = (0..64).collect();
    order.sort_by_key(|&v| places[v]);
    for eight in order.chunks(8) {
        let cube = |v: usize| [v % 4 / 2, v / 4 % 4 / 2, v / 32];
        assert!(eight.iter().all(|&v| cube(v) == cube(eight[0])), "{eight:?}");
    }
}

#[test]
fn any_box_has_a_curve() {
    assert!(along_curve(&[]).is_empty());
    assert_eq!(along_curve(&[[5.0; 3], [5.0; 3]]), [0, 0]);
    let widest = along_curve(&[[f32::MIN; 3], [f32::MAX; 3], [0.0, f32::MIN, f32::MIN]]);
    assert_eq!(widest[..2], [0, (1 << (3 * BITS)) - 1]);
    assert!(widest[2] > 0 && widest[2] < widest[1], "{widest:?}");
}
