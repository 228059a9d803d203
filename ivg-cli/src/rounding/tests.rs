use glam::Vec3;
use pmesh_format::{EncodeOptions, Mode, Positions, ProgressiveMesh, Wedges};

use super::*;

/// The header of a triangle with these texture coordinates.
fn header(options: &EncodeOptions, uvs: [[f32; 2]; 3]) -> Header {
    let mesh = ProgressiveMesh {
        positions: vec![[0.0; 3], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        wedges: Wedges {
            vertices: vec![0, 1, 2],
            normals: vec![[0.0, 0.0, 1.0]; 3],
            uvs: uvs.to_vec(),
            colours: vec![],
        },
        base_vertices: 3,
        faces: vec![[0, 1, 2]],
        ..ProgressiveMesh::default()
    };
    let file = pmesh_format::encode(&mesh, options).expect("a mesh");
    crate::reading::mesh_header(std::path::Path::new("mesh"), &file).expect("a header")
}

const UVS: [[f32; 2]; 3] = [[0.0, 0.0], [3.0, 0.5], [1.0, 1.0]];

#[test]
fn the_bounds_are_what_the_header_says() {
    let exact = EncodeOptions { mode: Mode::Raw, positions: Positions::F32, ..EncodeOptions::default() };
    let rounding = Rounding::of(&header(&exact, UVS));
    assert_eq!(rounding, Rounding::default());
    assert_eq!(rounding.text(), "nothing is rounded");
    let coded = EncodeOptions { mode: Mode::Coded, positions: Positions::Quantised(10), uv_bits: 4, ..exact };
    let rounding = Rounding::of(&header(&coded, UVS));
    // Sides of 2 m in 1,023 steps and of 3 widths in 15.
    assert_eq!((rounding.position, rounding.uv), (2.0 / 1023.0 / 2.0, 3.0 / 15.0 / 2.0));
    assert_eq!(
        rounding.text(),
        "rounded, at most by 9.8e-4 m in a coordinate, 1.6e-1 degrees in a normal, 1.0e-1 in a texture coordinate; \
         --mode raw --positions f32 rounds nothing"
    );
    let both = rounding.max(Rounding { position: 1.0, ..Rounding::default() });
    assert_eq!(both, Rounding { position: 1.0, ..rounding });
}

#[test]
fn normals_and_texture_coordinates_are_off_by_less_than_the_bounds_and_nearly_so() {
    // Directions spread by the golden angle, and texture coordinates by the same.
    let turn = std::f32::consts::PI * (3.0 - 5f32.sqrt());
    let count = 200_000;
    let wedge = |k: u32| {
        let z = 1.0 - (2.0 * k as f32 + 1.0) / count as f32;
        let around = turn * k as f32;
        let across = (1.0 - z * z).sqrt();
        ([across * around.cos(), across * around.sin(), z], [around.cos() * 1.5 + 1.5, z.abs()])
    };
    let (normals, uvs): (Vec<_>, Vec<_>) = (0..count).map(wedge).unzip();
    let wedges = Wedges { vertices: (0..count).collect(), normals, uvs, colours: vec![] };
    for (normal_bits, uv_bits) in [(6, 5), (10, 12)] {
        let options = EncodeOptions { mode: Mode::Coded, normal_bits, uv_bits, ..EncodeOptions::default() };
        let rounding = Rounding::of(&header(&options, UVS));
        let stored = options.quantised_wedges(&wedges);
        let angle = |a: &[f32; 3], b: &[f32; 3]| {
            let [a, b] = [*a, *b].map(|n| Vec3::from(n).as_dvec3());
            a.cross(b).length().atan2(a.dot(b)).to_degrees()
        };
        let angles = wedges.normals.iter().zip(&stored.normals).map(|(a, b)| angle(a, b));
        let most = angles.fold(0.0, f64::max);
        // The bound is of first order: at 6 bits, M = 31, the next order is 1/31 of it.
        assert!(
            (0.95..1.0 + 1.0 / 31.0).contains(&(most / rounding.normal)),
            "{normal_bits} bits: {most} and {} degrees",
            rounding.normal
        );
        let pairs = wedges.uvs.as_flattened().iter().zip(stored.uvs.as_flattened());
        let most = pairs.map(|(a, b)| (f64::from(*a) - f64::from(*b)).abs()).fold(0.0, f64::max);
        // Sides of up to 3 widths as in the header; f32 rounds what is stored by 2^-23 of up to 3.
        let slack = 3.0 * 2f64.powi(-23);
        assert!(
            (0.99 * rounding.uv..rounding.uv + slack).contains(&most),
            "{uv_bits} bits: {most} and {}",
            rounding.uv
        );
    }
}
