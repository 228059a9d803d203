use super::*;
use crate::SpatialFilter;
use crate::integrate::fibonacci_sphere;

/// Two vertices a metre apart along x, lit from one direction each, with one colour each.
fn two(lights: [(Vec3, Vec3); 2]) -> IrradianceGrid {
    let mut grid = IrradianceGrid::new(Lattice { dims: [2, 1, 1], origin: [0.0; 3], step: [1.0, 0.0, 0.0] })
        .expect("a lattice of two vertices");
    for (index, (w, colour)) in lights.into_iter().enumerate() {
        let vectors: HemisphereVectors = std::array::from_fn(|h| {
            let side = if h % 2 == 0 { w[h / 2] } else { -w[h / 2] };
            colour.to_array().map(|c| if side > 0.0 { (w * c).to_array() } else { [0.0; 3] })
        });
        grid.set(index, &vectors);
    }
    grid
}

const W: Vec3 = Vec3::new(2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0);

fn linear(grid: &IrradianceGrid, p: DVec3, n: Vec3) -> Vec3 {
    grid.irradiance(p, n, Reconstruction::ThreeVector, SpatialFilter::Trilinear)
}

#[test]
fn at_the_vertices_and_under_one_direction_it_is_the_linear_lookup() {
    let grid = two([(W, Vec3::new(1.0, 2.0, 3.0)), (W, Vec3::new(0.5, 0.0, 9.0))]);
    let textures = SeparateTextures::new(&grid);
    for n in fibonacci_sphere(40) {
        for x in [-1.0, 0.0, 0.25, 0.5, 1.0, 7.0] {
            let p = DVec3::new(x, 3.0, 0.0);
            let (found, expected) = (textures.irradiance(p, n.as_vec3()), linear(&grid, p, n.as_vec3()));
            // A dozen roundings of colours up to 9.
            assert!((found - expected).abs().max_element() < 9.0 * 1e-6, "{n} {x}: {found} {expected}");
        }
    }
}

#[test]
fn between_different_directions_the_product_of_means_is_not_the_mean_of_products() {
    // Half-way directions average to (0, 3, 6)/7 and colours to 1: towards z it is 6/7, as with the products.
    let other = Vec3::new(-W.x, W.y, W.z);
    let grid = two([(W, Vec3::ONE), (other, Vec3::ONE)]);
    let textures = SeparateTextures::new(&grid);
    let p = DVec3::new(0.5, 0.0, 0.0);
    assert!((textures.irradiance(p, Vec3::Z).x - 6.0 / 7.0).abs() < 1e-6);
    let grid = two([(W, Vec3::ONE), (Vec3::new(W.z, W.y, W.x), Vec3::ONE * 3.0)]);
    let textures = SeparateTextures::new(&grid);
    // Towards z the products average to (6 + 3 · 2) / 14, apart they are (6 + 2) / 14 · 2.
    assert!((linear(&grid, p, Vec3::Z).x - 12.0 / 14.0).abs() < 1e-5);
    assert!((textures.irradiance(p, Vec3::Z).x - 16.0 / 14.0).abs() < 1e-6);
    // At the vertices there is nothing to mix.
    for x in [0.0, 1.0] {
        let (p, n) = (DVec3::new(x, 0.0, 0.0), Vec3::new(0.6, 0.0, 0.8));
        assert!((textures.irradiance(p, n) - linear(&grid, p, n)).abs().max_element() < 1e-5);
    }
}

#[test]
fn packing_keeps_the_components_along_the_axes() {
    // Red from one direction, green from another.
    let mut grid = two([(W, Vec3::ONE); 2]);
    let other = Vec3::new(W.z, W.y, W.x);
    grid.set(0, &[[W.to_array(), other.to_array(), [0.0; 3]]; 6]);
    let textures = SeparateTextures::new(&grid);
    for axis in 0..3 {
        let found = textures.irradiance(DVec3::ZERO, Vec3::AXES[axis]);
        let expected = Vec3::new(W[axis], other[axis], 0.0);
        assert!((found - expected).abs().max_element() < 1e-6, "{found} {expected}");
    }
}
