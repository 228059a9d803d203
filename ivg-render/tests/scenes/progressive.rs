//! A progressive mesh made by code.

use pmesh_format::{Decoder, EncodeOptions, Limits, ProgressiveMesh, Replay, Wedges};

/// Squares along a side of the sheet; a power of two.
const SQUARES: u32 = 32;

/// Which sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sheet {
    /// Positions and faces.
    Plain,
    /// Normals, texture coordinates and two materials; every vertex has a wedge for the left half and one for the right.
    Full,
}

/// A bumpy square sheet of 1 m with 1,089 vertices and 2,048 faces, all its levels in.
///
/// Vertices come by the power of two that divides both coordinates, the greatest first, and collapse onto the one at the
/// next greater power below them.
pub(crate) fn sheet(kind: Sheet) -> Replay {
    let side = SQUARES + 1;
    let step = |[x, y]: [u32; 2]| 1 << (x | y | SQUARES).trailing_zeros();
    let mut order: Vec<[u32; 2]> = (0..side * side).map(|k| [k % side, k / side]).collect();
    order.sort_by_key(|&at| std::cmp::Reverse(step(at)));
    let mut number = vec![0; order.len()];
    for (index, &[x, y]) in (0..).zip(&order) {
        number[(y * side + x) as usize] = index;
    }
    let vertex = |x: u32, y: u32| number[(y * side + x) as usize];
    let base = order.iter().filter(|&&at| step(at) == SQUARES).count();
    let collapse: Vec<u32> = order[base..]
        .iter()
        .map(|&[x, y]| {
            let coarser = !(2 * step([x, y]) - 1);
            vertex(x & coarser, y & coarser)
        })
        .collect();
    let share = |k: u32| k as f32 / SQUARES as f32;
    let height = |[x, y]: [u32; 2]| 0.1 * (7.0 * share(x)).sin() * (5.0 * share(y) + 0.3).cos();
    let mut mesh = ProgressiveMesh {
        positions: order.iter().map(|&[x, y]| [share(x), share(y), height([x, y])]).collect(),
        base_vertices: base as u32,
        errors: (0..collapse.len()).map(|k| 1.0 / (k + 1) as f32).collect(),
        ..ProgressiveMesh::default()
    };
    let full = kind == Sheet::Full;
    for k in 0..SQUARES * SQUARES {
        let (x, y) = (k % SQUARES, k / SQUARES);
        let right = x >= SQUARES / 2;
        let wedge = |x, y| if full { 2 * vertex(x, y) + u32::from(right) } else { vertex(x, y) };
        let [a, b, c, d] = [wedge(x, y), wedge(x + 1, y), wedge(x + 1, y + 1), wedge(x, y + 1)];
        mesh.faces.extend([[a, b, c], [a, c, d]]);
        mesh.materials.extend([u16::from(right); 2]);
    }
    let vertices = order.len() as u32;
    if full {
        mesh.wedges.vertices = (0..2 * vertices).map(|wedge| wedge / 2).collect();
        mesh.wedge_collapse = collapse.iter().flat_map(|parent| [2 * parent, 2 * parent + 1]).collect();
        for &[x, y] in &order {
            let (s, t) = (7.0 * share(x), 5.0 * share(y) + 0.3);
            let normal = glam::Vec3::new(-0.7 * s.cos() * t.cos(), 0.5 * s.sin() * t.sin(), 1.0).normalize();
            mesh.wedges
                .normals
                .extend([normal.to_array(), (normal + 0.2 * glam::Vec3::X).normalize().to_array()]);
            mesh.wedges.uvs.extend([[3.0 * share(x), share(y)], [share(y), share(x)]]);
        }
    } else {
        mesh.wedges = Wedges { vertices: (0..vertices).collect(), ..Wedges::default() };
        mesh.wedge_collapse.clone_from(&collapse);
        mesh.materials.clear();
    }
    mesh.collapse = collapse;
    let file = pmesh_format::encode(&mesh, &EncodeOptions::fixed(300)).expect("a progressive mesh");
    let (mut decoder, mut replay, mut rest) = (Decoder::new(Limits::default()), Replay::default(), &file[..]);
    while let pmesh_format::Step::Consumed(used, event) = decoder.push(rest).expect("a file") {
        replay.accept(&event).expect("its packets");
        rest = &rest[used..];
        if rest.is_empty() {
            break;
        }
    }
    assert_eq!(replay.max_level(), vertices);
    replay
}
