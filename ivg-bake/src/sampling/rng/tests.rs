use super::{Purpose, Stream, philox, unit};

/// Known answers of the Random123 distribution (file `kat_vectors`, lines `philox4x32 10`).
#[test]
fn philox_gives_the_published_answers() {
    assert_eq!(philox([0; 4], [0; 2]), [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);
    assert_eq!(philox([u32::MAX; 4], [u32::MAX; 2]), [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]);
    assert_eq!(
        philox([0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344], [0xa409_3822, 0x299f_31d0]),
        [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]
    );
}

#[test]
fn seed_item_step_and_purpose_each_change_the_draw() {
    let base = Stream::new(7, 1).words(2, Purpose::Reflection);
    assert_eq!(base, Stream::new(7, 1).words(2, Purpose::Reflection));
    for other in [
        Stream::new(8, 1).words(2, Purpose::Reflection),
        Stream::new(7 + (1 << 32), 1).words(2, Purpose::Reflection),
        Stream::new(7, 2).words(2, Purpose::Reflection),
        Stream::new(7, 1 + (1 << 32)).words(2, Purpose::Reflection),
        Stream::new(7, 1).words(3, Purpose::Reflection),
        Stream::new(7, 1).words(2, Purpose::Light),
    ] {
        assert_ne!(base, other);
    }
}

#[test]
fn unit_numbers_stay_below_one() {
    assert!(unit(u32::MAX) < 1.0);
    assert_eq!(unit(0).to_bits(), 0);
}

/// 40,000 draws in 100 bins: chi-square with 99 degrees of freedom has mean 99 and standard deviation 14.1, so 170
/// is five standard deviations up.
#[test]
fn uniforms_are_uniform() {
    let mut bins = [0u32; 100];
    for item in 0..10_000 {
        for u in Stream::new(3, item).uniforms(0, Purpose::Light) {
            bins[(u * 100.0) as usize] += 1;
        }
    }
    let chi_square: f64 = bins.iter().map(|&n| (f64::from(n) - 400.0).powi(2) / 400.0).sum();
    assert!(chi_square < 170.0, "chi-square {chi_square}");
}
