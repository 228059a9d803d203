//! From an input mesh to a progressive mesh: cleaning, ordering, renumbering.

use glam::DVec3;
use pmesh_format::{IndexedMesh, ProgressiveMesh, Wedges};

use crate::error::BuildError;
use crate::input::{clean, index};
use crate::options::{BuildOptions, BuildReport};
use crate::order::{Order, find};
use crate::rules::twice_area;
use crate::surface::{Ring, Surface};

/// Orders the vertices of `mesh` by importance and finds what each collapses onto.
///
/// First the mesh is cleaned: vertices at one position are welded (unless `options` says otherwise), wedges with the same
/// vertex and attributes merged; faces with a repeated vertex, repeated faces and vertices without a face dropped. Then
/// vertices are collapsed until three are left (none, if there is no face). `progress` is told the share that is done,
/// rising from 0 to 1; 0 a second time when the mesh is clean.
///
/// # Errors
/// A coordinate or attribute is NaN or infinite, an index is out of range, an array has a wrong length, or there is more
/// than a .pmesh can hold. A mesh without faces is no error: its result has no vertices.
pub fn build(
    mesh: &IndexedMesh,
    options: &BuildOptions,
    progress: &mut dyn FnMut(f32),
) -> Result<(ProgressiveMesh, BuildReport), BuildError> {
    let mut report = BuildReport::default();
    progress(0.0);
    let mesh = clean(mesh, options, &mut report)?;
    let frame = Frame::around(&mesh.positions);
    report.diagonal = frame.diagonal;
    report.coordinate_spacing = frame.spacing;
    let surface = Surface::new(&mesh, mesh.positions.iter().map(|&p| frame.inside(p)).collect());
    describe(&surface, &mut report);
    report.vertices = mesh.positions.len();
    report.wedges = mesh.wedges.len();
    report.faces = mesh.triangles.len();
    progress(0.0);
    let order = find(surface, &mesh.wedges, options, &mut report, progress);
    report.base_vertices = report.vertices - order.collapses.len();
    let result = arrange(mesh, &order);
    let base = result.base_vertices;
    let at_base = |face: &&[u32; 3]| result.introduction(**face).is_some_and(|(level, _)| level <= base);
    report.base_faces = result.faces.iter().filter(at_base).count();
    progress(1.0);
    Ok((result, report))
}

/// Where the mesh lies: costs are computed about the centre of its box, so that a distant origin costs no precision. Its
/// scale costs none either: the sixth power of any f32 is a normal f64.
struct Frame {
    centre: DVec3,
    /// \[m\]
    diagonal: f64,
    /// \[m\]
    spacing: f32,
}

impl Frame {
    fn around(positions: &[[f32; 3]]) -> Self {
        let exact = |p: [f32; 3]| DVec3::from(p.map(f64::from));
        let Some(&first) = positions.first() else {
            return Self { centre: DVec3::ZERO, diagonal: 0.0, spacing: 0.0 };
        };
        let (mut low, mut high) = (exact(first), exact(first));
        for &p in positions {
            low = low.min(exact(p));
            high = high.max(exact(p));
        }
        let largest = positions.iter().flatten().fold(0.0f32, |m, x| m.max(x.abs()));
        let spacing = largest - f32::from_bits(largest.to_bits().saturating_sub(1));
        Self { centre: (low + high) * 0.5, diagonal: low.distance(high), spacing }
    }

    fn inside(&self, p: [f32; 3]) -> DVec3 {
        DVec3::from(p.map(f64::from)) - self.centre
    }
}

/// Counts edges and faces by kind.
fn describe(surface: &Surface, report: &mut BuildReport) {
    let mut ring = Ring::new(surface.positions.len());
    for u in 0..index(surface.positions.len()) {
        ring.collect(surface, u);
        for edge in ring.edges.iter().filter(|e| e.to > u) {
            match edge.faces {
                1 => report.boundary_edges += 1,
                2 => report.seam_edges += usize::from(edge.seam),
                _ => report.nonmanifold_edges += 1,
            }
        }
    }
    let faces = 0..index(surface.faces.len());
    report.zero_area = faces.filter(|&f| twice_area(surface.triangle(f)) == DVec3::ZERO).count();
}

/// Renumbers vertices: what is left first, then what was collapsed last.
fn arrange(mesh: IndexedMesh, order: &Order) -> ProgressiveMesh {
    let vertices = mesh.positions.len();
    let base = vertices - order.collapses.len();
    let mut gone = vec![false; vertices];
    for collapse in &order.collapses {
        gone[collapse.vertex as usize] = true;
    }
    let mut old: Vec<u32> = (0..index(vertices)).filter(|&v| !gone[v as usize]).collect();
    old.extend(order.collapses.iter().rev().map(|c| c.vertex));
    let new_vertex = inverse(&old);

    // Wedges were sorted by old vertex: those of one vertex stay together and in order.
    let mut old_wedges: Vec<u32> = (0..index(mesh.wedges.len())).collect();
    old_wedges.sort_by_key(|&w| (new_vertex[mesh.wedges.vertices[w as usize] as usize], w));
    let new_wedge = inverse(&old_wedges);
    let base_wedges = old_wedges
        .partition_point(|&w| (new_vertex[mesh.wedges.vertices[w as usize] as usize] as usize) < base);

    // The error of a level is that of the worst collapse that it lacks, so it never falls on the way to the base.
    let mut worst = 0.0f64;
    let mut errors: Vec<f32> = order
        .collapses
        .iter()
        .map(|c| {
            worst = worst.max(c.distance);
            (worst as f32).min(f32::MAX)
        })
        .collect();
    errors.reverse();

    let in_order = |array: &Vec<[f32; 3]>| take(array, &old_wedges);
    ProgressiveMesh {
        origin: mesh.origin,
        positions: take(&mesh.positions, &old),
        wedges: Wedges {
            vertices: old_wedges
                .iter()
                .map(|&w| new_vertex[mesh.wedges.vertices[w as usize] as usize])
                .collect(),
            normals: in_order(&mesh.wedges.normals),
            uvs: take(&mesh.wedges.uvs, &old_wedges),
            colours: take(&mesh.wedges.colours, &old_wedges),
        },
        base_vertices: index(base),
        collapse: order.collapses.iter().rev().map(|c| new_vertex[c.parent as usize]).collect(),
        wedge_collapse: old_wedges[base_wedges..]
            .iter()
            .map(|&w| new_wedge[order.wedge_targets[w as usize] as usize])
            .collect(),
        errors,
        faces: mesh.triangles.iter().map(|t| t.map(|w| new_wedge[w as usize])).collect(),
        materials: mesh.materials,
        material_names: mesh.material_names,
    }
}

fn inverse(order: &[u32]) -> Vec<u32> {
    let mut places = vec![0; order.len()];
    for (place, &item) in (0u32..).zip(order) {
        places[item as usize] = place;
    }
    places
}

fn take<T: Copy>(array: &[T], which: &[u32]) -> Vec<T> {
    if array.is_empty() { Vec::new() } else { which.iter().map(|&i| array[i as usize]).collect() }
}
