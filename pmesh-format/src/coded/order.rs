//! The order of vertices and faces that coded packets have (PMESH-COD-01).

use alloc::vec::Vec;

use crate::mesh::Wedges;
use crate::progressive::ProgressiveMesh;

/// The same mesh with the vertices from the base on sorted by parent inside each packet. `ends`: the vertex count after each
/// packet. Faces are turned so that the corner on the parent of the vertex that introduces them is the first, and of
/// those that one vertex introduces the ones that have it third come before those that have it second. Errors are those
/// of the packets.
pub(crate) fn arranged(mesh: &ProgressiveMesh, ends: &[u32]) -> ProgressiveMesh {
    let base = mesh.base_vertices;
    let parent = |vertex: u32| mesh.collapse[(vertex - base) as usize];
    // The old number of each new vertex, and the new one of each old.
    let mut old: Vec<u32> = (0..base).collect();
    let mut new = old.clone();
    new.resize(mesh.positions.len(), 0);
    let mut errors = Vec::with_capacity(mesh.errors.len());
    let mut start = base;
    for &end in ends {
        let mut children: Vec<(u32, u32)> = Vec::new();
        let mut later: Vec<(u32, u32)> = Vec::new();
        for vertex in start..end.max(start) {
            // Of a parent that is there its place is known, of one that comes in this packet not yet.
            let parent = parent(vertex);
            if parent < start {
                children.push((new[parent as usize], vertex));
            } else {
                later.push((parent, vertex));
            }
        }
        children.sort_unstable();
        later.sort_unstable();
        let mut known = children.into_iter().peekable();
        let mut place = 0;
        while old.len() < end as usize {
            // Children of vertices of this packet come behind all others, in the order of their parents.
            if let Some((_, vertex)) = known.next() {
                new[vertex as usize] = old.len() as u32;
                old.push(vertex);
                continue;
            }
            let of = old[start as usize + place];
            place += 1;
            let first = later.partition_point(|&(parent, _)| parent < of);
            for &(_, vertex) in later[first..].iter().take_while(|&&(parent, _)| parent == of) {
                new[vertex as usize] = old.len() as u32;
                old.push(vertex);
            }
        }
        if end > start {
            let error = mesh.errors.get((start - base) as usize).copied().unwrap_or(0.0);
            errors.resize((end - base) as usize, error);
        }
        start = end.max(start);
    }
    let mut wedge_starts: Vec<usize> = Vec::with_capacity(old.len() + 1);
    wedge_starts.push(0);
    for vertex in 0..old.len() as u32 {
        let before = wedge_starts[vertex as usize];
        let count = mesh.wedges.vertices[before..].partition_point(|&v| v == vertex);
        wedge_starts.push(before + count);
    }
    let base_wedges = mesh.base_wedges();
    let mut old_wedges: Vec<usize> = Vec::with_capacity(mesh.wedges.len());
    let mut new_wedges = alloc::vec![0u32; mesh.wedges.len()];
    for &vertex in &old {
        let first = old_wedges.len();
        old_wedges.extend(wedge_starts[vertex as usize]..wedge_starts[vertex as usize + 1]);
        if vertex >= base {
            // What wedges become then rises from each to the next, which is what a reader expects.
            old_wedges[first..]
                .sort_by_key(|&was| new_wedges[mesh.wedge_collapse[was - base_wedges] as usize]);
        }
        for (wedge, &was) in (first as u32..).zip(&old_wedges[first..]) {
            new_wedges[was] = wedge;
        }
    }
    let mut result = ProgressiveMesh {
        origin: mesh.origin,
        positions: old.iter().map(|&v| mesh.positions[v as usize]).collect(),
        wedges: Wedges {
            vertices: old_wedges.iter().map(|&w| new[mesh.wedges.vertices[w] as usize]).collect(),
            normals: pick(&mesh.wedges.normals, &old_wedges),
            uvs: pick(&mesh.wedges.uvs, &old_wedges),
            colours: pick(&mesh.wedges.colours, &old_wedges),
        },
        base_vertices: base,
        collapse: old[base as usize..].iter().map(|&v| new[parent(v) as usize]).collect(),
        wedge_collapse: old_wedges[base_wedges..]
            .iter()
            .map(|&w| new_wedges[mesh.wedge_collapse[w - base_wedges] as usize])
            .collect(),
        errors,
        faces: mesh.faces.iter().map(|face| face.map(|w| new_wedges[w as usize])).collect(),
        materials: mesh.materials.clone(),
        material_names: mesh.material_names.clone(),
    };
    turn(&mut result);
    result
}

/// Brings faces into stored order, turned as they must be.
fn turn(mesh: &mut ProgressiveMesh) {
    let mut keys: Vec<(u32, bool, usize, usize)> = Vec::with_capacity(mesh.faces.len());
    for (index, &face) in mesh.faces.iter().enumerate() {
        let Some((level, corners)) = mesh.introduction(face) else { continue };
        let vertices = corners.map(|w| mesh.wedges.vertices[w as usize]);
        let (first, second) = match level.checked_sub(mesh.base_vertices + 1) {
            None => (0, false),
            Some(split) => {
                let parent = vertices.iter().position(|&v| v == mesh.collapse[split as usize]).unwrap_or(0);
                (parent, vertices[(parent + 1) % 3] == level - 1)
            }
        };
        keys.push((level, second, index, first));
    }
    keys.sort_unstable();
    let materials = core::mem::take(&mut mesh.materials);
    mesh.materials = keys.iter().filter_map(|&(_, _, index, _)| materials.get(index).copied()).collect();
    mesh.faces = keys
        .iter()
        .map(|&(_, _, index, first)| core::array::from_fn(|k| mesh.faces[index][(first + k) % 3]))
        .collect();
}

fn pick<T: Copy>(array: &[T], which: &[usize]) -> Vec<T> {
    which.iter().filter_map(|&k| array.get(k).copied()).collect()
}
