use super::*;
use alloc::vec::Vec;
use quickcheck::quickcheck;

fn lattice(dims: [u16; 3]) -> Lattice {
    Lattice::new(dims, [-1.0, 0.0, 2.0], [1.0, 3.0, 4.0]).unwrap()
}

#[test]
fn first_vertex_is_at_the_minimum_and_last_at_the_maximum() {
    // Powers of two: every step and product is exact, so equality is the right test.
    let l = lattice([5, 4, 3]);
    assert_eq!(l.position(0, 0, 0), [-1.0, 0.0, 2.0]);
    assert_eq!(l.position(4, 3, 2), [1.0, 3.0, 4.0]);
    assert_eq!(l.step, [0.5, 1.0, 1.0]);
}

#[test]
fn an_axis_of_one_vertex_lies_in_the_middle() {
    let l = lattice([1, 2, 1]);
    assert_eq!(l.position(0, 1, 0), [0.0, 3.0, 3.0]);
    assert_eq!(l.step, [0.0, 3.0, 0.0]);
}

#[test]
fn numbers_that_make_no_lattice_are_refused_by_axis() {
    let new = |dims, max| Lattice::new(dims, [0.0; 3], max);
    assert_eq!(new([2, 0, 2], [1.0; 3]), Err(LatticeError::EmptyAxis { axis: 1 }));
    assert_eq!(new([2, 2, 2], [1.0, 1.0, f64::NAN]), Err(LatticeError::NotFinite { axis: 2 }));
    assert_eq!(new([2, 2, 2], [1.0, 1.0, f64::INFINITY]), Err(LatticeError::NotFinite { axis: 2 }));
    assert_eq!(new([2, 2, 2], [1.0, 0.0, 1.0]), Err(LatticeError::Step { axis: 1 }));
    assert_eq!(new([2, 2, 2], [-1.0, 1.0, 1.0]), Err(LatticeError::Step { axis: 0 }));
    assert_eq!(
        Lattice::new([2, 1, 1], [-f64::MAX; 3], [f64::MAX; 3]),
        Err(LatticeError::NotFinite { axis: 0 }),
        "an extent beyond binary64"
    );
    let one = Lattice { dims: [1; 3], origin: [0.0; 3], step: [0.0, 0.0, 1.0] };
    assert_eq!(one.check(), Err(LatticeError::Step { axis: 2 }));
}

#[test]
fn corners_are_distinct_and_ascending() {
    let corners = |dims| lattice(dims).corners().collect::<Vec<_>>();
    assert_eq!(corners([3, 3, 3]), [0, 2, 6, 8, 18, 20, 24, 26]);
    assert_eq!(corners([2, 2, 2]), [0, 1, 2, 3, 4, 5, 6, 7]);
    assert_eq!(corners([1, 3, 2]), [0, 2, 3, 5]);
    assert_eq!(corners([1, 1, 4]), [0, 3]);
    assert_eq!(corners([1, 1, 1]), [0]);
}

#[test]
fn longest_axis_prefers_the_lowest_of_equals() {
    let axis = |dims| lattice(dims).longest_axis();
    assert_eq!(axis([2, 2, 2]), 0);
    assert_eq!(axis([2, 3, 3]), 1);
    assert_eq!(axis([2, 2, 3]), 2);
    assert_eq!(axis([3, 2, 3]), 0);
}

#[test]
fn the_largest_lattice_is_counted_without_overflow() {
    let l = lattice([u16::MAX; 3]);
    assert_eq!(l.vertex_count(), 281_462_092_005_375);
    assert_eq!(l.index(65_534, 65_534, 65_534), l.vertex_count() - 1);
}

quickcheck! {
    fn coords_is_the_inverse_of_index(dims: (u16, u16, u16), at: (u16, u16, u16)) -> bool {
        let dims = [dims.0.max(1), dims.1.max(1), dims.2.max(1)];
        let at = [at.0 % dims[0], at.1 % dims[1], at.2 % dims[2]];
        let l = lattice(dims);
        l.coords(l.index(at[0], at[1], at[2])) == at
    }

    fn corners_and_is_corner_agree(dims: (u8, u8, u8)) -> bool {
        let l = lattice([dims.0, dims.1, dims.2].map(|n| u16::from(n % 6 + 1)));
        (0..l.vertex_count()).filter(|&v| l.is_corner(v)).eq(l.corners())
    }
}
