//! How fast the encodings are, beside what else could be done with the same numbers on the same core in the same minute.
//!
//! `cargo bench -p ivg-format --bench codec [-- VERTICES_PER_AXIS] [ENCODING…]`. Every figure is the median of rounds in which everything
//! is timed once, so that ratios compare like with like on a machine whose speed varies.

use ivg_format::{
    Bundle, EncodeOptions, Encoding, Event, GridSource, Header, HemisphereVectors, Lattice, Limits, Quantity,
    RadianceHarmonics, RecordId, Step, Values, decode_record, encode,
};
use std::hint::black_box;
use std::time::Instant;

/// Times everything is done.
const ROUNDS: usize = 15;

/// Vertices that are read at once.
const PIECE: usize = 64;

/// The level at which the targets compare with zstd.
const ZSTD_LEVEL: i32 = 3;

fn main() {
    let per_axis = std::env::args().filter_map(|word| word.parse().ok()).next().unwrap_or(32u16);
    let lattice = Lattice::new([per_axis; 3], [0.0; 3], [1.0; 3]).expect("a cube");
    let (vectors, radiance) = field(&lattice);
    let vertices = lattice.vertex_count();
    println!("{per_axis}³ vertices, {ROUNDS} rounds, medians\n");
    println!(
        "{:13} {:>6} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "encoding",
        "bytes",
        "checks",
        "values",
        "order",
        "encode",
        "zstd",
        "memcpy",
        "x zstd",
        "/ memcpy",
        "enc/dec"
    );
    println!(
        "{:13} {:>6} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "",
        "vertex",
        "ns/vertex",
        "ns/vertex",
        "ns/vertex",
        "ns/vertex",
        "ns/vertex",
        "ns/vertex",
        ">= 2",
        "<= 5",
        "<= 3"
    );
    let named: Vec<_> = std::env::args().filter_map(|word| Encoding::from_name(&word)).collect();
    for &encoding in if named.is_empty() { Encoding::ALL } else { &named } {
        let source = match encoding.quantity() {
            Quantity::Vectors => Values::Vectors(&vectors),
            Quantity::Radiance => Values::Radiance(&radiance),
        };
        Subject::new(lattice, source, encoding).measure(vertices as f64);
    }
    println!(
        "\nchecks: checksum and forbidden values of every record; values: to binary32, {PIECE} vertices at a time; order: which\n\
         vertices they are; encode: the whole file, order and checksums included; zstd: decompressing the same binary32\n\
         arrays, level {ZSTD_LEVEL}; x zstd: its time over checks + values; / memcpy: checks + values over copying the arrays;\n\
         enc/dec: encode over checks + values + order."
    );
}

/// A file and what is timed on it.
struct Subject<'a> {
    source: GridSource<'a>,
    options: EncodeOptions,
    file: Vec<u8>,
    header: Header,
    /// The decoded arrays as bytes, and compressed.
    plain: Vec<u8>,
    compressed: Vec<u8>,
}

impl<'a> Subject<'a> {
    fn new(lattice: Lattice, values: Values<'a>, encoding: Encoding) -> Self {
        let source = GridSource::new(lattice, values);
        let options = EncodeOptions { encoding, ..EncodeOptions::new() };
        let file = encode(&source, &options).expect("a grid that can be written");
        let Ok(Step::Consumed(_, header)) = Header::read(&file, &Limits::default()) else {
            panic!("the file has a header")
        };
        let mut subject = Self { source, options, file, header, plain: vec![], compressed: vec![] };
        // In the order of the lattice, as a program keeps them.
        let mut out = Out::new(subject.header.lattice.vertex_count() as usize);
        let mut all = vec![0.0f32; subject.numbers() * out.vectors.len()];
        for bundle in subject.bundles() {
            out.read(&bundle);
            for (n, vertex) in bundle.vertices().enumerate() {
                let numbers = match encoding.quantity() {
                    Quantity::Vectors => out.vectors[n].as_flattened().as_flattened(),
                    Quantity::Radiance => out.radiance[n].as_flattened(),
                };
                all[vertex as usize * numbers.len()..][..numbers.len()].copy_from_slice(numbers);
            }
        }
        let plain: Vec<u8> = all.iter().flat_map(|number| number.to_le_bytes()).collect();
        subject.compressed = zstd::bulk::compress(&plain, ZSTD_LEVEL).expect("compression in memory");
        subject.plain = plain;
        subject
    }

    /// binary32 numbers of a vertex.
    fn numbers(&self) -> usize {
        match self.header.encoding.quantity() {
            Quantity::Vectors => 54,
            Quantity::Radiance => 27,
        }
    }

    fn records(&self) -> impl Iterator<Item = (RecordId, &[u8])> {
        let records =
            self.header.records().filter(|id| matches!(id, RecordId::Corners | RecordId::Bundle(_)));
        records.map(|id| {
            let range = self.header.record_range(id);
            (id, &self.file[range.start as usize..range.end as usize])
        })
    }

    fn bundles(&self) -> Vec<Bundle<'_>> {
        self.records()
            .map(|(id, bytes)| match decode_record(&self.header, id, bytes) {
                Ok(Event::Corners(bundle) | Event::Bundle(bundle)) => bundle,
                other => panic!("{other:?}"),
            })
            .collect()
    }

    fn measure(&self, vertices: f64) {
        let mut rounds = [const { vec![] }; 6];
        let count = vertices as usize;
        let mut out = Out::new(count);
        let mut copy = vec![0u8; self.plain.len()];
        let mut decompressor = zstd::bulk::Decompressor::new().expect("a decompressor");
        for _ in 0..ROUNDS {
            let mut bundles = vec![];
            let timed = [
                time(|| bundles = self.bundles()),
                time(|| {
                    let mut first = 0;
                    for bundle in &bundles {
                        out.read_at(bundle, first);
                        first += bundle.len();
                    }
                    black_box(&mut out);
                }),
                time(|| {
                    for bundle in &bundles {
                        black_box(bundle.vertices().fold(0, |sum: u64, vertex| sum.wrapping_add(vertex)));
                    }
                }),
                time(|| {
                    black_box(encode(&self.source, &self.options).expect("it was written before"));
                }),
                time(|| {
                    let length = decompressor.decompress_to_buffer(&self.compressed, &mut copy);
                    assert_eq!(length.ok(), Some(self.plain.len()));
                }),
                time(|| black_box(&mut copy).copy_from_slice(black_box(&self.plain))),
            ];
            rounds.iter_mut().zip(timed).for_each(|(all, one)| all.push(one));
        }
        let ratio = |over: &dyn Fn(usize) -> f64| median((0..ROUNDS).map(over).collect());
        let [checks, values, order, encode, zstd, memcpy] = &rounds;
        let decode = |n: usize| checks[n] + values[n];
        print!("{:13} {:>6}", self.header.encoding.name(), self.header.encoding.bytes_per_vertex());
        rounds.iter().for_each(|times| print!(" {:>9.1}", median(times.clone()) / vertices));
        println!(
            " {:>9.2} {:>9.2} {:>9.2}",
            ratio(&|n| zstd[n] / decode(n)),
            ratio(&|n| decode(n) / memcpy[n]),
            ratio(&|n| encode[n] / (decode(n) + order[n])),
        );
    }
}

/// Arrays to decode to.
struct Out {
    vectors: Vec<HemisphereVectors>,
    radiance: Vec<RadianceHarmonics>,
}

impl Out {
    fn new(count: usize) -> Self {
        Self { vectors: vec![Default::default(); count], radiance: vec![Default::default(); count] }
    }

    fn read(&mut self, bundle: &Bundle<'_>) {
        self.read_at(bundle, 0);
    }

    /// A bundle's values, from vertex `start` of the arrays on.
    fn read_at(&mut self, bundle: &Bundle<'_>, start: usize) {
        for first in (0..bundle.len()).step_by(PIECE) {
            let range = start + first..start + (first + PIECE).min(bundle.len());
            match bundle.header().encoding.quantity() {
                Quantity::Vectors => bundle.read_vectors(first, &mut self.vectors[range]),
                Quantity::Radiance => bundle.read_radiance(first, &mut self.radiance[range]),
            }
        }
    }
}

/// Nanoseconds.
fn time(run: impl FnOnce()) -> f64 {
    let start = Instant::now();
    run();
    start.elapsed().as_secs_f64() * 1e9
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}

/// A light that fades with the distance: position, colour, size.
const LIGHTS: [([f64; 3], [f64; 3], f64); 7] = [
    ([0.5, 1.1, 0.5], [9.0, 8.0, 7.0], 0.4),
    ([-0.1, 0.5, 0.5], [4.0, 0.4, 0.2], 0.5),
    ([1.1, 0.4, 0.6], [0.2, 3.0, 0.5], 0.5),
    ([0.5, 0.3, 1.2], [0.7, 0.7, 2.5], 0.6),
    ([0.4, -0.1, 0.4], [1.5, 1.4, 1.2], 0.7),
    ([0.2, 0.9, -0.2], [0.3, 0.5, 0.9], 0.3),
    ([0.9, 0.8, 0.1], [1.2, 0.3, 0.9], 0.3),
];

/// Light from all sides.
const AMBIENT: [f64; 3] = [0.10, 0.09, 0.08];

/// Relative noise of every light at every vertex, as a bake leaves it.
const NOISE: f64 = 0.02;

/// Smooth coloured light with a little noise: irradiance vectors, and the radiance harmonics of the same light.
fn field(lattice: &Lattice) -> (Vec<HemisphereVectors>, Vec<RadianceHarmonics>) {
    let mut random = 0x1234_5678_9ABC_DEF0u64;
    let mut noise = move || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        1.0 + NOISE * ((random >> 32) as f64 / f64::from(u32::MAX) * 2.0 - 1.0)
    };
    let sphere = 4.0 * std::f64::consts::PI;
    (0..lattice.vertex_count())
        .map(|vertex| {
            let [i, j, k] = lattice.coords(vertex);
            let at = lattice.position(i, j, k);
            let mut vectors = HemisphereVectors::default();
            let mut radiance = RadianceHarmonics::default();
            for (h, hemisphere) in vectors.iter_mut().enumerate() {
                let axis = if h % 2 == 0 { 1.0 } else { -1.0 };
                // Uniform light L gives pi L along the axis.
                for (channel, ambient) in hemisphere.iter_mut().zip(AMBIENT) {
                    channel[h / 2] = (ambient * std::f64::consts::PI * axis * noise()) as f32;
                }
            }
            for (channel, ambient) in radiance.iter_mut().zip(AMBIENT) {
                channel[0] = (ambient * sphere.sqrt()) as f32;
            }
            for (position, colour, size) in LIGHTS {
                let way = [0, 1, 2].map(|i| position[i] - at[i]);
                let squared: f64 = way.iter().map(|c| c * c).sum();
                let w = way.map(|c| c / squared.sqrt());
                let strength = 0.3 / (squared + size * size) * noise();
                for (h, hemisphere) in vectors.iter_mut().enumerate() {
                    if (w[h / 2] > 0.0) == (h % 2 == 0) {
                        for (channel, colour) in hemisphere.iter_mut().zip(colour) {
                            channel.iter_mut().zip(w).for_each(|(c, w)| *c += (colour * strength * w) as f32);
                        }
                    }
                }
                for (channel, colour) in radiance.iter_mut().zip(colour) {
                    channel.iter_mut().zip(basis(w)).for_each(|(c, y)| *c += (colour * strength * y) as f32);
                }
            }
            (vectors, radiance)
        })
        .unzip()
}

/// The functions of IVG-SH-01.
fn basis([x, y, z]: [f64; 3]) -> [f64; 9] {
    let pi = std::f64::consts::PI;
    let (zero, one) = ((0.25 / pi).sqrt(), (0.75 / pi).sqrt());
    let (two, zonal, last) = ((3.75 / pi).sqrt(), (0.3125 / pi).sqrt(), (0.9375 / pi).sqrt());
    let zonal = zonal * (3.0 * z * z - 1.0);
    [zero, one * y, one * z, one * x, two * x * y, two * y * z, zonal, two * x * z, last * (x * x - y * y)]
}
