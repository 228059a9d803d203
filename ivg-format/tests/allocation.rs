//! Memory of a reader: at most 65,536 + 4 × bytes received (COM-LIM-03), whatever a file declares.
//!
//! One test, because the counting allocator counts for the whole process.

use ivg_format::{
    BufferedDecoder, Decoder, EncodeOptions, Encoding, GridSource, Lattice, Limits, Order, Quantity, Step,
    Values, Verdict, VertexValues, decode_all, encode,
};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static COUNTED: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Bytes allocated while `work` ran, freed ones included: at least as much as was held at any time.
fn allocated<T>(work: impl FnOnce() -> T) -> (usize, T) {
    let region = Region::new(COUNTED);
    let result = work();
    let change = region.change();
    // Of a buffer that grows, only the growth is counted. While it is copied, old and new are held at once, which
    // is at most the old one more: the received bytes once, and the bound leaves room for that.
    (change.bytes_allocated, result)
}

fn file(dims: [u16; 3], encoding: Encoding) -> Vec<u8> {
    let lattice = Lattice::new(dims, [0.0; 3], [1.0; 3]).unwrap();
    let mut vertex = [[[0.0; 3]; 3]; 6];
    // Along the axis, so that the packed encoding is exact too.
    vertex[3] = [[0.0, -1.0, 0.0]; 3];
    let count = lattice.vertex_count() as usize;
    let (vectors, radiance) = (vec![vertex; count], vec![[[1.0; 9]; 3]; count]);
    let values: Values<'_> = match encoding.quantity() {
        Quantity::Vectors => (&vectors).into(),
        Quantity::Radiance => (&radiance).into(),
    };
    let validity = vec![200; count];
    let meta = [("generator", "allocation")];
    let source = GridSource { validity: Some(&validity), meta: &meta, ..GridSource::new(lattice, values) };
    encode(&source, &EncodeOptions { encoding, vertices_per_slice: 8, ..EncodeOptions::new() }).unwrap()
}

#[test]
fn readers_hold_no_more_than_the_bytes_they_were_given() {
    the_counter_counts();
    reading_resident_bytes_allocates_nothing();
    a_declared_giant_allocates_nothing();
    pieces_stay_within_the_bound(&file([12, 9, 8], Encoding::VectorsF32));
    let (listed, bundles) = with_directory();
    a_directory_is_held_in_twice_its_bytes(&listed, bundles);
    pieces_stay_within_the_bound(&listed);
}

/// A file of the order explicit with as many bundles as there can be: one vertex in each.
fn with_directory() -> (Vec<u8>, usize) {
    let lattice = Lattice::new([20, 20, 20], [0.0; 3], [1.0; 3]).unwrap();
    let radiance = vec![[[1.0; 9]; 3]; 8000];
    let bundles: Vec<Vec<u64>> = (0..8000).filter(|&v| !lattice.is_corner(v)).map(|v| vec![v]).collect();
    let source = GridSource { bundles: Some(&bundles), ..GridSource::new(lattice, &radiance) };
    let options = EncodeOptions { encoding: Encoding::Sh2, order: Order::Explicit, ..EncodeOptions::new() };
    (encode(&source, &options).unwrap(), bundles.len())
}

/// 16 bytes a bundle, and the two counters of shared ownership (IVG-LIM-03).
fn a_directory_is_held_in_twice_its_bytes(file: &[u8], bundles: usize) {
    let (bytes, result) = allocated(|| decode_all(file, &Limits::default(), |_| {}));
    assert_eq!(result, Ok(()));
    assert!((16 * bundles..=16 * bundles + 16).contains(&bytes), "{bytes} bytes for {bundles} bundles");
    // Cut off inside the directory, nothing is held of it yet.
    let (bytes, result) = allocated(|| decode_all(&file[..144 + 8 * bundles], &Limits::default(), |_| {}));
    assert_eq!((bytes, result.map_err(|error| error.verdict())), (0, Err(Verdict::NeedMore)));
}

/// Otherwise everything below would pass in silence.
fn the_counter_counts() {
    let (bytes, kept) = allocated(|| vec![1u8; 100_000]);
    assert!((100_000..110_000).contains(&bytes), "{bytes} for {}", kept.len());
}

fn reading_resident_bytes_allocates_nothing() {
    for encoding in Encoding::ALL {
        let file = file([9, 8, 7], *encoding);
        let (bytes, sum) = allocated(|| {
            let mut sum = 0.0;
            decode_all(&file, &Limits::default(), |event| {
                if let ivg_format::Event::Bundle(bundle) = event {
                    sum += bundle
                        .iter()
                        .map(|(_, values)| match values {
                            VertexValues::Vectors(vectors) => vectors[3][0][1],
                            VertexValues::Radiance(radiance) => -radiance[0][0],
                        })
                        .sum::<f32>();
                }
            })
            .map(|()| sum)
        });
        assert_eq!((bytes, sum), (0, Ok(-(504.0 - 8.0))), "{}", encoding.name());
    }
}

/// A header of 65,535³ vertices, sealed, and what every prefix up to 100 bytes and the whole of it cost.
fn a_declared_giant_allocates_nothing() {
    let mut giant = file([2, 2, 2], Encoding::PackedOct24)[..144].to_vec();
    giant[56..62].fill(0xFF);
    giant[64..88].fill(0);
    for axis in 0..3 {
        giant[88 + 8 * axis..96 + 8 * axis].copy_from_slice(&1.0f64.to_le_bytes());
    }
    // 100 vertices a slice: records of 275 MB, and the number of bundles that follows.
    giant[116..120].copy_from_slice(&100u32.to_le_bytes());
    giant[128..132].copy_from_slice(&(65_535u64 * 65_535).div_ceil(100).to_le_bytes()[..4]);
    giant[132..136].fill(0);
    ivg_wire::seal_header(&mut giant);
    for n in (0..=100).chain([143, 144]) {
        let (bytes, verdict) = allocated(|| {
            let mut decoder = Decoder::new(Limits::default());
            match decoder.push(&giant[..n]) {
                Ok(Step::NeedMore(more)) => {
                    assert!(more <= 144, "{more} bytes asked for");
                    Verdict::NeedMore
                }
                Ok(Step::Consumed(..)) => Verdict::Ok,
                Err(error) => error.verdict(),
            }
        });
        let expected = if n < 144 { Verdict::NeedMore } else { Verdict::Limit };
        assert_eq!((bytes, verdict), (0, expected), "{n} bytes");
    }
    // The same with a reader that sets no limits: the length of the file cannot be right, and still nothing is held.
    let unlimited = Limits {
        vertices: u64::MAX,
        wire: ivg_wire::Limits { record_bytes: u32::MAX, ..ivg_wire::Limits::new() },
    };
    let (bytes, verdict) =
        allocated(|| Decoder::new(unlimited).push(&giant).map(|_| ()).map_err(|e| e.verdict()));
    assert_eq!((bytes, verdict), (0, Err(Verdict::Invalid)));
}

fn pieces_stay_within_the_bound(file: &[u8]) {
    for piece in [1, 7, 100, 4096, 100_000] {
        let mut decoder = BufferedDecoder::new(Limits::default());
        let held = Region::new(COUNTED);
        let mut received = 0;
        for part in file.chunks(piece) {
            let before = held.change();
            let now = before.bytes_allocated - before.bytes_deallocated;
            let (during, result) = allocated(|| decoder.feed(part, |_| {}));
            result.unwrap();
            received += part.len();
            assert!(now + during <= 65_536 + 3 * received, "{now} + {during} bytes after {received}");
        }
        assert!(decoder.is_finished());
    }
}
