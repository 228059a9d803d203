//! The formulas of the profile *irradiance* (`spec/ivg.md`, section 13), written anew in binary64 from its text, and the
//! bounds that it gives for binary32 (IVG-IRR-13).

use glam::Vec3;
use ivg_format::Encoding;
use ivg_grid::harmonics::{irradiance, irradiance_signed};
use ivg_grid::{
    HemisphereVectors, RadianceHarmonics, Reconstruction, TANGENTIAL_LOSS, reconstruct, reconstruct_signed,
};
use quickcheck::{Arbitrary, Gen, TestResult, quickcheck};
use std::f64::consts::PI;

/// The document on one line.
fn specification() -> String {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../spec/ivg.md")).unwrap();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A number from −1 to 1.
fn fraction(g: &mut Gen) -> f32 {
    f32::from(i16::arbitrary(g)) / 32768.0
}

/// A unit vector as near as binary32 has one, often in a plane or along an axis.
#[derive(Clone, Copy, Debug)]
struct Normal(Vec3);

impl Arbitrary for Normal {
    fn arbitrary(g: &mut Gen) -> Self {
        let mut n = [fraction(g), fraction(g), fraction(g)];
        n.iter_mut().for_each(|c| *c *= f32::from(u8::arbitrary(g) % 4 != 0));
        Self(Vec3::from(n).try_normalize().unwrap_or(Vec3::NEG_Y))
    }
}

/// Numbers of any sign; they need not be light for the formulas to be what they are.
#[derive(Clone, Debug)]
struct Numbers(Vec<f32>);

impl Arbitrary for Numbers {
    fn arbitrary(g: &mut Gen) -> Self {
        Self((0..54).map(|_| fraction(g) * 10.0).collect())
    }
}

/// The irradiance vectors that the numbers are, and one channel of them in binary64: `[hemisphere][coordinate]`.
fn vectors(numbers: &[f32]) -> (HemisphereVectors, [[f64; 3]; 6]) {
    let vectors: HemisphereVectors =
        std::array::from_fn(|h| std::array::from_fn(|k| std::array::from_fn(|i| numbers[h * 9 + k * 3 + i])));
    (vectors, vectors.map(|hemisphere| hemisphere[1].map(f64::from)))
}

/// IVG-IRR-02 to -04 before max(0, ·), for one channel, and the bound of IVG-IRR-13 for V = 1.
fn formula(method: Reconstruction, v: &[[f64; 3]; 6], n: [f64; 3]) -> (f64, f64) {
    let hemisphere = |i: usize| v[2 * i + usize::from(n[i] < 0.0)];
    let sign = |i: usize| if n[i] < 0.0 { -1.0 } else { 1.0 };
    let dot = |a: [f64; 3]| a[0] * n[0] + a[1] * n[1] + a[2] * n[2];
    let others = |i: usize| (0..3).filter(move |&j| j != i);
    match method {
        Reconstruction::NSquared => ((0..3).map(|i| n[i] * n[i] * dot(hemisphere(i))).sum(), 1.3e-6),
        Reconstruction::ThreeVector => {
            let term = |i: usize| {
                let weight = |j: usize| n[j] * (1.0 - 0.5 * n[j].abs());
                let tangential: f64 = others(i).map(|j| weight(j) * hemisphere(i)[j]).sum();
                n[i] * n[i] * (sign(i) * hemisphere(i)[i] + tangential)
            };
            ((0..3).map(term).sum(), 1.6e-6)
        }
        Reconstruction::SixVector => {
            let sum = |j: usize| v[2 * j][j] + v[2 * j + 1][j];
            let difference = |j: usize, k: usize| v[2 * j][k] - v[2 * j + 1][k];
            let first: f64 = (0..3).map(|j| n[j] * sum(j)).sum();
            let second: f64 = (0..3).map(|j| n[j] * n[j] * difference(j, j)).sum();
            let third: f64 = (0..3)
                .flat_map(|j| others(j).map(move |k| (j, k)))
                .map(|(j, k)| n[j] * n[k] * difference(j, k))
                .sum();
            (0.5 * (first + second + 0.5 * third), 6e-6)
        }
        other => panic!("{other:?} does not start from vectors"),
    }
}

#[test]
fn formulas_are_those_of_the_specification() {
    fn law(Numbers(numbers): Numbers, Normal(n): Normal) -> TestResult {
        let (vectors, channel) = vectors(&numbers);
        let largest = channel.iter().flatten().fold(0.0f64, |most, c| most.max(c.abs()));
        let ok = Reconstruction::OF_VECTORS.into_iter().all(|method| {
            let (exact, bound) = formula(method, &channel, n.to_array().map(f64::from));
            let signed = reconstruct_signed(method, &vectors, n).y;
            (f64::from(signed) - exact).abs() <= bound * largest
                && reconstruct(method, &vectors, n).y == signed.max(0.0)
        });
        TestResult::from_bool(ok)
    }
    quickcheck(law as fn(Numbers, Normal) -> TestResult);
}

/// The functions of IVG-SH-01 in binary64, and their magnitudes as IVG-IRR-13 counts them.
fn basis([x, y, z]: [f64; 3]) -> [(f64, f64); 9] {
    let plain = |value: f64| (value, value.abs());
    let one = (3.0 / (4.0 * PI)).sqrt();
    let two = (15.0 / (4.0 * PI)).sqrt();
    let (axial, plane) = ((5.0 / (16.0 * PI)).sqrt(), (15.0 / (16.0 * PI)).sqrt());
    [
        plain((1.0 / (4.0 * PI)).sqrt()),
        plain(one * y),
        plain(one * z),
        plain(one * x),
        plain(two * x * y),
        plain(two * y * z),
        (axial * (3.0 * z * z - 1.0), axial * (3.0 * z * z + 1.0)),
        plain(two * x * z),
        (plane * (x * x - y * y), plane * (x * x + y * y)),
    ]
}

/// The factors A of IVG-IRR-05.
fn factor(k: usize) -> f64 {
    match k {
        0 => PI,
        1..=3 => 2.0 * PI / 3.0,
        _ => PI / 4.0,
    }
}

#[test]
fn harmonics_are_evaluated_as_the_specification_says() {
    fn law(Numbers(numbers): Numbers, Normal(n): Normal) -> bool {
        let radiance: RadianceHarmonics =
            std::array::from_fn(|channel| std::array::from_fn(|k| numbers[9 * channel + k]));
        let terms = basis(n.to_array().map(f64::from));
        let (mut exact, mut bound) = (0.0, 0.0);
        for (k, ((value, magnitude), c)) in terms.into_iter().zip(radiance[2]).enumerate() {
            exact += factor(k) * f64::from(c) * value;
            bound += 1.1e-6 * factor(k) * f64::from(c).abs() * magnitude;
        }
        let signed = irradiance_signed(&radiance, n).z;
        (f64::from(signed) - exact).abs() <= bound && irradiance(&radiance, n).z == signed.max(0.0)
    }
    quickcheck(law as fn(Numbers, Normal) -> bool);
}

#[test]
fn what_the_tangential_components_lose_is_the_printed_half() {
    assert!(
        specification().contains("Σ_{j≠i} n_j (1 − ½ |n_j|) I_i[j]"),
        "IVG-IRR-03 prints another formula"
    );
    assert_eq!(TANGENTIAL_LOSS, 0.5);
}

#[test]
fn formulas_have_the_printed_values() {
    let one_channel: [[f32; 3]; 6] = [
        [3.0, 1.0, -0.5],
        [-1.0, 0.5, 0.25],
        [0.5, 2.0, 0.0],
        [1.5, -0.5, -0.25],
        [1.0, 1.0, 1.5],
        [1.0, 0.5, -1.75],
    ];
    let vectors: HemisphereVectors = one_channel.map(|vector| [vector; 3]);
    let radiance: RadianceHarmonics = [[1.0, 0.5, -0.25, 0.75, 0.1, -0.2, 0.3, 0.15, -0.05]; 3];
    let normals = [
        ("(0, 1, 0)", [0.0, 1.0, 0.0]),
        ("(2, −3, 6) / 7", [2.0, -3.0, 6.0]),
        ("(−1, −1, −1) / √3", [-1.0; 3]),
    ];
    let text = specification();
    for (name, n) in normals {
        let n = Vec3::from(n).normalize();
        let (_, row) = text.split_once(&format!("| {name} | ")).expect("the row is printed");
        let printed =
            row.split(" | ").take(4).map(|c| c.trim_end_matches(" |").replace('−', "-").parse::<f32>());
        let vectors = Reconstruction::OF_VECTORS.map(|method| reconstruct_signed(method, &vectors, n).x);
        for (found, printed) in vectors.into_iter().chain([irradiance_signed(&radiance, n).x]).zip(printed) {
            // Half a unit of the sixth decimal, and the bounds of IVG-IRR-13 with V = 3.
            let printed = printed.expect("a number");
            assert!((found - printed).abs() < 5e-7 + 3.0 * 6e-6, "{name}: {found}, printed {printed}");
        }
    }
}

#[test]
fn each_encoding_has_its_formula() {
    for encoding in Encoding::ALL.iter().copied() {
        let expected = match encoding.name() {
            "vectors-f32" => "six",
            "sh2-28" => "sh2",
            _ => "three",
        };
        assert_eq!(Reconstruction::for_encoding(encoding).name(), expected, "{}", encoding.name());
        assert!(Reconstruction::for_encoding(encoding).fits(encoding.quantity()));
    }
}

quickcheck! {
    fn a_wrong_share_would_be_seen(normal: Normal) -> TestResult {
        // In light along the diagonal, one hundredth more of the tangential components is far beyond the bound.
        let Normal(n) = normal;
        let (vectors, channel) = vectors(&[1.0; 54]);
        let (exact, bound) = formula(Reconstruction::ThreeVector, &channel, n.to_array().map(f64::from));
        let more = Vec3::splat(1.01) * ivg_grid::tangential_weights(n);
        let weights = ivg_grid::tangential_weights(n).to_array();
        let tangential: f32 =
            n.to_array().iter().zip(weights).map(|(c, w)| c * c * (weights.iter().sum::<f32>() - w)).sum();
        if tangential.abs() < 0.1 {
            return TestResult::discard();
        }
        let wrong = ivg_grid::three_vector(&vectors, n, more).y;
        TestResult::from_bool((f64::from(wrong) - exact).abs() > bound)
    }
}
