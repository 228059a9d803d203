//! What is kept of a hemisphere between packing and writing, by encoding.

use crate::codec::HEMISPHERES;
use crate::quant::direction::Octahedral24;
use crate::quant::direction::pack::{self, PackedTogether};
use crate::quant::pack::{DirectionQuantiser, PackedAll, pack_all, pack_hemisphere};
use crate::quant::pair::{HalfDirection, SingleDirection};
use crate::quant::rgb9e5::Unscaled;
use crate::quant::xyz::Xyz24;
use crate::quant::{half, rgb9e5};
use crate::values::HemisphereVectors;

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
    pub(super) exact: [f64; N],
    /// Of colours that are off by [`pack::ERROR`].
    near: [f32; N],
}

impl<const N: usize> Largest<N> {
    pub(super) const NONE: Self = Self { exact: [0.0; N], near: [0.0; N] };

    /// The largest is no less than the first and no more than the second.
    pub(super) fn bounds(&self) -> (f64, f64) {
        let exact = self.exact.iter().fold(0.0, |most: f64, &c| most.max(c));
        let near = f64::from(self.near.iter().fold(0.0, |most: f32, &c| most.max(c)));
        (exact.max(near * (1.0 - 2.0 * pack::ERROR)), exact.max(near * (1.0 + 2.0 * pack::ERROR)))
    }
}

/// A direction code of three bytes and a colour.
#[derive(Clone, Copy, Default)]
pub(crate) struct Packed {
    /// The direction's code, and in the upper eight bits the exponent of the colour.
    pub(super) direction: u32,
    mantissas: u32,
}

impl Packed {
    #[inline(always)]
    fn new(direction: u32, Unscaled { mantissas, exponent }: Unscaled) -> Self {
        Self { direction: direction | u32::from(exponent) << 24, mantissas }
    }

    #[inline(always)]
    pub(super) fn colour(self) -> Unscaled {
        Unscaled { mantissas: self.mantissas, exponent: (self.direction >> 24) as u8 }
    }
}

/// Direction and colour of a pair.
#[derive(Clone, Copy, Default)]
pub(crate) struct Pair<Code> {
    pub(super) direction: Code,
    pub(super) colour: [f32; 3],
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
