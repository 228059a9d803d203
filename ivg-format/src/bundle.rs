//! A bundle: the irradiance vectors of some vertices, as a window into the caller's bytes.

use crate::code::codes;
use crate::encoding::Encoding;
use crate::header::{Header, RecordId};
use crate::order::BundleVertices;
use crate::quant::direction::{decode_valid, is_valid};
use crate::quant::{pack::unpack, power_of_two, rgb9e5};
use ivg_wire::{ByteOffset, Error, Part};

/// Irradiance vectors `[hemisphere +x −x +y −y +z −z][rgb][xyz]` \[W/m², or lux\], in binary32.
pub type HemisphereVectors = [[[f32; 3]; 3]; 6];

/// Indirect radiance as real spherical harmonics to degree 2, `[rgb][coefficient]` \[W/(m² sr)\], in binary32: the
/// coefficients of the orthonormal basis in the order (0,0), (1,−1), (1,0), (1,1), (2,−2) … (2,2) (IVG-SH-01).
pub type RadianceHarmonics = [[f32; 9]; 3];

/// Directions in each hemisphere of a vertex.
const HEMISPHERES: usize = 6;

/// Bytes of a direction code.
const DIRECTION_BYTES: usize = 3;

/// Binary32 numbers of a vertex in `vectors-f32`.
const COMPONENTS: usize = 54;

/// The vertices of one record, corners or a bundle, with their irradiance vectors. Its bytes have been
/// checked, so that reading them cannot fail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bundle<'a> {
    header: &'a Header,
    id: RecordId,
    generation: u32,
    payload: &'a [u8],
    len: usize,
}

impl<'a> Bundle<'a> {
    /// Checks a payload whose length is the one that the header gives.
    pub(crate) fn check(
        header: &'a Header,
        id: RecordId,
        generation: u32,
        payload: &'a [u8],
        offset: ByteOffset,
    ) -> Result<Self, Error> {
        let len = header.record_vertices(id) as usize;
        let bundle = Self { header, id, generation, payload, len };
        let wrong = match header.encoding {
            Encoding::PackedOct24 => bundle
                .directions()
                .chunks_exact(DIRECTION_BYTES)
                .position(|code| !is_valid(direction_code(code)))
                .map(|n| {
                    (codes::DIRECTION_CODE, payload.len() - bundle.directions().len() + n * DIRECTION_BYTES)
                }),
            Encoding::VectorsF32 => {
                let scale = bundle.scale();
                payload
                    .chunks_exact(4)
                    .position(|bytes| !(component(bytes) * scale).is_finite())
                    .map(|n| (codes::NOT_FINITE, n * 4))
            }
        };
        match wrong {
            None => Ok(bundle),
            Some((code, at)) => {
                Err(Error::new(code, ByteOffset(offset.0 + at as u64), Part::Record(id.stored())))
            }
        }
    }

    /// The header of the file.
    #[must_use]
    pub const fn header(&self) -> &'a Header {
        self.header
    }

    /// Which record this is.
    #[must_use]
    pub const fn id(&self) -> RecordId {
        self.id
    }

    /// The record's generation: of two with one id, the higher counts.
    #[must_use]
    pub const fn generation(&self) -> u32 {
        self.generation
    }

    /// Number of vertices.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Whether the bundle has no vertex; a file has no such bundle.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The stored bytes.
    #[must_use]
    pub const fn payload(&self) -> &'a [u8] {
        self.payload
    }

    /// Linear indices of the vertices, in stored order.
    #[must_use]
    pub fn vertices(&self) -> Vertices {
        match self.id {
            RecordId::Bundle(k) => Vertices(Source::Bundle(self.header.bundle_vertices(k))),
            _ => {
                let mut corners = [0; 8];
                for (to, from) in corners.iter_mut().zip(self.header.lattice.corners()) {
                    *to = from;
                }
                Vertices(Source::Corners { corners, next: 0, count: self.len })
            }
        }
    }

    /// Irradiance vectors of the bundle's vertex `n`.
    ///
    /// # Panics
    ///
    /// If `n` is not less than [`Bundle::len`].
    #[must_use]
    pub fn vectors(&self, n: usize) -> HemisphereVectors {
        assert!(n < self.len, "vertex {n} of a bundle of {}", self.len);
        match self.header.encoding {
            Encoding::PackedOct24 => core::array::from_fn(|h| {
                let (direction, colour) = self.hemisphere(n, h);
                unpack(direction, colour)
            }),
            Encoding::VectorsF32 => {
                let scale = self.scale();
                let start = n * COMPONENTS * 4;
                let numbers = &self.payload[start..start + COMPONENTS * 4];
                core::array::from_fn(|h| {
                    core::array::from_fn(|k| {
                        core::array::from_fn(|i| {
                            let at = (h * 9 + k * 3 + i) * 4;
                            component(&numbers[at..at + 4]) * scale
                        })
                    })
                })
            }
        }
    }

    /// Direction and colour \[W/m², or lux\] of each hemisphere of the bundle's vertex `n`, for the packed
    /// encodings; `None` for others.
    ///
    /// # Panics
    ///
    /// If `n` is not less than [`Bundle::len`].
    #[must_use]
    pub fn packed(&self, n: usize) -> Option<[([f32; 3], [f32; 3]); 6]> {
        assert!(n < self.len, "vertex {n} of a bundle of {}", self.len);
        match self.header.encoding {
            Encoding::PackedOct24 => Some(core::array::from_fn(|h| self.hemisphere(n, h))),
            Encoding::VectorsF32 => None,
        }
    }

    /// Every vertex with its irradiance vectors, in stored order.
    pub fn iter(&self) -> impl Iterator<Item = (u64, HemisphereVectors)> + use<'a> {
        let bundle = *self;
        bundle.vertices().enumerate().map(move |(n, vertex)| (vertex, bundle.vectors(n)))
    }

    /// For validators: the first direction that is not strictly inside its hemisphere, as vertex and hemisphere
    /// (IVG-PACK-03). Readers accept such a bundle; no writer should have made it.
    #[must_use]
    pub fn outside_hemisphere(&self) -> Option<(u64, usize)> {
        let vertices = self.vertices().zip(0..self.len);
        vertices.flat_map(|(vertex, n)| (0..HEMISPHERES).map(move |h| (vertex, n, h))).find_map(
            |(vertex, n, h)| {
                let directions = self.packed(n)?;
                let along = directions[h].0[h / 2];
                let inside = if h.is_multiple_of(2) { along > 0.0 } else { along < 0.0 };
                (!inside).then_some((vertex, h))
            },
        )
    }

    fn hemisphere(&self, n: usize, h: usize) -> ([f32; 3], [f32; 3]) {
        let at = n * HEMISPHERES + h;
        let colour = component_code(&self.payload[at * 4..at * 4 + 4]);
        let code = &self.directions()[at * DIRECTION_BYTES..at * DIRECTION_BYTES + DIRECTION_BYTES];
        (decode_valid(direction_code(code)), rgb9e5::decode_scaled(colour, self.header.scale_exponent))
    }

    /// The direction codes of a packed payload: behind the colours.
    fn directions(&self) -> &'a [u8] {
        self.payload.get(self.len * HEMISPHERES * 4..).unwrap_or(&[])
    }

    fn scale(&self) -> f32 {
        power_of_two(i32::from(self.header.scale_exponent))
    }
}

fn component_code(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |number, &b| number << 8 | u32::from(b))
}

fn component(bytes: &[u8]) -> f32 {
    f32::from_bits(component_code(bytes))
}

fn direction_code(bytes: &[u8]) -> u32 {
    component_code(bytes)
}

/// The vertices of a record, in stored order: an iterator over linear indices.
#[derive(Clone, Debug)]
pub struct Vertices(Source);

#[derive(Clone, Debug)]
enum Source {
    /// The first `count` of `corners`, from `next` on.
    Corners {
        corners: [u64; 8],
        next: usize,
        count: usize,
    },
    Bundle(BundleVertices),
}

impl Iterator for Vertices {
    type Item = u64;

    fn next(&mut self) -> Option<u64> {
        match &mut self.0 {
            Source::Corners { corners, next, count } => {
                let vertex = corners.get(*next).copied().filter(|_| next < count);
                *next += usize::from(vertex.is_some());
                vertex
            }
            Source::Bundle(vertices) => vertices.next(),
        }
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        match &self.0 {
            Source::Corners { next, count, .. } => (count - next, Some(count - next)),
            Source::Bundle(vertices) => vertices.size_hint(),
        }
    }
}

impl ExactSizeIterator for Vertices {}
