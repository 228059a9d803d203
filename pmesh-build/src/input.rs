//! Checks an input mesh and brings it into the state that ordering expects: welded, nothing degenerate, nothing
//! duplicate, nothing unreferenced, vertices near their neighbours, wedges sorted by vertex.

use pmesh_format::{IndexedMesh, MAX_COUNT, Wedges};

use crate::error::BuildError;
use crate::locality::along_curve;
use crate::options::{BuildOptions, BuildReport};

/// A cleaned copy of `mesh`; what was changed is counted in `report`.
pub(crate) fn clean(
    mesh: &IndexedMesh,
    options: &BuildOptions,
    report: &mut BuildReport,
) -> Result<IndexedMesh, BuildError> {
    check(mesh)?;
    let weights = &options.attributes;
    for (attribute, weight) in
        [("normals", weights.normal), ("texture coordinates", weights.uv), ("colours", weights.colour)]
    {
        if !(weight.is_finite() && weight >= 0.0) {
            return Err(BuildError::AttributeWeight { attribute, weight: weight.to_string() });
        }
    }
    report.input_vertices = mesh.positions.len();
    report.input_triangles = mesh.triangles.len();

    let same_vertex = if options.weld { weld(&mesh.positions) } else { identity(mesh.positions.len()) };
    report.welded_vertices = (0u32..).zip(&same_vertex).filter(|&(i, &to)| i != to).count();
    let wedge_vertices: Vec<u32> = mesh.wedges.vertices.iter().map(|&v| same_vertex[v as usize]).collect();
    let same_wedge = merge_wedges(&mesh.wedges, &wedge_vertices);

    let vertices_of = |t: &[u32; 3]| t.map(|w| wedge_vertices[w as usize]);
    let mut kept: Vec<usize> = (0..mesh.triangles.len())
        .filter(|&i| {
            let [a, b, c] = vertices_of(&mesh.triangles[i]);
            a != b && b != c && c != a
        })
        .collect();
    report.dropped_degenerate = mesh.triangles.len() - kept.len();
    let before = kept.len();
    drop_duplicates(&mut kept, |i| (turned(vertices_of(&mesh.triangles[i])), mesh.material(i)));
    report.dropped_duplicate = before - kept.len();

    // Renumber what is left: vertices along a curve, wedges by vertex, then in the order of the input.
    let mut used = vec![false; mesh.wedges.len()];
    for &i in &kept {
        for w in mesh.triangles[i] {
            used[same_wedge[w as usize] as usize] = true;
        }
    }
    let places = along_curve(&mesh.positions);
    let mut wedges: Vec<(u64, u32, u32)> = (0u32..)
        .zip(&used)
        .filter(|&(_, &used)| used)
        .map(|(w, _)| {
            let v = wedge_vertices[w as usize];
            (places[v as usize], v, w)
        })
        .collect();
    wedges.sort_unstable();
    let wedges: Vec<u32> = wedges.into_iter().map(|(.., w)| w).collect();
    let mut new_vertex = vec![u32::MAX; mesh.positions.len()];
    let mut new_wedge = vec![u32::MAX; mesh.wedges.len()];
    let mut positions = Vec::new();
    let mut vertices = Vec::with_capacity(wedges.len());
    for (to, &w) in (0u32..).zip(&wedges) {
        let v = wedge_vertices[w as usize] as usize;
        if new_vertex[v] == u32::MAX {
            new_vertex[v] = index(positions.len());
            positions.push(mesh.positions[v].map(|x| x + 0.0));
        }
        new_wedge[w as usize] = to;
        vertices.push(new_vertex[v]);
    }
    report.merged_wedges = (0u32..).zip(&same_wedge).filter(|&(w, &to)| w != to).count();
    report.dropped_unreferenced = mesh.positions.len() - report.welded_vertices - positions.len();

    let pick = |w: &u32| *w as usize;
    Ok(IndexedMesh {
        origin: mesh.origin,
        positions,
        wedges: Wedges {
            vertices,
            normals: select(&mesh.wedges.normals, wedges.iter().map(pick)),
            uvs: select(&mesh.wedges.uvs, wedges.iter().map(pick)),
            colours: select(&mesh.wedges.colours, wedges.iter().map(pick)),
        },
        triangles: kept
            .iter()
            .map(|&i| mesh.triangles[i].map(|w| new_wedge[same_wedge[w as usize] as usize]))
            .collect(),
        materials: select(&mesh.materials, kept.iter().copied()),
        material_names: mesh.material_names.clone(),
    })
}

/// Everything that makes a mesh unusable, by name.
fn check(mesh: &IndexedMesh) -> Result<(), BuildError> {
    let counts = [
        ("vertices", mesh.positions.len()),
        ("wedges", mesh.wedges.len()),
        ("triangles", mesh.triangles.len()),
    ];
    for (what, found) in counts {
        if found > MAX_COUNT as usize {
            return Err(BuildError::TooMany { what, found, maximum: MAX_COUNT as usize });
        }
    }
    if !mesh.origin.iter().all(|x| x.is_finite()) {
        return Err(BuildError::NonFiniteOrigin);
    }
    for (vertex, p) in mesh.positions.iter().enumerate() {
        if let Some(axis) = p.iter().position(|x| !x.is_finite()) {
            return Err(BuildError::NonFinitePosition { vertex, axis });
        }
    }
    let wedges = mesh.wedges.len();
    let lengths = [
        ("normals", mesh.wedges.normals.len(), wedges),
        ("texture coordinates", mesh.wedges.uvs.len(), wedges),
        ("colours", mesh.wedges.colours.len(), wedges),
        ("materials", mesh.materials.len(), mesh.triangles.len()),
    ];
    for (array, found, expected) in lengths {
        if found != 0 && found != expected {
            return Err(BuildError::ArrayLength { array, found, expected });
        }
    }
    if let Some(wedge) = mesh.wedges.normals.iter().position(|n| !n.iter().all(|x| x.is_finite())) {
        return Err(BuildError::NonFiniteAttribute { wedge, attribute: "normal" });
    }
    if let Some(wedge) = mesh.wedges.uvs.iter().position(|n| !n.iter().all(|x| x.is_finite())) {
        return Err(BuildError::NonFiniteAttribute { wedge, attribute: "texture coordinate" });
    }
    for (wedge, &index) in mesh.wedges.vertices.iter().enumerate() {
        if index as usize >= mesh.positions.len() {
            return Err(BuildError::VertexOutOfRange { wedge, index, vertices: mesh.positions.len() });
        }
    }
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        if let Some(&index) = corners.iter().find(|&&w| w as usize >= wedges) {
            return Err(BuildError::CornerOutOfRange { triangle, index, wedges });
        }
    }
    Ok(())
}

/// For each vertex the first one at exactly the same position; -0 and 0 are the same.
fn weld(positions: &[[f32; 3]]) -> Vec<u32> {
    let key = |v: u32| positions[v as usize].map(|x| (x + 0.0).to_bits());
    first_equal(positions.len(), key)
}

/// For each wedge the first one of the same vertex with the same attributes, bit for bit.
fn merge_wedges(wedges: &Wedges, vertices: &[u32]) -> Vec<u32> {
    let key = |w: u32| {
        let w = w as usize;
        (
            vertices[w],
            wedges.normals.get(w).map(|n| n.map(|x| (x + 0.0).to_bits())),
            wedges.uvs.get(w).map(|t| t.map(|x| (x + 0.0).to_bits())),
            wedges.colours.get(w),
        )
    };
    first_equal(vertices.len(), key)
}

/// For each of `count` items the first one with the same key.
fn first_equal<K: Ord>(count: usize, key: impl Fn(u32) -> K) -> Vec<u32> {
    let mut order = identity(count);
    order.sort_by(|&a, &b| key(a).cmp(&key(b)).then(a.cmp(&b)));
    let mut first = vec![0; count];
    for group in order.chunk_by(|&a, &b| key(a) == key(b)) {
        for &item in group {
            first[item as usize] = group[0];
        }
    }
    first
}

/// Keeps the first of all triangles with the same key; what is kept stays in order.
fn drop_duplicates<K: Ord>(triangles: &mut Vec<usize>, key: impl Fn(usize) -> K) {
    let mut order = triangles.clone();
    order.sort_by(|&a, &b| key(a).cmp(&key(b)).then(a.cmp(&b)));
    order.dedup_by(|later, first| key(*later) == key(*first));
    order.sort_unstable();
    *triangles = order;
}

/// The vertices of a triangle turned so that the lowest stands first; its orientation stays.
fn turned([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

fn identity(count: usize) -> Vec<u32> {
    (0..index(count)).collect()
}

fn select<T: Copy>(array: &[T], which: impl Iterator<Item = usize>) -> Vec<T> {
    if array.is_empty() { Vec::new() } else { which.map(|i| array[i]).collect() }
}

/// An index as the format stores it; `check` has seen that all counts fit.
pub(crate) fn index(i: usize) -> u32 {
    u32::try_from(i).expect("counts were checked against the format's maximum")
}
