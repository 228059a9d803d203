//! Closest hits and occlusion: the only file that names `obvhs`.
//!
//! An eight-wide compressed tree (`CwBvh`) finds the candidates, [`crate::intersect`] tests them. Three defects measured
//! in obvhs 0.4 are met here: its own triangle test misses shared edges, so it is not used; and its box test culls
//! boxes that a ray leaves within 1e-4 units, so coordinates must come in bake space ([`crate::space`]), where that
//! is less than f32 resolves, and boxes are padded beyond both that and the rounding of the box test itself; and it misses every box along directions with a
//! component of −0.
//!
//! Photons' flights find their hits in this tree 1.2 to 1.3 times as fast as in a binary one of the same crate (the kitchen, the
//! dragon in a box), for 1.2 to 1.6 times as long to build; the slowest builds take five to ten times as long and gain a
//! twentieth at most (`cargo xtask peers bake --only rays` prints them all). So others exist for that comparison alone.
//!
//! Of hits at equal distance the one with the lowest triangle index counts, so that no result depends on the order of
//! nodes. The tree is built on one thread (the crate's feature `parallel` is off) and is the same every time.

use glam::{Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
#[cfg(any(test, feature = "rays"))]
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::cwbvh::node::CwBvhNode;
use obvhs::ploc::PlocBuilder;
use obvhs::ray::{Ray, RayHit};
use obvhs::{Boundable, BvhBuildParams};

use crate::BakeError;
use crate::intersect::{Corners, ShearedRay, corners};

/// Padding of every box, as a share of the largest coordinate: sixteen roundings of f32. The box test rounds a few
/// times at up to three times that coordinate (Woop et al. 2013, section 3.3, pad for the same reason).
const BOX_PADDING: f32 = 1.0 / 1_048_576.0;

/// Primitives in a leaf of the wide tree, the most that its nodes can name.
const LEAF_TRIANGLES: u32 = 3;

/// Levels of the wide tree that the traversal stack of obvhs holds.
const MAX_DEPTH: usize = 31;

/// How long a tree may take to build: presets of obvhs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Build {
    #[cfg(any(test, feature = "rays"))]
    Fast,
    Medium,
    #[cfg(any(test, feature = "rays"))]
    VerySlow,
}

impl Build {
    fn preset(self) -> BvhBuildParams {
        match self {
            #[cfg(any(test, feature = "rays"))]
            Self::Fast => BvhBuildParams::fast_build(),
            Self::Medium => BvhBuildParams::medium_build(),
            #[cfg(any(test, feature = "rays"))]
            Self::VerySlow => BvhBuildParams::very_slow_build(),
        }
    }
}

/// The triangles of a scene, ready to be hit by rays. All coordinates are bake space.
#[derive(Debug)]
pub(crate) struct TraceScene<T = CwBvh> {
    tree: T,
    /// In the order of the tree's leaves.
    triangles: Vec<Corners>,
    /// Index in the scene of each of `triangles`.
    indices: Vec<u32>,
}

/// The closest hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hit {
    /// Distance from the ray's origin \[bake units for unit directions\].
    pub(crate) distance: f32,
    /// Index of the triangle in the scene.
    pub(crate) triangle: u32,
    /// Barycentric weights of its corners.
    pub(crate) weights: [f32; 3],
}

/// A box that a ray cannot miss by rounding.
#[derive(Debug)]
pub(crate) struct PaddedBox(Aabb);

impl Boundable for PaddedBox {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

impl TraceScene {
    /// Builds the tree over `triangles`; those without area are left out, since no ray can hit them.
    ///
    /// # Errors
    ///
    /// [`BakeError::TreeTooDeep`] for triangles nested so that the traversal stack would not hold the way down.
    pub(crate) fn new(triangles: &[[Vec3; 3]]) -> Result<Self, BakeError> {
        Self::built(triangles, Build::Medium)
    }
}

impl<T: Tree> TraceScene<T> {
    /// [`TraceScene::new`] with a tree and a preset of one's choice.
    ///
    /// # Errors
    ///
    /// As [`TraceScene::new`].
    pub(crate) fn built(triangles: &[[Vec3; 3]], build: Build) -> Result<Self, BakeError> {
        let solid: Vec<u32> = (0u32..)
            .zip(triangles)
            .filter(|(_, [a, b, c])| (b - a).as_dvec3().cross((c - a).as_dvec3()).length_squared() > 0.0)
            .map(|(index, _)| index)
            .collect();
        let reach = triangles.iter().flatten().fold(0f32, |reach, p| reach.max(p.abs().max_element()));
        let padding = Vec3A::splat(reach * BOX_PADDING);
        let boxes: Vec<PaddedBox> = solid
            .iter()
            .map(|&index| {
                let [a, b, c] = triangles[index as usize];
                let (low, high) = (a.min(b).min(c), a.max(b).max(c));
                PaddedBox(Aabb { min: Vec3A::from(low) - padding, max: Vec3A::from(high) + padding })
            })
            .collect();
        let tree = if boxes.is_empty() { T::default() } else { T::over(&boxes, build.preset()) };
        if tree.is_too_deep() {
            return Err(BakeError::TreeTooDeep);
        }
        let indices: Vec<u32> = tree.leaves().iter().map(|&leaf| solid[leaf as usize]).collect();
        let triangles = indices.iter().map(|&index| corners(triangles[index as usize])).collect();
        Ok(Self { tree, triangles, indices })
    }

    /// The closest hit at a distance above 0 and up to `limit`.
    #[inline]
    pub(crate) fn closest_hit(&self, origin: Vec3, direction: Vec3, limit: f32) -> Option<Hit> {
        let direction = unsigned_zeros(direction);
        let sheared = ShearedRay::new(origin, direction);
        let mut best: Option<Hit> = None;
        let ray = Ray::new(origin.into(), direction.into(), 0.0, limit.min(f32::MAX));
        self.tree.closest(ray, |ray, leaf| {
            let Some(crossing) = sheared.intersect(&self.triangles[leaf], ray.tmax) else {
                return f32::INFINITY;
            };
            let triangle = self.indices[leaf];
            let closer =
                best.as_ref().is_none_or(|b| (crossing.distance, triangle) < (b.distance, b.triangle));
            if closer {
                best = Some(Hit { distance: crossing.distance, triangle, weights: crossing.weights });
            }
            crossing.distance
        });
        best
    }

    /// Whether anything is hit at a distance above 0 and up to `limit`.
    #[inline]
    pub(crate) fn occluded(&self, origin: Vec3, direction: Vec3, limit: f32) -> bool {
        let direction = unsigned_zeros(direction);
        let sheared = ShearedRay::new(origin, direction);
        let ray = Ray::new(origin.into(), direction.into(), 0.0, limit.min(f32::MAX));
        self.tree.any(ray, |ray, leaf| {
            // Any number below the ray's limit ends the traversal; a hit exactly at the limit counts as well.
            sheared.intersect(&self.triangles[leaf], ray.tmax).map_or(f32::INFINITY, |_| f32::NEG_INFINITY)
        })
    }
}

/// The direction with every −0 made +0: obvhs takes the sign of −0 as positive in one place of its box test and as negative
/// in another, and misses every box then.
#[inline]
fn unsigned_zeros(direction: Vec3) -> Vec3 {
    direction + Vec3::ZERO
}

/// A tree of boxes whose leaves name triangles.
pub(crate) trait Tree: Default {
    /// The tree over `boxes`, of which there is at least one.
    fn over(boxes: &[PaddedBox], preset: BvhBuildParams) -> Self;

    /// The numbers of the boxes in the order of the leaves.
    fn leaves(&self) -> &[u32];

    /// Whether the traversal stack would not hold the way down.
    fn is_too_deep(&self) -> bool;

    /// Calls `test` with every leaf whose box the ray may pass; each answer below the ray's limit becomes its limit.
    fn closest(&self, ray: Ray, test: impl FnMut(&Ray, usize) -> f32);

    /// Whether `test` answers with less than the ray's limit for a leaf whose box the ray may pass.
    fn any(&self, ray: Ray, test: impl FnMut(&Ray, usize) -> f32) -> bool;
}

impl Tree for CwBvh {
    fn over(boxes: &[PaddedBox], preset: BvhBuildParams) -> Self {
        bvh2_to_cwbvh(&binary(boxes, &preset), LEAF_TRIANGLES, true, false)
    }

    fn leaves(&self) -> &[u32] {
        &self.primitive_indices
    }

    fn is_too_deep(&self) -> bool {
        depth(&self.nodes) > MAX_DEPTH
    }

    #[inline]
    fn closest(&self, ray: Ray, test: impl FnMut(&Ray, usize) -> f32) {
        self.ray_traverse(ray, &mut RayHit::none(), test);
    }

    #[inline]
    fn any(&self, ray: Ray, test: impl FnMut(&Ray, usize) -> f32) -> bool {
        !self.ray_traverse_miss(ray, test)
    }
}

/// The tree that bakes do not use.
#[cfg(any(test, feature = "rays"))]
pub(crate) type BinaryTree = Bvh2;

#[cfg(any(test, feature = "rays"))]
impl Tree for Bvh2 {
    fn over(boxes: &[PaddedBox], preset: BvhBuildParams) -> Self {
        let mut tree = binary(boxes, &preset);
        collapse(&mut tree, preset.max_prims_per_leaf, preset.collapse_traversal_cost);
        let ratio = preset.reinsertion_batch_ratio * preset.post_collapse_reinsertion_batch_ratio_multiplier;
        ReinsertionOptimizer::default().run(&mut tree, ratio, None);
        tree
    }

    fn leaves(&self) -> &[u32] {
        &self.primitive_indices
    }

    fn is_too_deep(&self) -> bool {
        // The stack grows with the tree.
        false
    }

    #[inline]
    fn closest(&self, ray: Ray, test: impl FnMut(&Ray, usize) -> f32) {
        self.ray_traverse(ray, &mut RayHit::none(), test);
    }

    #[inline]
    fn any(&self, ray: Ray, test: impl FnMut(&Ray, usize) -> f32) -> bool {
        !self.ray_traverse_miss(ray, test)
    }
}

/// A binary tree over boxes.
fn binary(boxes: &[PaddedBox], preset: &BvhBuildParams) -> Bvh2 {
    let mut tree = PlocBuilder::with_capacity(boxes.len()).build(
        preset.ploc_search_distance,
        boxes,
        (0u32..).zip(boxes).map(|(index, _)| index).collect(),
        preset.sort_precision,
        preset.search_depth_threshold,
    );
    ReinsertionOptimizer::default().run(&mut tree, preset.reinsertion_batch_ratio, None);
    tree
}

/// Levels of the tree below and including the root.
fn depth(nodes: &[CwBvhNode]) -> usize {
    let mut deepest = 0;
    let mut open: Vec<(usize, usize)> = if nodes.is_empty() { vec![] } else { vec![(0, 1)] };
    while let Some((index, level)) = open.pop() {
        deepest = deepest.max(level);
        let node = &nodes[index];
        let first = node.child_base_idx as usize;
        open.extend((0..node.imask.count_ones() as usize).map(|child| (first + child, level + 1)));
    }
    deepest
}

#[cfg(test)]
mod tests;
