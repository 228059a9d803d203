//! A bundle: the irradiance vectors of some vertices, as a window into the caller's bytes.

use crate::codec::{Broken, HEMISPHERES, Payload};
use crate::encoding::Order;
use crate::header::{Header, RecordId};
use crate::order::BundleVertices;
use crate::order::explicit::{self, Listed};
use crate::values::{HemisphereVectors, Quantity, RadianceHarmonics, VertexValues};
use ivg_wire::{ByteOffset, Error, Part};

/// The vertices of one record, corners or a bundle, with their values. Its bytes have been
/// checked, so that reading them cannot fail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bundle<'a> {
    header: &'a Header,
    id: RecordId,
    generation: u32,
    /// The list of vertices, where the order is `explicit`.
    index: &'a [u8],
    /// The values.
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
        let index_bytes = header.index_bytes(id) as usize;
        let Some((index, payload)) = payload.split_at_checked(index_bytes) else {
            return Err(Error::new(ivg_wire::codes::RECORD_LENGTH, offset, Part::Record(id.stored())));
        };
        if let RecordId::Bundle(k) = id
            && header.order == Order::Explicit
        {
            explicit::check(&header.lattice, k, index, len, offset)?;
        }
        let offset = ByteOffset(offset.0.saturating_add(index_bytes as u64));
        let bundle = Self { header, id, generation, index, payload, len };
        match bundle.stored().check() {
            Ok(()) => Ok(bundle),
            Err(Broken { code, at }) => {
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

    /// The stored list of vertices of a bundle of the order `explicit`; empty for others.
    #[must_use]
    pub const fn index(&self) -> &'a [u8] {
        self.index
    }

    /// The stored bytes of the values.
    #[must_use]
    pub const fn payload(&self) -> &'a [u8] {
        self.payload
    }

    /// Linear indices of the vertices, in stored order.
    #[must_use]
    pub fn vertices(&self) -> Vertices<'a> {
        let implied = match self.id {
            RecordId::Bundle(k) => Some(self.header.bundle_vertices(k)),
            _ => None,
        };
        match implied {
            Some(Some(vertices)) => Vertices(Source::Bundle(vertices)),
            Some(None) => Vertices(Source::Listed(Listed::new(self.index, self.len))),
            None => {
                let mut corners = [0; 8];
                for (to, from) in corners.iter_mut().zip(self.header.lattice.corners()) {
                    *to = from;
                }
                Vertices(Source::Corners { corners, next: 0, count: self.len })
            }
        }
    }

    /// The values of the bundle's vertex `n`.
    ///
    /// # Panics
    ///
    /// If `n` is not less than [`Bundle::len`].
    #[must_use]
    pub fn values(&self, n: usize) -> VertexValues {
        match self.header.encoding.quantity() {
            Quantity::Vectors => VertexValues::Vectors(self.vectors(n)),
            Quantity::Radiance => VertexValues::Radiance(self.radiance(n)),
        }
    }

    /// Irradiance vectors of the bundle's vertex `n`. [`Bundle::read_vectors`] is faster for many.
    ///
    /// # Panics
    ///
    /// If `n` is not less than [`Bundle::len`], or the encoding holds [`Quantity::Radiance`].
    #[must_use]
    pub fn vectors(&self, n: usize) -> HemisphereVectors {
        let mut vertex = [HemisphereVectors::default()];
        self.read_vectors(n, &mut vertex);
        let [vertex] = vertex;
        vertex
    }

    /// Radiance harmonics of the bundle's vertex `n`. [`Bundle::read_radiance`] is faster for many.
    ///
    /// # Panics
    ///
    /// If `n` is not less than [`Bundle::len`], or the encoding holds [`Quantity::Vectors`].
    #[must_use]
    pub fn radiance(&self, n: usize) -> RadianceHarmonics {
        let mut vertex = [RadianceHarmonics::default()];
        self.read_radiance(n, &mut vertex);
        let [vertex] = vertex;
        vertex
    }

    /// Reads the irradiance vectors of `out.len()` vertices, from the bundle's vertex `first` on. Some tens at a time are
    /// several times as fast as one by one.
    ///
    /// # Panics
    ///
    /// If the bundle has fewer vertices than that, or the encoding holds [`Quantity::Radiance`].
    pub fn read_vectors(&self, first: usize, out: &mut [HemisphereVectors]) {
        self.expect(first, out.len());
        let found = self.stored().read_vectors(first, out);
        assert!(found, "{} holds no irradiance vectors", self.header.encoding.name());
    }

    /// Reads the radiance harmonics of `out.len()` vertices, from the bundle's vertex `first` on. Some tens at a time are
    /// several times as fast as one by one.
    ///
    /// # Panics
    ///
    /// If the bundle has fewer vertices than that, or the encoding holds [`Quantity::Vectors`].
    pub fn read_radiance(&self, first: usize, out: &mut [RadianceHarmonics]) {
        self.expect(first, out.len());
        let found = self.stored().read_radiance(first, out);
        assert!(found, "{} holds no radiance harmonics", self.header.encoding.name());
    }

    /// Direction and colour \[W/m², or lux\] of each hemisphere of the bundle's vertex `n`, for the encodings that
    /// store these; `None` for others.
    ///
    /// # Panics
    ///
    /// If `n` is not less than [`Bundle::len`].
    #[must_use]
    pub fn packed(&self, n: usize) -> Option<[([f32; 3], [f32; 3]); 6]> {
        self.expect(n, 1);
        self.stored().pairs(n)
    }

    fn expect(&self, first: usize, count: usize) {
        let enough = first.checked_add(count).is_some_and(|end| end <= self.len);
        assert!(enough, "{count} vertices from {first} on, of a bundle of {}", self.len);
    }

    fn stored(&self) -> Payload<'a> {
        Payload {
            bytes: self.payload,
            len: self.len,
            encoding: self.header.encoding,
            scale_exponent: self.header.scale_exponent,
        }
    }

    /// Every vertex with its values, in stored order.
    pub fn iter(&self) -> impl Iterator<Item = (u64, VertexValues)> + use<'a> {
        let bundle = *self;
        bundle.vertices().enumerate().map(move |(n, vertex)| (vertex, bundle.values(n)))
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
}

/// The vertices of a record, in stored order: an iterator over linear indices.
#[derive(Clone, Debug)]
pub struct Vertices<'a>(Source<'a>);

#[derive(Clone, Debug)]
enum Source<'a> {
    /// The first `count` of `corners`, from `next` on.
    Corners {
        corners: [u64; 8],
        next: usize,
        count: usize,
    },
    Bundle(BundleVertices),
    Listed(Listed<'a>),
}

impl Iterator for Vertices<'_> {
    type Item = u64;

    fn next(&mut self) -> Option<u64> {
        match &mut self.0 {
            Source::Corners { corners, next, count } => {
                let vertex = corners.get(*next).copied().filter(|_| next < count);
                *next += usize::from(vertex.is_some());
                vertex
            }
            Source::Bundle(vertices) => vertices.next(),
            Source::Listed(vertices) => vertices.next(),
        }
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        match &self.0 {
            Source::Corners { next, count, .. } => (count - next, Some(count - next)),
            Source::Bundle(vertices) => vertices.size_hint(),
            Source::Listed(vertices) => (vertices.left(), Some(vertices.left())),
        }
    }
}

impl ExactSizeIterator for Vertices<'_> {}
