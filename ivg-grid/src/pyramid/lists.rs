//! Short lists and disjoint sets of nodes, each in one or two flat arrays.

use super::{NONE, narrow};

/// Many short lists of nodes, one after the other.
#[derive(Clone, Debug)]
pub(super) struct Lists {
    starts: Vec<u32>,
    nodes: Vec<u32>,
}

impl Default for Lists {
    fn default() -> Self {
        Self { starts: vec![0], nodes: Vec::new() }
    }
}

impl Lists {
    pub(super) fn push(&mut self, nodes: &[u32]) {
        self.nodes.extend_from_slice(nodes);
        self.starts.push(narrow(self.nodes.len()));
    }

    /// One list for each of `count` parents, holding its nodes in ascending order.
    pub(super) fn grouped(count: usize, parents: &[u32]) -> Self {
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

    /// Number of lists.
    pub(super) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    pub(super) fn get(&self, list: usize) -> &[u32] {
        &self.nodes[self.starts[list] as usize..self.starts[list + 1] as usize]
    }
}

/// Sets of nodes that are joined; the root of a set is its lowest node.
pub(super) struct DisjointSets(Vec<u32>);

impl DisjointSets {
    pub(super) fn new(count: usize) -> Self {
        Self((0..count).map(narrow).collect())
    }

    pub(super) fn root(&self, mut node: usize) -> usize {
        // Sets have at most the nodes of one block: the way to the root is short without compressing it.
        while self.0[node] as usize != node {
            node = self.0[node] as usize;
        }
        node
    }

    pub(super) fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = narrow(a.min(b));
    }
}
