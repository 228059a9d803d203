use std::mem::offset_of;

use ivg_grid::{FLAG_USABLE, TANGENTIAL_LOSS};
use wgpu::naga;
use wgpu::naga::{Expression, Literal, TypeInner};

use super::*;
use crate::gpu::{SHADE_SHADER, SHADOW_SHADER};
use crate::upload::{FLAG_CLEAR_BLOCK, FLAG_CLEAR_CELL};

fn modules() -> [naga::Module; 2] {
    [SHADE_SHADER, SHADOW_SHADER].map(|source| naga::front::wgsl::parse_str(source).unwrap())
}

/// Size of a structure and name and offset of its members, as WGSL lays it out.
fn wgsl_struct(module: &naga::Module, name: &str) -> (usize, Vec<(String, usize)>) {
    let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name));
    let Some((_, naga::Type { inner: TypeInner::Struct { members, span }, .. })) = found else {
        panic!("there is no structure {name} in the shader");
    };
    let members = members.iter().map(|m| (m.name.clone().unwrap(), m.offset as usize)).collect();
    (*span as usize, members)
}

/// Size and offsets of a Rust structure, from the names of its fields.
macro_rules! rust_struct {
    ($name:ident { $($field:ident),* $(,)? }) => {
        (
            stringify!($name),
            size_of::<$name>(),
            vec![$((stringify!($field).to_string(), offset_of!($name, $field))),*],
        )
    };
}

#[test]
fn structures_have_the_same_layout_on_both_sides() {
    let expected = [
        rust_struct!(LightRecord {
            position,
            kind,
            axis,
            disk,
            tangent,
            first_layer,
            bitangent,
            layers,
            strength,
            reach,
            cone_scale,
            cone_offset,
            padding,
        }),
        rust_struct!(FrameRecord {
            view_projection,
            eye,
            light_count,
            lattice_origin,
            shadow_size,
            lattice_inverse_step,
            indirect,
            lattice_dims,
            reconstruction,
            normal_bias,
            value_scale,
            filter_kind,
            padding,
        }),
        rust_struct!(MaterialRecord { albedo, textured, emission, two_sided }),
        rust_struct!(FaceRecord { matrix, perspective, bias, cap, padding }),
    ];
    for module in modules() {
        for (name, size, members) in &expected {
            assert_eq!(wgsl_struct(&module, name), (*size, members.clone()), "{name}");
        }
    }
}

#[test]
fn constants_have_the_same_value_on_both_sides() {
    let expected = [
        ("SHADOW_FILTER_RADIUS", f64::from(SHADOW_FILTER_RADIUS)),
        ("SHADOW_BORDER", f64::from(SHADOW_BORDER)),
        ("SAME_SURFACE", f64::from(SAME_SURFACE)),
        ("DIRECTIONAL_TILES", f64::from(DIRECTIONAL_TILES)),
        ("LIGHT_AREA", f64::from(LIGHT_AREA)),
        ("LIGHT_POINT", f64::from(LIGHT_POINT)),
        ("LIGHT_SPOT", f64::from(LIGHT_SPOT)),
        ("LIGHT_DIRECTIONAL", f64::from(LIGHT_DIRECTIONAL)),
        ("PI", f64::from(std::f32::consts::PI)),
        ("RECONSTRUCT_N_SQUARED", f64::from(RECONSTRUCT_N_SQUARED)),
        ("RECONSTRUCT_THREE_VECTOR", f64::from(RECONSTRUCT_THREE_VECTOR)),
        ("RECONSTRUCT_SIX_VECTOR", f64::from(RECONSTRUCT_SIX_VECTOR)),
        ("RECONSTRUCT_HARMONICS", f64::from(RECONSTRUCT_HARMONICS)),
        ("HARMONIC_CONSTANT", f64::from(HARMONIC_CONSTANT)),
        ("HARMONIC_LINEAR", f64::from(HARMONIC_LINEAR)),
        ("HARMONIC_MIXED", f64::from(HARMONIC_MIXED)),
        ("HARMONIC_ZONAL", f64::from(HARMONIC_ZONAL)),
        ("HARMONIC_SQUARE", f64::from(HARMONIC_SQUARE)),
        ("TANGENTIAL_LOSS", f64::from(TANGENTIAL_LOSS)),
        ("FLAG_USABLE", f64::from(FLAG_USABLE)),
        ("FLAG_CLEAR_CELL", f64::from(FLAG_CLEAR_CELL)),
        ("FLAG_CLEAR_BLOCK", f64::from(FLAG_CLEAR_BLOCK)),
    ];
    let [shade, _] = modules();
    let mut found: Vec<(String, f64)> = shade
        .constants
        .iter()
        .filter_map(|(_, constant)| {
            let value = match shade.global_expressions[constant.init] {
                Expression::Literal(Literal::F32(value)) => f64::from(value),
                Expression::Literal(Literal::U32(value)) => f64::from(value),
                Expression::Literal(Literal::I32(value)) => f64::from(value),
                _ => panic!("{:?} is not a plain number", constant.name),
            };
            Some((constant.name.clone()?, value))
        })
        .collect();
    found.sort_by(|a, b| a.0.cmp(&b.0));
    let mut expected: Vec<_> = expected.map(|(name, value)| (name.to_string(), value)).into();
    expected.sort_by(|a, b| a.0.cmp(&b.0));
    assert_eq!(found, expected);
}

#[test]
fn harmonic_constants_are_the_basis_times_the_convolution_with_the_cosine() {
    let n = glam::Vec3::new(0.48, -0.6, 0.64);
    let glam::Vec3 { x, y, z } = n;
    let weights = [
        HARMONIC_CONSTANT,
        HARMONIC_LINEAR * y,
        HARMONIC_LINEAR * z,
        HARMONIC_LINEAR * x,
        HARMONIC_MIXED * x * y,
        HARMONIC_MIXED * y * z,
        HARMONIC_ZONAL * (3.0 * z * z - 1.0),
        HARMONIC_MIXED * x * z,
        HARMONIC_SQUARE * (x * x - y * y),
    ];
    for (coefficient, weight) in weights.into_iter().enumerate() {
        let mut radiance = [[0.0; 9]; 3];
        radiance[1][coefficient] = 1.0;
        let irradiance = ivg_grid::harmonics::irradiance_signed(&radiance, n);
        // Both are products of at most six numbers rounded to binary32.
        let close = (irradiance.y - weight).abs() <= 12.0 * f32::EPSILON * weight.abs();
        assert!(close, "coefficient {coefficient}: {} instead of {weight}", irradiance.y);
        assert_eq!((irradiance.x, irradiance.z), (0.0, 0.0));
    }
}
