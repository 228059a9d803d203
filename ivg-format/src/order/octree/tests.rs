extern crate std;
use super::*;
use alloc::vec;
use alloc::vec::Vec;
use quickcheck::quickcheck;
use std::collections::BTreeSet;

fn lattice(dims: [u16; 3]) -> Lattice {
    Lattice::new(dims, [0.0; 3], [1.0; 3]).unwrap()
}

fn octree(dims: [u16; 3], per_slice: u32, seed: u64) -> Octree {
    Octree::new(&lattice(dims), per_slice, seed)
}

fn index(dims: [u16; 3], cell: Cell) -> u64 {
    let [i, j, k] = cell.low.map(|n| n as u16);
    lattice(dims).index(i, j, k)
}

/// The order as IVG-OCT-03 tells it: whole lists of the children's vertices, taken in turn.
fn round_by_round(dims: [u16; 3], cell: Cell, depth: u64, seed: u64) -> Vec<u64> {
    if cell.extent == [1; 3] {
        let vertex = index(dims, cell);
        return if lattice(dims).is_corner(vertex) { vec![] } else { vec![vertex] };
    }
    let longest = cell.extent.iter().copied().max().unwrap();
    let cut: Vec<usize> = (0..3).filter(|&a| cell.extent[a] >= 2 && 2 * cell.extent[a] > longest).collect();
    let m = 1u64 << cut.len();
    let hash = splitmix64(seed, 32 * index(dims, cell) + depth) % m;
    let turns: &[u64] = match m {
        2 => &[0, 1],
        4 => &[0, 3, 1, 2],
        _ => &[0, 3, 5, 6, 7, 4, 2, 1],
    };
    let children: Vec<Vec<u64>> = turns
        .iter()
        .map(|turn| {
            let mut child = cell;
            for (bit, &axis) in cut.iter().enumerate() {
                let lower = cell.extent[axis].div_ceil(2);
                if (turn ^ hash) >> bit & 1 == 1 {
                    child.low[axis] += lower;
                    child.extent[axis] -= lower;
                } else {
                    child.extent[axis] = lower;
                }
            }
            round_by_round(dims, child, depth + 1, seed)
        })
        .collect();
    let most = children.iter().map(Vec::len).max().unwrap();
    (0..most).flat_map(|round| children.iter().filter_map(move |child| child.get(round))).copied().collect()
}

/// Checks everything the order promises, by brute force.
fn check(dims: [u16; 3], per_slice: u32, seed: u64) {
    let octree = octree(dims, per_slice, seed);
    let expected = round_by_round(dims, Cell::whole(dims), 0, seed);
    assert_eq!(octree.count, expected.len() as u64, "{dims:?}");
    let found: Vec<u64> = (0..octree.count).map(|rank| octree.at(rank)).collect();
    assert_eq!(found, expected, "{dims:?}, seed {seed}");
    let corners: BTreeSet<u64> = lattice(dims).corners().collect();
    let all: BTreeSet<u64> = found.iter().copied().chain(corners.iter().copied()).collect();
    assert_eq!(all.len(), corners.len() + found.len(), "{dims:?}: a vertex comes twice");
    assert!(all.into_iter().eq(0..lattice(dims).vertex_count()), "{dims:?}: a vertex is missing");
    let size = u64::from(per_slice) * u64::from(dims.into_iter().max().unwrap());
    let mut bundled = vec![];
    for k in 1..=octree.bundle_count() as u32 {
        let bundle: Vec<u64> = std::iter::from_fn({
            let mut walk = octree.walk(k);
            move || walk.next()
        })
        .collect();
        assert_eq!(bundle.len() as u64, octree.bundle_len(k));
        let is_last = u64::from(k) == octree.bundle_count();
        assert!(bundle.len() as u64 == size || is_last && !bundle.is_empty(), "{dims:?}: bundle {k}");
        for (n, &vertex) in (0..).zip(&bundle) {
            assert_eq!(octree.vertex(k, n), Some(vertex), "{dims:?}: bundle {k}, vertex {n}");
        }
        assert_eq!(octree.vertex(k, bundle.len() as u64), None);
        bundled.extend(bundle);
    }
    assert_eq!(bundled, expected, "{dims:?}");
}

#[test]
fn every_vertex_comes_exactly_once_on_awkward_lattices() {
    let all: Vec<[u16; 3]> =
        (1..=5).flat_map(|x| (1..=4).flat_map(move |y| (1..=4).map(move |z| [x, y, z]))).collect();
    for dims in all.into_iter().chain([[1, 17, 3], [2, 2, 40], [33, 1, 1], [1, 1, 9], [8, 8, 8], [3, 19, 20]])
    {
        for per_slice in [1, 2, 3, 64, u32::MAX] {
            check(dims, per_slice, 42);
        }
    }
}

#[test]
fn a_rank_is_where_the_rounds_put_it() {
    for seed in 0..4 {
        check([17, 5, 9], 3, seed);
        check([6, 6, 6], 1, seed);
    }
}

#[test]
fn the_order_is_that_of_the_specification() {
    let order = |dims, seed| {
        let octree = octree(dims, 1, seed);
        (0..octree.count).map(|rank| octree.at(rank)).collect::<Vec<_>>()
    };
    // The worked values of the clause IVG-OCT-06, by a program written from the text alone.
    assert_eq!(order([4, 3, 2], 0), [10, 17, 9, 7, 22, 1, 21, 2, 4, 18, 5, 14, 16, 19, 13, 6]);
    assert_eq!(order([1, 5, 3], 0), [13, 1, 12, 9, 7, 11, 3, 2, 8, 5, 6]);
    let cube = [23, 25, 4, 17, 16, 11, 22, 12, 7, 5, 19, 10, 15, 14, 21, 9, 13, 1, 3];
    assert_eq!(order([3, 3, 3], 0x0123_4567_89AB_CDEF), cube);
    assert_eq!(order([2, 2, 3], 0), [6, 5, 4, 7]);
    assert_eq!(order([7, 1, 1], 0), [5, 1, 4, 2, 3]);
    assert_eq!(order([2, 2, 2], 0), [0u64; 0]);
    let large = octree([65_535, 40_000, 1000], 1, 1);
    let ranks = [0, 1, 1_000_000_000_000, large.count - 1];
    let found = ranks.map(|rank| large.at(rank));
    assert_eq!(found, [524_691_690_850, 964_353_436_566, 1_222_016_595_314, 1_987_473_750_134]);
}

#[test]
fn seeds_give_orders_of_their_own() {
    let prefix = |seed| {
        let octree = octree([32, 32, 32], 1, seed);
        (0..64).map(|rank| octree.at(rank)).collect::<Vec<_>>()
    };
    for other in [1, 2, u64::MAX] {
        // 64 vertices of 32,768 each: more than a few in one place have a probability below 1e-6.
        let same = prefix(0).iter().zip(prefix(other)).filter(|&(&a, b)| a == b).count();
        assert!(same < 4, "{same} places agree with seed {other}");
    }
}

#[test]
fn every_prefix_is_spread_over_the_volume() {
    // 8^k vertices are one in each of 8^k equal boxes but for the corners, which are not in the order: eight boxes of 32³
    // cells less one vertex each.
    let octree = octree([32, 32, 32], 1, 5);
    for side in [2u64, 4, 8] {
        let boxes: BTreeSet<u64> = (0..side.pow(3))
            .map(|rank| {
                let at = lattice([32, 32, 32]).coords(octree.at(rank)).map(|c| u64::from(c) * side / 32);
                at[0] + side * (at[1] + side * at[2])
            })
            .collect();
        assert_eq!(boxes.len() as u64, side.pow(3), "{side}");
    }
}

quickcheck! {
    fn every_vertex_comes_exactly_once(dims: (u8, u8, u8), per_slice: u8, seed: u64) -> bool {
        let dims = [dims.0, dims.1, dims.2].map(|n| u16::from(n % 9 + 1));
        check(dims, u32::from(per_slice) + 1, seed);
        true
    }
}
