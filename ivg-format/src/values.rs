//! What a vertex of the grid holds: one of two quantities, as plain numbers.

/// Irradiance vectors `[hemisphere +x −x +y −y +z −z][rgb][xyz]` \[W/m², or lux\], in binary32.
pub type HemisphereVectors = [[[f32; 3]; 3]; 6];

/// Indirect radiance as real spherical harmonics to degree 2, `[rgb][coefficient]` \[W/(m² sr), or cd/m²\], in
/// binary32: the coefficients of the orthonormal basis in the order (0,0), (1,−1), (1,0), (1,1), (2,−2) … (2,2)
/// (IVG-SH-01).
pub type RadianceHarmonics = [[f32; 9]; 3];

/// What the numbers of a vertex are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Six irradiance vectors for each colour channel: [`HemisphereVectors`].
    #[default]
    Vectors,
    /// Nine spherical harmonics of the radiance for each colour channel: [`RadianceHarmonics`].
    Radiance,
}

impl Quantity {
    /// What it is called in messages and reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Vectors => "irradiance vectors",
            Self::Radiance => "radiance harmonics",
        }
    }
}

/// The values of all vertices in order of the linear index, borrowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Values<'a> {
    /// Irradiance vectors.
    Vectors(&'a [HemisphereVectors]),
    /// Radiance harmonics.
    Radiance(&'a [RadianceHarmonics]),
}

impl Values<'_> {
    /// Which of the two they are.
    #[must_use]
    pub const fn quantity(&self) -> Quantity {
        match self {
            Self::Vectors(_) => Quantity::Vectors,
            Self::Radiance(_) => Quantity::Radiance,
        }
    }

    /// Number of vertices.
    #[must_use]
    pub const fn len(&self) -> usize {
        match self {
            Self::Vectors(vectors) => vectors.len(),
            Self::Radiance(radiance) => radiance.len(),
        }
    }

    /// Whether there is no vertex.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl<'a> From<&'a [HemisphereVectors]> for Values<'a> {
    fn from(vectors: &'a [HemisphereVectors]) -> Self {
        Self::Vectors(vectors)
    }
}

impl<'a> From<&'a [RadianceHarmonics]> for Values<'a> {
    fn from(radiance: &'a [RadianceHarmonics]) -> Self {
        Self::Radiance(radiance)
    }
}

impl<'a> From<&'a alloc::vec::Vec<HemisphereVectors>> for Values<'a> {
    fn from(vectors: &'a alloc::vec::Vec<HemisphereVectors>) -> Self {
        Self::Vectors(vectors)
    }
}

impl<'a> From<&'a alloc::vec::Vec<RadianceHarmonics>> for Values<'a> {
    fn from(radiance: &'a alloc::vec::Vec<RadianceHarmonics>) -> Self {
        Self::Radiance(radiance)
    }
}

impl<'a, const N: usize> From<&'a [HemisphereVectors; N]> for Values<'a> {
    fn from(vectors: &'a [HemisphereVectors; N]) -> Self {
        Self::Vectors(vectors)
    }
}

impl<'a, const N: usize> From<&'a [RadianceHarmonics; N]> for Values<'a> {
    fn from(radiance: &'a [RadianceHarmonics; N]) -> Self {
        Self::Radiance(radiance)
    }
}

/// The values of one vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum VertexValues {
    /// Irradiance vectors.
    Vectors(HemisphereVectors),
    /// Radiance harmonics.
    Radiance(RadianceHarmonics),
}

impl VertexValues {
    /// Which of the two they are.
    #[must_use]
    pub const fn quantity(&self) -> Quantity {
        match self {
            Self::Vectors(_) => Quantity::Vectors,
            Self::Radiance(_) => Quantity::Radiance,
        }
    }
}

impl From<&HemisphereVectors> for VertexValues {
    fn from(vectors: &HemisphereVectors) -> Self {
        Self::Vectors(*vectors)
    }
}

impl From<&RadianceHarmonics> for VertexValues {
    fn from(radiance: &RadianceHarmonics) -> Self {
        Self::Radiance(*radiance)
    }
}
