//! The payload of each encoding: where numbers lie, which are refused, how near what was written comes back.

use crate::files::{edited, header, lattice, one_shot, options, plain, radiance, vectors};
use ivg_format::{
    Encoding, Event, GridSource, HemisphereVectors, Lattice, Limits, Quantity, RadianceHarmonics, RecordId,
    Step, Verdict, codes, decode_all, decode_record, encode,
};
use ivg_wire::Code;
use quickcheck::{TestResult, quickcheck};

/// Encodings that store a direction and a colour.
const PAIRED: [Encoding; 5] =
    [Encoding::PackedOct24, Encoding::PackedXyz24, Encoding::PairF16, Encoding::PairF16x4, Encoding::PairF32];

/// A file of one vertex whose payload is `bytes`, with this scale exponent; and where the payload begins.
fn one_vertex(encoding: Encoding, scale_exponent: i16, bytes: &[u8]) -> (Vec<u8>, usize) {
    assert_eq!(bytes.len() as u64, encoding.bytes_per_vertex());
    let file = plain([1, 1, 1], encoding, 1);
    let start = header(&file).record_range(RecordId::Corners).start as usize + 8;
    let file = edited(&file, |file| {
        file[114..116].copy_from_slice(&scale_exponent.to_le_bytes());
        file[start..start + bytes.len()].copy_from_slice(bytes);
    });
    (file, start)
}

/// The vectors of such a file.
fn vectors_of(encoding: Encoding, scale_exponent: i16, bytes: &[u8]) -> HemisphereVectors {
    let mut found = None;
    let (file, _) = one_vertex(encoding, scale_exponent, bytes);
    decode_all(&file, &Limits::default(), |event| {
        if let Event::Corners(bundle) = event {
            found = Some(bundle.vectors(0));
        }
    })
    .unwrap();
    found.expect("a corner")
}

/// The payload of a vertex with one direction and colour in hemisphere 4, as `number` writes a number; the others hold
/// whatever `rest` gives for a colour and a direction.
fn payload(colour: &[u8], direction: &[u8], no_colour: &[u8], no_direction: &[u8]) -> Vec<u8> {
    let six = |which: &[u8], others: &[u8]| [others, others, others, others, which, others].concat();
    [six(colour, no_colour), six(direction, no_direction)].concat()
}

/// Numbers of binary16 or binary32 for the encodings that store those.
fn numbers(encoding: Encoding, numbers: [f32; 3]) -> Vec<u8> {
    let half = |x: f32| ivg_format::quant::half::from_f32(x).to_le_bytes();
    match encoding {
        Encoding::PairF16 => numbers.map(half).concat(),
        Encoding::PairF16x4 => [&numbers.map(half).concat()[..], &[0, 0]].concat(),
        _ => numbers.map(f32::to_le_bytes).concat(),
    }
}

fn pair(encoding: Encoding, colour: [f32; 3], direction: [f32; 3]) -> Vec<u8> {
    let zero = numbers(encoding, [0.0; 3]);
    payload(&numbers(encoding, colour), &numbers(encoding, direction), &zero, &zero)
}

#[test]
fn payloads_are_laid_out_as_the_clauses_say() {
    // Colour (1, 2, 0.5), direction (0, 0.6, -0.8), which all encodings of numbers hold nearly, scaled by 4.
    for encoding in [Encoding::PairF16, Encoding::PairF16x4, Encoding::PairF32] {
        let direction = [0.0, 0.6, -0.8];
        let stored = direction.map(|d: f32| match encoding {
            Encoding::PairF32 => d,
            _ => [0.0, 0.600_097_66, -0.799_804_7][direction.iter().position(|&x| x == d).unwrap()],
        });
        let found = vectors_of(encoding, 2, &pair(encoding, [1.0, 2.0, 0.5], direction));
        assert_eq!(found[4], [4.0, 8.0, 2.0].map(|c: f32| stored.map(|d| c * d)), "{encoding:?}");
        assert_eq!(found[3], [[0.0; 3]; 3]);
    }
    // RGB9E5 of the same colour: exponent 17, whose step is 2^-7. Direction (3, 0, -4) as bytes.
    let colour = (17u32 << 27 | 64 << 18 | 256 << 9 | 128).to_le_bytes();
    let found = vectors_of(Encoding::PackedXyz24, 2, &payload(&colour, &[3, 0, 0xFC], &[0; 4], &[0, 127, 0]));
    assert_eq!(found[4], [4.0, 8.0, 2.0].map(|c: f32| [c * 0.6, 0.0, c * -0.8]));
    assert_eq!(found[5], [[0.0; 3]; 3]);
    // Harmonics: means (1, 2, 0.5), the green channel's coefficient 6 at either bound.
    for (code, bound) in [(127u8, 5.0f32.sqrt()), (0x81, -(5.0f32.sqrt()) / 2.0)] {
        let mut bytes = [&colour[..], &[0; 24]].concat();
        bytes[4 + 8 + 5] = code;
        let (file, _) = one_vertex(Encoding::Sh2, 2, &bytes);
        decode_all(&file, &Limits::default(), |event| {
            if let Event::Corners(bundle) = event {
                let found = bundle.radiance(0);
                assert_eq!(found.map(|channel| channel[0]), [4.0, 8.0, 2.0]);
                assert!((found[1][6] - 8.0 * bound).abs() <= 8.0 * 3.0 * f32::EPSILON, "{}", found[1][6]);
                assert_eq!(found.as_flattened().iter().filter(|&&c| c == 0.0).count(), 23);
            }
        })
        .unwrap();
    }
}

#[track_caller]
fn refused(encoding: Encoding, scale_exponent: i16, bytes: &[u8], code: Code, at: usize) {
    let (file, start) = one_vertex(encoding, scale_exponent, bytes);
    let error = one_shot(&file).1.unwrap_or_else(|| panic!("{encoding:?} was accepted"));
    assert_eq!(
        (error.code(), error.offset().0),
        (code.number(), (start + at) as u64),
        "{encoding:?}: {error}"
    );
}

#[test]
fn forbidden_bytes_of_xyz_codes_are_refused_where_they_stand() {
    for code in [[0, 0, 0], [0x80, 0, 0], [0, 0x80, 1], [1, 1, 0x80]] {
        let bytes = payload(&[0; 4], &code, &[0; 4], &[1, 0, 0]);
        refused(Encoding::PackedXyz24, 0, &bytes, codes::DIRECTION_CODE, 24 + 4 * 3);
    }
}

#[test]
fn colours_below_zero_or_not_finite_are_refused_where_they_stand() {
    let below = [-1.0, -f32::MIN_POSITIVE, f32::NEG_INFINITY, f32::INFINITY, f32::NAN];
    for encoding in [Encoding::PairF16, Encoding::PairF16x4, Encoding::PairF32] {
        let width = encoding.bytes_per_vertex() as usize / 12;
        let number = if encoding == Encoding::PairF32 { 4 } else { 2 };
        for bad in below.map(|x| if number == 2 && x == -f32::MIN_POSITIVE { -6e-8 } else { x }) {
            let bytes = pair(encoding, [0.0, bad, 0.0], [0.0, 0.0, 1.0]);
            refused(encoding, 0, &bytes, codes::PAIR_COLOUR, 4 * width + number);
        }
        // The first in stored order counts: a colour stands before every direction.
        let both = pair(encoding, [0.0, 0.0, -1.0], [0.0, 0.0, 2.0]);
        refused(encoding, 0, &both, codes::PAIR_COLOUR, 4 * width + 2 * number);
    }
    // Finite, but not when scaled: only numbers of binary32 are so large.
    let large = pair(Encoding::PairF32, [1.0, 1e38, 0.0], [0.0, 0.0, 1.0]);
    refused(Encoding::PairF32, 2, &large, codes::PAIR_COLOUR, 4 * 12 + 4);
    vectors_of(Encoding::PairF32, 1, &large);
    let largest = vectors_of(Encoding::PairF16, 112, &pair(Encoding::PairF16, [65504.0; 3], [0.0, 0.0, 1.0]));
    assert_eq!(largest[4][0][2], 65504.0 * 2.0f32.powi(112));
}

#[test]
fn components_beyond_one_are_refused_where_they_stand() {
    for encoding in [Encoding::PairF16, Encoding::PairF16x4, Encoding::PairF32] {
        let width = encoding.bytes_per_vertex() as usize / 12;
        let number = if encoding == Encoding::PairF32 { 4 } else { 2 };
        let above = if number == 4 { 1.0f32.next_up() } else { 1.000_976_6 };
        for bad in [above, -above, f32::INFINITY, f32::NAN] {
            let bytes = pair(encoding, [1.0; 3], [0.0, 0.0, bad]);
            refused(encoding, 0, &bytes, codes::PAIR_DIRECTION, (6 + 4) * width + 2 * number);
        }
        // No other rule for directions: none is normalised or refused for its length.
        assert_eq!(
            vectors_of(encoding, 0, &pair(encoding, [1.0; 3], [1.0, -1.0, 0.5]))[4][0],
            [1.0, -1.0, 0.5]
        );
    }
}

#[test]
fn minus_zero_is_a_colour_and_read_as_zero() {
    for encoding in [Encoding::PairF16, Encoding::PairF16x4, Encoding::PairF32] {
        let found = vectors_of(encoding, -3, &pair(encoding, [-0.0, 0.0, 1.0], [-0.5, 0.5, 0.5]));
        assert_eq!(found[4][0].map(f32::to_bits), [-0.0f32, 0.0, 0.0].map(f32::to_bits), "{encoding:?}");
        assert_eq!(found[4][0].map(f32::to_bits), found[4][1].map(f32::to_bits), "{encoding:?}");
    }
}

#[test]
fn padding_that_is_not_zero_is_unsupported_where_it_stands() {
    let good = pair(Encoding::PairF16x4, [1.0; 3], [0.0, 0.0, 1.0]);
    for number in 0..12 {
        for byte in [6, 7] {
            let mut bytes = good.clone();
            bytes[number * 8 + byte] = 0x80;
            refused(Encoding::PairF16x4, 0, &bytes, ivg_wire::codes::RESERVED, number * 8 + 6);
            let (file, _) = one_vertex(Encoding::PairF16x4, 0, &bytes);
            assert_eq!(one_shot(&file).1.unwrap().verdict(), Verdict::Unsupported);
        }
    }
}

#[test]
fn forbidden_ratio_codes_are_refused_where_they_stand() {
    for ratio in 0..24 {
        let mut bytes = [0; 28];
        bytes[4 + ratio] = 0x80;
        refused(Encoding::Sh2, 0, &bytes, codes::RATIO_CODE, 4 + ratio);
    }
}

#[test]
fn scaled_colours_of_pairs_are_rounded_once() {
    // Scaled to a subnormal number: three halves of the smallest number go to the even neighbour, two of them.
    let bytes = pair(Encoding::PairF32, [1.5 * 2.0f32.powi(-24), 0.0, 0.0], [0.0, 0.0, 1.0]);
    assert_eq!(vectors_of(Encoding::PairF32, -125, &bytes)[4][0][2], f32::from_bits(2));
}

/// The values of all vertices of a file in order of the linear index, read in pieces of the sizes given, over and over.
fn read(file: &[u8], pieces: &[usize]) -> (Vec<HemisphereVectors>, Vec<RadianceHarmonics>) {
    let header = header(file);
    let count = header.lattice.vertex_count() as usize;
    let mut vectors = vec![HemisphereVectors::default(); count];
    let mut radiance = vec![RadianceHarmonics::default(); count];
    decode_all(file, &Limits::default(), |event| {
        let (Event::Corners(bundle) | Event::Bundle(bundle)) = event else { return };
        let vertices: Vec<u64> = bundle.vertices().collect();
        let mut sizes = pieces.iter().cycle();
        let mut first = 0;
        while first < bundle.len() {
            let size = (*sizes.next().unwrap()).clamp(1, bundle.len() - first);
            match header.encoding.quantity() {
                Quantity::Vectors => {
                    let mut piece = vec![HemisphereVectors::default(); size];
                    bundle.read_vectors(first, &mut piece);
                    piece.iter().zip(&vertices[first..]).for_each(|(v, &at)| vectors[at as usize] = *v);
                }
                Quantity::Radiance => {
                    let mut piece = vec![RadianceHarmonics::default(); size];
                    bundle.read_radiance(first, &mut piece);
                    piece.iter().zip(&vertices[first..]).for_each(|(v, &at)| radiance[at as usize] = *v);
                }
            }
            first += size;
        }
    })
    .unwrap();
    (vectors, radiance)
}

fn encoded(vectors: &[HemisphereVectors], encoding: Encoding) -> Vec<u8> {
    let lattice = Lattice::new([1, 1, vectors.len() as u16], [0.0; 3], [1.0; 3]).unwrap();
    encode(&GridSource::new(lattice, vectors), &options(encoding, 64)).unwrap()
}

/// One vertex with light of this size along one axis.
fn along(size: f32) -> HemisphereVectors {
    let mut vertex = HemisphereVectors::default();
    vertex[0] = [[size, 0.0, 0.0]; 3];
    vertex
}

#[test]
fn half_precision_never_overflows() {
    for encoding in [Encoding::PairF16, Encoding::PairF16x4] {
        let with = |size: f32| {
            let file = encoded(&[along(size)], encoding);
            (header(&file).scale_exponent, read(&file, &[1]).0[0][0][0][0])
        };
        assert_eq!(with(0.0), (0, 0.0));
        assert_eq!(with(65504.0), (0, 65504.0));
        // One more unit of binary32, which would round to 65504 at exponent 0, is not above half of it at the next.
        assert_eq!(with(65504.0f32.next_up()), (1, 65504.0));
        assert_eq!(with(65520.0), (1, 65536.0), "halfway to what is infinite at exponent 0; to even");
        assert_eq!(with(1e9).0, 14);
        let largest = 65504.0 * 2.0f32.powi(112);
        assert_eq!(with(largest), (112, largest));
    }
}

#[test]
fn lights_of_a_microwatt_and_of_a_gigawatt_keep_their_precision() {
    for encoding in PAIRED {
        for size in [1e-6f32, 1e9] {
            let back = read(&encoded(&[along(size)], encoding), &[1]).0[0][0][0][0];
            // The coarsest: half a step of RGB9E5 is 1/511 of the largest component.
            assert!((back - size).abs() <= size / 511.0, "{encoding:?}: {size} became {back}");
        }
    }
    for size in [1e-6f32, 1e9] {
        let lattice = lattice([1, 1, 1]);
        let grid = [[[size, size, 0.0, 0.0, 0.0, 0.0, -size, 0.0, 0.0]; 3]];
        let file = encode(&GridSource::new(lattice, &grid), &options(Encoding::Sh2, 1)).unwrap();
        let found = read(&file, &[1]).1[0][1];
        assert!((found[0] - size).abs() <= size / 511.0);
        // And half of 1/127 of the bound, in units of the mean.
        for (k, bound) in [(1, 3.0f32.sqrt()), (6, 5.0f32.sqrt() / 2.0)] {
            let error = (found[k] - grid[0][1][k]).abs();
            assert!(error <= found[0] * bound * 0.501 / 127.0, "{size}: coefficient {k} is off by {error}");
        }
    }
}

#[test]
fn too_large_for_each_encoding_is_named() {
    use ivg_format::EncodeError;
    // The sum grazes the tangent plane, so that the colour becomes 1.5 times the length: beyond binary32.
    let mut grazing = HemisphereVectors::default();
    grazing[0] = [[3e38, 0.0, 0.0], [0.0, 3.4e38, 0.0], [0.0, 3.4e38, 0.0]];
    for encoding in PAIRED {
        let lattice = lattice([1, 2, 1]);
        let grid = [HemisphereVectors::default(), grazing];
        let error = encode(&GridSource::new(lattice, &grid), &options(encoding, 1)).unwrap_err();
        assert_eq!(error, EncodeError::TooLarge { vertex: [0, 1, 0], hemisphere: 0 }, "{encoding:?}");
    }
    let bright = [[[f32::MAX; 9]; 3]];
    let error =
        encode(&GridSource::new(lattice([1, 1, 1]), &bright), &options(Encoding::Sh2, 1)).unwrap_err();
    assert_eq!(error, EncodeError::RadianceTooLarge { vertex: [0, 0, 0] });
}

#[test]
fn ratios_are_taken_to_the_mean_that_will_be_decoded() {
    // 257.5 steps become 258 steps: half a step in 257.5 matters for ratios near the middle between two codes.
    let mean = 257.5f32;
    let step = 3.0f64.sqrt() / 127.0;
    // 60.45 codes of the mean that is stored, and 60.57 of the one that was given.
    let coefficient = (258.0 * step * 60.45) as f32;
    let grid = [[[mean, coefficient, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]; 3]];
    let file = encode(&GridSource::new(lattice([1, 1, 1]), &grid), &options(Encoding::Sh2, 1)).unwrap();
    let found = read(&file, &[1]).1[0][0];
    assert_eq!(found[0], 258.0);
    assert!((f64::from(found[1]) - 258.0 * step * 60.0).abs() <= 1e-3, "{}", found[1]);
}

#[test]
fn records_that_the_header_does_not_have_room_for_are_not_read() {
    let file = plain([1, 3, 1], Encoding::PairF16, 1);
    let Step::Consumed(_, header) = ivg_format::Header::read(&file, &Limits::default()).unwrap() else {
        panic!("the header is there")
    };
    let range = header.record_range(RecordId::Corners);
    let bytes = &file[range.start as usize..range.end as usize];
    let Event::Corners(bundle) = decode_record(&header, RecordId::Corners, bytes).unwrap() else {
        panic!("corners were asked for")
    };
    let beyond = || bundle.read_vectors(1, &mut [HemisphereVectors::default(); 2]);
    assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(beyond)).is_err());
    let other = || bundle.read_radiance(0, &mut [RadianceHarmonics::default(); 1]);
    assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(other)).is_err());
}

/// A vector of one hemisphere from three small integers: along the axis not negative.
fn vector(h: usize, (along, one, two): (u8, i8, i8)) -> [f32; 3] {
    let mut v = [0.0; 3];
    v[h / 2] = f32::from(along) * if h.is_multiple_of(2) { 1.0 } else { -1.0 };
    v[(h / 2 + 1) % 3] = f32::from(one);
    v[(h / 2 + 2) % 3] = f32::from(two);
    v
}

/// The most by which a direction may be off \[rad\], and a colour, of the largest component of its colour.
fn bounds(encoding: Encoding) -> (f32, f32) {
    match encoding {
        Encoding::PackedOct24 => (std::f32::consts::SQRT_2 / 2047.0, 1.0 / 511.0),
        // Half a step of 1/127 in each coordinate.
        Encoding::PackedXyz24 => (3.0f32.sqrt() / 254.0, 1.0 / 511.0),
        Encoding::PairF16 | Encoding::PairF16x4 => (3.0f32.sqrt() / 4096.0, 1.0 / 2048.0),
        // Roundings to binary32, of the quotient and of the products.
        _ => (3.0f32.sqrt() * f32::EPSILON, 2.0 * f32::EPSILON),
    }
}

quickcheck! {
    /// Channels of one direction, well above the tangent plane: then packing itself loses nothing, and what is left is
    /// quantisation.
    fn packing_is_within_its_bound(
        which: usize, h: u8, parts: (u8, i8, i8), colour: (u8, u8, u8), size: i8
    ) -> TestResult {
        let encoding = PAIRED[which % PAIRED.len()];
        let h = usize::from(h % 6);
        let direction = vector(h, parts);
        let length = direction.iter().map(|c| c * c).sum::<f32>().sqrt();
        if f32::from(parts.0) < 0.3 * length || parts.0 == 0 {
            return TestResult::discard();
        }
        let scale = 2.0f32.powi(i32::from(size) / 2) / length;
        let channels = [colour.0, colour.1, colour.2].map(f32::from);
        let mut vertex = HemisphereVectors::default();
        vertex[h] = channels.map(|c| direction.map(|d| d * c * scale));
        let back = read(&encoded(&[vertex], encoding), &[1]).0;
        // The colour is divided by the decoded component along the axis, which is at least 0.3 less the angle: so the error
        // along the direction is at most one over that as large as that of the direction. A direction's length may be off as
        // its angle is. One part in a hundred covers the second order of what remains, the roundings to binary32 and those of
        // this test.
        let (angle, step) = bounds(encoding);
        let most = channels.iter().fold(0.0f32, |a, &b| a.max(b)) * scale * length;
        let bound = 1.01 * most * (angle * (1.0 + 1.0 / (0.3 - angle)) + step + 4.0 * f32::EPSILON);
        let worst = (0..3).map(|k| {
            let squared: f32 = (0..3).map(|i| (back[0][h][k][i] - vertex[h][k][i]).powi(2)).sum();
            squared.sqrt()
        }).fold(0.0, f32::max);
        TestResult::from_bool(worst <= bound)
    }

    fn pieces_of_any_size_give_the_same_values(which: usize, n: u8, pieces: Vec<u8>) -> bool {
        let encoding = Encoding::ALL[which % Encoding::ALL.len()];
        let lattice = lattice([2, 3, u16::from(n % 40) + 1]);
        let file = match encoding.quantity() {
            Quantity::Vectors => encode(&GridSource::new(lattice, &vectors(&lattice)), &options(encoding, 64)),
            Quantity::Radiance => encode(&GridSource::new(lattice, &radiance(&lattice)), &options(encoding, 64)),
        }.unwrap();
        let pieces: Vec<usize> = pieces.iter().map(|&piece| usize::from(piece) % 100 + 1).chain([17]).collect();
        read(&file, &pieces) == read(&file, &[1])
    }

    fn harmonics_are_within_their_bound(mean: (u8, u8, u8), ratios: Vec<i8>, size: i8) -> bool {
        let scale = 2.0f32.powi(i32::from(size) / 2);
        let bound = |k: usize, negative: bool| match k {
            1..=3 => 3.0f32.sqrt(),
            6 if negative => 5.0f32.sqrt() / 2.0,
            6 => 5.0f32.sqrt(),
            _ => 15.0f32.sqrt() / 2.0,
        };
        let ratio = |n: usize| f32::from(ratios.get(n).copied().unwrap_or(0)) / 128.0;
        let means = [mean.0, mean.1, mean.2].map(|mean| f32::from(mean) * scale);
        let grid: [RadianceHarmonics; 1] = [std::array::from_fn(|channel| std::array::from_fn(|k| {
            let ratio = ratio(channel * 8 + k);
            if k == 0 { means[channel] } else { means[channel] * ratio * bound(k, ratio < 0.0) }
        }))];
        let file = encode(&GridSource::new(lattice([1, 1, 1]), &grid), &options(Encoding::Sh2, 1)).unwrap();
        let found = read(&file, &[1]).1[0];
        let largest = means.iter().fold(0.0f32, |a, &b| a.max(b));
        (0..3).all(|channel| (0..9).all(|k| {
            let error = (found[channel][k] - grid[0][channel][k]).abs();
            // The mean: half a step of RGB9E5. The others: half a step of the ratio, and what the mean lost where the ratio
            // is cut at its bound, which is at most its error times the bound. A thousandth for the roundings.
            let step = largest / 511.0;
            let bound = if k == 0 { step } else {
                bound(k, false) * (found[channel][0] * 0.5 / 127.0 + if means[channel] > found[channel][0] { step } else { 0.0 })
            };
            error <= bound * 1.001
        }))
    }
}

#[test]
fn harmonics_are_finite_at_every_scale_that_is_allowed() {
    // The brightest mean that there is, and the largest ratios.
    let mut brightest = [127; 28];
    brightest[..4].copy_from_slice(&u32::MAX.to_le_bytes());
    let (file, _) = one_vertex(Encoding::Sh2, 110, &brightest);
    let mut largest = 0.0f32;
    decode_all(&file, &Limits::default(), |event| {
        if let Event::Corners(bundle) = event {
            largest = bundle.radiance(0).as_flattened().iter().fold(0.0, |most: f32, c| most.max(*c));
        }
    })
    .unwrap();
    assert!(largest.is_finite() && largest > 1e38, "{largest}");
    // One more, and the same numbers would not be: the header is refused.
    let mut over = file;
    over[114..116].copy_from_slice(&111i16.to_le_bytes());
    ivg_wire::seal_header(&mut over[..144]);
    let error = decode_all(&over, &Limits::default(), |_| {}).unwrap_err();
    assert_eq!((error.code(), error.offset().0), (codes::SCALE_EXPONENT.number(), 114));
}
