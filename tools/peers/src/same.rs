//! Is it the same mesh? Triangles are compared by the places of their corners, whatever their order in the file.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use crate::mesh::Mesh;

#[cfg(test)]
mod tests;

/// The places of a triangle's corners: lattice coordinates, or the bits of floats.
type Places = [[i64; 3]; 3];

/// How many triangles of the one mesh the other lacks, with positions on the lattice of `bits` bits along the longest side of
/// the original, or as they are for zero bits. Triangles with two corners in one place are left out, repeated ones count once:
/// whoever welds equal positions loses them.
pub(crate) fn compare(original: &Mesh, other: &Mesh, bits: u32) -> Value {
    let bounds = original.bounds();
    let [ours, theirs] = [original, other].map(|mesh| triangles(mesh, bounds, bits));
    json!({
        "triangles": ours.len(),
        "lost": ours.difference(&theirs).count(),
        "foreign": theirs.difference(&ours).count(),
    })
}

fn triangles(mesh: &Mesh, [least, greatest]: [[f32; 3]; 2], bits: u32) -> BTreeSet<Places> {
    let extent = (0..3).map(|axis| f64::from(greatest[axis]) - f64::from(least[axis])).fold(0.0, f64::max);
    let step = extent / f64::from((1_u32 << bits) - 1).max(1.0);
    let place = |index: u32| {
        let point = mesh.positions[index as usize];
        [0, 1, 2].map(|axis| match bits {
            // Zero has two signs and one place.
            0 => i64::from((point[axis] + 0.0).to_bits()),
            _ if step == 0.0 => 0,
            _ => ((f64::from(point[axis]) - f64::from(least[axis])) / step).round() as i64,
        })
    };
    let places =
        mesh.indices.chunks_exact(3).map(|corners| [place(corners[0]), place(corners[1]), place(corners[2])]);
    places
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .map(|[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap_or_default())
        .collect()
}
