//! Which triangles border solids: a refracting body needs an inside and an outside.

use std::collections::HashMap;

use glam::DVec3;

use crate::FlatScene;

/// What lies behind a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Side {
    /// It is part of a surface with holes or of faces wound both ways: a sheet, with the same on both sides.
    #[default]
    Sheet,
    /// It borders a solid that lies behind its front.
    SolidBehind,
    /// It borders a solid that lies before its front: the mesh is wound inside out.
    SolidBefore,
}

impl FlatScene {
    /// What lies behind each triangle, looking only at the triangles that `belongs` names; for all others a sheet.
    ///
    /// Triangles that share edges (places, not vertex numbers) make a body. It is a solid if every edge is passed as often
    /// one way as the other, which holds for closed surfaces wound one way; the sign of its volume tells where the inside is.
    /// Triangles without area do not count.
    #[must_use]
    pub fn sides(&self, belongs: impl Fn(usize) -> bool) -> Vec<Side> {
        let mut sides = vec![Side::Sheet; self.triangles.len()];
        let chosen: Vec<usize> =
            (0..self.triangles.len()).filter(|&t| belongs(t) && self.area(t) > 0.0).collect();
        let mut places: HashMap<[u32; 3], u32> = HashMap::new();
        let corners: Vec<[u32; 3]> = chosen
            .iter()
            .map(|&t| {
                self.corners(t).map(|p| {
                    let next = places.len() as u32;
                    // Adding zero makes one place of 0 and -0.
                    *places.entry((p + glam::Vec3::ZERO).to_array().map(f32::to_bits)).or_insert(next)
                })
            })
            .collect();
        let mut bodies = Groups::new(chosen.len());
        // Edge, from the lower to the higher place: a triangle that has it, and how often it is passed that way.
        let mut edges: HashMap<[u32; 2], (usize, i32)> = HashMap::new();
        for (index, [a, b, c]) in corners.iter().copied().enumerate() {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let edge = edges.entry([from.min(to), from.max(to)]).or_insert((index, 0));
                edge.1 += if from < to { 1 } else { -1 };
                bodies.join(index, edge.0);
            }
        }
        let mut closed = vec![true; chosen.len()];
        for (index, passed) in edges.into_values() {
            if passed != 0 {
                closed[bodies.root(index)] = false;
            }
        }
        let mut volumes = vec![0.0f64; chosen.len()];
        for (index, &triangle) in chosen.iter().enumerate() {
            let root = bodies.root(index);
            // Relative to a corner of the body, so that a small one far away keeps its digits.
            let origin = self.corners(chosen[root])[0].as_dvec3();
            let [a, b, c] = self.corners(triangle).map(|p| p.as_dvec3() - origin);
            volumes[root] += DVec3::dot(a, b.cross(c));
        }
        for (index, &triangle) in chosen.iter().enumerate() {
            let root = bodies.root(index);
            if closed[root] && volumes[root] != 0.0 {
                sides[triangle] = if volumes[root] > 0.0 { Side::SolidBehind } else { Side::SolidBefore };
            }
        }
        sides
    }
}

/// Sets of indices that are joined pair by pair.
struct Groups(Vec<usize>);

impl Groups {
    fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    fn root(&mut self, mut index: usize) -> usize {
        while self.0[index] != index {
            self.0[index] = self.0[self.0[index]];
            index = self.0[index];
        }
        index
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        // The lower index stays, so that the result does not depend on the order of joining.
        self.0[a.max(b)] = a.min(b);
    }
}

#[cfg(test)]
mod tests;
