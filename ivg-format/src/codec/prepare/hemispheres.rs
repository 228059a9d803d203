//! Directions and colours on their way to bytes: packed in the order of the lattice, written in that of the records. What is
//! kept of a hemisphere in between is as little as the scale exponent, known only after all, leaves open.

use super::super::HEMISPHERES;
use super::super::packed::{COLOUR_BYTES, DIRECTION_BYTES};
use super::keep::{Keep, Largest, Packed};
use super::{Fault, GATHERED, Scale, settle};
use crate::header::SCALE_EXPONENTS;
use crate::quant::pack::pack_hemisphere;
use crate::quant::pair::{HalfDirection, SingleDirection};
use crate::quant::{half, power_of_two, power_of_two_f64, rgb9e5};
use crate::values::HemisphereVectors;
use alloc::vec::Vec;

/// Vertices that are packed at once.
const VERTICES: usize = 16;

/// Direction and colour of all hemispheres.
pub(crate) struct Hemispheres<'a, Q: Keep> {
    vectors: &'a [HemisphereVectors],
    kept: Vec<[Q::Kept; HEMISPHERES]>,
    scale_exponent: i16,
}

impl<'a, Q: Keep> Hemispheres<'a, Q> {
    pub(super) fn new(vectors: &'a [HemisphereVectors], scale: Scale) -> Result<Self, Fault> {
        // Colours of binary32 are not scaled (IVG-HDR-04).
        let highest = if Q::STORABLE == f32::MAX { 0 } else { *SCALE_EXPONENTS.end() };
        let limit = f64::from(Q::STORABLE) * power_of_two_f64(i32::from(highest));
        let mut kept = Vec::with_capacity(vectors.len());
        let mut largest = Largest::NONE;
        let mut largest_rest = Largest::NONE;
        let (chunks, rest) = vectors.as_chunks::<VERTICES>();
        let (ones, _) = rest.as_chunks::<1>();
        for chunk in chunks {
            append::<Q, VERTICES>(&mut kept, chunk, &mut largest, limit)?;
        }
        for one in ones {
            append::<Q, 1>(&mut kept, one, &mut largest_rest, limit)?;
        }
        let ((least, most), (least_rest, most_rest)) = (largest.bounds(), largest_rest.bounds());
        let mut scale_exponent = settle(most.max(most_rest), Q::STORABLE, scale);
        if scale_exponent != settle(least.max(least_rest), Q::STORABLE, scale) {
            scale_exponent = settle(exactly_largest::<Q>(vectors), Q::STORABLE, scale);
        }
        Ok(Self { vectors, kept, scale_exponent: scale_exponent? })
    }

    pub(super) fn scale_exponent(&self) -> i16 {
        self.scale_exponent
    }

    /// The colour of a hemisphere, divided by the scale, which is exact: for what the number kept cannot give.
    #[cold]
    fn colour(&self, vertex: usize, hemisphere: usize) -> [f64; 3] {
        let scale = power_of_two_f64(-i32::from(self.scale_exponent));
        let packed = pack_hemisphere::<Q>(&self.vectors[vertex][hemisphere], hemisphere);
        packed.map_or([0.0; 3], |packed| packed.colour.map(|c| c * scale))
    }

    /// Fills the colours, then the directions of a payload.
    #[inline(always)]
    fn fill_both<const COLOUR: usize, const DIRECTION: usize>(
        &self,
        payload: &mut [u8],
        vertices: &[u64],
        bytes: impl Fn(usize, usize, &Q::Kept) -> ([u8; COLOUR], [u8; DIRECTION]),
    ) {
        let hemispheres = payload.len() / (COLOUR + DIRECTION);
        let (colours, directions) = payload.split_at_mut(hemispheres * COLOUR);
        let colours = colours.as_chunks_mut::<COLOUR>().0.as_chunks_mut::<HEMISPHERES>().0;
        let directions = directions.as_chunks_mut::<DIRECTION>().0.as_chunks_mut::<HEMISPHERES>().0;
        let mut gathered = [[Q::Kept::default(); HEMISPHERES]; GATHERED];
        let colours = colours.chunks_mut(GATHERED);
        let directions = directions.chunks_mut(GATHERED);
        for ((colours, directions), vertices) in colours.zip(directions).zip(vertices.chunks(GATHERED)) {
            gathered.iter_mut().zip(vertices).for_each(|(to, &vertex)| *to = self.kept[vertex as usize]);
            let places = colours.iter_mut().zip(directions).zip(vertices);
            for (((colours, directions), &vertex), kept) in places.zip(&gathered) {
                for h in 0..HEMISPHERES {
                    (colours[h], directions[h]) = bytes(vertex as usize, h, &kept[h]);
                }
            }
        }
    }
}

impl<Q: Keep<Kept = Packed>> Hemispheres<'_, Q> {
    #[cold]
    fn packed_colour(&self, vertex: usize, hemisphere: usize) -> u32 {
        let [code] = rgb9e5::encode_all(&self.colour(vertex, hemisphere).map(|c| [c]));
        code
    }

    pub(super) fn fill_packed(&self, payload: &mut [u8], vertices: &[u64]) {
        self.fill_both::<COLOUR_BYTES, DIRECTION_BYTES>(payload, vertices, |vertex, hemisphere, kept| {
            let colour = kept.colour().scaled(self.scale_exponent);
            let colour = colour.unwrap_or_else(|| self.packed_colour(vertex, hemisphere));
            let [low, middle, high, _] = kept.direction.to_le_bytes();
            (colour.to_le_bytes(), [low, middle, high])
        });
    }
}

impl Hemispheres<'_, HalfDirection> {
    /// `BYTES` for three numbers and the zeros behind them.
    pub(super) fn fill_half<const BYTES: usize>(&self, payload: &mut [u8], vertices: &[u64]) {
        /// At this and higher scale exponents, what is subnormal in binary32 becomes 0 in binary16: 2^-126 / 2^-100 is less
        /// than half of 2^-24. Everything else keeps its 24 bits when it is scaled.
        const SCALABLE: i16 = -100;
        let bytes = |numbers: [u16; 3]| little_endian::<2, BYTES>(numbers.map(u16::to_le_bytes));
        let scale = power_of_two(-i32::from(self.scale_exponent));
        self.fill_both::<BYTES, BYTES>(payload, vertices, |vertex, hemisphere, kept| {
            // To binary32 first: no hardware rounds binary64 to binary16.
            let colour = if self.scale_exponent >= SCALABLE {
                kept.colour.map(|c| c * scale)
            } else {
                self.colour(vertex, hemisphere).map(|c| c as f32)
            };
            (bytes(colour.map(half::from_f32)), bytes(kept.direction))
        });
    }
}

impl Hemispheres<'_, SingleDirection> {
    pub(super) fn fill_single(&self, payload: &mut [u8], vertices: &[u64]) {
        let bytes = |numbers: [f32; 3]| little_endian::<4, 12>(numbers.map(f32::to_le_bytes));
        self.fill_both::<12, 12>(payload, vertices, |_, _, kept| (bytes(kept.colour), bytes(kept.direction)));
    }
}

/// The bytes of three numbers, and zeros behind them.
fn little_endian<const NUMBER: usize, const ALL: usize>(numbers: [[u8; NUMBER]; 3]) -> [u8; ALL] {
    let mut bytes = [0; ALL];
    bytes.iter_mut().zip(numbers.as_flattened()).for_each(|(to, from)| *to = *from);
    bytes
}

/// The largest component of a colour: where its bounds leave open which scale exponent it needs.
#[cold]
fn exactly_largest<Q: Keep>(vectors: &[HemisphereVectors]) -> f64 {
    let hemispheres = vectors.iter().flat_map(|vertex| vertex.iter().enumerate());
    let packed = hemispheres.filter_map(|(h, vectors)| pack_hemisphere::<Q>(vectors, h));
    packed.flat_map(|packed| packed.colour).fold(0.0, f64::max)
}

/// Packs every hemisphere of some vertices, which must be finite and their colours no more than the limit.
fn append<Q: Keep, const N: usize>(
    kept: &mut Vec<[Q::Kept; HEMISPHERES]>,
    vectors: &[HemisphereVectors; N],
    largest: &mut Largest<N>,
    limit: f64,
) -> Result<(), Fault> {
    let mut vertices = [[Q::Kept::default(); HEMISPHERES]; N];
    let mut finite = true;
    for hemisphere in 0..HEMISPHERES {
        finite &= Q::keep_all(vectors, hemisphere, &mut vertices, largest);
    }
    // What is not exact is far from the limit.
    if !finite || largest.exact.iter().fold(false, |any, &c| any | (c > limit)) {
        return Err(fault::<Q>(kept.len(), vectors, limit));
    }
    kept.extend_from_slice(&vertices);
    Ok(())
}

/// What is wrong with the first vertex and hemisphere of which something is.
#[cold]
fn fault<Q: Keep>(first: usize, vectors: &[HemisphereVectors], limit: f64) -> Fault {
    for (vertex, vectors) in (first..).zip(vectors) {
        for (hemisphere, vectors) in vectors.iter().enumerate() {
            match pack_hemisphere::<Q>(vectors, hemisphere) {
                None => return Fault::NotFinite(vertex, hemisphere),
                Some(packed) if packed.colour.iter().any(|&c| c > limit) => {
                    return Fault::TooLarge(vertex, hemisphere);
                }
                Some(_) => {}
            }
        }
    }
    unreachable!("some hemisphere was at fault")
}
