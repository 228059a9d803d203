//! What must hold of writer and reader of `.ivg` together, for any grid.

use crate::choices::Choices;
use ivg_format::quant::direction::Octahedral24;
use ivg_format::quant::pack::{DirectionQuantiser, pack_hemisphere};
use ivg_format::quant::pair::{HalfDirection, SingleDirection};
use ivg_format::quant::ratio::decode as decode_ratio;
use ivg_format::quant::xyz::Xyz24;
use ivg_format::{
    BakedLight, EncodeError, EncodeOptions, Encoding, Event, GridSource, HemisphereVectors, Lattice, Limits,
    Order, Quantity, RadianceHarmonics, Units, Values, VertexValues, decode_all, encode, lights, metadata,
};

/// Vertices along an axis, at most: the longest grid then has 125 vertices, which keeps an input fast.
const MOST_VERTICES: usize = 5;

/// A grid made of the bytes is the same after encoding and decoding: exactly, or for a quantised encoding within half a step
/// of each colour.
///
/// # Panics
///
/// When that does not hold.
pub fn ivg_roundtrip(data: &[u8]) {
    let mut choices = Choices::new(data);
    let options = choose_options(&mut choices);
    let mut grid = Grid::choose(&mut choices, options.encoding.quantity());
    if options.order == Order::Explicit {
        grid.bundles = Some(grid.choose_bundles(&mut choices, options.vertices_per_slice));
    }
    let source = grid.source();
    let file = match encode(&source, &options) {
        // Too large for the exponent of the quantised colours, as it may be.
        Err(EncodeError::TooLarge { .. } | EncodeError::RadianceTooLarge { .. })
            if is_quantised(&options) =>
        {
            return;
        }
        result => result.unwrap_or_else(|error| panic!("a sound grid is refused: {error}")),
    };
    assert_eq!(encode(&source, &options).as_ref(), Ok(&file), "encoded twice, and the bytes differ");
    grid.compare(&file, &options);
}

fn is_quantised(options: &EncodeOptions) -> bool {
    options.encoding != Encoding::VectorsF32
}

fn choose_options(choices: &mut Choices<'_>) -> EncodeOptions {
    EncodeOptions {
        encoding: Encoding::ALL[choices.below(Encoding::ALL.len())],
        vertices_per_slice: 1 + choices.below(30) as u32,
        seed: choices.long(),
        units: if choices.byte() < 128 { Units::Radiometric } else { Units::Photometric },
        order: [Order::Slices, Order::Octree, Order::Explicit][choices.below(3)],
        headroom: choices.below(8) as u8,
    }
}

/// A grid that owns its arrays.
struct Grid {
    lattice: Lattice,
    values: GridValues,
    validity: Option<Vec<u8>>,
    blocked_edges: Option<Vec<u8>>,
    bundles: Option<Vec<Vec<u64>>>,
    lights: &'static [BakedLight<'static>],
    meta: &'static [(&'static str, &'static str)],
}

/// The values of all vertices.
enum GridValues {
    Vectors(Vec<HemisphereVectors>),
    Radiance(Vec<RadianceHarmonics>),
}

impl GridValues {
    fn borrowed(&self) -> Values<'_> {
        match self {
            Self::Vectors(vectors) => vectors.into(),
            Self::Radiance(radiance) => radiance.into(),
        }
    }
}

const LIGHTS: [BakedLight<'_>; 2] = [
    BakedLight { name: "lamp", direct_included: false },
    BakedLight { name: "Fenster über dem Tisch", direct_included: true },
];
const META: [(&str, &str); 2] = [("generator", "a test"), ("photons", "")];

impl Grid {
    fn choose(choices: &mut Choices<'_>, quantity: Quantity) -> Self {
        let dims = [0; 3].map(|_: u16| 1 + choices.below(MOST_VERTICES) as u16);
        let min = [0; 3].map(|_| f64::from(choices.byte()) - 128.0);
        let extent = [0; 3].map(|_| f64::from(choices.byte()) / 16.0 + 0.5);
        let max = [0, 1, 2].map(|axis| min[axis] + extent[axis]);
        let lattice = Lattice::new(dims, min, max).expect("finite bounds with an extent");
        let count = lattice.vertex_count() as usize;
        let flags = choices.byte();
        let validity = (flags & 1 != 0).then(|| (0..count).map(|_| choices.byte()).collect());
        let blocked_edges = (flags & 2 != 0).then(|| {
            let inside = |vertex: usize| {
                let coordinates = lattice.coords(vertex as u64);
                (0..3)
                    .filter(|&axis| coordinates[axis] + 1 < dims[axis])
                    .fold(0, |bits, axis| bits | 1 << axis)
            };
            (0..count).map(|vertex| choices.byte() & inside(vertex)).collect()
        });
        let lights = &LIGHTS[..usize::from(flags >> 2) % 3];
        let meta = &META[..usize::from(flags >> 4) % 3];
        // Numbers of every size; zeros once the bytes are used up.
        let values = match quantity {
            Quantity::Vectors => {
                let mut vectors = vec![HemisphereVectors::default(); count];
                vectors.iter_mut().flatten().flatten().flatten().for_each(|c| *c = choices.finite());
                GridValues::Vectors(vectors)
            }
            Quantity::Radiance => {
                let mut radiance = vec![RadianceHarmonics::default(); count];
                radiance.iter_mut().flatten().flatten().for_each(|c| *c = choices.finite());
                GridValues::Radiance(radiance)
            }
        };
        Self { lattice, values, validity, blocked_edges, bundles: None, lights, meta }
    }

    /// Spreads the vertices over bundles; those that are not valid may be in none.
    fn choose_bundles(&self, choices: &mut Choices<'_>, vertices_per_slice: u32) -> Vec<Vec<u64>> {
        let longest = self.lattice.dims.into_iter().max().unwrap_or(1);
        let most = vertices_per_slice as usize * usize::from(longest);
        let mut full = Vec::new();
        let mut open = vec![Vec::new(); 4];
        for vertex in (0..self.lattice.vertex_count()).filter(|&vertex| !self.lattice.is_corner(vertex)) {
            let valid = self.validity.as_ref().is_none_or(|validity| validity[vertex as usize] != 0);
            let choice = choices.byte();
            if !valid && choice >= 128 {
                continue;
            }
            let bundle = &mut open[usize::from(choice % 4)];
            bundle.push(vertex);
            if bundle.len() == most {
                full.push(std::mem::take(bundle));
            }
        }
        full.extend(open.into_iter().filter(|bundle| !bundle.is_empty()));
        full
    }

    /// Whether the file has a value for a vertex.
    fn is_sent(&self, vertex: u64) -> bool {
        let listed = |bundles: &Vec<Vec<u64>>| bundles.iter().flatten().any(|&sent| sent == vertex);
        self.lattice.is_corner(vertex) || self.bundles.as_ref().is_none_or(listed)
    }

    fn source(&self) -> GridSource<'_> {
        GridSource {
            lattice: self.lattice,
            values: self.values.borrowed(),
            validity: self.validity.as_deref(),
            blocked_edges: self.blocked_edges.as_deref(),
            bundles: self.bundles.as_deref(),
            lights: self.lights,
            meta: self.meta,
        }
    }

    fn compare(&self, file: &[u8], options: &EncodeOptions) {
        let count = self.values.borrowed().len();
        let mut received = vec![false; count];
        let mut validity = vec![255; count];
        let mut edges = vec![0; count];
        let mut chunks = 0;
        let decoded = decode_all(file, &Limits::default(), |event| match event {
            Event::Header(header) => {
                assert_eq!(header.lattice, self.lattice);
                assert_eq!(header.file_bytes, file.len() as u64);
                assert_eq!(
                    (header.encoding, header.units, header.seed, header.vertices_per_slice),
                    (options.encoding, options.units, options.seed, options.vertices_per_slice)
                );
                assert_eq!(header.order, options.order);
            }
            Event::Chunk(chunk) if chunk.kind == ivg_format::LIGHTS => {
                assert!(lights(&chunk).expect("well formed").eq(self.lights.iter().copied()));
                chunks += 1;
            }
            Event::Chunk(chunk) => {
                assert!(metadata(&chunk).expect("well formed").eq(self.meta.iter().copied()));
                chunks += 1;
            }
            Event::Validity(block) => {
                let first = block.first_vertex() as usize;
                validity[first..first + block.len()].copy_from_slice(block.validity());
                (0..block.len()).for_each(|n| edges[first + n] = block.blocked_edges(n));
            }
            Event::Corners(bundle) | Event::Bundle(bundle) => {
                for (n, vertex) in bundle.vertices().enumerate() {
                    let vertex = vertex as usize;
                    assert!(!std::mem::replace(&mut received[vertex], true), "vertex {vertex} comes twice");
                    let exponent = bundle.header().scale_exponent;
                    match (bundle.values(n), bundle.packed(n), &self.values) {
                        (VertexValues::Vectors(found), None, GridValues::Vectors(all)) => {
                            assert_eq!(bits(&found), bits(&all[vertex]));
                        }
                        (VertexValues::Vectors(found), Some(packed), GridValues::Vectors(all)) => {
                            compare_packed(&all[vertex], &packed, &found, options.encoding, exponent);
                        }
                        (VertexValues::Radiance(found), None, GridValues::Radiance(all)) => {
                            compare_harmonics(&all[vertex], &found, exponent);
                        }
                        _ => panic!("{:?} holds another quantity than was written", options.encoding),
                    }
                }
            }
            _ => {}
        });
        assert_eq!(decoded, Ok(()), "what the encoder wrote is refused");
        for (vertex, received) in (0..).zip(received) {
            assert_eq!(received, self.is_sent(vertex), "vertex {vertex}");
        }
        assert_eq!(chunks, usize::from(!self.lights.is_empty()) + usize::from(!self.meta.is_empty()));
        assert_eq!(validity, self.validity.clone().unwrap_or(vec![255; count]));
        assert_eq!(edges, self.blocked_edges.clone().unwrap_or(vec![0; count]));
    }
}

fn bits(vectors: &HemisphereVectors) -> Vec<u32> {
    vectors.iter().flatten().flatten().map(|component| component.to_bits()).collect()
}

/// Directions are those that packing chooses; colours are those that packing chooses within the rounding of what stores them.
fn compare_packed(
    original: &HemisphereVectors,
    packed: &[([f32; 3], [f32; 3]); 6],
    vectors: &HemisphereVectors,
    encoding: Encoding,
    scale_exponent: i16,
) {
    for (hemisphere, ((direction, colour), vectors)) in packed.iter().zip(vectors).enumerate() {
        let (expected_direction, expected) = expected(&original[hemisphere], hemisphere, encoding);
        assert_eq!(*direction, expected_direction);
        let largest = expected.iter().copied().fold(0.0, f64::max);
        for (channel, (&colour, expected)) in colour.iter().zip(expected).enumerate() {
            let half_step = half_step(encoding, expected, largest, scale_exponent);
            let error = (f64::from(colour) - expected).abs();
            assert!(
                error <= half_step,
                "colour {colour} for {expected}: off by {error}, at most {half_step}"
            );
            assert_eq!(vectors[channel], direction.map(|d| colour * d));
        }
    }
}

/// Direction and colour of a hemisphere by the rules for packing.
fn expected(vectors: &[[f32; 3]; 3], hemisphere: usize, encoding: Encoding) -> ([f32; 3], [f64; 3]) {
    fn by<Q: DirectionQuantiser>(vectors: &[[f32; 3]; 3], hemisphere: usize) -> ([f32; 3], [f64; 3]) {
        let packed = pack_hemisphere::<Q>(vectors, hemisphere).expect("finite");
        (Q::decode(&packed.direction), packed.colour)
    }
    match encoding {
        Encoding::PackedOct24 => by::<Octahedral24>(vectors, hemisphere),
        Encoding::PackedXyz24 => by::<Xyz24>(vectors, hemisphere),
        Encoding::PairF16 | Encoding::PairF16x4 => by::<HalfDirection>(vectors, hemisphere),
        Encoding::PairF32 => by::<SingleDirection>(vectors, hemisphere),
        other => panic!("{} holds no directions and colours", other.name()),
    }
}

/// How much a component of a colour may be off, the largest of its colour given. RGB9E5: the mantissa of the largest is at least
/// 255.5 steps (it may have been rounded up to 256), so that half a step is at most 1/511 of it, or 2^-25 before scaling where
/// the exponent can get no smaller. binary16: half of 2^-10 of its power of two, or 2^-25 before scaling; and as much again as
/// the rounding to binary32 before it, which is that of binary32 too: half of 2^-23, or half of its smallest number.
fn half_step(encoding: Encoding, component: f64, largest: f64, scale_exponent: i16) -> f64 {
    let absolute = f64::from(scale_exponent - 25).exp2();
    let single = component * 2.0f64.powi(-24) + 2.0f64.powi(-150);
    match encoding {
        Encoding::PackedOct24 | Encoding::PackedXyz24 => (largest / 511.0).max(absolute),
        Encoding::PairF16 | Encoding::PairF16x4 => (component / 2048.0).max(absolute) + single,
        _ => single,
    }
}

/// The means are those given within the rounding of RGB9E5, as in [`compare_packed`]; every other coefficient is off by at
/// most half a ratio step of the decoded mean, where its ratio lies within the bounds of radiance that is never negative.
fn compare_harmonics(original: &RadianceHarmonics, found: &RadianceHarmonics, scale_exponent: i16) {
    let means = original.map(|c| f64::from(c[0]).max(0.0));
    let largest = means.iter().copied().fold(0.0, f64::max);
    let half_step = (largest / 511.0).max(f64::from(scale_exponent - 25).exp2());
    for ((original, found), mean) in original.iter().zip(found).zip(means) {
        let decoded = f64::from(found[0]);
        assert!((decoded - mean).abs() <= half_step, "mean {decoded} for {mean}");
        for which in 1..9 {
            let bounds = [127, -127].map(|code| f64::from(decode_ratio(code, which)) * decoded);
            let expected = f64::from(original[which]).clamp(bounds[1], bounds[0]);
            // Half a step of the coarser side, and three roundings of binary32.
            let most = bounds[0].abs().max(bounds[1].abs()) * (0.5 / 127.0 + 3.0 * f64::from(f32::EPSILON));
            let error = (f64::from(found[which]) - expected).abs();
            assert!(error <= most + f64::from(f32::from_bits(1)), "coefficient {which}: off by {error}");
        }
    }
}
