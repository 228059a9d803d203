//! Which slots switch to each vertex, as the writer of coded packets asks for it.

use alloc::vec::Vec;

use crate::progressive::ProgressiveMesh;
use crate::slots::Slots;

/// For each vertex from the base on, a code for each slot of its parent, in descending order of slots: 0 for one that stays,
/// 1 + the number of the vertex's wedge that it switches to.
pub(super) struct Switches {
    codes: Vec<u32>,
    /// Where the codes of each vertex lie.
    ranges: Vec<(usize, usize)>,
}

impl Switches {
    /// Takes vertices away from the finest level down, as a reader that goes down does, and notes what switched.
    pub(super) fn find(
        mesh: &ProgressiveMesh,
        faces: &[(u32, [u32; 3], usize)],
        wedge_starts: &[u32],
    ) -> Self {
        let base = mesh.base_vertices as usize;
        let base_wedges = wedge_starts.get(base).copied().unwrap_or(0);
        let mut corners: Vec<[u32; 3]> = faces.iter().map(|&(_, _, i)| mesh.faces[i]).collect();
        let vertex_of = |w: u32| mesh.wedges.vertices[w as usize];
        let mut slots = Slots::default();
        slots.resize(mesh.positions.len(), mesh.positions.len());
        for (face, corners) in (0u32..).zip(&corners) {
            for (corner, &wedge) in (0u32..).zip(corners) {
                slots.push(vertex_of(wedge), 3 * face + corner);
            }
        }
        let mut codes = Vec::new();
        let mut ranges = alloc::vec![(0, 0); mesh.collapse.len()];
        let mut left = faces.len();
        for split in (0..mesh.collapse.len()).rev() {
            let vertex = (base + split) as u32;
            while left > 0 && faces[left - 1].0 == vertex + 1 {
                left -= 1;
                debug_assert_eq!(corners[left], faces[left].1, "corners as mapped at introduction");
                for wedge in corners[left] {
                    slots.pop(vertex_of(wedge));
                }
            }
            let start = codes.len();
            slots.merge(vertex, mesh.collapse[split], |slot, was_child| {
                let corner = &mut corners[(slot / 3) as usize][(slot % 3) as usize];
                if was_child {
                    codes.push(*corner - wedge_starts[vertex as usize] + 1);
                    *corner = mesh.wedge_collapse[(*corner - base_wedges) as usize];
                } else {
                    codes.push(0);
                }
            });
            // Canonical order is descending.
            codes[start..].reverse();
            ranges[split] = (start, codes.len());
        }
        Self { codes, ranges }
    }

    /// The codes of all vertices, and where those of each lie.
    pub(super) fn parts(&self) -> (&[u32], &[(usize, usize)]) {
        (&self.codes, &self.ranges)
    }
}
