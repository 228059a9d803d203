use ivg_format::{Encoding, Quantity, RadianceHarmonics};
use quickcheck::{Arbitrary, Gen};

use super::*;
use crate::fill;
use crate::fill::tests::{ALL, Partial, open_grid};

fn bits(grid: &IrradianceGrid) -> Vec<u32> {
    let numbers = match grid.values() {
        crate::Values::Vectors(vectors) => vectors.as_flattened().as_flattened().as_flattened(),
        crate::Values::Radiance(radiance) => radiance.as_flattened().as_flattened(),
    };
    numbers.iter().map(|number| number.to_bits()).collect()
}

/// Something that happens to a grid on its way.
#[derive(Clone, Debug)]
enum Step {
    /// The vertex of `sent` with this number arrives, scaled by a power of two: a newer generation if it has before.
    Arrives(u8, i8),
    Validity(u16, u8),
    Blocked(u16, u8),
    Look,
    Forget,
}

impl Arbitrary for Step {
    fn arbitrary(g: &mut Gen) -> Self {
        match u8::arbitrary(g) % 16 {
            0 => Self::Validity(u16::arbitrary(g), u8::arbitrary(g) % 2),
            1 => Self::Blocked(u16::arbitrary(g), u8::arbitrary(g) % 8),
            2 => Self::Forget,
            3..8 => Self::Look,
            _ => Self::Arrives(u8::arbitrary(g), i8::arbitrary(g) % 4),
        }
    }
}

#[test]
fn each_look_gives_what_filling_from_scratch_gives() {
    fn law(partial: Partial, steps: Vec<Step>) -> bool {
        ALL.iter().all(|options| {
            let mut received = partial.empty();
            let mut filled = FilledGrid::new(received.clone(), *options);
            let count = received.vertex_count();
            steps.iter().chain([&Step::Look]).all(|step| {
                match *step {
                    Step::Arrives(n, scale) => {
                        let sent = partial.sent.get(usize::from(n) % partial.sent.len().max(1));
                        if let Some((index, vectors)) = sent {
                            let scale = 2.0_f32.powi(i32::from(scale));
                            let vectors = vectors.map(|c| c.map(|v| v.map(|number| number * scale)));
                            received.set(*index, &vectors);
                            filled.set(*index, &vectors);
                        }
                    }
                    Step::Validity(index, validity) => {
                        received.set_validity(usize::from(index) % count, validity);
                        filled.set_validity(usize::from(index) % count, validity);
                    }
                    Step::Blocked(index, edges) => {
                        received.set_blocked_edges(usize::from(index) % count, edges);
                        filled.set_blocked_edges(usize::from(index) % count, edges);
                    }
                    Step::Forget => filled.forget_filled(),
                    Step::Look => return bits(filled.grid()) == bits(&fill(&received, options)),
                }
                (0..count).all(|index| {
                    filled.received(index)
                        == received.is_received(index).then(|| received.get(index)).flatten()
                })
            })
        })
    }
    quickcheck::QuickCheck::new().tests(300).quickcheck(law as fn(Partial, Vec<Step>) -> bool);
}

#[test]
fn the_order_of_arrival_does_not_matter_bit_for_bit_whenever_one_looks() {
    fn law(partial: Partial, seed: u64, looks: u64) -> bool {
        ALL.iter().all(|options| {
            let mut filled = FilledGrid::new(partial.empty(), *options);
            let mut order: Vec<_> = partial.sent.iter().collect();
            order.sort_by_key(|(index, _)| (*index as u64 + 1).wrapping_mul(seed | 1).rotate_left(31));
            for (n, (index, vectors)) in order.into_iter().enumerate() {
                filled.set(*index, vectors);
                if looks >> (n % 64) & 1 == 1 {
                    filled.grid();
                }
            }
            bits(filled.grid()) == bits(&fill(&partial.grid, options))
        })
    }
    quickcheck::quickcheck(law as fn(Partial, u64, u64) -> bool);
}

#[test]
fn radiance_harmonics_are_filled_like_the_first_numbers_of_vectors() {
    fn law(partial: Partial, looks: u64) -> bool {
        let harmonics = |vectors: &crate::HemisphereVectors| -> RadianceHarmonics {
            let numbers = vectors.as_flattened().as_flattened();
            std::array::from_fn(|channel| std::array::from_fn(|n| numbers[9 * channel + n]))
        };
        ALL.iter().all(|options| {
            let lattice = *partial.grid.lattice();
            let mut grid = IrradianceGrid::of(lattice, Quantity::Radiance).expect("small");
            for index in 0..grid.vertex_count() {
                grid.set_validity(index, partial.grid.validity()[index]);
                grid.set_blocked_edges(index, partial.grid.blocked_edges()[index]);
            }
            let mut filled = FilledGrid::new(grid, *options);
            for (n, (index, vectors)) in partial.sent.iter().enumerate() {
                filled.set(*index, &harmonics(vectors));
                if looks >> (n % 64) & 1 == 1 {
                    filled.grid();
                }
            }
            let expected = fill(&partial.grid, options);
            filled.grid().radiance().iter().zip(expected.vectors()).all(|(a, b)| {
                let (a, b) = (a.as_flattened(), harmonics(b));
                a.iter().zip(b.as_flattened()).all(|(a, b)| a.to_bits() == b.to_bits())
            })
        })
    }
    quickcheck::quickcheck(law as fn(Partial, u64) -> bool);
}

#[test]
fn a_partition_that_closes_while_vertices_arrive_keeps_the_rooms_apart() {
    let lattice = *open_grid([8, 5, 6]).lattice();
    let room = |index: usize| f32::from(lattice.coords(index as u64)[0] / 4);
    let mut filled = FilledGrid::new(open_grid([8, 5, 6]), FillOptions::default());
    for index in (0..240).step_by(9) {
        filled.set(index, &[[[room(index); 3]; 3]; 6]);
        filled.grid();
    }
    let mixed = |v: &crate::HemisphereVectors| v[0][0][0] > 0.0 && v[0][0][0] < 1.0;
    assert!(filled.grid().vectors().iter().any(mixed));
    for index in (0..240).filter(|&index| lattice.coords(index as u64)[0] == 3) {
        filled.set_blocked_edges(index, 0b001);
    }
    assert!(filled.is_pending());
    for index in (4..240).step_by(9) {
        let vectors = filled.grid().vectors();
        assert!((0..240).all(|index| vectors[index] == [[[room(index); 3]; 3]; 6]));
        filled.set(index, &[[[room(index); 3]; 3]; 6]);
    }
}

#[test]
fn a_look_without_news_computes_nothing() {
    let mut filled = FilledGrid::new(open_grid([3; 3]), FillOptions::default());
    assert!(filled.is_pending());
    assert!(filled.grid().is_filled());
    assert!(!filled.is_pending());
    filled.set(13, &[[[1.0; 3]; 3]; 6]);
    assert!(filled.is_pending() && filled.received_count() == 1);
    assert_eq!(filled.grid().vectors(), [[[[1.0; 3]; 3]; 6]; 27]);
    // The same validity changes nothing.
    filled.set_validity(13, 200);
    filled.set_blocked_edges(13, 0);
    assert!(!filled.is_pending());
}

#[test]
fn events_are_taken_over_and_stale_ones_leave_no_trace() {
    // A vertex inside geometry, with values that are not light: they must not be lost to the fill.
    let mut whole = open_grid([4, 3, 5]);
    (0..60).for_each(|index| whole.set(index, &[[[(index + 1) as f32; 3]; 3]; 6]));
    whole.set_validity(31, 0);
    let mut options = ivg_format::EncodeOptions::new();
    (options.encoding, options.vertices_per_slice) = (Encoding::VectorsF32, 2);
    let bytes = ivg_format::encode(&whole.as_source(), &options).expect("a sound grid");
    let (mut plain, mut filled) =
        (open_grid([4, 3, 5]), FilledGrid::new(open_grid([4, 3, 5]), FillOptions::default()));
    for _ in 0..2 {
        // Everything comes twice: the second time it changes nothing.
        ivg_format::decode_all(&bytes, &ivg_format::Limits::default(), |event| {
            plain.accept(&event).expect("the same lattice");
            filled.accept(&event).expect("the same lattice");
            assert_eq!(bits(filled.grid()), bits(&fill(&plain, &FillOptions::default())));
            assert!((0..60).all(|index| filled.received(index) == plain.get(index)));
        })
        .expect("a sound file");
    }
    let mut other = FilledGrid::new(open_grid([4, 3, 4]), FillOptions::default());
    let refused = ivg_format::decode_all(&bytes, &ivg_format::Limits::default(), |event| {
        if matches!(event, Event::Corners(_) | Event::Bundle(_)) {
            assert_eq!(other.accept(&event), Err(GridError::OtherLattice));
        }
    });
    refused.expect("a sound file");
    assert_eq!(other.received_count(), 0);
}

#[test]
fn what_becomes_known_counts_though_its_value_stays() {
    // Blocks of two: 0, missing, missing, 64. The second gets 0 from its known neighbour, and then receives just that;
    // for the third it is now a known neighbour too.
    let mut received = open_grid([8, 1, 1]);
    received.set(0, &[[[0.0; 3]; 3]; 6]);
    received.set(7, &[[[64.0; 3]; 3]; 6]);
    let mut filled = FilledGrid::new(received.clone(), FillOptions::default());
    let before = filled.grid().vectors()[4][0][0][0];
    received.set(2, &[[[0.0; 3]; 3]; 6]);
    filled.set(2, &[[[0.0; 3]; 3]; 6]);
    assert_eq!(bits(filled.grid()), bits(&fill(&received, &FillOptions::default())));
    assert!(filled.grid().vectors()[4][0][0][0] < before);
}

#[test]
fn vertices_that_exchange_their_values_change_what_is_smoothed_beside_them() {
    // Both are in one block, whose mean stays: what depends on them alone is the smoothing of their neighbours.
    let mut received = open_grid([8, 1, 1]);
    for options in &ALL {
        let mut filled = FilledGrid::new(received.clone(), *options);
        for light in [[1.0, 3.0, 5.0], [3.0, 1.0, 5.0]] {
            for (vertex, light) in [0, 1, 7].into_iter().zip(light) {
                received.set(vertex, &[[[light; 3]; 3]; 6]);
                filled.set(vertex, &[[[light; 3]; 3]; 6]);
            }
            assert_eq!(bits(filled.grid()), bits(&fill(&received, options)), "{options:?}");
        }
    }
}
