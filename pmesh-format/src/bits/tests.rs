use std::vec::Vec;

use quickcheck::quickcheck;

use super::*;

#[test]
fn a_width_holds_every_number_below_the_count_and_no_more() {
    assert_eq!([0, 1, 2, 3, 4, 5, 8, 9].map(width), [0, 0, 1, 2, 2, 3, 3, 4]);
    assert_eq!([1 << 30, (1 << 30) + 1, u32::MAX].map(width), [30, 31, 32]);
}

#[test]
fn numbers_are_packed_from_the_lowest_bit_on() {
    let mut packer = Packer::default();
    for (number, width) in [(1, 1), (0b10, 2), (0, 0), (0x1234_5678, 32), (0b101, 3)] {
        packer.push(number, width);
    }
    // 38 bits: 1, 01 (lowest first), 32 bits, then 101.
    assert_eq!(packer.finish(), [0xC5, 0xB3, 0xA2, 0x91, 0x28]);
}

#[test]
fn only_unused_bits_of_the_last_byte_are_padding() {
    assert!(is_padded(&[], 0) && is_padded(&[0xFF], 8) && is_padded(&[0xFF, 1], 9));
    assert!(!is_padded(&[0xFF, 2], 9) && !is_padded(&[0x80], 7));
}

quickcheck! {
    fn what_is_packed_is_read_again(values: Vec<(u32, u8)>) -> bool {
        let values: Vec<(u32, u32)> = values
            .into_iter()
            .map(|(number, width)| (number, u32::from(width) % 33))
            .map(|(number, width)| (number & 1u32.unbounded_shl(width).wrapping_sub(1), width))
            .collect();
        let mut packer = Packer::default();
        values.iter().for_each(|&(number, width)| packer.push(number, width));
        let bytes = packer.finish();
        let mut at = 0u64;
        let good = values.iter().all(|&(value, width)| {
            at += u64::from(width);
            number(&bytes, at - u64::from(width), width) == value
        });
        good && bytes.len() == bytes_of(at) && is_padded(&bytes, at)
    }

    fn numbers_of_one_width_follow_each_other(values: Vec<u32>, width: u8) -> bool {
        let width = u32::from(width) % 33;
        let values: Vec<u32> =
            values.into_iter().map(|number| number & 1u32.unbounded_shl(width).wrapping_sub(1)).collect();
        let mut packer = Packer::default();
        values.iter().for_each(|&number| packer.push(number, width));
        let bytes = packer.finish();
        // Behind the last there are only zeros.
        let expected = [&values[..], &[0; 40]].concat();
        numbers(&bytes, width).take(expected.len()).eq(expected)
    }
}
