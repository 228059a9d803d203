//! How far a level lies from the whole surface, and the whole surface from it, where a collapse changes it.

use glam::DVec3;

use crate::bvh::Bvh;
use crate::distance::squared_distance;
use crate::input::index;
use crate::surface::{Ring, Surface};

/// What Hausdorff distances are measured against: the surface as it was before anything collapsed.
#[derive(Debug)]
pub(crate) struct Hausdorff {
    original: Bvh,
    /// The vertices that have come to each vertex that is left, and itself, as a ring: each names the next.
    next: Vec<u32>,
    /// Which of the vertices that have come to each vertex was found to be the farthest, or went beyond what was asked for. It
    /// is seldom another one the next time, and if it is too far off the others are not looked at.
    farthest: Vec<u32>,
    /// Scratch space: the faces that move, and those around the vertex that they move onto, as they will be.
    after: Vec<[DVec3; 3]>,
}

impl Hausdorff {
    /// For the uncollapsed surface, which has a face.
    pub(crate) fn new(surface: &Surface) -> Self {
        Self {
            original: Bvh::new(surface),
            next: (0..index(surface.positions.len())).collect(),
            farthest: (0..index(surface.positions.len())).collect(),
            after: Vec::new(),
        }
    }

    /// Squared distance between the whole surface and the faces that move with `u`, whose edges are in `ring`, onto `v`:
    /// the greater of the two one-sided ones \[m²\]. Of the moved faces it looks at their centres and at the middles of
    /// new edges; of the surface at the vertices that have come to `u` so far, as in Klein, Liebich and Straßer, "Mesh
    /// Reduction with Error Control", IEEE Visualization 1996, section 3.
    ///
    /// `enough` if it is less than that; once it is more than `limit`, no greater one is looked for.
    pub(crate) fn squared_distance(
        &mut self,
        surface: &Surface,
        ring: &Ring,
        (u, v): (u32, u32),
        (enough, limit): (f64, f64),
    ) -> f64 {
        let positions = &surface.positions;
        let to = positions[v as usize];
        let mut greatest = enough;
        let around = |x: u32| surface.around(x).iter().map(|&f| surface.faces[f as usize]);
        self.after.clear();
        for face in around(u).filter(|face| !face.contains(&v)) {
            self.after.push(face.map(|x| if x == u { to } else { positions[x as usize] }));
        }
        for face in around(v).filter(|face| !face.contains(&u)) {
            self.after.push(face.map(|x| positions[x as usize]));
        }
        let first = self.farthest[u as usize];
        let mut x = first;
        loop {
            let squared = nearest(positions[x as usize], &mut self.after, greatest);
            if squared > greatest {
                greatest = squared;
                self.farthest[u as usize] = x;
            }
            if greatest > limit {
                return greatest;
            }
            x = self.next[x as usize];
            if x == first {
                break;
            }
        }
        let corner = |x: u32| if x == u { to } else { positions[x as usize] };
        let centre = |[a, b, c]: [u32; 3]| (corner(a) + corner(b) + corner(c)) / 3.0;
        let centres = around(u).filter(|face| !face.contains(&v)).map(centre);
        // Vertices of a face that vanishes have an edge with `v` already.
        let new_edges = ring
            .edges
            .iter()
            .map(|edge| edge.to)
            .filter(|&x| x != v && !around(u).any(|face| face.contains(&x) && face.contains(&v)));
        let middles = new_edges.map(|x| (to + positions[x as usize]) * 0.5);
        for p in middles.chain(centres) {
            greatest = greatest.max(self.original.squared_distance(positions, p, greatest));
            if greatest > limit {
                break;
            }
        }
        greatest
    }

    /// Tells that `u` has moved onto `v`.
    pub(crate) fn collapsed(&mut self, u: u32, v: u32) {
        // Two rings become one.
        self.next.swap(u as usize, v as usize);
    }
}

/// Squared distance of `p` to the nearest of the triangles, or to any that is at most `enough` \[m²\]. That one is moved to
/// the front: the next point is seldom far from it.
fn nearest(p: DVec3, triangles: &mut [[DVec3; 3]], enough: f64) -> f64 {
    let mut least = f64::INFINITY;
    for i in 0..triangles.len() {
        least = least.min(squared_distance(p, triangles[i]));
        if least <= enough {
            triangles.swap(0, i);
            break;
        }
    }
    least
}

#[cfg(test)]
mod tests;
