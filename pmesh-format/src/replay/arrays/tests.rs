use std::vec;
use std::vec::Vec;

use quickcheck::quickcheck;

use super::*;

quickcheck! {
    /// Wherever the bytes lie, and as often as it is done.
    fn arrays_are_what_their_bytes_say(values: Vec<[u32; 3]>, shift: u8) -> bool {
        let shift = usize::from(shift) % 8;
        let mut bytes = vec![0; shift];
        bytes.extend(values.as_flattened().iter().flat_map(|value| value.to_le_bytes()));
        let (mut integers, mut floats) = (Vec::<[u32; 3]>::new(), Vec::<[f32; 3]>::new());
        for _ in 0..2 {
            append(&mut integers, &bytes[shift..], 2 * values.len());
            append(&mut floats, &bytes[shift..], 2 * values.len());
        }
        let twice = [&values[..], &values].concat();
        integers == twice && floats.iter().zip(&twice).all(|(x, y)| x.map(f32::to_bits) == *y)
    }
}

#[test]
fn one_coordinate_outside_is_noticed_wherever_it_is() {
    let bounds = [[-1.0, -2.0, -3.0], [1.0, 2.0, 3.0f32]];
    for count in 0..15 {
        let right = vec![[1.0, -2.0, 0.5]; count];
        assert!(inside(&right, bounds));
        for at in 0..3 * count {
            for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3.5, -3.5] {
                let mut wrong = right.clone();
                wrong.as_flattened_mut()[at] = value;
                assert!(!inside(&wrong, bounds), "{value} at {at} of {count}");
            }
        }
    }
}
