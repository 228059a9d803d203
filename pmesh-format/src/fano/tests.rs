use std::vec;
use std::vec::Vec;

use quickcheck::quickcheck;

use super::*;

/// The words of PMESH-SWI-05, with all possible numbers of low bits tried.
fn by_trying(count: u32, limit: u32) -> (u32, u64) {
    let (m, u) = (u64::from(count), u64::from(limit));
    if m == 0 {
        return (0, 0);
    }
    let high = |low: u32| m + ((u - 1) >> low);
    let low = (0..40).min_by_key(|&low| m * u64::from(low) + high(low)).unwrap();
    (low, high(low))
}

#[test]
fn the_number_of_low_bits_is_the_best() {
    for limit in 0..200 {
        for count in 0..=limit {
            let shape = Shape::new(count, limit);
            assert_eq!((shape.low, shape.high_bits), by_trying(count, limit), "{count} below {limit}");
        }
    }
    // Three times the most faces there can be.
    let most = 3 << 30;
    for count in [1, 2, 1000, 1 << 20, 1 << 30, most - 1, most] {
        let shape = Shape::new(count, most);
        assert_eq!((shape.low, shape.high_bits), by_trying(count, most), "{count} below {most}");
    }
}

#[test]
fn numbers_are_stored_as_the_specification_says() {
    // 3 numbers below 100: 4 low bits make 12 + 3 + 6 bits, 5 make 15 + 3 + 3; the smaller of equals.
    let shape = Shape::new(3, 100);
    assert_eq!((shape.low, shape.high_bits), (4, 9));
    // 5 = 0·16 + 5, 21 = 1·16 + 5, 99 = 6·16 + 3: ones at 0, 2, 8.
    assert_eq!(shape.write(&[5, 21, 99]), [0x55, 0x03, 0b101, 1]);
}

fn read(shape: Shape, bytes: &[u8], block: usize) -> (bool, Vec<u32>, bool) {
    let mut reader = Reader::new(shape, bytes);
    let mut all = vec![];
    while reader.left() > 0 {
        let mut to = vec![0; block.min(reader.left())];
        if !reader.fill(&mut to) {
            return (false, all, reader.is_clean());
        }
        all.extend(to);
    }
    (true, all, reader.is_clean())
}

quickcheck! {
    fn what_is_written_is_read_again(gaps: Vec<u16>, sparse: u8, above: u16, block: u8) -> bool {
        let mut next = 0u32;
        let numbers: Vec<u32> = gaps
            .iter()
            .map(|&gap| {
                let number = next + (u32::from(gap) << (sparse % 8) >> (sparse / 32));
                next = number + 1;
                number
            })
            .collect();
        let shape = Shape::new(numbers.len() as u32, next + u32::from(above));
        let bytes = shape.write(&numbers);
        bytes.len() == shape.bytes() && read(shape, &bytes, 1 + usize::from(block)) == (true, numbers, true)
    }

    /// A bit more, or one less, is never clean, or gives other numbers.
    fn a_changed_bit_is_noticed(gaps: Vec<u8>, at: u16) -> bool {
        let mut next = 0;
        let numbers: Vec<u32> = gaps.iter().map(|&gap| { next += u32::from(gap) + 1; next - 1 }).collect();
        let shape = Shape::new(numbers.len() as u32, next);
        let mut bytes = shape.write(&numbers);
        if bytes.is_empty() {
            return true;
        }
        let at = usize::from(at) % (8 * bytes.len());
        bytes[at / 8] ^= 1 << (at % 8);
        let high = &bytes[shape.low_bytes()..];
        let (enough, found, clean) = read(shape, &bytes, 7);
        let right = ones(high, shape.high_bits) == u64::from(shape.count);
        let padded = is_padded(&bytes[..shape.low_bytes()], shape.low_bits()) && is_padded(high, shape.high_bits);
        found != numbers && enough && clean == (right && padded) || !clean && (!right || !padded)
    }
}
