extern crate std;
use super::*;
use crate::order::Rule;
use alloc::vec;
use alloc::vec::Vec;
use quickcheck::quickcheck;

fn lattice(dims: [u16; 3]) -> Lattice {
    Lattice::new(dims, [0.0; 3], [1.0; 3]).unwrap()
}

/// Every bundle's vertices.
fn bundles(dims: [u16; 3], per_slice: u32, seed: u64) -> Vec<Vec<u64>> {
    let slices = Slices::new(&lattice(dims), per_slice, seed);
    (1..=slices.bundle_count() as u32)
        .map(|k| Rule::Slices(slices).vertices(&lattice(dims), k).collect())
        .collect()
}

/// Checks everything the order promises, by brute force.
fn check(dims: [u16; 3], per_slice: u32, seed: u64) {
    let l = lattice(dims);
    let slices = Slices::new(&l, per_slice, seed);
    let bundles = bundles(dims, per_slice, seed);
    let mut seen = vec![0u8; l.vertex_count() as usize];
    for corner in l.corners() {
        seen[corner as usize] += 1;
    }
    let axis = l.longest_axis();
    for (k, bundle) in (1..).zip(&bundles) {
        assert!(!bundle.is_empty(), "{dims:?}: bundle {k} is empty");
        assert_eq!(bundle.len() as u64, slices.bundle_len(k), "{dims:?}: length of bundle {k}");
        for (n, &vertex) in (0..).zip(bundle) {
            seen[vertex as usize] += 1;
            assert_eq!(slices.vertex(&l, k, n), Some(vertex), "{dims:?}: bundle {k}, vertex {n}");
        }
        assert_eq!(slices.vertex(&l, k, bundle.len() as u64), None);
        // Every slice contributes its share: the smaller of S and what remains of it.
        for s in 0..dims[axis] {
            let of_slice = |v: &u64| l.coords(*v)[axis] == s;
            let remaining = bundles[k as usize - 1..].iter().flatten().filter(|v| of_slice(v)).count();
            let share = bundle.iter().filter(|v| of_slice(v)).count();
            assert_eq!(share, remaining.min(per_slice as usize), "{dims:?}: slice {s} in bundle {k}");
        }
        assert!(bundle.is_sorted_by_key(|&v| l.coords(v)[axis]), "{dims:?}: slices ascend");
    }
    assert!(seen.iter().all(|&n| n == 1), "{dims:?}: every vertex exactly once, {seen:?}");
}

#[test]
fn every_vertex_comes_exactly_once_on_awkward_lattices() {
    let all: Vec<[u16; 3]> =
        (1..=5).flat_map(|x| (1..=4).flat_map(move |y| (1..=4).map(move |z| [x, y, z]))).collect();
    for dims in all.into_iter().chain([[1, 17, 3], [2, 2, 40], [33, 1, 1], [1, 1, 9], [8, 8, 8], [3, 19, 20]])
    {
        for per_slice in [1, 2, 3, 5, 64, u32::MAX] {
            check(dims, per_slice, 42);
        }
    }
}

#[test]
fn bundle_one_of_the_specification() {
    // The worked values of the clause IVG-ORD-11.
    assert_eq!(bundles([4, 3, 2], 2, 0), spec_values::LATTICE_4_3_2);
    let permutation = Permutation::new(1000, 0x0123_4567_89AB_CDEF, 7);
    assert_eq!((0..8).map(|n| permutation.at(n)).collect::<Vec<_>>(), spec_values::PERMUTATION_1000);
}

mod spec_values;

#[test]
fn the_whole_range_of_slice_sizes_is_permuted_within_it() {
    for count in [1, 2, 3, 4, 5, 15, 16, 17, 1000, 65_535 * 65_535] {
        let p = Permutation::new(count, 9, 3);
        for rank in (0..count).step_by((count / 50).max(1) as usize) {
            assert!(p.at(rank) < count);
        }
    }
}

#[test]
fn the_walk_stays_within_four_steps_a_vertex_on_average() {
    // The work bound of the specification: the network covers at most 4 × count numbers, each visited once.
    for count in [1u32, 3, 5, 17, 1025, 4097] {
        let p = Permutation::new(count, 1, 0);
        let mut steps = 0;
        for rank in 0..count {
            let mut number = rank;
            loop {
                number = p.network(number);
                steps += 1;
                if number < count {
                    break;
                }
            }
        }
        assert!(steps <= 4 * count, "{steps} steps for {count}");
    }
}

#[test]
fn slices_and_seeds_have_permutations_of_their_own() {
    let order = |seed, slice| {
        let p = Permutation::new(256, seed, slice);
        (0..256).map(|n| p.at(n)).collect::<Vec<_>>()
    };
    let base = order(0, 0);
    assert_ne!(base, (0..256).collect::<Vec<_>>(), "the identity");
    for other in [order(0, 1), order(1, 0), order(u64::MAX, 0)] {
        // Two random permutations of n agree in one place on average, whatever n; 12 or more have a
        // probability below 1e-8.
        let same = base.iter().zip(&other).filter(|(a, b)| a == b).count();
        assert!(same < 12, "{same} places agree");
    }
}

#[test]
fn a_prefix_is_spread_over_the_slice() {
    // The first quarter of a 32 × 32 slice, counted in 16 blocks of 8 × 8: 16 expected in each, hypergeometric
    // with a standard deviation of 3.4. Over 64 seeds and 16 blocks, seven deviations are never reached by chance.
    for seed in 0..64 {
        let p = Permutation::new(1024, seed, 5);
        let mut blocks = [0i32; 16];
        for rank in 0..256 {
            let at = p.at(rank);
            blocks[((at / 32 / 8) * 4 + at % 32 / 8) as usize] += 1;
        }
        assert!(blocks.iter().all(|&n| (n - 16).abs() < 24), "seed {seed}: {blocks:?}");
    }
}

quickcheck! {
    fn every_vertex_comes_exactly_once(dims: (u8, u8, u8), per_slice: u8, seed: u64) -> bool {
        let dims = [dims.0, dims.1, dims.2].map(|n| u16::from(n % 9 + 1));
        check(dims, u32::from(per_slice) + 1, seed);
        true
    }
}
