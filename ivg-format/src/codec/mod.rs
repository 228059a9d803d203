//! The encodings: how the values of a vertex become bytes and back. Each file knows how a payload is laid out, which bytes
//! are forbidden, and how numbers are read; `prepare` holds what writing needs to know of a whole grid.
//!
//! Reading goes in chunks of some vertices, kept as arrays of one component each, so that every step is a loop over plain
//! numbers: that is what compilers turn into vector instructions, on any processor and without unsafe code.

mod harmonics;
mod packed;
mod pair;
mod prepare;
mod products;
mod vectors;

use crate::encoding::Encoding;
use crate::quant::direction::Octahedral24;
use crate::quant::xyz::Xyz24;
use crate::values::{HemisphereVectors, RadianceHarmonics};
use ivg_wire::Code;
use packed::Packed;
use pair::{Half, Pair, Single};
pub(crate) use prepare::{Fault, Prepared, Scale};

/// Hemispheres of a vertex.
pub(crate) const HEMISPHERES: usize = 6;

/// Direction and colour of each hemisphere of a vertex.
pub(crate) type Pairs = [([f32; 3], [f32; 3]); HEMISPHERES];

/// A rule of an encoding that a payload breaks, and where in the payload.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Broken {
    pub(crate) code: Code,
    pub(crate) at: usize,
}

/// The payload of `len` vertices, in an encoding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Payload<'a> {
    pub(crate) bytes: &'a [u8],
    pub(crate) len: usize,
    pub(crate) encoding: Encoding,
    pub(crate) scale_exponent: i16,
}

impl Payload<'_> {
    /// Finds the first thing that no file of this encoding may hold.
    pub(crate) fn check(&self) -> Result<(), Broken> {
        let Self { bytes, len, encoding, scale_exponent } = *self;
        match encoding {
            Encoding::PackedOct24 => Packed::<Octahedral24>::of(bytes, len, scale_exponent).check(),
            Encoding::PackedXyz24 => Packed::<Xyz24>::of(bytes, len, scale_exponent).check(),
            Encoding::PairF16 => Pair::<Half<3>>::of(bytes, len, scale_exponent).check(),
            Encoding::PairF16x4 => Pair::<Half<4>>::of(bytes, len, scale_exponent).check(),
            Encoding::PairF32 => Pair::<Single>::of(bytes, len, scale_exponent).check(),
            Encoding::VectorsF32 => vectors::check(bytes, scale_exponent),
            Encoding::Sh2 => harmonics::check(bytes, len),
        }
    }

    /// Reads the irradiance vectors of the vertices from `first` on; `false` if the encoding has none.
    pub(crate) fn read_vectors(&self, first: usize, out: &mut [HemisphereVectors]) -> bool {
        let Self { bytes, len, encoding, scale_exponent } = *self;
        match encoding {
            Encoding::PackedOct24 => {
                products::read(&Packed::<Octahedral24>::of(bytes, len, scale_exponent), first, out);
            }
            Encoding::PackedXyz24 => {
                products::read(&Packed::<Xyz24>::of(bytes, len, scale_exponent), first, out);
            }
            Encoding::PairF16 => products::read(&Pair::<Half<3>>::of(bytes, len, scale_exponent), first, out),
            Encoding::PairF16x4 => {
                products::read(&Pair::<Half<4>>::of(bytes, len, scale_exponent), first, out);
            }
            Encoding::PairF32 => products::read(&Pair::<Single>::of(bytes, len, scale_exponent), first, out),
            Encoding::VectorsF32 => vectors::read(bytes, first, scale_exponent, out),
            Encoding::Sh2 => return false,
        }
        true
    }

    /// Reads the radiance harmonics of the vertices from `first` on; `false` if the encoding has none.
    pub(crate) fn read_radiance(&self, first: usize, out: &mut [RadianceHarmonics]) -> bool {
        if self.encoding == Encoding::Sh2 {
            harmonics::read(self.bytes, self.len, first, self.scale_exponent, out);
        }
        self.encoding == Encoding::Sh2
    }

    /// Direction and scaled colour of each hemisphere of vertex `n`, for the encodings that store these.
    pub(crate) fn pairs(&self, n: usize) -> Option<Pairs> {
        let Self { bytes, len, encoding, scale_exponent } = *self;
        match encoding {
            Encoding::PackedOct24 => {
                Some(products::pairs(&Packed::<Octahedral24>::of(bytes, len, scale_exponent), n))
            }
            Encoding::PackedXyz24 => {
                Some(products::pairs(&Packed::<Xyz24>::of(bytes, len, scale_exponent), n))
            }
            Encoding::PairF16 => Some(products::pairs(&Pair::<Half<3>>::of(bytes, len, scale_exponent), n)),
            Encoding::PairF16x4 => Some(products::pairs(&Pair::<Half<4>>::of(bytes, len, scale_exponent), n)),
            Encoding::PairF32 => Some(products::pairs(&Pair::<Single>::of(bytes, len, scale_exponent), n)),
            Encoding::VectorsF32 | Encoding::Sh2 => None,
        }
    }
}
