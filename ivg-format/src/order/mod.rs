//! Orders: which vertices a bundle holds (`spec/ivg.md`, "Order"). Integers only, and no bytes.

pub(crate) mod explicit;
mod octree;
mod slices;

use crate::encoding::Order;
use crate::lattice::Lattice;
use octree::Octree;
use slices::Slices;

/// The rule of an order that needs no directory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Rule {
    /// Some vertices of every slice across the longest axis.
    Slices(Slices),
    /// The next ranks of a recursive spread over the volume.
    Octree(Octree),
}

impl Rule {
    /// The rule of `order`; `None` where each bundle lists its vertices.
    pub(crate) fn new(order: Order, lattice: &Lattice, per_slice: u32, seed: u64) -> Option<Self> {
        match order {
            Order::Slices => Some(Self::Slices(Slices::new(lattice, per_slice, seed))),
            Order::Octree => Some(Self::Octree(Octree::new(lattice, per_slice, seed))),
            Order::Explicit => None,
        }
    }

    /// Number of bundles (IVG-ORD-04, IVG-OCT-01); 0 where every vertex is a corner.
    pub(crate) fn bundle_count(&self) -> u64 {
        match self {
            Self::Slices(slices) => slices.bundle_count(),
            Self::Octree(octree) => octree.bundle_count(),
        }
    }

    /// Vertices of bundle `k`, counted from 1. It never grows with k.
    pub(crate) fn bundle_len(&self, k: u32) -> u64 {
        match self {
            Self::Slices(slices) => slices.bundle_len(k),
            Self::Octree(octree) => octree.bundle_len(k),
        }
    }

    /// Number of leading bundles that have the same length. At most four follow.
    pub(crate) fn full_bundles(&self) -> u64 {
        match self {
            Self::Slices(slices) => slices.full_bundles(),
            Self::Octree(octree) => octree.full_bundles(),
        }
    }

    /// The vertex at place `n` of bundle `k`, or `None` beyond its end.
    pub(crate) fn vertex(&self, lattice: &Lattice, k: u32, n: u64) -> Option<u64> {
        match self {
            Self::Slices(slices) => slices.vertex(lattice, k, n),
            Self::Octree(octree) => octree.vertex(k, n),
        }
    }

    /// The vertices of bundle `k` in stored order.
    pub(crate) fn vertices(&self, lattice: &Lattice, k: u32) -> BundleVertices {
        BundleVertices(match self {
            Self::Slices(slices) => Walk::Slices(slices.walk(lattice, k)),
            Self::Octree(octree) => Walk::Octree(octree.walk(k)),
        })
    }
}

/// The vertices of a bundle in stored order, as linear indices.
#[derive(Clone, Debug)]
pub struct BundleVertices(Walk);

#[derive(Clone, Debug)]
enum Walk {
    Slices(slices::Walk),
    Octree(octree::Walk),
}

impl Iterator for BundleVertices {
    type Item = u64;

    fn next(&mut self) -> Option<u64> {
        match &mut self.0 {
            Walk::Slices(walk) => walk.next(),
            Walk::Octree(walk) => walk.next(),
        }
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = match &self.0 {
            Walk::Slices(walk) => walk.left(),
            Walk::Octree(walk) => walk.left(),
        };
        usize::try_from(left).map_or((usize::MAX, None), |left| (left, Some(left)))
    }
}

impl ExactSizeIterator for BundleVertices {}
