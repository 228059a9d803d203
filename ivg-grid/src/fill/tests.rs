use ivg_format::Lattice;
use quickcheck::{Arbitrary, Gen, TestResult};

use super::*;
use crate::HemisphereVectors;

/// Every combination of options.
pub(crate) const ALL: [FillOptions; 6] = {
    let smoothing = [Smoothing::Nowhere, Smoothing::Finest, Smoothing::EveryLevel];
    let mut all = [FillOptions::BEST; 6];
    let mut n = 0;
    while n < 6 {
        all[n] = FillOptions { neighbours: n >= 3, smoothing: smoothing[n % 3] };
        n += 1;
    }
    all
};

pub(crate) fn open_grid(dims: [u16; 3]) -> IrradianceGrid {
    let max = dims.map(|n| if n > 1 { f64::from(n - 1) } else { 0.0 });
    IrradianceGrid::new(Lattice::new(dims, [0.0; 3], max).expect("a box")).expect("small")
}

fn flat(vectors: &HemisphereVectors) -> &[f32] {
    vectors.as_flattened().as_flattened()
}

pub(crate) fn same_bits(a: &HemisphereVectors, b: &HemisphereVectors) -> bool {
    flat(a).iter().zip(flat(b)).all(|(a, b)| a.to_bits() == b.to_bits())
}

/// A small grid with random obstructions of which a random part was received, and what was sent.
#[derive(Clone, Debug)]
pub(crate) struct Partial {
    pub(crate) grid: IrradianceGrid,
    pub(crate) sent: Vec<(usize, HemisphereVectors)>,
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

    /// The same lattice and obstructions, nothing received.
    pub(crate) fn empty(&self) -> IrradianceGrid {
        let mut grid = open_grid(self.grid.lattice().dims);
        for index in 0..grid.vertex_count() {
            grid.set_validity(index, self.grid.validity()[index]);
            grid.set_blocked_edges(index, self.grid.blocked_edges()[index]);
        }
        grid
    }

    fn valid_sent(&self) -> impl Iterator<Item = &(usize, HemisphereVectors)> {
        self.sent.iter().filter(|(index, _)| self.grid.is_valid(*index))
    }
}

#[test]
fn received_vectors_are_never_altered() {
    fn law(partial: Partial) -> bool {
        ALL.iter().all(|options| {
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
            ALL.iter().all(|options| fill(&partial.grid, options).vectors().iter().all(inside)),
        )
    }
    quickcheck::quickcheck(law as fn(Partial) -> TestResult);
}

#[test]
fn the_order_of_arrival_does_not_matter_bit_for_bit() {
    fn law(mut partial: Partial, seed: u64) -> bool {
        let before = partial.grid.clone();
        partial.sent.sort_by_key(|(index, _)| (*index as u64 + 1).wrapping_mul(seed | 1).rotate_left(31));
        let mut other = partial.empty();
        // Fill on the way too: a picture shown half-way must not leave a trace.
        for (arrived, (index, vectors)) in partial.sent.iter().enumerate() {
            if arrived == partial.sent.len() / 2 {
                let _ = fill(&other, &FillOptions::default());
            }
            other.set(*index, vectors);
        }
        ALL.iter().all(|options| {
            let (a, b) = (fill(&before, options), fill(&other, options));
            a.vectors().iter().zip(b.vectors()).all(|(a, b)| same_bits(a, b))
        })
    }
    quickcheck::quickcheck(law as fn(Partial, u64) -> bool);
}

#[test]
fn filling_twice_is_filling_once() {
    fn law(partial: Partial) -> bool {
        ALL.iter().all(|options| {
            let once = fill(&partial.grid, options);
            let twice = fill(&once, options);
            once.vectors().iter().zip(twice.vectors()).all(|(a, b)| same_bits(a, b))
        })
    }
    quickcheck::quickcheck(law as fn(Partial) -> bool);
}

#[test]
fn nothing_received_is_darkness() {
    for options in &ALL {
        let filled = fill(&open_grid([4, 3, 5]), options);
        assert!(filled.vectors().iter().all(|vectors| *vectors == [[[0.0; 3]; 3]; 6]));
    }
    // Received, but only inside geometry: that is not light.
    let mut grid = open_grid([4, 3, 5]);
    grid.set(7, &[[[9.0; 3]; 3]; 6]);
    grid.set_validity(7, 0);
    assert!(fill(&grid, &ALL[0]).vectors().iter().all(|vectors| *vectors == [[[0.0; 3]; 3]; 6]));
    assert_eq!(
        grid.get(7),
        Some(crate::VertexValues::Vectors([[[9.0; 3]; 3]; 6])),
        "the given grid keeps what it received"
    );
}

#[test]
fn pushed_values_of_a_row_are_computed_by_hand() {
    // Six vertices in a row, the ends received: 0 and 64. Pull: 0, none, 64; above that 0, 64.
    let mut grid = open_grid([6, 1, 1]);
    grid.set(0, &[[[0.0; 3]; 3]; 6]);
    grid.set(5, &[[[64.0; 3]; 3]; 6]);
    let row = |neighbours, smoothing| {
        let filled = fill(&grid, &FillOptions { neighbours, smoothing });
        filled.vectors().iter().map(|v| v[0][0][0]).collect::<Vec<_>>()
    };
    // Along y and z there are no neighbours: the parent's share is 3/4. The node that is missing gets 3/4 0 + 1/4 64 = 16,
    // the vertices that are missing lie between 0, 16 and 64.
    assert_eq!(row(false, Smoothing::Nowhere), [0.0, 4.0, 12.0, 28.0, 52.0, 64.0]);
    // The node that is missing gets the mean of its neighbours, 32; a vertex next to a received one takes its value.
    assert_eq!(row(true, Smoothing::Nowhere), [0.0, 0.0, 24.0, 40.0, 64.0, 64.0]);
    // A quarter is the value's own; of the six neighbours four are missing and replaced by it: (6 a + b + c) / 8.
    assert_eq!(row(true, Smoothing::Finest), [0.0, 3.0, 23.0, 41.0, 61.0, 64.0]);
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
        for options in &ALL {
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
    assert!(fill(&open, &ALL[0]).vectors().iter().any(mixed));
}

#[test]
fn a_door_lets_light_through() {
    let mut grid = two_rooms([8, 5, 6], 4);
    let door = grid.lattice().index(3, 2, 2) as usize;
    grid.set_blocked_edges(door, 0);
    let filled = fill(&grid, &FillOptions::BEST);
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
    assert!(fill(&partial, &FillOptions::BEST).vectors().iter().all(|v| *v == [[[1.0; 3]; 3]; 6]));
    // The first vertex that arrives ends the guess for its whole room.
    let first = grid.lattice().index(6, 2, 2) as usize;
    grid = partial;
    grid.set(first, &[[[0.0; 3]; 3]; 6]);
    let filled = fill(&grid, &FillOptions::BEST);
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
    for options in &ALL {
        assert!(fill(&grid, options).vectors().iter().all(|v| *v == [[[2.0; 3]; 3]; 6]));
    }
}

#[test]
fn numbers_as_large_as_they_come_do_not_overflow() {
    // Sums and differences of these overflow; the means do not (IVG-FILL-02).
    for [a, b] in [[f32::MAX; 2], [f32::MAX, f32::MIN], [f32::MIN, -1.0], [f32::MAX, f32::MIN_POSITIVE]] {
        let mut grid = open_grid([7, 6, 5]);
        for index in (0..grid.vertex_count()).step_by(7) {
            grid.set(index, &[[[if index % 2 == 0 { a } else { b }; 3]; 3]; 6]);
        }
        for options in &ALL {
            let filled = fill(&grid, options);
            assert!(
                filled
                    .vectors()
                    .iter()
                    .all(|v| (b..=a).contains(&v[0][0][0]) || (a..=b).contains(&v[5][2][2]))
            );
        }
    }
}

#[test]
fn the_smallest_numbers_stay_in_range() {
    // Below the normal numbers halves are rounded.
    let mut grid = open_grid([7, 6, 5]);
    (0..grid.vertex_count()).step_by(5).for_each(|index| grid.set(index, &[[[f32::from_bits(3); 3]; 3]; 6]));
    for options in &ALL {
        assert!(fill(&grid, options).vectors().iter().all(|v| *v == [[[f32::from_bits(3); 3]; 3]; 6]));
    }
}

#[test]
fn with_only_the_corners_received_all_others_lie_between_them() {
    let mut grid = open_grid([9, 8, 7]);
    for (n, corner) in grid.clone().lattice().corners().enumerate() {
        grid.set(corner as usize, &[[[n as f32; 3]; 3]; 6]);
    }
    for options in &ALL {
        let filled = fill(&grid, options);
        let value = |x, y, z| filled.vectors()[grid.lattice().index(x, y, z) as usize][0][0][0];
        assert!(filled.vectors().iter().all(|v| (0.0..=7.0).contains(&v[0][0][0])));
        // Corner n lies at the far end of x, y, z for bits 0, 1, 2 of n: light grows along each axis.
        assert!(
            value(2, 4, 3) < value(6, 4, 3)
                && value(4, 2, 3) < value(4, 6, 3)
                && value(4, 4, 1) < value(4, 4, 5)
        );
    }
}

#[test]
fn a_missing_vertex_is_the_mean_of_its_six_neighbours() {
    let mut grid = open_grid([3; 3]);
    for index in (0..27).filter(|&index| index != 13) {
        grid.set(index, &[[[index as f32; 3]; 3]; 6]);
    }
    // Of a linear field that mean is the value itself, and smoothing keeps it. At most eight roundings of half an epsilon.
    let filled = fill(&grid, &FillOptions::BEST).vectors()[13][0][0][0];
    assert!((filled - 13.0).abs() < 13.0 * 8.0 * f32::EPSILON, "{filled}");
}

/// What smoothing makes of the values before it, computed one vertex after the other.
fn smoothed(rough: &IrradianceGrid) -> Vec<f32> {
    let dims = rough.lattice().dims.map(usize::from);
    let strides = [1, dims[0], dims[0] * dims[1]];
    let known = |index: usize| rough.is_received(index) && rough.is_valid(index);
    let value = |index: usize| rough.vectors()[index][3][1][2];
    (0..rough.vertex_count())
        .map(|index| {
            let neighbours: [Option<usize>; 6] = std::array::from_fn(|direction| {
                let (axis, up) = (direction / 2, direction % 2 == 1);
                let at = index / strides[axis] % dims[axis];
                let exists = if up { at + 1 < dims[axis] } else { at > 0 };
                let other =
                    if up { index.wrapping_add(strides[axis]) } else { index.wrapping_sub(strides[axis]) };
                let low = index.min(other);
                let open = exists
                    && rough.is_valid(index)
                    && rough.is_valid(other)
                    && rough.blocked_edges()[low] >> axis & 1 == 0;
                open.then_some(other)
            });
            if known(index)
                || !rough.is_valid(index)
                || neighbours.iter().flatten().filter(|&&other| known(other)).count() >= 4
            {
                return value(index);
            }
            let own = value(index);
            let [a, b, c, d, e, f] = neighbours.map(|other| other.map_or(own, value));
            0.125 * (((a + b) + (own + own)) + ((c + d) + (e + f)))
        })
        .collect()
}

#[test]
fn smoothing_takes_the_values_before_it_in_lattices_of_many_layers() {
    // Larger than what is held of a layer and its neighbours.
    for dims in [[12, 11, 10], [70, 3, 4], [2, 3, 90], [2, 2, 2], [1, 9, 80]] {
        let mut grid = open_grid(dims);
        let mut filled = FilledGrid::new(grid.clone(), FillOptions::BEST);
        for index in 0..grid.vertex_count() {
            let wall = u8::from(index % 13 == 4) | u8::from(index % 17 == 5) << 2;
            grid.set_blocked_edges(index, wall);
            filled.set_blocked_edges(index, wall);
        }
        let mut order: Vec<usize> = (0..grid.vertex_count()).collect();
        order.sort_by_key(|&index| (index as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29));
        for request in order.chunks(order.len().div_ceil(8)) {
            for &index in request {
                let vectors = [[[(index as f32 * 0.7).sin(); 3]; 3]; 6];
                grid.set(index, &vectors);
                filled.set(index, &vectors);
            }
            let rough = fill(&grid, &FillOptions { neighbours: true, smoothing: Smoothing::Nowhere });
            let expected = smoothed(&rough);
            let found = filled.grid().vectors().iter().map(|vectors| vectors[3][1][2]);
            // These walls leave a way to every vertex: nothing is a guess, which would not be smoothed.
            let differing = found.zip(&expected).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
            assert_eq!(differing, 0, "{dims:?} with {} received", grid.received_count());
        }
    }
}
