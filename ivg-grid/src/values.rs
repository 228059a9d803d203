//! The values of all vertices in memory: irradiance vectors or radiance harmonics.

use ivg_format::{HemisphereVectors, Quantity, RadianceHarmonics, Values, VertexValues};

/// One value a vertex in order of the linear index, of the one quantity or the other.
#[derive(Clone, Debug, PartialEq)]
pub enum GridValues {
    /// Irradiance vectors \[W/m²\].
    Vectors(Vec<HemisphereVectors>),
    /// Radiance harmonics \[W/(m² sr)\].
    Radiance(Vec<RadianceHarmonics>),
}

impl GridValues {
    /// Darkness at `count` vertices; `None` if there is not enough memory.
    pub(crate) fn dark(quantity: Quantity, count: usize) -> Option<Self> {
        match quantity {
            Quantity::Vectors => dark(count, [[[0.0; 3]; 3]; 6]).map(Self::Vectors),
            Quantity::Radiance => dark(count, [[0.0; 9]; 3]).map(Self::Radiance),
        }
    }

    /// Which quantity it is.
    #[must_use]
    pub fn quantity(&self) -> Quantity {
        self.borrowed().quantity()
    }

    /// The same, borrowed.
    #[must_use]
    pub fn borrowed(&self) -> Values<'_> {
        match self {
            Self::Vectors(vectors) => Values::Vectors(vectors),
            Self::Radiance(radiance) => Values::Radiance(radiance),
        }
    }

    /// Number of vertices.
    #[must_use]
    pub fn len(&self) -> usize {
        self.borrowed().len()
    }

    /// Whether there is no vertex.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The numbers of all vertices, one after the other.
    pub(crate) fn numbers(&self) -> &[f32] {
        match self {
            Self::Vectors(vectors) => vectors.as_flattened().as_flattened().as_flattened(),
            Self::Radiance(radiance) => radiance.as_flattened().as_flattened(),
        }
    }

    /// The same, to be changed.
    pub(crate) fn numbers_mut(&mut self) -> &mut [f32] {
        match self {
            Self::Vectors(vectors) => vectors.as_flattened_mut().as_flattened_mut().as_flattened_mut(),
            Self::Radiance(radiance) => radiance.as_flattened_mut().as_flattened_mut(),
        }
    }

    /// Puts the values of a vertex in place.
    ///
    /// # Panics
    ///
    /// If there is no such vertex, or the values are of the other quantity.
    pub(crate) fn put(&mut self, index: usize, values: &VertexValues) {
        match (self, values) {
            (Self::Vectors(all), VertexValues::Vectors(one)) => all[index] = *one,
            (Self::Radiance(all), VertexValues::Radiance(one)) => all[index] = *one,
            (all, one) => panic!("{} in a grid of {}", one.quantity().name(), all.quantity().name()),
        }
    }
}

impl From<Vec<HemisphereVectors>> for GridValues {
    fn from(vectors: Vec<HemisphereVectors>) -> Self {
        Self::Vectors(vectors)
    }
}

impl From<Vec<RadianceHarmonics>> for GridValues {
    fn from(radiance: Vec<RadianceHarmonics>) -> Self {
        Self::Radiance(radiance)
    }
}

/// Not `vec!`: there, running out of memory ends the process.
fn dark<T: Clone>(count: usize, value: T) -> Option<Vec<T>> {
    let mut values = Vec::new();
    values.try_reserve_exact(count).ok()?;
    values.resize(count, value);
    Some(values)
}
