use ivg_format::Lattice;
use quickcheck::{Arbitrary, Gen};

use super::*;
use crate::{FillOptions, HemisphereVectors, fill};

/// All components of a vertex's vectors alike: enough to see which vertices a lookup reads.
fn constant(value: f32) -> HemisphereVectors {
    [[[value; 3]; 3]; 6]
}

/// A grid with steps of 0.5, 1 and 2 m whose origin is (-1, 10, 3), all received.
fn grid_of(dims: [u16; 3], value: impl Fn([u16; 3]) -> f32) -> IrradianceGrid {
    let origin = [-1.0, 10.0, 3.0];
    let steps = [0.5, 1.0, 2.0];
    let max = std::array::from_fn(|axis| origin[axis] + steps[axis] * f64::from(dims[axis] - 1));
    let lattice = Lattice::new(dims, origin, max).expect("a box");
    let mut grid = IrradianceGrid::new(lattice).expect("small");
    for index in 0..grid.vertex_count() {
        grid.set(index, &constant(value(lattice.coords(index as u64))));
    }
    grid
}

/// The world position of lattice coordinates.
fn at(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(-1.0 + 0.5 * x, 10.0 + y, 3.0 + 2.0 * z)
}

fn lookup(grid: &IrradianceGrid, p: DVec3, n: Option<Vec3>, filter: SpatialFilter) -> f32 {
    let vectors = grid.vectors_at(p, n, filter);
    assert!(vectors.as_flattened().as_flattened().iter().all(|c| c.to_bits() == vectors[0][0][0].to_bits()));
    vectors[0][0][0]
}

/// Lattice coordinates from two cells before to two cells behind a lattice of up to 6 vertices, in 1/64 steps.
#[derive(Clone, Copy, Debug)]
struct Point(f64, f64, f64);

impl Arbitrary for Point {
    fn arbitrary(g: &mut Gen) -> Self {
        let mut coordinate = || f64::from(u16::arbitrary(g) % 640) / 64.0 - 2.0;
        Self(coordinate(), coordinate(), coordinate())
    }
}

#[derive(Clone, Debug)]
struct Values(IrradianceGrid);

impl Arbitrary for Values {
    fn arbitrary(g: &mut Gen) -> Self {
        let dims = [(); 3].map(|()| u16::from(u8::arbitrary(g) % 6) + 1);
        let mut grid = grid_of(dims, |_| 0.0);
        (0..grid.vertex_count()).for_each(|index| grid.set(index, &constant(f32::from(i8::arbitrary(g)))));
        Self(grid)
    }
}

impl Values {
    fn obstruct(&mut self, seed: u64) {
        let mut state = seed | 1;
        for index in 0..self.0.vertex_count() {
            state = state.wrapping_mul(0x5851_F42D_4C95_7F2D).wrapping_add(0x1405_7B7E_F767_814F);
            let random = (state >> 33) as u8;
            self.0.set_blocked_edges(index, random & (random >> 3));
            self.0.set_validity(index, if state >> 60 < 3 { 0 } else { 255 });
        }
    }
}

#[test]
fn names_read_back() {
    for filter in SpatialFilter::ALL {
        assert_eq!(SpatialFilter::from_name(filter.name()), Some(filter));
    }
    assert_eq!(SpatialFilter::from_name("nearest"), None);
}

#[test]
fn trilinear_weights_are_the_textbook_ones() {
    let grid = grid_of([2, 2, 2], |[i, j, k]| f32::from(i + 10 * j + 100 * k));
    // 0.25 + 10 × 0.5 + 100 × 0.75, all exact in binary.
    assert_eq!(lookup(&grid, at(0.25, 0.5, 0.75), None, SpatialFilter::Trilinear), 80.25);
    let taps = Taps::new(&grid, at(0.25, 0.5, 0.75), None, SpatialFilter::Trilinear);
    let weights: Vec<(usize, f32)> = taps.iter().collect();
    assert_eq!(weights.len(), 8);
    assert_eq!(weights[1], (1, 0.25 * 0.5 * 0.25));
    assert_eq!(weights[6], (6, 0.75 * 0.5 * 0.75));
}

#[test]
fn vertices_give_their_own_value_to_the_trilinear_filter_only() {
    let grid = grid_of([4, 3, 5], |[i, j, k]| if [i, j, k] == [2, 1, 3] { 216.0 } else { 0.0 });
    assert_eq!(lookup(&grid, at(2.0, 1.0, 3.0), None, SpatialFilter::Trilinear), 216.0);
    // The B-spline's own weight at a vertex is (2/3)³: it smooths.
    assert!((lookup(&grid, at(2.0, 1.0, 3.0), None, SpatialFilter::Tricubic) - 64.0).abs() < 1e-4);
}

#[test]
fn linear_fields_are_reproduced() {
    let grid = grid_of([7, 6, 8], |[i, j, k]| f32::from(i) - 2.0 * f32::from(j) + 0.5 * f32::from(k));
    for (x, y, z) in [(2.3, 1.9, 4.5), (1.0, 2.0, 5.99), (4.4, 3.3, 1.01)] {
        for filter in SpatialFilter::ALL {
            let expected = x - 2.0 * y + 0.5 * z;
            let found = f64::from(lookup(&grid, at(x, y, z), None, filter));
            // 64 products of values below 16 summed in f32: 64 × 16 × 2^-24 = 6e-5.
            assert!((found - expected).abs() < 6e-5, "{} at {x} {y} {z}: {found}", filter.name());
        }
    }
}

#[test]
fn the_cubic_filter_is_eight_linear_fetches() {
    fn law(Values(grid): Values, Point(x, y, z): Point) -> bool {
        let dims = grid.lattice().dims;
        let located = [x, y, z];
        let fetches: [[(f64, f64); 2]; 3] = std::array::from_fn(|axis| {
            let (base, fraction) = locate(located[axis], 0.0, 1.0, dims[axis] - 1);
            cubic_fetches(fraction).map(|(offset, weight)| (f64::from(base) + offset, weight))
        });
        let mut sum = 0.0;
        for (x, wx) in fetches[0] {
            for (y, wy) in fetches[1] {
                for (z, wz) in fetches[2] {
                    let value = lookup(&grid, at(x, y, z), None, SpatialFilter::Trilinear);
                    sum += wx * wy * wz * f64::from(value);
                }
            }
        }
        // Values below 128; 8 × 8 against 64 products in f32: 64 × 128 × 2^-24 = 5e-4.
        (sum - f64::from(lookup(
            &grid,
            at(located[0], located[1], located[2]),
            None,
            SpatialFilter::Tricubic,
        )))
        .abs()
            < 5e-4
    }
    quickcheck::quickcheck(law as fn(Values, Point) -> bool);
}

#[test]
fn outside_the_grid_the_nearest_point_answers() {
    fn law(Values(grid): Values, Point(x, y, z): Point) -> bool {
        let last = grid.lattice().dims.map(|n| f64::from(n - 1));
        let inside = at(x.clamp(0.0, last[0]), y.clamp(0.0, last[1]), z.clamp(0.0, last[2]));
        SpatialFilter::ALL
            .into_iter()
            .all(|filter| lookup(&grid, at(x, y, z), None, filter) == lookup(&grid, inside, None, filter))
    }
    quickcheck::quickcheck(law as fn(Values, Point) -> bool);
    let grid = grid_of([3, 3, 3], |[i, ..]| f32::from(i));
    assert_eq!(lookup(&grid, DVec3::splat(f64::INFINITY), None, SpatialFilter::Trilinear), 2.0);
    assert_eq!(lookup(&grid, DVec3::splat(f64::NAN), None, SpatialFilter::Trilinear), 0.0);
}

#[test]
fn continuous_everywhere_where_nothing_obstructs() {
    fn law(Values(grid): Values, Point(x, y, z): Point) -> bool {
        // Values differ by at most 255 a step along each of three axes; 2e-6 steps apart, plus roundings as above.
        let bound = 255.0 * 3.0 * 2e-6 + 5e-4;
        let (low, high) = (at(x - 1e-6, y - 1e-6, z - 1e-6), at(x + 1e-6, y + 1e-6, z + 1e-6));
        SpatialFilter::ALL.into_iter().all(|filter| {
            (lookup(&grid, low, None, filter) - lookup(&grid, high, None, filter)).abs() < bound
        })
    }
    quickcheck::quickcheck(law as fn(Values, Point) -> bool);
}

#[test]
fn weights_are_positive_and_sum_to_one_however_obstructed() {
    fn law(mut values: Values, Point(x, y, z): Point, seed: u64, facing: u8) -> bool {
        values.obstruct(seed);
        let n = [None, Some(Vec3::X), Some(Vec3::new(-0.6, 0.8, 0.0)), Some(Vec3::NEG_Z)]
            [usize::from(facing % 4)];
        SpatialFilter::ALL.into_iter().all(|filter| {
            let taps = Taps::new(&values.0, at(x, y, z), n, filter);
            let sum: f32 = taps.iter().map(|(_, weight)| weight).sum();
            // Each of up to 64 weights and their sum is rounded to 2^-24.
            taps.iter().all(|(_, weight)| weight >= 0.0) && (sum - 1.0).abs() < 64.0 * 6e-8
        })
    }
    quickcheck::quickcheck(law as fn(Values, Point, u64, u8) -> bool);
}

#[test]
fn invalid_vertices_count_nothing_while_a_corner_is_usable() {
    fn law(mut values: Values, Point(x, y, z): Point, seed: u64) -> bool {
        values.obstruct(seed);
        let grid = &values.0;
        let taps = |filter| Taps::new(grid, at(x, y, z), None, filter);
        let corner_usable = taps(SpatialFilter::Trilinear).iter().any(|(vertex, _)| grid.is_valid(vertex));
        let none_invalid = |filter| taps(filter).iter().all(|(vertex, _)| grid.is_valid(vertex));
        !corner_usable || SpatialFilter::ALL.into_iter().all(none_invalid)
    }
    quickcheck::quickcheck(law as fn(Values, Point, u64) -> bool);
}

/// The bright room's light is 1 but for the rounding of up to 64 weights and their sum; the dark room's is exactly 0,
/// or light leaks.
fn room(grid: &IrradianceGrid, p: DVec3, n: Option<Vec3>, filter: SpatialFilter) -> f32 {
    let light = lookup(grid, p, n, filter);
    if (light - 1.0).abs() < 64.0 * 6e-8 { 1.0 } else { light }
}

/// Vertices with i below `wall` are a bright room, the others a dark one; the edges between are blocked.
fn rooms(wall: u16) -> IrradianceGrid {
    let mut grid = grid_of([8, 5, 6], |[i, ..]| if i < wall { 1.0 } else { 0.0 });
    for index in 0..grid.vertex_count() {
        if grid.lattice().coords(index as u64)[0] + 1 == wall {
            grid.set_blocked_edges(index, 0b001);
        }
    }
    grid
}

#[test]
fn a_wall_thinner_than_a_cell_lets_nothing_through_to_surfaces() {
    for wall in 1..8 {
        let grid = rooms(wall);
        for filter in SpatialFilter::ALL {
            for share in [0.02, 0.3, 0.5, 0.7, 0.98] {
                let x = f64::from(wall) - 1.0 + share;
                // The two faces of a wall at x: each sees its own room, wherever in the cell the wall is.
                let p = at(x, 1.3, 2.6);
                assert_eq!(room(&grid, p, Some(Vec3::NEG_X), filter), 1.0, "wall {wall} at {x}");
                assert_eq!(room(&grid, p, Some(Vec3::X), filter), 0.0, "wall {wall} at {x}");
                // Without a normal the nearer room.
                let nearer = if share < 0.5 { 1.0 } else { 0.0 };
                if share != 0.5 {
                    assert_eq!(room(&grid, p, None, filter), nearer, "wall {wall} at {x}");
                }
            }
        }
    }
}

#[test]
fn a_surface_beside_the_wall_faces_along_it_and_stays_in_its_room() {
    // A floor 0.4 cells from the wall: its normal points up, all corners in front are above it, on both sides of the
    // wall; those of its own room are nearer.
    let grid = rooms(4);
    for filter in SpatialFilter::ALL {
        assert_eq!(room(&grid, at(3.2, 1.1, 2.5), Some(Vec3::Y), filter), 1.0);
        assert_eq!(room(&grid, at(3.8, 1.1, 2.5), Some(Vec3::Y), filter), 0.0);
    }
}

#[test]
fn reachable_around_an_edge_counts() {
    // One blocked edge in a cell: the way round through the other corners is open, so all corners count.
    let mut grid = grid_of([2, 2, 2], |[i, ..]| f32::from(i));
    grid.set_blocked_edges(0, 0b001);
    assert_eq!(lookup(&grid, at(0.5, 0.5, 0.5), Some(Vec3::X), SpatialFilter::Trilinear), 0.5);
    // All four edges along x blocked: the corners are apart.
    [0, 2, 4, 6].into_iter().for_each(|index| grid.set_blocked_edges(index, 0b001));
    assert_eq!(lookup(&grid, at(0.5, 0.5, 0.5), Some(Vec3::X), SpatialFilter::Trilinear), 1.0);
}

#[test]
fn the_cubic_filter_does_not_reach_past_a_wall_beyond_its_cell() {
    // The wall is one cell further; the four-vertex support reaches over it.
    let grid = rooms(4);
    assert_eq!(room(&grid, at(2.9, 2.0, 2.0), None, SpatialFilter::Tricubic), 1.0);
    assert_eq!(room(&grid, at(4.1, 2.0, 2.0), None, SpatialFilter::Tricubic), 0.0);
}

#[test]
fn only_where_all_corners_are_invalid_the_filled_value_answers() {
    let mut grid = grid_of([4, 2, 2], |[i, ..]| f32::from(i));
    for index in (0..16).filter(|index| index % 4 < 2) {
        grid.set_validity(index, 0);
    }
    let filled = fill(&grid, &FillOptions::default());
    // Between the invalid planes: the filled values, which come from the valid vertices 2 and 3.
    let inside = lookup(&filled, at(0.5, 0.5, 0.5), None, SpatialFilter::Trilinear);
    assert!((2.0..=3.0).contains(&inside), "{inside}");
    // Between an invalid and a valid plane: the valid one alone, however far.
    assert_eq!(lookup(&filled, at(1.01, 0.5, 0.5), None, SpatialFilter::Trilinear), 2.0);
    // Right on an invalid vertex no usable corner has weight.
    let vertex = filled.vectors()[1][0][0][0];
    assert_eq!(lookup(&filled, at(1.0, 0.0, 0.0), None, SpatialFilter::Trilinear), vertex);
}

#[test]
fn missing_vertices_of_an_unfilled_grid_count_nothing() {
    let mut grid = IrradianceGrid::new(*grid_of([3, 3, 3], |_| 0.0).lattice()).expect("small");
    for filter in SpatialFilter::ALL {
        assert_eq!(lookup(&grid, at(1.2, 0.3, 1.9), None, filter), 0.0, "nothing received, nothing seen");
    }
    grid.set(0, &constant(5.0));
    assert_eq!(lookup(&grid, at(0.9, 0.9, 0.9), None, SpatialFilter::Trilinear), 5.0);
    assert_eq!(lookup(&grid, at(1.1, 1.1, 1.1), None, SpatialFilter::Trilinear), 0.0);
}

#[test]
fn an_axis_of_one_vertex_is_constant_along_it() {
    let grid = grid_of([1, 4, 1], |[_, j, _]| f32::from(j));
    for filter in SpatialFilter::ALL {
        let middle = lookup(&grid, at(0.0, 1.5, 0.0), Some(Vec3::X), filter);
        assert!((middle - 1.5).abs() < 1e-6);
        assert_eq!(lookup(&grid, at(-7.0, 1.5, 9.0), Some(Vec3::X), filter), middle);
    }
}
