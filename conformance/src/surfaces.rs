//! Meshes that are surfaces, grown vertex by vertex: what an ordered mesh looks like to a coder, while tables chosen at random look
//! like nothing that anybody would draw.

use pmesh_format::{ProgressiveMesh, Wedges};

/// What a surface has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Kind {
    /// Vertices of the finest level, at least 3.
    pub vertices: usize,
    /// The surface has a border: it grows from one triangle, not from two opposite ones.
    pub bordered: bool,
    /// Wedges have normals.
    pub normals: bool,
    /// Wedges have texture coordinates.
    pub uvs: bool,
    /// Wedges have colours.
    pub colours: bool,
    /// Faces are of two materials, and wedges differ along their border if there is anything in which they can.
    pub seams: bool,
    /// Some vertices are split so that faces on both sides of a pinch, or none, go with the new one.
    pub irregular: bool,
}

/// Grows a surface by splitting vertices. `choose` returns a number below the one given, which is at least 1.
///
/// # Panics
///
/// Never, if `choose` keeps to that and there are three vertices.
pub fn surface(kind: Kind, mut choose: impl FnMut(usize) -> usize) -> ProgressiveMesh {
    let mut faces: Vec<[u32; 3]> = vec![[0, 1, 2]];
    if !kind.bordered {
        faces.push([0, 2, 1]);
    }
    // A face keeps the group of the one beside which it comes; groups are materials, and wedges differ between them.
    let mut groups: Vec<u16> = (0..faces.len() as u16).map(|f| if kind.seams { f } else { 0 }).collect();
    let mut positions = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.5], [1.5, 3.0, -0.25]];
    let mut collapse = Vec::new();
    for v in 3..kind.vertices as u32 {
        let parent = choose(v as usize) as u32;
        split(&mut faces, &mut groups, parent, v, kind, &mut choose);
        collapse.push(parent);
        let reach = 4.0 / (1.0 + (v as f32).sqrt());
        let at: [f32; 3] = positions[parent as usize];
        positions.push(at.map(|x| x + reach * (choose(33) as f32 / 16.0 - 1.0)));
    }
    let (wedges, wedge_collapse, starts) = wedges(&faces, &groups, &collapse, kind, &mut choose);
    let wedge_of = |vertex: u32, group: u16| {
        let own = starts[vertex as usize]..starts[vertex as usize + 1];
        own.clone().find(|&w| wedges.1[w] == group).unwrap_or(own.start) as u32
    };
    ProgressiveMesh {
        origin: [0.0, 100.0, -7.5],
        positions,
        faces: faces.iter().zip(&groups).map(|(face, &group)| face.map(|v| wedge_of(v, group))).collect(),
        materials: if kind.seams { groups.clone() } else { Vec::new() },
        material_names: if kind.seams { vec!["one".to_owned(), "two".to_owned()] } else { Vec::new() },
        base_vertices: 3,
        errors: (0..collapse.len()).map(|k| 1.0 / (k as f32 + 1.0)).collect(),
        collapse,
        wedge_collapse,
        wedges: wedges.0,
    }
}

/// Splits `parent`: some of its faces go to the new vertex `v`, and where those that go meet those that stay, a face comes in
/// between.
fn split(
    faces: &mut Vec<[u32; 3]>,
    groups: &mut Vec<u16>,
    parent: u32,
    v: u32,
    kind: Kind,
    choose: &mut impl FnMut(usize) -> usize,
) {
    let (fan, closed) = fan(faces, parent, choose);
    if fan.is_empty() || (kind.irregular && choose(4) == 0) {
        // A vertex on its own, or one that comes with a face across.
        if let Some(&(_, to, face)) = fan.first() {
            faces.push([parent, to, v]);
            groups.push(groups[face]);
        }
        return;
    }
    let start = choose(fan.len());
    let most = if closed { fan.len() - 1 } else { fan.len() - start };
    let arc: Vec<(u32, u32, usize)> = (0..1 + choose(most)).map(|k| fan[(start + k) % fan.len()]).collect();
    for &(_, _, face) in &arc {
        for corner in faces[face].iter_mut().filter(|corner| **corner == parent) {
            *corner = v;
        }
    }
    let (first, last) = (arc[0], arc[arc.len() - 1]);
    // At a border the surface may stay as it is on that side, but one face at least comes.
    let at_start = closed || start > 0 || choose(2) == 0;
    let at_end = closed || start + arc.len() < fan.len() || choose(2) == 0 || !at_start;
    if at_start {
        faces.push([parent, first.0, v]);
        groups.push(groups[first.2]);
    }
    if at_end {
        faces.push([parent, v, last.1]);
        groups.push(groups[last.2]);
    }
}

/// A chain of faces around a vertex, each with the vertices of its opposite edge; and whether it goes all the way round.
fn fan(
    faces: &[[u32; 3]],
    vertex: u32,
    choose: &mut impl FnMut(usize) -> usize,
) -> (Vec<(u32, u32, usize)>, bool) {
    let mut around: Vec<(u32, u32, usize)> = Vec::new();
    for (index, face) in faces.iter().enumerate() {
        if let Some(corner) = face.iter().position(|&corner| corner == vertex) {
            around.push((face[(corner + 1) % 3], face[(corner + 2) % 3], index));
        }
    }
    if around.is_empty() {
        return (Vec::new(), false);
    }
    let mut chain = vec![around.swap_remove(choose(around.len()))];
    while let Some(next) = around.iter().position(|face| face.0 == chain[chain.len() - 1].1) {
        chain.push(around.swap_remove(next));
    }
    while let Some(before) = around.iter().position(|face| face.1 == chain[0].0) {
        chain.insert(0, around.swap_remove(before));
    }
    let closed = chain.len() > 1 && chain[0].0 == chain[chain.len() - 1].1;
    (chain, closed)
}

/// Wedges with the group of each; what each becomes; where those of each vertex begin.
type WedgeTables = ((Wedges, Vec<u16>), Vec<u32>, Vec<usize>);

/// A wedge for each group of faces that a vertex ever has: its own, and those of the vertices that collapse onto it.
fn wedges(
    faces: &[[u32; 3]],
    groups: &[u16],
    collapse: &[u32],
    kind: Kind,
    choose: &mut impl FnMut(usize) -> usize,
) -> WedgeTables {
    let vertices = collapse.len() + 3;
    let mut has = vec![[false; 2]; vertices];
    let differ = kind.normals || kind.uvs || kind.colours;
    for (face, &group) in faces.iter().zip(groups) {
        face.iter().for_each(|&v| has[v as usize][if differ { usize::from(group) } else { 0 }] = true);
    }
    for v in (3..vertices).rev() {
        let (own, parent) = (has[v], &mut has[collapse[v - 3] as usize]);
        parent.iter_mut().zip(own).for_each(|(parent, own)| *parent |= own);
    }
    let (mut wedges, mut of_group, mut starts) = (Wedges::default(), Vec::new(), vec![0]);
    for (v, has) in (0..).zip(&has) {
        let groups: Vec<u16> =
            if *has == [false; 2] { vec![0] } else { (0..2).filter(|&g| has[usize::from(g)]).collect() };
        for &group in &groups {
            wedges.vertices.push(v);
            if kind.normals {
                let [x, y] = [0; 2].map(|_: usize| choose(17) as f32 / 16.0 - 0.5);
                let z = if group == 0 { 1.0 } else { -1.0 };
                let length = (x * x + y * y + 1.0).sqrt();
                wedges.normals.push([x / length, y / length, z / length]);
            }
            if kind.uvs {
                wedges.uvs.push([choose(100) as f32 / 128.0, f32::from(group) + choose(100) as f32 / 256.0]);
            }
            if kind.colours {
                wedges.colours.push([choose(256) as u8, 128, group as u8, 255]);
            }
            of_group.push(group);
        }
        starts.push(of_group.len());
    }
    let targets = (starts[3]..of_group.len())
        .map(|w| {
            let parent = collapse[wedges.vertices[w] as usize - 3] as usize;
            let own = starts[parent]..starts[parent + 1];
            own.clone().find(|&target| of_group[target] == of_group[w]).unwrap_or(own.start) as u32
        })
        .collect();
    ((wedges, of_group), targets, starts)
}

#[cfg(test)]
mod tests;
