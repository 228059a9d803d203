use ivg_format::Lattice;
use quickcheck::{Arbitrary, Gen, TestResult};

use super::*;

const BOTH: [FillOptions; 2] = [FillOptions { smooth: false }, FillOptions { smooth: true }];

fn open_grid(dims: [u16; 3]) -> IrradianceGrid {
    let max = dims.map(|n| if n > 1 { f64::from(n - 1) } else { 0.0 });
    IrradianceGrid::new(Lattice::new(dims, [0.0; 3], max).expect("a box")).expect("small")
}

fn flat(vectors: &HemisphereVectors) -> &[f32] {
    vectors.as_flattened().as_flattened()
}

fn same_bits(a: &HemisphereVectors, b: &HemisphereVectors) -> bool {
    flat(a).iter().zip(flat(b)).all(|(a, b)| a.to_bits() == b.to_bits())
}

/// A small grid with random obstructions of which a random part was received, and what was sent.
#[derive(Clone, Debug)]
struct Partial {
    grid: IrradianceGrid,
    sent: Vec<(usize, HemisphereVectors)>,
}

impl Arbitrary for Partial {
    fn arbitrary(g: &mut Gen) -> Self {
        let mut grid = open_grid([(); 3].map(|()| u16::from(u8::arbitrary(g) % 6) + 1));
        let obstructed = u8::arbitrary(g) / 2;
        let share = u8::arbitrary(g);
        let mut sent = Vec::new();
        for index in 0..grid.vertex_count() {
            let bits = (0..3).map(|bit| u8::from(u8::arbitrary(g) < obstructed) << bit).sum();
            grid.set_blocked_edges(index, bits);
            if u8::arbitrary(g) < obstructed / 4 {
                grid.set_validity(index, 0);
            }
            if u8::arbitrary(g) < share {
                // Of very different sizes and signs, so that a careless mean would leave their range by rounding.
                let size = 10.0_f32.powi(i32::from(i8::arbitrary(g) % 9));
                let vectors =
                    [(); 6].map(|()| [(); 3].map(|()| [(); 3].map(|()| size * f32::from(i8::arbitrary(g)))));
                sent.push((index, vectors));
            }
        }
        let mut partial = Self { grid, sent };
        partial.receive_all();
        partial
    }
}

impl Partial {
    fn receive_all(&mut self) {
        self.sent.iter().for_each(|(index, vectors)| self.grid.set(*index, vectors));
    }

    fn valid_sent(&self) -> impl Iterator<Item = &(usize, HemisphereVectors)> {
        self.sent.iter().filter(|(index, _)| self.grid.is_valid(*index))
    }
}

#[test]
fn received_vectors_are_never_altered() {
    fn law(partial: Partial) -> bool {
        BOTH.iter().all(|options| {
            let filled = fill(&partial.grid, options);
            filled.is_filled()
                && filled.received_count() == partial.sent.len()
                && partial.valid_sent().all(|(index, vectors)| same_bits(&filled.vectors()[*index], vectors))
        })
    }
    quickcheck::quickcheck(law as fn(Partial) -> bool);
}

#[test]
fn filled_values_lie_between_the_received_ones() {
    fn law(partial: Partial) -> TestResult {
        let Some((_, first)) = partial.valid_sent().next() else { return TestResult::discard() };
        let (mut low, mut high) = (flat(first).to_vec(), flat(first).to_vec());
        for (_, vectors) in partial.valid_sent() {
            for (component, &value) in flat(vectors).iter().enumerate() {
                low[component] = low[component].min(value);
                high[component] = high[component].max(value);
            }
        }
        let inside = |vectors: &HemisphereVectors| {
            flat(vectors).iter().enumerate().all(|(c, value)| (low[c]..=high[c]).contains(value))
        };
        TestResult::from_bool(
            BOTH.iter().all(|options| fill(&partial.grid, options).vectors().iter().all(inside)),
        )
    }
    quickcheck::quickcheck(law as fn(Partial) -> TestResult);
}

#[test]
fn the_order_of_arrival_does_not_matter_bit_for_bit() {
    fn law(mut partial: Partial, seed: u64) -> bool {
        let before = partial.grid.clone();
        partial.sent.sort_by_key(|(index, _)| (*index as u64 + 1).wrapping_mul(seed | 1).rotate_left(31));
        let mut other = open_grid(before.lattice().dims);
        for index in 0..other.vertex_count() {
            other.set_validity(index, before.validity()[index]);
            other.set_blocked_edges(index, before.blocked_edges()[index]);
        }
        // Fill on the way too: a picture shown half-way must not leave a trace.
        for (arrived, (index, vectors)) in partial.sent.iter().enumerate() {
            if arrived == partial.sent.len() / 2 {
                let _ = fill(&other, &FillOptions::default());
            }
            other.set(*index, vectors);
        }
        BOTH.iter().all(|options| {
            let (a, b) = (fill(&before, options), fill(&other, options));
            a.vectors().iter().zip(b.vectors()).all(|(a, b)| same_bits(a, b))
        })
    }
    quickcheck::quickcheck(law as fn(Partial, u64) -> bool);
}

#[test]
fn filling_twice_is_filling_once() {
    fn law(partial: Partial) -> bool {
        BOTH.iter().all(|options| {
            let once = fill(&partial.grid, options);
            let twice = fill(&once, options);
            once.vectors().iter().zip(twice.vectors()).all(|(a, b)| same_bits(a, b))
        })
    }
    quickcheck::quickcheck(law as fn(Partial) -> bool);
}

#[test]
fn nothing_received_is_darkness() {
    for options in &BOTH {
        let filled = fill(&open_grid([4, 3, 5]), options);
        assert!(filled.vectors().iter().all(|vectors| *vectors == [[[0.0; 3]; 3]; 6]));
    }
    // Received, but only inside geometry: that is not light.
    let mut grid = open_grid([4, 3, 5]);
    grid.set(7, &[[[9.0; 3]; 3]; 6]);
    grid.set_validity(7, 0);
    assert!(fill(&grid, &BOTH[0]).vectors().iter().all(|vectors| *vectors == [[[0.0; 3]; 3]; 6]));
    assert_eq!(
        grid.get(7),
        Some(crate::VertexValues::Vectors([[[9.0; 3]; 3]; 6])),
        "the given grid keeps what it received"
    );
}

#[test]
fn pushed_values_of_a_row_are_computed_by_hand() {
    // Four vertices in a row, the ends received: 0 and 16. Pull: 0, 16. Push: 0 + 16/4 and 16 - 16/4. The smoothing
    // then takes (6 × 4 + 0 + 12) / 8 = 4.5 and its mirror image.
    let mut grid = open_grid([4, 1, 1]);
    grid.set(0, &[[[0.0; 3]; 3]; 6]);
    grid.set(3, &[[[16.0; 3]; 3]; 6]);
    let row = |options| fill(&grid, options).vectors().iter().map(|v| v[0][0][0]).collect::<Vec<_>>();
    assert_eq!(row(&BOTH[0]), [0.0, 4.0, 12.0, 16.0]);
    assert_eq!(row(&BOTH[1]), [0.0, 4.5, 11.5, 16.0]);
}

/// The vertices with x below `wall` are one room, the others another; edges across are blocked. Each room gets one
/// constant light, received at a few vertices.
fn two_rooms(dims: [u16; 3], wall: u16) -> IrradianceGrid {
    let mut grid = open_grid(dims);
    for index in 0..grid.vertex_count() {
        let x = grid.lattice().coords(index as u64)[0];
        if x + 1 == wall {
            grid.set_blocked_edges(index, 0b001);
        }
        if index % 11 == 3 || grid.lattice().is_corner(index as u64) {
            grid.set(index, &[[[if x < wall { 1.0 } else { 0.0 }; 3]; 3]; 6]);
        }
    }
    grid
}

#[test]
fn rooms_with_a_wall_thinner_than_a_cell_between_them_do_not_mix_at_all() {
    for wall in [1, 4, 5, 7] {
        let grid = two_rooms([8, 5, 6], wall);
        for options in &BOTH {
            let filled = fill(&grid, options);
            for (index, vectors) in filled.vectors().iter().enumerate() {
                let light = if grid.lattice().coords(index as u64)[0] < wall { 1.0 } else { 0.0 };
                assert_eq!(*vectors, [[[light; 3]; 3]; 6], "wall {wall}, vertex {index}");
            }
        }
    }
    // Without the blocked edges the same grid mixes: the law above is about them.
    let mut open = two_rooms([8, 5, 6], 4);
    (0..open.vertex_count()).for_each(|index| open.set_blocked_edges(index, 0));
    let mixed = |v: &HemisphereVectors| v[0][0][0] > 0.01 && v[0][0][0] < 0.99;
    assert!(fill(&open, &BOTH[0]).vectors().iter().any(mixed));
}

#[test]
fn a_door_lets_light_through() {
    let mut grid = two_rooms([8, 5, 6], 4);
    let door = grid.lattice().index(3, 2, 2) as usize;
    grid.set_blocked_edges(door, 0);
    let filled = fill(&grid, &BOTH[1]);
    assert!(filled.vectors().iter().any(|v| v[0][0][0] > 0.0 && v[0][0][0] < 1.0));
}

#[test]
fn a_room_of_which_nothing_arrived_is_filled_from_outside_last() {
    let mut grid = two_rooms([8, 5, 6], 4);
    let mut partial = open_grid([8, 5, 6]);
    for index in 0..grid.vertex_count() {
        partial.set_blocked_edges(index, grid.blocked_edges()[index]);
        if grid.lattice().coords(index as u64)[0] < 4 && grid.is_received(index) {
            partial.set(index, &grid.vectors()[index]);
        }
    }
    assert!(fill(&partial, &BOTH[1]).vectors().iter().all(|v| *v == [[[1.0; 3]; 3]; 6]));
    // The first vertex that arrives ends the guess for its whole room.
    let first = grid.lattice().index(6, 2, 2) as usize;
    grid = partial;
    grid.set(first, &[[[0.0; 3]; 3]; 6]);
    let filled = fill(&grid, &BOTH[1]);
    assert_eq!(filled.vectors()[grid.lattice().index(4, 0, 0) as usize], [[[0.0; 3]; 3]; 6]);
}

#[test]
fn invalid_vertices_count_for_nothing_but_get_values() {
    let mut grid = open_grid([3, 3, 3]);
    for index in 0..27 {
        grid.set(index, &[[[2.0; 3]; 3]; 6]);
    }
    grid.set(13, &[[[500.0; 3]; 3]; 6]);
    grid.set_validity(13, 0);
    for options in &BOTH {
        assert!(fill(&grid, options).vectors().iter().all(|v| *v == [[[2.0; 3]; 3]; 6]));
    }
}
