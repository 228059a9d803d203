//! Errors of levels that include the deviation of attributes.

use super::shapes::{grid, mapped};
use super::*;
use crate::AttributeWeights;

fn counting(weights: AttributeWeights) -> BuildOptions {
    BuildOptions { attributes: weights, ..BuildOptions::default() }
}

/// A plane that is black on the left and white on the right, with the change between two columns of vertices.
fn black_and_white(side: u32) -> IndexedMesh {
    let mut mesh = grid(side, |_, _| 0.0);
    let shade = |p: &[f32; 3]| if p[0] < 0.5 { [0, 0, 0, 255] } else { [255; 4] };
    mesh.wedges.colours = mesh.positions.iter().map(shade).collect();
    mesh
}

#[test]
fn a_linear_attribute_costs_nothing() {
    let mut mesh = grid(20, |_, _| 0.0);
    mesh.wedges.uvs = mesh.positions.iter().map(|p| [0.25 + 3.0 * p[0] - p[1], p[1]]).collect();
    let options = counting(AttributeWeights { uv: 1.0, ..AttributeWeights::default() });
    let (progressive, _) = built(&mesh, &options);
    check_levels(&progressive, 20);
    // Coordinates are rounded to 2⁻²⁴ of up to 4 units, which the cells of 1/19 turn into gradients of 1e-5.
    let error = progressive.errors[4 - progressive.base_vertices as usize];
    assert!(error < 1e-4, "{error}");
}

#[test]
fn a_level_includes_the_deviation_of_attributes() {
    let mesh = black_and_white(20);
    let at_four = |weight: f64| {
        let options = counting(AttributeWeights { colour: weight, ..AttributeWeights::default() });
        let (progressive, _) = built(&mesh, &options);
        check_levels(&progressive, 20);
        (progressive.errors[4 - progressive.base_vertices as usize], progressive.level(8))
    };
    let (without, _) = at_four(0.0);
    assert!(without < 1e-6, "the plane itself loses nothing: {without}");
    let (with, coarse) = at_four(0.1);
    // The estimate extends the slope of the one column with the step, 19 a metre, over half of the square: 9.5 in each of
    // three channels on 1/19 of the area. The other columns are off by 1 at most, and at least some by 1/2.
    assert!(with > 0.02 && with < 0.1 * (9.5 * (3.0f32 / 19.0).sqrt() + 3.0f32.sqrt()), "{with}");
    // The least that shows the step: four corners and two pairs of vertices at either end of it.
    let beside_the_step = coarse.positions.iter().filter(|p| (p[0] - 0.5).abs() < 0.03).count();
    assert_eq!(beside_the_step, 4, "{:?}", coarse.positions);
}

#[test]
fn every_attribute_counts_on_its_own() {
    let mut mesh = grid(12, |_, _| 0.0);
    let bend = |x: f32| (x - 0.5).abs();
    mesh.wedges.normals = mesh.positions.iter().map(|p| [bend(p[0]), 0.0, 1.0]).collect();
    mesh.wedges.uvs = mesh.positions.iter().map(|p| [0.0, bend(p[0])]).collect();
    mesh.wedges.colours = mesh.positions.iter().map(|p| [(255.0 * bend(p[0])) as u8, 0, 0, 255]).collect();
    let nothing = AttributeWeights::default();
    for weights in [
        AttributeWeights { normal: 1.0, ..nothing },
        AttributeWeights { uv: 1.0, ..nothing },
        AttributeWeights { colour: 1.0, ..nothing },
    ] {
        let (progressive, _) = built(&mesh, &counting(weights));
        let error = progressive.errors[6 - progressive.base_vertices as usize];
        // Six vertices: the corners, and two at the ridge. A constant in place of a tent of height 1/2: its root mean
        // square is 1/2 / √3 at most.
        assert!(error > 0.02 && error < 0.3, "{weights:?}: {error}");
    }
}

#[test]
fn seams_stay_with_attributes_that_count() {
    let mesh = seams::two_charts(21, false);
    let options = counting(AttributeWeights { uv: 1.0, ..AttributeWeights::default() });
    let (progressive, _) = built(&mesh, &options);
    check_levels(&progressive, 50);
    for level in [400, 100, 20, 10] {
        let mesh = progressive.level(level);
        for corners in &mesh.triangles {
            let u = corners.map(|w| mesh.wedges.uvs[w as usize][0]);
            assert!(u.iter().all(|&u| u < 1.0) || u.iter().all(|&u| u > 1.5), "level {level}: {u:?}");
        }
    }
}

#[test]
fn weights_must_be_lengths() {
    let mesh = mapped(&black_and_white(3), |p| p);
    for weight in [-1.0, f64::NAN, f64::INFINITY] {
        let options = counting(AttributeWeights { colour: weight, ..AttributeWeights::default() });
        let error = build(&mesh, &options, &mut |_| {}).unwrap_err();
        assert_eq!(error, BuildError::AttributeWeight { attribute: "colours", weight: weight.to_string() });
    }
}
