use ivg_format::Lattice;
use quickcheck::{Arbitrary, Gen};

use super::*;

/// A small grid with random invalid vertices and blocked edges.
#[derive(Clone, Debug)]
struct Obstructed(IrradianceGrid);

impl Arbitrary for Obstructed {
    fn arbitrary(g: &mut Gen) -> Self {
        let dims = [(); 3].map(|()| u16::from(u8::arbitrary(g) % 7) + 1);
        let mut grid = open_grid(dims);
        // From almost open to almost closed.
        let density = u8::arbitrary(g);
        for index in 0..grid.vertex_count() {
            let bits = (0..3).map(|bit| u8::from(u8::arbitrary(g) < density) << bit).sum();
            grid.set_blocked_edges(index, bits);
            if u8::arbitrary(g) < density / 4 {
                grid.set_validity(index, 0);
            }
        }
        Self(grid)
    }
}

fn open_grid(dims: [u16; 3]) -> IrradianceGrid {
    let max = dims.map(|n| if n > 1 { f64::from(n - 1) } else { 0.0 });
    IrradianceGrid::new(Lattice::new(dims, [0.0; 3], max).expect("a box")).expect("small")
}

/// For each vertex the lowest vertex that open edges lead to, by plain flooding.
fn rooms(grid: &IrradianceGrid) -> Vec<usize> {
    let dims = grid.lattice().dims.map(usize::from);
    let strides = [1, dims[0], dims[0] * dims[1]];
    let mut room = vec![usize::MAX; grid.vertex_count()];
    for start in 0..grid.vertex_count() {
        let mut open = vec![start];
        while let Some(vertex) = open.pop() {
            if room[vertex] != usize::MAX {
                continue;
            }
            room[vertex] = start;
            for axis in 0..3 {
                let at = vertex / strides[axis] % dims[axis];
                let passes = |low: usize, high: usize| {
                    grid.is_valid(low) && grid.is_valid(high) && grid.blocked_edges()[low] >> axis & 1 == 0
                };
                if at > 0 && passes(vertex - strides[axis], vertex) {
                    open.push(vertex - strides[axis]);
                }
                if at + 1 < dims[axis] && passes(vertex, vertex + strides[axis]) {
                    open.push(vertex + strides[axis]);
                }
            }
        }
    }
    room
}

/// For each vertex the level and node where its way up ends.
fn summits(pyramid: &Pyramid) -> Vec<(usize, usize)> {
    (0..pyramid.levels[0].len())
        .map(|vertex| {
            let (mut level, mut node) = (0, vertex);
            while pyramid.levels[level].parents[node] != NONE {
                node = pyramid.levels[level].parents[node] as usize;
                level += 1;
            }
            (level, node)
        })
        .collect()
}

#[test]
fn vertices_share_a_summit_exactly_when_an_open_path_joins_them() {
    fn law(Obstructed(grid): Obstructed) -> bool {
        let (rooms, summits) = (rooms(&grid), summits(&Pyramid::of_grid(&grid)));
        (0..rooms.len()).all(|a| (0..a).all(|b| (rooms[a] == rooms[b]) == (summits[a] == summits[b])))
    }
    quickcheck::quickcheck(law as fn(Obstructed) -> bool);
}

#[test]
fn links_are_mutual_and_children_know_their_parents() {
    fn law(Obstructed(grid): Obstructed) -> bool {
        let pyramid = Pyramid::of_grid(&grid);
        pyramid.levels.iter().enumerate().all(|(index, level)| {
            (0..level.len()).all(|node| {
                let mutual = (0..DIRECTIONS).all(|direction| {
                    let back =
                        |other: u32| level.links(other as usize, direction ^ 1).any(|n| n as usize == node);
                    level.links(node, direction).all(back)
                });
                let known = index == 0
                    || level
                        .children(node)
                        .iter()
                        .all(|&child| pyramid.levels[index - 1].parents[child as usize] as usize == node);
                mutual && known && (index == 0 || !level.children(node).is_empty())
            })
        })
    }
    quickcheck::quickcheck(law as fn(Obstructed) -> bool);
}

#[test]
fn the_number_of_nodes_is_bounded() {
    fn law(Obstructed(grid): Obstructed) -> bool {
        let nodes: usize = Pyramid::of_grid(&grid).levels.iter().map(Level::len).sum();
        nodes < 6 * grid.vertex_count()
    }
    quickcheck::quickcheck(law as fn(Obstructed) -> bool);

    // Edges open only across the borders of blocks: nothing ever merges below, the case with the most nodes.
    let mut grid = open_grid([16; 3]);
    for index in 0..grid.vertex_count() {
        let at = grid.lattice().coords(index as u64);
        grid.set_blocked_edges(index, (0..3).map(|axis| u8::from(at[axis].is_multiple_of(2)) << axis).sum());
    }
    let nodes: usize = Pyramid::of_grid(&grid).levels.iter().map(Level::len).sum();
    assert!(nodes > 2 * 4096 && nodes < 6 * 4096, "{nodes}");
}

#[test]
fn an_open_lattice_has_one_node_a_cell() {
    let pyramid = Pyramid::of_grid(&open_grid([9, 4, 1]));
    let lengths: Vec<usize> = pyramid.levels.iter().map(Level::len).collect();
    assert_eq!(lengths, [36, 5 * 2, 3, 2, 1]);
    let level = &pyramid.levels[1];
    assert_eq!(level.children(0), [0, 1, 9, 10]);
    assert_eq!(level.children(9), [26, 35], "the ninth vertex of a row has a block for itself");
    assert!(level.links(0, 1).eq([1]));
    assert!(level.links(0, 3).eq([5]));
    assert!(level.links(0, 0).len() == 0 && level.links(0, 5).len() == 0);
}

#[test]
fn a_wall_inside_a_block_splits_its_node() {
    // Four vertices in a row and two rows; the wall cuts the middle of the first block.
    let mut grid = open_grid([4, 2, 1]);
    for row in 0..2 {
        grid.set_blocked_edges(4 * row, 0b001);
    }
    let pyramid = Pyramid::of_grid(&grid);
    let level = &pyramid.levels[1];
    assert_eq!(level.len(), 3);
    assert_eq!((level.children(0), level.children(1)), ([0, 4].as_slice(), [1, 5].as_slice()));
    assert!((0..DIRECTIONS).all(|direction| level.links(0, direction).len() == 0));
    assert!(level.links(1, 1).eq([2]));
    assert_eq!(level.parents, [NONE, 0, 0], "the part behind the wall ends here");
    assert_eq!(pyramid.levels[2].len(), 1);
}

#[test]
fn closed_vertices_end_at_once() {
    let mut grid = open_grid([5; 3]);
    (0..125).for_each(|index| grid.set_validity(index, 0));
    assert_eq!(Pyramid::of_grid(&grid).levels.len(), 1);
    assert_eq!(Pyramid::unobstructed(grid.lattice()).levels.len(), 4);
}
