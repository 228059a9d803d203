//! Distances to the surface as it was before anything collapsed.

use glam::{DVec3, Vec3};

use crate::distance::squared_distance;
use crate::input::index;
use crate::surface::Surface;

/// Faces in a leaf, at most.
const LEAF_FACES: usize = 4;
/// Levels that a tree can have: each node has half of its parent's faces, and there are fewer than 2³² of them.
const MAX_DEPTH: usize = 33;

/// The faces of the uncollapsed surface in a bounding volume hierarchy.
#[derive(Debug)]
pub(crate) struct Bvh {
    /// An inner node stands right before its first child.
    nodes: Vec<Node>,
    /// Vertices of the faces, leaf by leaf.
    faces: Vec<[u32; 3]>,
    /// The leaf of the face that was found last: the next point is seldom far from it.
    last: Node,
}

/// Bounds are rounded outwards: with half the bytes twice as many nodes stay in the cache.
#[derive(Debug, Clone, Copy)]
struct Node {
    low: Vec3,
    high: Vec3,
    /// First face of a leaf, second child of an inner node.
    at: u32,
    /// Faces of a leaf; 0 for an inner node.
    faces: u32,
}

impl Bvh {
    /// For the uncollapsed surface, which has a face.
    pub(crate) fn new(surface: &Surface) -> Self {
        let mut items: Vec<Item> = (0..index(surface.faces.len()))
            .map(|face| {
                let [a, b, c] = surface.triangle(face);
                Item { centre: (a + b + c) / 3.0, face }
            })
            .collect();
        let mut nodes = Vec::with_capacity(items.len());
        grow(&mut nodes, &mut items, 0, surface);
        let last = nodes[nodes.len() - 1];
        Self { nodes, faces: items.iter().map(|item| surface.faces[item.face as usize]).collect(), last }
    }

    /// Squared distance of `p` to the nearest face, or to any that is at most `enough` \[m²\].
    pub(crate) fn squared_distance(&mut self, positions: &[DVec3], p: DVec3, enough: f64) -> f64 {
        let mut least = self.in_leaf(&self.last, positions, p, enough);
        // Nodes to visit, with their squared distances: at most one for each level above the current one.
        let mut stack = [(0, 0.0); MAX_DEPTH];
        let mut waiting = 1;
        while waiting > 0 && least > enough {
            waiting -= 1;
            let (mut at, mut distance) = stack[waiting];
            while distance < least {
                let node = self.nodes[at as usize];
                if node.faces > 0 {
                    let found = self.in_leaf(&node, positions, p, enough);
                    if found < least {
                        least = found;
                        self.last = node;
                    }
                    break;
                }
                let child = |at: u32| (at, self.nodes[at as usize].squared_distance(p));
                let (mut near, mut far) = (child(at + 1), child(node.at));
                if far.1 < near.1 {
                    std::mem::swap(&mut near, &mut far);
                }
                stack[waiting] = far;
                waiting += 1;
                (at, distance) = near;
            }
        }
        least
    }

    fn in_leaf(&self, leaf: &Node, positions: &[DVec3], p: DVec3, enough: f64) -> f64 {
        let mut least = f64::INFINITY;
        for face in &self.faces[leaf.at as usize..(leaf.at + leaf.faces) as usize] {
            least = least.min(squared_distance(p, face.map(|v| positions[v as usize])));
            if least <= enough {
                break;
            }
        }
        least
    }
}

impl Node {
    fn squared_distance(&self, p: DVec3) -> f64 {
        (self.low.as_dvec3() - p).max(p - self.high.as_dvec3()).max(DVec3::ZERO).length_squared()
    }
}

#[derive(Debug, Clone, Copy)]
struct Item {
    centre: DVec3,
    face: u32,
}

/// Appends the tree of `items`, the first of which will be face number `first` of the leaves, and returns its bounds.
fn grow(nodes: &mut Vec<Node>, items: &mut [Item], first: usize, surface: &Surface) -> (DVec3, DVec3) {
    let node = nodes.len();
    nodes.push(Node { low: Vec3::ZERO, high: Vec3::ZERO, at: index(first), faces: 0 });
    let (low, high) = if items.len() <= LEAF_FACES {
        nodes[node].faces = index(items.len());
        bounds(items.iter().flat_map(|item| surface.triangle(item.face)))
    } else {
        let (low, high) = bounds(items.iter().map(|item| item.centre));
        let axis = (high - low).max_position();
        let middle = items.len() / 2;
        // Faces with equal centres are told apart, so that the tree does not depend on how the sort works.
        items.select_nth_unstable_by(middle, |a, b| {
            a.centre[axis].total_cmp(&b.centre[axis]).then(a.face.cmp(&b.face))
        });
        let (below, above) = items.split_at_mut(middle);
        let (low, high) = grow(nodes, below, first, surface);
        nodes[node].at = index(nodes.len());
        let others = grow(nodes, above, first + middle, surface);
        (low.min(others.0), high.max(others.1))
    };
    nodes[node].low = Vec3::from_array(low.as_vec3().to_array().map(f32::next_down));
    nodes[node].high = Vec3::from_array(high.as_vec3().to_array().map(f32::next_up));
    (low, high)
}

fn bounds(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}

#[cfg(test)]
mod tests;
