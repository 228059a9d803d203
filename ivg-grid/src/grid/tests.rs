use super::*;

fn lattice(dims: [u16; 3]) -> Lattice {
    let max = dims.map(|n| if n > 1 { f64::from(n - 1) } else { 0.0 });
    Lattice::new(dims, [0.0; 3], max).expect("a box")
}

#[test]
fn a_new_grid_has_nothing_received_and_everything_valid() {
    let grid = IrradianceGrid::new(lattice([5, 4, 7])).expect("small");
    assert_eq!(grid.vertex_count(), 140);
    assert_eq!((grid.received_count(), grid.valid_count(), grid.blocked_edge_count()), (0, 140, 0));
    assert!((0..140).all(|index| !grid.is_received(index) && grid.get(index).is_none()));
    assert!(!grid.is_filled());
}

#[test]
fn zero_light_counts_as_received_and_a_repeat_counts_once() {
    let mut grid = IrradianceGrid::new(lattice([5, 4, 7])).expect("small");
    grid.set(64, &[[[0.0; 3]; 3]; 6]);
    grid.set(64, &[[[0.0; 3]; 3]; 6]);
    assert_eq!(grid.received_count(), 1);
    assert!(grid.is_received(64) && !grid.is_received(63) && !grid.is_received(65));
    assert_eq!(grid.get(64), Some(VertexValues::Vectors([[[0.0; 3]; 3]; 6])));
    assert_eq!(grid.get(140), None);
}

#[test]
fn a_lattice_above_the_limit_is_refused_before_anything_is_allocated() {
    // 65,535³ vertices would take 6e16 bytes: the test would not come back if they were asked for.
    let huge = Lattice { dims: [65_535; 3], origin: [0.0; 3], step: [1.0; 3] };
    let expected = GridError::TooManyVertices { vertices: 65_535u64.pow(3), limit: DEFAULT_MAX_VERTICES };
    assert_eq!(IrradianceGrid::new(huge), Err(expected));
    assert!(matches!(
        IrradianceGrid::with_limit(huge, Quantity::Vectors, u64::MAX),
        Err(GridError::TooManyVertices { .. })
    ));
    assert!(IrradianceGrid::with_limit(lattice([2, 2, 2]), Quantity::Vectors, 8).is_ok());
    assert!(IrradianceGrid::with_limit(lattice([2, 2, 2]), Quantity::Vectors, 7).is_err());
    let empty = Lattice { dims: [0, 1, 1], origin: [0.0; 3], step: [0.0; 3] };
    assert!(matches!(IrradianceGrid::new(empty), Err(GridError::Lattice(_))));
}

#[test]
fn parts_of_another_length_are_refused_by_name() {
    let parts = |vectors: usize, validity: usize, blocked: usize| {
        IrradianceGrid::from_parts(
            lattice([2, 2, 1]),
            vec![[[[1.0; 3]; 3]; 6]; vectors],
            vec![VALIDITY_FREE; validity],
            vec![0xff; blocked],
        )
    };
    let grid = parts(4, 4, 4).expect("fits");
    assert_eq!(grid.received_count(), 4);
    assert_eq!(grid.blocked_edges(), [0b011, 0b010, 0b001, 0], "edges that leave the lattice are dropped");
    assert_eq!(grid.blocked_edge_count(), 4);
    assert_eq!(parts(4, 3, 4), Err(GridError::Length { array: "validity", found: 3, vertices: 4 }));
    assert!(matches!(parts(5, 4, 4), Err(GridError::Length { array: "irradiance vectors", .. })));
    assert!(matches!(parts(4, 4, 0), Err(GridError::Length { array: "blocked edges", .. })));
}

#[test]
fn the_largest_component_looks_at_signs_and_every_place() {
    let mut grid = IrradianceGrid::new(lattice([2, 1, 1])).expect("small");
    assert_eq!(grid.largest_component(), 0.0);
    let mut vectors = [[[0.25; 3]; 3]; 6];
    vectors[5][2][2] = -7.5;
    grid.set(1, &vectors);
    assert_eq!(grid.largest_component(), 7.5);
}

#[test]
fn counts_follow_every_change() {
    let mut grid = IrradianceGrid::new(lattice([3, 2, 2])).expect("small");
    assert!(!grid.is_unobstructed(), "nothing has arrived");
    (0..12).for_each(|index| grid.set(index, &[[[1.0; 3]; 3]; 6]));
    assert!(grid.is_unobstructed());
    for (validity, valid) in [(0, 11), (0, 11), (1, 12), (255, 12), (0, 11)] {
        grid.set_validity(4, validity);
        assert_eq!(grid.valid_count(), valid);
        assert_eq!(grid.is_unobstructed(), valid == 12);
    }
    grid.set_validity(4, 255);
    for (bits, blocked) in [(0b111, 3), (0b101, 2), (0b1111_1000, 0), (0b010, 1)] {
        grid.set_blocked_edges(0, bits);
        assert_eq!(grid.blocked_edge_count(), blocked);
        assert_eq!(grid.is_unobstructed(), blocked == 0);
    }
    let parts = IrradianceGrid::from_parts(
        *grid.lattice(),
        grid.vectors().to_vec(),
        grid.validity().to_vec(),
        grid.blocked_edges().to_vec(),
    );
    assert_eq!(parts.as_ref(), Ok(&grid), "the counts belong to what is compared");
}
