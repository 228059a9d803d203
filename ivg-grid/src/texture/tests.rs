use ivg_format::Lattice;

use super::*;
use crate::{FillOptions, fill};

/// 2 × 2 × 1 vertices: 0 received with a blocked edge, 1 received but invalid, 2 missing, 3 received.
fn grid() -> IrradianceGrid {
    let mut grid = IrradianceGrid::new(Lattice::new([2, 2, 1], [0.0; 3], [1.0, 1.0, 0.0]).expect("a box"))
        .expect("small");
    for index in [0usize, 1, 3] {
        let mut vectors = [[[0.0; 3]; 3]; 6];
        let mut next = index as f32 * 100.0;
        for component in vectors.as_flattened_mut().as_flattened_mut() {
            *component = next;
            next += 1.0;
        }
        grid.set(index, &vectors);
    }
    grid.set_validity(1, 0);
    grid.set_blocked_edges(0, 0b010);
    grid
}

#[test]
fn each_texture_holds_one_channel_of_one_hemisphere() {
    let grid = grid();
    for (texture, texels) in grid.texture_layers().enumerate() {
        let first = 3.0 * texture as f32;
        assert_eq!(texels[0], [first, first + 1.0, first + 2.0, 1.0]);
        assert_eq!(texels[1], [0.0; 4], "invalid: no weight");
        assert_eq!(texels[2], [0.0; 4], "missing: no weight");
        assert_eq!(texels[3], [300.0 + first, 301.0 + first, 302.0 + first, 1.0]);
    }
    assert_eq!(grid.texture_layers().count(), texture_count(Quantity::Vectors));
}

#[test]
fn in_a_filled_grid_invalid_vertices_have_a_little_weight() {
    let filled = fill(&grid(), &FillOptions::default());
    let texels = filled.texture_layer(4);
    let expected = filled.vectors()[1][1][1].map(|c| c * INVALID_TEXTURE_WEIGHT);
    assert_eq!(texels[1], [expected[0], expected[1], expected[2], INVALID_TEXTURE_WEIGHT]);
    assert_eq!(texels[2][3], 1.0, "filled");
}

#[test]
fn flags_tell_blocked_edges_and_usable_vertices() {
    assert_eq!(grid().texture_flags(), [FLAG_USABLE | 0b010, 0, 0, FLAG_USABLE]);
    let filled = fill(&grid(), &FillOptions::default());
    assert_eq!(filled.texture_flags(), [FLAG_USABLE | 0b010, 0, FLAG_USABLE, FLAG_USABLE]);
}

#[test]
#[should_panic(expected = "texture 18 of 18")]
fn there_is_no_nineteenth_texture() {
    let _ = grid().texture_layer(18);
}
