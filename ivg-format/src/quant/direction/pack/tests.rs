use super::*;
use crate::quant::direction::Octahedral24;
use crate::quant::pack::pack_hemisphere;

/// Numbers from 0 to 1, by a generator of test vectors: Knuth's MMIX.
fn random(state: &mut u64) -> f32 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 40) as f32 / (1u32 << 24) as f32
}

#[test]
fn together_they_are_what_each_is_alone() {
    let mut state = 11;
    let mut doubts = [0; 3];
    for round in 0..60_000usize {
        let hemisphere = round % 6;
        let kind = round / 6 % 3;
        let size = 2.0f32.powi((random(&mut state) * 60.0) as i32 - 30);
        let vertices: [HemisphereVectors; 16] = core::array::from_fn(|_| {
            let mut number = || random(&mut state) * 2.0 - 1.0;
            // Light from one side, nearly; from anywhere; and as numbers of few digits.
            let common = [number(), number(), number()];
            let vectors = [0, 1, 2].map(|_| {
                let strength = number().abs();
                [0, 1, 2].map(|i| match kind {
                    0 => (common[i] + number() * 0.02) * strength * size,
                    1 => number() * size,
                    _ => (number() * 8.0).round() * size,
                })
            });
            let mut vertex = HemisphereVectors::default();
            vertex[hemisphere] = vectors.map(|mut vector| {
                let side = if hemisphere % 2 == 0 { 1.0 } else { -1.0 };
                vector[hemisphere / 2] = vector[hemisphere / 2].abs() * side;
                vector
            });
            vertex
        });
        let packed = pack_together(&vertices, hemisphere);
        for (n, vertex) in vertices.iter().enumerate() {
            doubts[kind] += u32::from(packed.doubt[n] != 0);
            if packed.doubt[n] == 0 {
                let alone = pack_hemisphere::<Octahedral24>(&vertex[hemisphere], hemisphere).unwrap();
                assert_eq!(packed.directions[n], alone.direction, "{vertex:?}");
                let Unscaled { mantissas, exponent } = Unscaled::new(alone.colour);
                assert_eq!(
                    (packed.mantissas[n], packed.exponents[n]),
                    (mantissas, exponent.into()),
                    "{vertex:?}"
                );
                let largest = alone.colour.into_iter().fold(0.0, f64::max);
                assert!((f64::from(packed.largest[n]) - largest).abs() <= ERROR * largest, "{vertex:?}");
            }
        }
    }
    // Of 320,000 each: few of usual light, or it would not be worth it.
    assert!(doubts[0] < 16_000, "{doubts:?}");
}

#[test]
fn what_binary32_cannot_hold_is_in_doubt() {
    let numbers = [0.0, f32::NAN, f32::INFINITY, f32::MAX, 1e30, 1e-30, f32::from_bits(1)];
    let vertices = numbers.map(|number| {
        let mut vertex = HemisphereVectors::default();
        vertex[0] = [[1.0, 0.5, 0.25], [number, 0.0, 0.0], [number, 0.0, 0.0]];
        if number <= 1e-30 {
            vertex[0][0] = [0.0; 3];
        }
        vertex
    });
    assert!(pack_together(&vertices, 0).doubt.iter().all(|&doubt| doubt != 0));
}
