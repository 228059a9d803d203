//! The pyramid of push-pull: which vertices light can pass between, level by level.
//!
//! Level 0 has one node a vertex. Each level above halves the lattice: its cells are blocks of 2 × 2 × 2 cells of the
//! level below, and a node of it is a set of nodes of one block that are *connected inside the block* by edges that
//! geometry does not cut. A block that a wall divides therefore has a node for each side, and two nodes of
//! neighbouring blocks are linked only if an open edge joins them: two rooms that no open path joins share no node at
//! any level, however thin the wall.
//!
//! A node without links has nothing to exchange and ends there. That bounds the whole pyramid: a node of level l has
//! come up because an open edge leads across a border of blocks of 2^(l-1) vertices, and such borders touch ever fewer
//! vertices. All levels together have fewer than six times as many nodes as there are vertices, for any pattern of
//! blocked edges (8/7 times where nothing is blocked).
//!
//! Only the lattice, validity and blocked edges matter here, never which vertices were received.

use ivg_format::Lattice;

use crate::IrradianceGrid;

mod lists;

use lists::{DisjointSets, Lists};

/// No node: a parent that does not exist.
pub(crate) const NONE: u32 = u32::MAX;

/// Directions in the order -x +x -y +y -z +z: `2 * axis + (1 if positive)`.
pub(crate) const DIRECTIONS: usize = 6;

/// The levels, finest first.
#[derive(Clone, Debug)]
pub(crate) struct Pyramid {
    pub(crate) levels: Vec<Level>,
}

/// The nodes of one level, in order of their cells and, in one cell, of their first child.
#[derive(Clone, Debug)]
pub(crate) struct Level {
    dims: [u32; 3],
    /// Which child of its block the cell of each node is: bits 0, 1, 2 for the second one along x, y, z.
    octants: Vec<u8>,
    /// Linear index of the cell of each node, ascending. Empty at level 0: there it is the node's own number.
    cells: Vec<u32>,
    /// Node of the next level, or [`NONE`] for a node without links.
    pub(crate) parents: Vec<u32>,
    children: Lists,
    links: Links,
}

/// Which nodes of neighbouring cells light passes to.
#[derive(Clone, Debug)]
enum Links {
    /// Level 0: one bit for each direction; the neighbour is as many vertices away as the direction's stride.
    Open(Vec<u8>),
    /// For each node and direction a list, and the node in it if that is the only one, the node itself if there is
    /// none, or [`NONE`].
    Lists { lists: Lists, single: Vec<[u32; DIRECTIONS]> },
}

impl Pyramid {
    /// The pyramid of a grid's validity and blocked edges: light passes between neighbours that are both valid and
    /// have an open edge.
    pub(crate) fn of_grid(grid: &IrradianceGrid) -> Self {
        let (validity, blocked) = (grid.validity(), grid.blocked_edges());
        let open = |low: usize, high: usize, axis: usize| {
            validity[low] > 0 && validity[high] > 0 && blocked[low] >> axis & 1 == 0
        };
        Self::new(grid.lattice().dims.map(u32::from), open)
    }

    /// The pyramid of a lattice that nothing obstructs.
    pub(crate) fn unobstructed(lattice: &Lattice) -> Self {
        Self::new(lattice.dims.map(u32::from), |_, _, _| true)
    }

    fn new(dims: [u32; 3], open: impl Fn(usize, usize, usize) -> bool) -> Self {
        let mut levels = vec![Level::finest(dims, open)];
        loop {
            let finer = levels.last_mut().expect("level 0");
            match finer.coarser() {
                Some(level) => levels.push(level),
                None => return Self { levels },
            }
        }
    }
}

impl Level {
    fn finest(dims: [u32; 3], open: impl Fn(usize, usize, usize) -> bool) -> Self {
        let [nx, ny, nz] = dims.map(|n| n as usize);
        let count = nx * ny * nz;
        let strides = [1, nx, nx * ny];
        let (mut links, mut octants) = (vec![0u8; count], Vec::with_capacity(count));
        let mut vertex = 0;
        for z in 0..nz {
            for y in 0..ny {
                for x in 0..nx {
                    octants.push((x & 1 | (y & 1) << 1 | (z & 1) << 2) as u8);
                    for (axis, last) in [x + 1 == nx, y + 1 == ny, z + 1 == nz].into_iter().enumerate() {
                        let next = vertex + strides[axis];
                        if !last && open(vertex, next, axis) {
                            links[vertex] |= 0b10 << (2 * axis);
                            links[next] |= 0b01 << (2 * axis);
                        }
                    }
                    vertex += 1;
                }
            }
        }
        Self {
            dims,
            octants,
            cells: Vec::new(),
            parents: vec![NONE; count],
            children: Lists::default(),
            links: Links::Open(links),
        }
    }

    /// The next level, or nothing when no node has a link left. Sets the parents of this one.
    fn coarser(&mut self) -> Option<Self> {
        let mut sets = DisjointSets::new(self.len());
        let mut linked = Vec::with_capacity(self.len());
        for node in 0..self.len() {
            let mut any = false;
            for direction in 0..DIRECTIONS {
                for other in self.links(node, direction) {
                    any = true;
                    // The second child of a block along an axis looks back at the first one.
                    if direction % 2 == 0 && self.octants[node] >> (direction / 2) & 1 == 1 {
                        sets.join(node, other as usize);
                    }
                }
            }
            linked.push(any);
        }

        let dims = self.dims.map(|n| n.div_ceil(2));
        let block = |at: [u32; 3]| at[0] / 2 + dims[0] * (at[1] / 2 + dims[1] * (at[2] / 2));
        // The root of a set is its first node, so roots in order of block and number are the nodes in order.
        let mut roots: Vec<(u32, u32)> = (0..self.len())
            .filter(|&node| linked[node] && sets.root(node) == node)
            .map(|node| (block(self.coords(node)), narrow(node)))
            .collect();
        if roots.is_empty() {
            return None;
        }
        roots.sort_unstable();
        let mut number = vec![NONE; self.len()];
        roots.iter().enumerate().for_each(|(new, &(_, root))| number[root as usize] = narrow(new));
        for node in 0..self.len() {
            self.parents[node] = number[sets.root(node)];
        }

        let children = Lists::grouped(roots.len(), &self.parents);
        let links = self.links_of_parents(&children);
        let cells: Vec<u32> = roots.iter().map(|&(cell, _)| cell).collect();
        let mut level = Self {
            dims,
            octants: Vec::with_capacity(cells.len()),
            cells,
            parents: vec![NONE; roots.len()],
            children,
            links,
        };
        for node in 0..roots.len() {
            let at = level.coords(node);
            level.octants.push((at[0] & 1 | (at[1] & 1) << 1 | (at[2] & 1) << 2) as u8);
        }
        Some(level)
    }

    /// The links between the nodes of the next level, which have these children.
    fn links_of_parents(&self, children: &Lists) -> Links {
        let mut lists = Lists::default();
        let mut single = vec![[NONE; DIRECTIONS]; children.len()];
        let mut found = Vec::new();
        for (parent, single) in single.iter_mut().enumerate() {
            for (direction, single) in single.iter_mut().enumerate() {
                found.clear();
                // Only the children on this side of the block have neighbours outside it.
                let side = |&&child: &&u32| {
                    usize::from(self.octants[child as usize] >> (direction / 2) & 1) == direction % 2
                        || self.dims[direction / 2] % 2 == 1
                };
                for &child in children.get(parent).iter().filter(side) {
                    for other in self.links(child as usize, direction) {
                        let other = self.parents[other as usize];
                        if other as usize != parent && found.last() != Some(&other) {
                            found.push(other);
                        }
                    }
                }
                if found.len() > 1 {
                    found.sort_unstable();
                    found.dedup();
                }
                *single = match found[..] {
                    [] => narrow(parent),
                    [one] => one,
                    _ => NONE,
                };
                lists.push(&found);
            }
        }
        Links::Lists { lists, single }
    }

    /// Number of nodes.
    pub(crate) fn len(&self) -> usize {
        self.octants.len()
    }

    /// Nodes of the level below that make up a node, ascending.
    pub(crate) fn children(&self, node: usize) -> &[u32] {
        self.children.get(node)
    }

    /// Nodes of the neighbouring cell in a direction that light passes to, ascending.
    #[inline]
    pub(crate) fn links(&self, node: usize, direction: usize) -> impl ExactSizeIterator<Item = u32> + Clone {
        let (single, list) = match &self.links {
            Links::Lists { lists, .. } => (0, lists.get(DIRECTIONS * node + direction)),
            Links::Open(bits) => (bits[node] >> direction & 1, [].as_slice()),
        };
        let stride = self.stride(direction / 2);
        let neighbour =
            if direction.is_multiple_of(2) { node.wrapping_sub(stride) } else { node.wrapping_add(stride) };
        LinkIter { single: (single == 1).then(|| narrow(neighbour)), list: list.iter() }
    }

    /// The neighbour of a node in each direction: the linked one, the node itself where there is none. Nothing if
    /// there are several in any direction.
    #[inline(always)]
    pub(crate) fn neighbours(&self, node: usize) -> Option<[usize; DIRECTIONS]> {
        match &self.links {
            Links::Open(bits) => {
                let bits = bits[node];
                let strides = [self.stride(0), self.stride(1), self.stride(2)];
                let steps = |direction: usize| usize::from(bits >> direction & 1) * strides[direction / 2];
                Some([
                    node - steps(0),
                    node + steps(1),
                    node - steps(2),
                    node + steps(3),
                    node - steps(4),
                    node + steps(5),
                ])
            }
            Links::Lists { single, .. } => {
                let single = &single[node];
                let [a, b, c, d, e, f] = *single;
                let several = [a, b, c, d, e, f].contains(&NONE);
                let nodes = [a as usize, b as usize, c as usize, d as usize, e as usize, f as usize];
                (!several).then_some(nodes)
            }
        }
    }

    /// Calls `found` with every node that light passes to, in order of the directions and, in one, of the nodes.
    #[inline]
    pub(crate) fn for_each_link(&self, node: usize, mut found: impl FnMut(usize)) {
        match self.neighbours(node) {
            Some(neighbours) => {
                neighbours.into_iter().filter(|&other| other != node).for_each(found);
            }
            None => (0..DIRECTIONS)
                .flat_map(|direction| self.links(node, direction))
                .for_each(|other| found(other as usize)),
        }
    }

    /// The nodes of level 0 between two neighbours along an axis, plus one.
    pub(crate) fn stride(&self, axis: usize) -> usize {
        [1, self.dims[0] as usize, self.dims[0] as usize * self.dims[1] as usize][axis]
    }

    /// Which child of its block a node's cell is: bits 0, 1, 2 for the second one along x, y, z.
    pub(crate) fn octant(&self, node: usize) -> usize {
        usize::from(self.octants[node])
    }

    fn coords(&self, node: usize) -> [u32; 3] {
        let [nx, ny, _] = self.dims;
        let cell = self.cells.get(node).copied().unwrap_or(narrow(node));
        [cell % nx, cell / nx % ny, cell / nx / ny]
    }
}

/// Either the one neighbour of a vertex or a list of nodes.
#[derive(Clone)]
struct LinkIter<'a> {
    single: Option<u32>,
    list: std::slice::Iter<'a, u32>,
}

impl Iterator for LinkIter<'_> {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        self.single.take().or_else(|| self.list.next().copied())
    }

    #[inline]
    fn size_hint(&self) -> (usize, Option<usize>) {
        let len = usize::from(self.single.is_some()) + self.list.len();
        (len, Some(len))
    }
}

impl ExactSizeIterator for LinkIter<'_> {}

/// Node numbers fit: a grid has fewer than 2³² vertices.
#[expect(clippy::cast_possible_truncation, reason = "a grid has at most u32::MAX vertices")]
fn narrow(number: usize) -> u32 {
    debug_assert!(u32::try_from(number).is_ok(), "too many nodes");
    number as u32
}

#[cfg(test)]
mod tests;
