use super::*;
use ivg_wire::splitmix64;
use pmesh_format::check_level;
use std::collections::BTreeMap;

fn choose(seed: u64) -> impl FnMut(usize) -> usize {
    let mut n = 0;
    move |bound| {
        n += 1;
        (splitmix64(seed, n) % bound as u64) as usize
    }
}

/// How often each directed edge comes.
fn edges(mesh: &pmesh_format::IndexedMesh) -> BTreeMap<(u32, u32), usize> {
    let mut edges = BTreeMap::new();
    for face in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.triangle_vertices(face);
        for edge in [(a, b), (b, c), (c, a)] {
            *edges.entry(edge).or_default() += 1;
        }
    }
    edges
}

#[test]
fn closed_surfaces_are_closed_at_every_level() {
    for seed in 0..20 {
        let kind = Kind { vertices: 40, seams: true, uvs: true, ..Kind::default() };
        let mesh = surface(kind, choose(seed));
        for level in 3..=40 {
            let level = mesh.level(level);
            check_level(&level).unwrap();
            assert_eq!(level.triangles.len(), 2 * level.positions.len() - 4, "Euler's formula");
            let edges = edges(&level);
            assert!(edges.iter().all(|(&(a, b), &count)| edges.get(&(b, a)) == Some(&count)));
        }
    }
}

#[test]
fn bordered_surfaces_have_a_border_and_every_vertex_brings_a_face() {
    for seed in 0..20 {
        let mesh = surface(Kind { vertices: 40, bordered: true, ..Kind::default() }, choose(seed));
        let mut before = 0;
        for level in 3..=40 {
            let level = mesh.level(level);
            check_level(&level).unwrap();
            assert!(level.triangles.len() > before);
            before = level.triangles.len();
        }
        let edges = edges(&mesh.level(40));
        assert!(edges.keys().any(|&(a, b)| !edges.contains_key(&(b, a))));
    }
}
