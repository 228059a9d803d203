use glam::Vec3;
use ivg_format::Lattice;
use ivg_grid::IrradianceGrid;
use ivg_scene::FlatScene;

use super::{compare, mark_near};

/// A grid whose I_d·d are `value` of (bake, vertex).
fn grid(value: impl Fn(usize) -> f32) -> IrradianceGrid {
    let lattice = Lattice::new([4, 3, 2], [0.0; 3], [3.0, 2.0, 1.0]).unwrap();
    let mut grid = IrradianceGrid::new(lattice).unwrap();
    for vertex in 0..grid.vertex_count() {
        let mut vectors = [[[0.0; 3]; 3]; 6];
        for (hemisphere, channels) in vectors.iter_mut().enumerate() {
            let sign = if hemisphere % 2 == 0 { 1.0 } else { -1.0 };
            channels.iter_mut().for_each(|vector| vector[hemisphere / 2] = sign * value(vertex));
        }
        grid.set(vertex, &vectors);
    }
    grid
}

/// Noise of two bakes that differ by ±0.3 from their mean, and a difference of 0.02: 0.02² is left of 0.02² + 0.3²/1 · 2/2.
#[test]
fn noise_is_taken_off_the_error_and_what_bakes_have_in_common_is_none() {
    let vertices: Vec<usize> = (0..24).collect();
    let shared = |vertex: usize| (vertex as f32 * 2.4).sin() * 0.3;
    let reference = [1.0, -1.0].map(|sign| grid(|v| 1.0 + sign * shared(v)));
    let darker = [1.0, -1.0].map(|sign| grid(|v| 0.98 + sign * shared(v)));
    let found = compare(&darker, &reference, &vertices);
    // Rounding of f32 sums.
    assert!((found.error - 0.02).abs() < 1e-6 && found.noise < 1e-6, "{found:?}");
    assert!((found.mean - 0.98).abs() < 1e-6 && (found.largest - 0.02).abs() < 1e-6, "{found:?}");
    // Other noise in bakes of the same light: the difference of the means is as large as its variance says, on the average
    // over the vertices, so that nothing is left.
    let alternating = |v: usize| if v.is_multiple_of(2) { 0.1 } else { -0.1 };
    let noisy = [grid(|v| 1.0 + 2.0 * alternating(v)), grid(|_| 1.0)];
    let even = [grid(|_| 1.0), grid(|_| 1.0)];
    let found = compare(&noisy, &even, &vertices);
    assert!(found.error < 1e-3 && (found.noise - 0.1).abs() < 1e-6, "{found:?}");
}

#[test]
fn only_the_vertices_named_are_compared() {
    let one = [grid(|_| 1.0), grid(|_| 1.0)];
    let other = [grid(|v| if v == 5 { 9.0 } else { 1.0 }), grid(|v| if v == 5 { 9.0 } else { 1.0 })];
    assert_eq!(compare(&other, &one, &[0, 1, 2]).error, 0.0);
    assert!((compare(&other, &one, &[0, 5]).error - 32f64.sqrt()).abs() < 1e-6);
}

#[test]
fn vertices_within_half_a_step_of_a_triangle_are_near() {
    let lattice = Lattice::new([4, 3, 2], [0.0; 3], [3.0, 2.0, 1.0]).unwrap();
    let flat = FlatScene {
        positions: vec![Vec3::new(-9.0, 0.6, -9.0), Vec3::new(9.0, 0.6, -9.0), Vec3::new(0.0, 0.6, 9.0)],
        triangles: vec![[0, 1, 2]],
        triangle_materials: vec![0],
        ..FlatScene::default()
    };
    let mut near = vec![false; 24];
    mark_near(&flat, &lattice, &mut near);
    let found: Vec<usize> = (0..24).filter(|&vertex| near[vertex]).collect();
    let expected: Vec<usize> = (0..24).filter(|&vertex| lattice.coords(vertex as u64)[1] == 1).collect();
    assert_eq!(found, expected);
    let beside = FlatScene { origin: glam::DVec3::X * 20.0, ..flat };
    let mut near = vec![false; 24];
    mark_near(&beside, &lattice, &mut near);
    assert!(near.iter().all(|near| !near));
}
