//! Directions and colours on their way to bytes: packed in the order of the lattice, written in that of the records. What is
//! kept of a hemisphere in between is as little as the scale exponent, known only after all, leaves open.

use super::super::HEMISPHERES;
use super::super::packed::{COLOUR_BYTES, DIRECTION_BYTES};
use super::{Fault, GATHERED, settle};
use crate::header::SCALE_EXPONENTS;
use crate::quant::direction::Octahedral24;
use crate::quant::direction::pack::{self, PackedTogether};
use crate::quant::pack::{DirectionQuantiser, PackedAll, pack_all, pack_hemisphere};
use crate::quant::pair::{HalfDirection, SingleDirection};
use crate::quant::rgb9e5::Unscaled;
use crate::quant::xyz::Xyz24;
use crate::quant::{half, power_of_two, power_of_two_f64, rgb9e5};
use crate::values::HemisphereVectors;
use alloc::vec::Vec;

/// Vertices that are packed at once.
const VERTICES: usize = 16;

/// What is kept of a hemisphere until it is written.
pub(crate) trait Keep: DirectionQuantiser + Sized {
    /// A direction and a colour.
    type Kept: Copy + Default;

    /// The largest number that stores a component of a colour.
    const STORABLE: f32;

    fn keep(direction: Self::Code, colour: [f64; 3]) -> Self::Kept;

    /// Keeps one hemisphere of some vertices; `false` if a component is not finite.
    fn keep_all<const N: usize>(
        vectors: &[HemisphereVectors; N],
        hemisphere: usize,
        kept: &mut [[Self::Kept; HEMISPHERES]; N],
        largest: &mut Largest<N>,
    ) -> bool {
        let PackedAll { directions, colours } = pack_all::<Self, N>(vectors, hemisphere);
        for (n, kept) in kept.iter_mut().enumerate() {
            kept[hemisphere] = Self::keep(directions[n], colours.each_ref().map(|component| component[n]));
        }
        for component in &colours {
            for (most, &c) in largest.exact.iter_mut().zip(component) {
                *most = if c > *most { c } else { *most };
            }
        }
        let finite = |all, vertex: &HemisphereVectors| {
            vertex[hemisphere].as_flattened().iter().fold(all, |all, c| all & c.is_finite())
        };
        vectors.iter().fold(true, finite)
    }
}

/// The largest components of colours, found for `N` vertices side by side.
pub(crate) struct Largest<const N: usize> {
    /// Of colours that are as they should be.
    exact: [f64; N],
    /// Of colours that are off by [`pack::ERROR`].
    near: [f32; N],
}

impl<const N: usize> Largest<N> {
    const NONE: Self = Self { exact: [0.0; N], near: [0.0; N] };

    /// The largest is no less than the first and no more than the second.
    fn bounds(&self) -> (f64, f64) {
        let exact = self.exact.iter().fold(0.0, |most: f64, &c| most.max(c));
        let near = f64::from(self.near.iter().fold(0.0, |most: f32, &c| most.max(c)));
        (exact.max(near * (1.0 - 2.0 * pack::ERROR)), exact.max(near * (1.0 + 2.0 * pack::ERROR)))
    }
}

/// A direction code of three bytes and a colour.
#[derive(Clone, Copy, Default)]
pub(crate) struct Packed {
    /// The direction's code, and in the upper eight bits the exponent of the colour.
    direction: u32,
    mantissas: u32,
}

impl Packed {
    #[inline(always)]
    fn new(direction: u32, Unscaled { mantissas, exponent }: Unscaled) -> Self {
        Self { direction: direction | u32::from(exponent) << 24, mantissas }
    }

    #[inline(always)]
    fn colour(self) -> Unscaled {
        Unscaled { mantissas: self.mantissas, exponent: (self.direction >> 24) as u8 }
    }
}

/// Direction and colour of a pair.
#[derive(Clone, Copy, Default)]
pub(crate) struct Pair<Code> {
    direction: Code,
    colour: [f32; 3],
}

impl Keep for Octahedral24 {
    type Kept = Packed;
    const STORABLE: f32 = rgb9e5::LARGEST;

    #[inline(always)]
    fn keep(direction: u32, colour: [f64; 3]) -> Packed {
        Packed::new(direction, Unscaled::new(colour))
    }

    fn keep_all<const N: usize>(
        vectors: &[HemisphereVectors; N],
        hemisphere: usize,
        kept: &mut [[Packed; HEMISPHERES]; N],
        largest: &mut Largest<N>,
    ) -> bool {
        let PackedTogether { directions, mantissas, exponents, largest: near, doubt } =
            pack::pack_together(vectors, hemisphere);
        for (n, kept) in kept.iter_mut().enumerate() {
            kept[hemisphere] =
                Packed { direction: directions[n] | exponents[n] << 24, mantissas: mantissas[n] };
        }
        for n in 0..N {
            let certain = if doubt[n] == 0 { near[n] } else { 0.0 };
            largest.near[n] = if certain > largest.near[n] { certain } else { largest.near[n] };
        }
        if doubt.iter().fold(0, |any, doubt| any | doubt) == 0 {
            return true;
        }
        let mut finite = true;
        for n in (0..N).filter(|&n| doubt[n] != 0) {
            let vectors = &vectors[n][hemisphere];
            kept[n][hemisphere] = if *vectors == [[0.0; 3]; 3] {
                let (direction, colour) = pack::black(hemisphere);
                Packed::new(direction, colour)
            } else if let Some(packed) = pack_hemisphere::<Self>(vectors, hemisphere) {
                largest.exact[n] = packed.colour.iter().fold(largest.exact[n], |most, &c| most.max(c));
                Self::keep(packed.direction, packed.colour)
            } else {
                finite = false;
                Packed::default()
            };
        }
        finite
    }
}

impl Keep for Xyz24 {
    type Kept = Packed;
    const STORABLE: f32 = rgb9e5::LARGEST;

    #[inline(always)]
    fn keep(direction: u32, colour: [f64; 3]) -> Packed {
        Packed::new(direction, Unscaled::new(colour))
    }
}

impl Keep for HalfDirection {
    type Kept = Pair<[u16; 3]>;
    const STORABLE: f32 = half::LARGEST;

    #[inline(always)]
    fn keep(direction: [u16; 3], colour: [f64; 3]) -> Self::Kept {
        Pair { direction, colour: colour.map(|c| c as f32) }
    }
}

impl Keep for SingleDirection {
    type Kept = Pair<[f32; 3]>;
    const STORABLE: f32 = f32::MAX;

    #[inline(always)]
    fn keep(direction: [f32; 3], colour: [f64; 3]) -> Self::Kept {
        Pair { direction, colour: colour.map(|c| c as f32) }
    }
}

/// Direction and colour of all hemispheres.
pub(crate) struct Hemispheres<'a, Q: Keep> {
    vectors: &'a [HemisphereVectors],
    kept: Vec<[Q::Kept; HEMISPHERES]>,
    scale_exponent: i16,
}

impl<'a, Q: Keep> Hemispheres<'a, Q> {
    pub(super) fn new(vectors: &'a [HemisphereVectors], fixed: Option<i16>) -> Result<Self, Fault> {
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
        let mut scale_exponent = settle(most.max(most_rest), Q::STORABLE, fixed);
        if scale_exponent != settle(least.max(least_rest), Q::STORABLE, fixed) {
            scale_exponent = settle(exactly_largest::<Q>(vectors), Q::STORABLE, fixed);
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
