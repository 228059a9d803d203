//! What is written comes back, exactly or within the bound of its quantisation.

use crate::files::{full, header, lattice, one_shot, options, vectors};
use ivg_format::{
    BakedLight, EncodeError, EncodeOptions, Encoding, Event, GridSource, HemisphereVectors, Lattice,
    LatticeError, Limits, Quantity, Units, decode_all, encode, lights, metadata,
};
use quickcheck::{TestResult, quickcheck};

/// All vectors of a file in the order of the linear index.
fn decoded(file: &[u8]) -> Vec<HemisphereVectors> {
    let mut all = vec![None; header(file).lattice.vertex_count() as usize];
    decode_all(file, &Limits::default(), |event| {
        if let Event::Corners(bundle) | Event::Bundle(bundle) = event {
            for (n, vertex) in bundle.vertices().enumerate() {
                all[vertex as usize] = Some(bundle.vectors(n));
            }
        }
    })
    .unwrap();
    all.into_iter().map(|vectors| vectors.expect("every vertex arrives")).collect()
}

/// A packed file with a validity section.
pub(crate) fn with_validity(dims: [u16; 3], validity: &[u8], blocked: &[u8]) -> Vec<u8> {
    let lattice = Lattice::new(dims, [0.0; 3], [1.0; 3]).unwrap();
    let vectors = vectors(&lattice);
    let source = GridSource {
        validity: Some(validity),
        blocked_edges: Some(blocked),
        ..GridSource::new(lattice, &vectors)
    };
    encode(&source, &options(Encoding::PackedOct24, 1)).unwrap()
}

fn encoded(vectors: &[HemisphereVectors], encoding: Encoding) -> Result<Vec<u8>, EncodeError> {
    let lattice = Lattice::new([1, 1, vectors.len() as u16], [0.0; 3], [1.0; 3]).unwrap();
    encode(&GridSource::new(lattice, vectors), &options(encoding, 64))
}

#[test]
fn floats_come_back_bit_for_bit() {
    let mut vertex = [[[0.0f32; 3]; 3]; 6];
    let odd = [-0.0, f32::from_bits(1), f32::MAX, f32::MIN, f32::MIN_POSITIVE, -1.5e-40, 1.0 / 3.0];
    for (component, value) in vertex.iter_mut().flatten().flatten().zip(odd.iter().cycle()) {
        *component = *value;
    }
    let back = decoded(&encoded(&[vertex; 3], Encoding::VectorsF32).unwrap());
    let bits = |v: &[HemisphereVectors]| -> Vec<u32> {
        v.iter().flatten().flatten().flatten().map(|c| c.to_bits()).collect()
    };
    assert_eq!(bits(&back), bits(&[vertex; 3]));
}

#[test]
fn everything_else_comes_back_too() {
    let (mut found_lights, mut pairs, mut validity, mut blocked) = (vec![], vec![], Vec::<u8>::new(), vec![]);
    decode_all(&full(), &Limits::default(), |event| match event {
        Event::Chunk(chunk) if chunk.kind == ivg_format::LIGHTS => {
            found_lights.extend(lights(&chunk).unwrap().map(|l| (l.name.to_string(), l.direct_included)));
        }
        Event::Chunk(chunk) => {
            pairs.extend(metadata(&chunk).unwrap().map(|(k, v)| (k.to_string(), v.to_string())));
        }
        Event::Validity(block) => {
            validity.extend(block.validity());
            blocked.extend((0..block.len()).map(|n| block.blocked_edges(n)));
        }
        _ => {}
    })
    .unwrap();
    assert_eq!(found_lights, [("ceiling lamp".into(), false), ("sun".into(), true)]);
    assert_eq!(pairs, [("generator".into(), "laws".into()), ("photons".into(), "1000".to_string())]);
    assert_eq!(validity, (0..24).map(|v| v * 10).collect::<Vec<u8>>());
    let l = lattice([2, 4, 3]);
    for (v, bits) in (0..).zip(blocked) {
        let at = l.coords(v);
        let inside = (0..3).map(|a| u8::from(at[a] + 1 < l.dims[a]) << a).sum::<u8>();
        assert_eq!(bits, if v % 2 == 0 { inside } else { 0 }, "vertex {v}");
    }
}

#[test]
fn options_come_back_in_the_header() {
    let lattice = lattice([3, 2, 2]);
    let vectors = vectors(&lattice);
    let options = EncodeOptions {
        encoding: Encoding::VectorsF32,
        vertices_per_slice: 5,
        seed: u64::MAX,
        units: Units::Photometric,
        ..EncodeOptions::default()
    };
    let header = header(&encode(&GridSource::new(lattice, &vectors), &options).unwrap());
    assert_eq!(
        (header.lattice, header.encoding, header.vertices_per_slice),
        (lattice, Encoding::VectorsF32, 5)
    );
    assert_eq!((header.seed, header.units, header.scale_exponent), (u64::MAX, Units::Photometric, 0));
}

#[test]
fn the_same_grid_gives_the_same_bytes_and_another_another_content_id() {
    assert_eq!(full(), full());
    let lattice = lattice([2, 2, 2]);
    let vectors = vectors(&lattice);
    let id = |options| header(&encode(&GridSource::new(lattice, &vectors), &options).unwrap()).content_id;
    let base = EncodeOptions::new();
    assert_ne!(id(base), id(EncodeOptions { seed: 1, ..base }));
    assert_ne!(id(base), id(EncodeOptions { units: Units::Photometric, ..base }));
}

#[test]
fn the_scale_exponent_brings_the_largest_colour_just_under_the_largest_number() {
    let with = |size: f32| {
        let mut vertex = [[[0.0; 3]; 3]; 6];
        vertex[0] = [[size, 0.0, 0.0]; 3];
        let file = encoded(&[vertex], Encoding::PackedOct24).unwrap();
        (header(&file).scale_exponent, decoded(&file)[0][0][0][0])
    };
    assert_eq!(with(0.0), (0, 0.0));
    assert_eq!(with(1.0), (-15, 1.0));
    assert_eq!(with(65408.0), (0, 65408.0));
    assert_eq!(with(65408.0f32.next_up()).0, 1);
    assert_eq!(with(32704.0), (-1, 32704.0));
    assert_eq!(with(1e9).0, 14);
    // The smallest number of binary32 and the largest colour there can be.
    assert_eq!(with(f32::from_bits(1)), (-125, f32::from_bits(1)));
    let largest = 65408.0 * 2.0f32.powi(112);
    assert_eq!(with(largest), (112, largest));
}

#[test]
fn a_grid_of_very_different_lights_keeps_the_small_ones() {
    // Below the lowest exponent of RGB9E5 the step stays at 2^-24, here times the scale 2^14 that 1e9 needs.
    let sizes = [1e9f32, 1.0, 1e-2, 1e-6];
    let vertices = sizes.map(|size| {
        let mut vertex = [[[0.0; 3]; 3]; 6];
        vertex[2] = [[0.0, size, 0.0]; 3];
        vertex
    });
    let back = decoded(&encoded(&vertices, Encoding::PackedOct24).unwrap());
    for (size, vertex) in sizes.iter().zip(&back) {
        let bound = (size / 512.0).max(2.0f32.powi(14 - 25));
        assert!((size - vertex[2][0][1]).abs() <= bound, "{size} became {}", vertex[2][0][1]);
    }
}

#[test]
fn what_cannot_be_written_is_named() {
    let good = lattice([1, 3, 1]);
    let vectors = vectors(&good);
    let options = options(Encoding::PackedOct24, 1);
    let source = GridSource::new(good, &vectors);
    let error = |source: GridSource<'_>| encode(&source, &options).unwrap_err();

    for bad in [f32::NAN, f32::INFINITY] {
        let mut vectors = vectors.clone();
        vectors[2][5][1][0] = bad;
        for &encoding in Encoding::ALL.iter().filter(|e| e.quantity() == Quantity::Vectors) {
            let options = EncodeOptions { encoding, ..options };
            let error = encode(&GridSource::new(good, &vectors), &options).unwrap_err();
            assert_eq!(error, EncodeError::NotFinite { vertex: [0, 2, 0], hemisphere: 5 });
            assert!(error.to_string().contains("(0, 2, 0)") && error.to_string().contains("-z"), "{error}");
        }
    }
    let mut large = vectors.clone();
    large[1][0][0] = [f32::MAX, 0.0, 0.0];
    assert_eq!(
        error(GridSource::new(good, &large)),
        EncodeError::TooLarge { vertex: [0, 1, 0], hemisphere: 0 }
    );
    assert_eq!(
        error(GridSource::new(good, &vectors[..2])),
        EncodeError::Count { what: "values", found: 2, expected: 3 }
    );
    assert_eq!(
        error(GridSource { validity: Some(&[1]), ..source }),
        EncodeError::Count { what: "validity", found: 1, expected: 3 }
    );
    assert_eq!(
        error(GridSource { blocked_edges: Some(&[0, 0, 2]), ..source }),
        EncodeError::EdgeOutside { vertex: [0, 2, 0] }
    );
    assert_eq!(
        error(GridSource { blocked_edges: Some(&[0, 8, 0]), ..source }),
        EncodeError::EdgeOutside { vertex: [0, 1, 0] }
    );
    assert_eq!(
        error(GridSource { meta: &[("ok", ""), ("No", "")], ..source }),
        EncodeError::Metadata { pair: 1 }
    );
    assert_eq!(error(GridSource { meta: &[("a", "b\nc")], ..source }), EncodeError::Metadata { pair: 0 });
    let long = "x".repeat(65_536);
    let lights = [BakedLight { name: &long, direct_included: false }];
    assert_eq!(error(GridSource { lights: &lights, ..source }), EncodeError::LightName { light: 0 });
    let broken = Lattice { dims: [1, 0, 1], ..good };
    assert_eq!(
        error(GridSource { lattice: broken, ..source }),
        EncodeError::Lattice(LatticeError::EmptyAxis { axis: 1 })
    );
    let none = EncodeOptions { vertices_per_slice: 0, ..options };
    assert_eq!(encode(&source, &none), Err(EncodeError::NoVerticesPerSlice));
}

/// A vector of one hemisphere and channel from three small integers: along the axis not negative.
fn vector(h: usize, (along, one, two): (u8, i8, i8)) -> [f32; 3] {
    let mut v = [0.0; 3];
    v[h / 2] = f32::from(along) * if h.is_multiple_of(2) { 1.0 } else { -1.0 };
    v[(h / 2 + 1) % 3] = f32::from(one);
    v[(h / 2 + 2) % 3] = f32::from(two);
    v
}

quickcheck! {
    /// Channels of one direction, well above the tangent plane: then packing itself loses nothing, and what is
    /// left is quantisation.
    fn packing_is_within_its_bound(
        h: u8, along: u8, one: i8, two: i8, colour: (u8, u8, u8), size: i8
    ) -> TestResult {
        let h = usize::from(h % 6);
        let direction = vector(h, (along, one, two));
        let length = direction.iter().map(|c| c * c).sum::<f32>().sqrt();
        if f32::from(along) < 0.3 * length || along == 0 {
            return TestResult::discard();
        }
        let scale = 2.0f32.powi(i32::from(size) / 2) / length;
        let channels = [colour.0, colour.1, colour.2].map(f32::from);
        let mut vertex = [[[0.0; 3]; 3]; 6];
        vertex[h] = channels.map(|c| direction.map(|d| d * c * scale));
        let back = decoded(&encoded(&[vertex], Encoding::PackedOct24).unwrap());
        // Direction: at most sqrt(2)/2047 rad off; since the colour is divided by the decoded component along the
        // axis, which is at least 0.3, the error along the direction is at most 1/0.3 as large. Colour: at most
        // 1/512 of the largest component, which the same division may have made larger by that factor. The
        // grid's own largest colour fixes the exponent, so the absolute step 2^-25 does not matter. A thousandth
        // covers the second order and the roundings to binary32.
        let most = channels.iter().fold(0.0f32, |a, &b| a.max(b)) * scale * length;
        let angle = std::f32::consts::SQRT_2 / 2047.0;
        let bound = 1.001 * most * (angle * (1.0 + 1.0 / 0.3) + 1.01 / 512.0);
        let worst = (0..3).map(|k| {
            let squared: f32 = (0..3).map(|i| (back[0][h][k][i] - vertex[h][k][i]).powi(2)).sum();
            squared.sqrt()
        }).fold(0.0, f32::max);
        TestResult::from_bool(worst <= bound)
    }

    /// The component along the axis, for any three channels: exact up to RGB9E5, unless capped.
    fn the_axis_survives(h: u8, r: (u8, i8, i8), g: (u8, i8, i8), b: (u8, i8, i8)) -> bool {
        let h = usize::from(h % 6);
        let mut vertex = [[[0.0; 3]; 3]; 6];
        vertex[h] = [r, g, b].map(|v| vector(h, v));
        let file = encoded(&[vertex], Encoding::PackedOct24).unwrap();
        let back = decoded(&file);
        let axis = h / 2;
        (0..3).all(|k| {
            let (stored, exact) = (back[0][h][k][axis].abs(), vertex[h][k][axis].abs());
            let length = vertex[h][k].iter().map(|c| c * c).sum::<f32>().sqrt();
            // A colour is at most 1.5 times the longest vector; half a step of RGB9E5 is 1/512 of the largest.
            let longest = vertex[h].iter().map(|v| v.iter().map(|c| c * c).sum::<f32>().sqrt()).fold(0.0, f32::max);
            let bound = 1.5 * longest / 512.0 * 1.01;
            // Capped: the colour is 1.5 times the length, so that the rest of the vector is longer than 1.1 times.
            let length_back = back[0][h][k].iter().map(|c| c * c).sum::<f32>().sqrt();
            let capped = (length_back - 1.5 * length).abs() <= bound && stored <= exact + bound;
            (stored - exact).abs() <= bound || capped
        })
    }

    fn what_was_decoded_is_stable(seed: u8) -> bool {
        let lattice = lattice([2, 3, 2]);
        let mut vectors = vectors(&lattice);
        vectors.rotate_left(usize::from(seed) % 12);
        let once = decoded(&encode(&GridSource::new(lattice, &vectors), &options(Encoding::PackedOct24, 2)).unwrap());
        let twice = decoded(&encode(&GridSource::new(lattice, &once), &options(Encoding::PackedOct24, 2)).unwrap());
        once == twice
    }

    fn any_small_lattice_comes_back(dims: (u8, u8, u8), per_slice: u8, floats: bool) -> bool {
        let lattice = lattice([dims.0, dims.1, dims.2].map(|n| u16::from(n % 5 + 1)));
        let vectors = vectors(&lattice);
        let encoding = if floats { Encoding::VectorsF32 } else { Encoding::PackedOct24 };
        let file =
            encode(&GridSource::new(lattice, &vectors), &options(encoding, u32::from(per_slice) + 1)).unwrap();
        let back = decoded(&file);
        one_shot(&file).1.is_none() && (!floats || back == vectors)
    }
}
