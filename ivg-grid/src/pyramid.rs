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

use crate::IrradianceGrid;

/// No node: a parent that does not exist.
pub(crate) const NONE: u32 = u32::MAX;

/// Directions in the order -x +x -y +y -z +z: `2 * axis + (1 if positive)`.
pub(crate) const DIRECTIONS: usize = 6;

/// The levels, finest first.
#[derive(Debug)]
pub(crate) struct Pyramid {
    pub(crate) levels: Vec<Level>,
}

/// The nodes of one level, in order of their cells and, in one cell, of their first child.
#[derive(Debug)]
pub(crate) struct Level {
    dims: [u32; 3],
    /// Linear index of the cell of each node, ascending. At level 0 the node's own number.
    cells: Vec<u32>,
    /// Node of the next level, or [`NONE`] for a node without links.
    pub(crate) parents: Vec<u32>,
    children: Lists,
    links: Lists,
}

/// Many short lists of nodes, one after the other.
#[derive(Debug, Default)]
struct Lists {
    starts: Vec<u32>,
    nodes: Vec<u32>,
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
    pub(crate) fn unobstructed(grid: &IrradianceGrid) -> Self {
        Self::new(grid.lattice().dims.map(u32::from), |_, _, _| true)
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
        let count = dims.iter().map(|&n| n as usize).product::<usize>();
        let strides = [1, dims[0] as usize, dims[0] as usize * dims[1] as usize];
        let mut links = Lists::default();
        let mut level = Self {
            dims,
            cells: (0..count).map(narrow).collect(),
            parents: vec![NONE; count],
            children: Lists::default(),
            links: Lists::default(),
        };
        for vertex in 0..count {
            let at = level.coords(vertex);
            for direction in 0..DIRECTIONS {
                let (axis, stride) = (direction / 2, strides[direction / 2]);
                links.begin();
                let neighbour = if direction % 2 == 0 {
                    (at[axis] > 0).then(|| (vertex - stride, vertex - stride, vertex))
                } else {
                    (at[axis] + 1 < dims[axis]).then(|| (vertex + stride, vertex, vertex + stride))
                };
                match neighbour {
                    Some((node, low, high)) if open(low, high, axis) => links.nodes.push(narrow(node)),
                    _ => {}
                }
            }
        }
        links.begin();
        level.links = links;
        level
    }

    /// The next level, or nothing when no node has a link left. Sets the parents of this one.
    fn coarser(&mut self) -> Option<Self> {
        if self.links.nodes.is_empty() {
            return None;
        }
        let mut sets = DisjointSets::new(self.len());
        for node in 0..self.len() {
            let cell = self.coords(node);
            for direction in 0..DIRECTIONS {
                // The second child of a block along an axis looks back at the first one.
                if direction % 2 == 0 && cell[direction / 2] % 2 == 1 {
                    self.links(node, direction).iter().for_each(|&other| sets.join(node, other as usize));
                }
            }
        }

        let dims = self.dims.map(|n| n.div_ceil(2));
        let block = |at: [u32; 3]| at[0] / 2 + dims[0] * (at[1] / 2 + dims[1] * (at[2] / 2));
        // The root of a set is its first node, so roots in order of block and number are the nodes in order.
        let mut roots: Vec<(u32, u32)> = (0..self.len())
            .filter(|&node| self.has_links(node) && sets.root(node) == node)
            .map(|node| (block(self.coords(node)), narrow(node)))
            .collect();
        roots.sort_unstable();
        let mut number = vec![NONE; self.len()];
        roots.iter().enumerate().for_each(|(new, &(_, root))| number[root as usize] = narrow(new));
        for node in 0..self.len() {
            self.parents[node] = number[sets.root(node)];
        }

        let children = Lists::grouped(roots.len(), &self.parents);
        let mut links = Lists::default();
        let mut found = Vec::new();
        for parent in 0..roots.len() {
            for direction in 0..DIRECTIONS {
                found.clear();
                for &child in children.get(parent) {
                    let neighbours = self.links(child as usize, direction).iter();
                    found.extend(
                        neighbours.map(|&n| self.parents[n as usize]).filter(|&n| n as usize != parent),
                    );
                }
                found.sort_unstable();
                found.dedup();
                links.begin();
                links.nodes.extend_from_slice(&found);
            }
        }
        links.begin();
        let cells = roots.iter().map(|&(cell, _)| cell).collect();
        Some(Self { dims, cells, parents: vec![NONE; roots.len()], children, links })
    }

    /// Number of nodes.
    pub(crate) fn len(&self) -> usize {
        self.cells.len()
    }

    /// Nodes of the level below that make up a node, ascending.
    pub(crate) fn children(&self, node: usize) -> &[u32] {
        self.children.get(node)
    }

    /// Nodes of the neighbouring cell in a direction that light passes to, ascending.
    pub(crate) fn links(&self, node: usize, direction: usize) -> &[u32] {
        self.links.get(DIRECTIONS * node + direction)
    }

    /// For each axis the direction from the middle of a node's block towards the node.
    pub(crate) fn outward(&self, node: usize) -> [usize; 3] {
        let at = self.coords(node);
        std::array::from_fn(|axis| 2 * axis + (at[axis] % 2) as usize)
    }

    fn has_links(&self, node: usize) -> bool {
        self.links.starts[DIRECTIONS * node] != self.links.starts[DIRECTIONS * (node + 1)]
    }

    fn coords(&self, node: usize) -> [u32; 3] {
        let [nx, ny, _] = self.dims;
        let cell = self.cells[node];
        [cell % nx, cell / nx % ny, cell / nx / ny]
    }
}

impl Lists {
    /// Ends the list before and begins the next one; once more at the very end.
    fn begin(&mut self) {
        self.starts.push(narrow(self.nodes.len()));
    }

    /// One list for each of `count` parents, holding its nodes in ascending order.
    fn grouped(count: usize, parents: &[u32]) -> Self {
        let mut starts = vec![0u32; count + 1];
        let with_parent = || parents.iter().enumerate().filter(|&(_, &parent)| parent != NONE);
        with_parent().for_each(|(_, &parent)| starts[parent as usize + 1] += 1);
        (0..count).for_each(|parent| starts[parent + 1] += starts[parent]);
        let mut next = starts.clone();
        let mut nodes = vec![0; starts[count] as usize];
        for (node, &parent) in with_parent() {
            nodes[next[parent as usize] as usize] = narrow(node);
            next[parent as usize] += 1;
        }
        Self { starts, nodes }
    }

    fn get(&self, list: usize) -> &[u32] {
        &self.nodes[self.starts[list] as usize..self.starts[list + 1] as usize]
    }
}

/// Sets of nodes that are joined; the root of a set is its lowest node.
struct DisjointSets(Vec<u32>);

impl DisjointSets {
    fn new(count: usize) -> Self {
        Self((0..count).map(narrow).collect())
    }

    fn root(&self, mut node: usize) -> usize {
        // Sets have at most the nodes of one block: the way to the root is short without compressing it.
        while self.0[node] as usize != node {
            node = self.0[node] as usize;
        }
        node
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = narrow(a.min(b));
    }
}

/// Node numbers fit: a grid has fewer than 2³² vertices.
#[expect(clippy::cast_possible_truncation, reason = "a grid has at most u32::MAX vertices")]
fn narrow(number: usize) -> u32 {
    debug_assert!(u32::try_from(number).is_ok(), "too many nodes");
    number as u32
}

#[cfg(test)]
mod tests;
