use ivg_format::Lattice;
use ivg_grid::HemisphereVectors;

use super::*;

fn grid(dims: [u16; 3], scale: f32) -> IrradianceGrid {
    let lattice = Lattice::new(dims, [0.0; 3], [1.0; 3]).unwrap();
    let count = dims.map(usize::from).iter().product();
    let vectors: Vec<HemisphereVectors> = (0..count)
        .map(|vertex| {
            let mut vectors = [[[0.0; 3]; 3]; 6];
            for (index, component) in vectors.as_flattened_mut().as_flattened_mut().iter_mut().enumerate() {
                *component = scale * ((vertex * 54 + index) as f32 * 0.01).sin();
            }
            vectors
        })
        .collect();
    IrradianceGrid::from_parts(lattice, vectors, vec![255; count], vec![0; count]).unwrap()
}

#[test]
fn textures_hold_every_vector_at_half_precision() {
    for scale in [1e-6, 1.0, 1e9] {
        let grid = grid([3, 2, 4], scale);
        let (textures, factor) = grid_textures(&grid);
        for (hemisphere, channel, vertex) in [(0, 0, 0), (1, 2, 23), (4, 1, 7), (5, 2, 16)] {
            let slab = hemisphere % 2 * 3 + channel;
            let texel = 4 * (slab * 24 + vertex);
            for axis in 0..3 {
                let found = textures[hemisphere / 2][texel + axis].to_f32() * factor;
                let expected = grid.vectors()[vertex][hemisphere][channel][axis];
                // Half precision rounds to 11 binary digits.
                assert!((found - expected).abs() <= expected.abs() / 2048.0, "{found} {expected}");
            }
            assert_eq!(textures[hemisphere / 2][texel + 3].to_f32(), 1.0);
        }
        let largest =
            textures.iter().flatten().fold(0f32, |largest, value| largest.max(value.to_f32().abs()));
        assert!((LARGEST_HALF / 2.0..=LARGEST_HALF).contains(&largest), "{largest}");
    }
}

#[test]
fn textures_of_radiance_hold_three_coefficients_each() {
    let lattice = Lattice::new([3, 2, 4], [0.0; 3], [1.0; 3]).unwrap();
    let radiance: Vec<_> = (0..24)
        .map(|vertex| {
            [0, 1, 2]
                .map(|channel| [0, 1, 2, 3, 4, 5, 6, 7, 8].map(|c| (vertex * 27 + channel * 9 + c) as f32))
        })
        .collect();
    let grid = IrradianceGrid::from_parts(lattice, radiance, vec![255; 24], vec![0; 24]).unwrap();
    let (textures, factor) = grid_textures(&grid);
    for (coefficient, channel, vertex) in [(0, 0, 0), (4, 2, 23), (8, 1, 7), (5, 0, 16)] {
        let texel = 4 * (channel * 24 + vertex);
        let found = textures[coefficient / 3][texel + coefficient % 3].to_f32() * factor;
        // Whole numbers below 2^11 are exact at half precision.
        assert_eq!(found, (vertex * 27 + channel * 9 + coefficient) as f32);
        assert_eq!(textures[coefficient / 3][texel + 3].to_f32(), 1.0);
    }
    assert!(textures.iter().all(|texture| texture.len() == 4 * 3 * 24));
}

#[test]
fn a_dark_grid_has_a_scale_too() {
    let (textures, factor) = grid_textures(&grid([2; 3], 0.0));
    assert_eq!(factor, 1.0);
    assert!(textures.iter().flatten().all(|value| value.to_f32().is_finite()));
}

#[test]
fn cells_are_clear_unless_an_obstacle_touches_them() {
    let mut grid = grid([6, 5, 4], 1.0);
    let index = |i: usize, j: usize, k: usize| i + 6 * (j + 5 * k);
    let clear = FLAG_USABLE | FLAG_CLEAR_CELL | FLAG_CLEAR_BLOCK;
    assert!(grid_flags(&grid).iter().all(|flags| *flags == clear));
    grid.set_validity(index(4, 2, 1), 0);
    let flags = grid_flags(&grid);
    assert_eq!(flags[index(4, 2, 1)] & FLAG_USABLE, 0);
    for (i, j, k) in [(3, 1, 0), (4, 2, 1), (3, 2, 1)] {
        assert_eq!(flags[index(i, j, k)] & (FLAG_CLEAR_CELL | FLAG_CLEAR_BLOCK), 0, "({i}, {j}, {k})");
    }
    // Two steps away: the cell is clear, the block around it is not.
    assert_eq!(flags[index(2, 2, 1)], FLAG_USABLE | FLAG_CLEAR_CELL);
    assert_eq!(flags[index(1, 2, 1)], clear);
}

#[test]
fn a_blocked_edge_touches_the_four_cells_around_it() {
    let mut grid = grid([6, 5, 4], 1.0);
    let index = |i: usize, j: usize, k: usize| i + 6 * (j + 5 * k);
    grid.set_blocked_edges(index(2, 2, 1), 0b001);
    let flags = grid_flags(&grid);
    for k in 0..3 {
        for j in 0..4 {
            for i in 0..5 {
                let touched = i == 2 && (1..=2).contains(&j) && k <= 1;
                assert_eq!(flags[index(i, j, k)] & FLAG_CLEAR_CELL == 0, touched, "({i}, {j}, {k})");
            }
        }
    }
}

#[test]
fn uniforms_lie_at_multiples_of_the_alignment() {
    let bytes = aligned_uniforms(&[1u32, 2, 3]);
    assert_eq!(bytes.len(), 3 * UNIFORM_ALIGNMENT);
    assert_eq!((bytes[0], bytes[256], bytes[512]), (1, 2, 3));
    assert_eq!(aligned_uniforms::<u32>(&[]).len(), UNIFORM_ALIGNMENT);
}
