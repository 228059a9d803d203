//! The dense grid in memory: what is known about every vertex of a lattice.

use ivg_format::{
    Arrival, ContentId, Generations, HemisphereVectors, Lattice, Quantity, RadianceHarmonics, RecordId,
    Values, VertexValues,
};

use crate::{GridError, GridValues};

/// Vertices that a grid may have unless the caller allows another number: 256³, which take 3.7 GB.
pub const DEFAULT_MAX_VERTICES: u64 = 1 << 24;

/// Validity of a vertex whose surroundings are all free. 0 means inside geometry: no light reaches the vertex.
pub const VALIDITY_FREE: u8 = 255;

/// The bits of a vertex's blocked edges that have a meaning: bit 0, 1, 2 = geometry cuts the edge to the +x, +y,
/// +z neighbour.
pub const BLOCKED_BITS: u8 = 0b111;

/// Indirect light on the vertices of a lattice, as irradiance vectors or as radiance harmonics, and what is known about
/// each vertex.
///
/// Three things are kept apart: whether a vertex was **received** (its values have arrived), whether it is **valid**
/// (light reaches it; 0 = inside geometry), and which of its **edges are blocked** (cut by geometry). A value of zero
/// is darkness, never a sign that something is missing.
///
/// A vertex is named by its linear index `i + nx (j + ny k)`.
#[derive(Clone, Debug, PartialEq)]
pub struct IrradianceGrid {
    lattice: Lattice,
    values: GridValues,
    received: BitSet,
    validity: Vec<u8>,
    blocked_edges: Vec<u8>,
    invalid_count: usize,
    blocked_count: usize,
    filled: bool,
    accepted: Accepted,
}

/// Which generation of each record of a file has been accepted. It says what to do with the next record, not what the
/// grid holds: grids are equal whatever it is.
#[derive(Clone, Debug, Default)]
struct Accepted(Generations);

impl PartialEq for Accepted {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl IrradianceGrid {
    /// A grid of irradiance vectors, of at most [`DEFAULT_MAX_VERTICES`] vertices, none received, all valid, no edge
    /// blocked.
    ///
    /// # Errors
    ///
    /// [`GridError::Lattice`] if the lattice breaks its own rules, [`GridError::TooManyVertices`] if it is too
    /// large. Nothing is allocated then.
    pub fn new(lattice: Lattice) -> Result<Self, GridError> {
        Self::of(lattice, Quantity::Vectors)
    }

    /// Like [`IrradianceGrid::new`], of either quantity.
    ///
    /// # Errors
    ///
    /// As [`IrradianceGrid::new`].
    pub fn of(lattice: Lattice, quantity: Quantity) -> Result<Self, GridError> {
        Self::with_limit(lattice, quantity, DEFAULT_MAX_VERTICES)
    }

    /// Like [`IrradianceGrid::of`], of at most `max_vertices` vertices. A vertex takes 219 bytes for irradiance vectors,
    /// 111 for radiance harmonics.
    ///
    /// # Errors
    ///
    /// As [`IrradianceGrid::new`]. Grids of 2³² vertices or more are refused whatever the limit.
    pub fn with_limit(lattice: Lattice, quantity: Quantity, max_vertices: u64) -> Result<Self, GridError> {
        let count = checked_vertices(&lattice, max_vertices)?;
        let values = GridValues::dark(quantity, count).ok_or(GridError::Memory { vertices: count })?;
        Ok(Self {
            lattice,
            values,
            received: BitSet::new(count),
            validity: vec![VALIDITY_FREE; count],
            blocked_edges: vec![0; count],
            invalid_count: 0,
            blocked_count: 0,
            filled: false,
            accepted: Accepted::default(),
        })
    }

    /// A grid whose vertices have all been received: what a baker makes.
    ///
    /// # Errors
    ///
    /// As [`IrradianceGrid::new`], and [`GridError::Length`] if there is not one element a vertex.
    pub fn from_parts(
        lattice: Lattice,
        values: impl Into<GridValues>,
        validity: Vec<u8>,
        blocked_edges: Vec<u8>,
    ) -> Result<Self, GridError> {
        let values = values.into();
        let count = checked_vertices(&lattice, u64::from(u32::MAX))?;
        check_length(values.quantity().name(), values.len(), count)?;
        check_length("validity", validity.len(), count)?;
        check_length("blocked edges", blocked_edges.len(), count)?;
        let mut received = BitSet::new(count);
        (0..count).for_each(|index| received.insert(index));
        let invalid_count = validity.iter().filter(|&&validity| validity == 0).count();
        let edges = blocked_edges.into_iter().enumerate();
        let blocked_edges: Vec<u8> =
            edges.map(|(index, bits)| bits & existing_edges(&lattice, index)).collect();
        let blocked_count = blocked_edges.iter().map(|bits| bits.count_ones() as usize).sum();
        Ok(Self {
            lattice,
            values,
            received,
            validity,
            blocked_edges,
            invalid_count,
            blocked_count,
            filled: false,
            accepted: Accepted::default(),
        })
    }

    /// Where the vertices are.
    #[must_use]
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// Number of vertices of the lattice.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.values.len()
    }

    /// Number of vertices received so far. A whole file of the order `explicit` may bring fewer than there are: vertices
    /// inside geometry are in no bundle (IVG-EXP-05). That a file is whole is what `Event::End` says.
    #[must_use]
    pub fn received_count(&self) -> usize {
        self.received.count
    }

    /// Number of vertices that light reaches.
    #[must_use]
    pub fn valid_count(&self) -> usize {
        self.vertex_count() - self.invalid_count
    }

    /// Number of edges between neighbours that geometry cuts.
    #[must_use]
    pub fn blocked_edge_count(&self) -> usize {
        self.blocked_count
    }

    /// Whether every vertex has a value because the grid came out of [`fill`](crate::fill()).
    #[must_use]
    pub fn is_filled(&self) -> bool {
        self.filled
    }

    /// Whether the vectors of a vertex have arrived.
    ///
    /// # Panics
    ///
    /// If `index` is not less than the number of vertices.
    #[must_use]
    pub fn is_received(&self, index: usize) -> bool {
        assert!(index < self.vertex_count(), "vertex {index} outside the lattice");
        self.received.contains(index)
    }

    /// Whether light reaches a vertex (validity above 0).
    ///
    /// # Panics
    ///
    /// If `index` is not less than the number of vertices.
    #[must_use]
    pub fn is_valid(&self, index: usize) -> bool {
        self.validity[index] > 0
    }

    /// Whether a vertex has a value: received, or given by [`fill`](crate::fill()).
    ///
    /// # Panics
    ///
    /// If `index` is not less than the number of vertices.
    #[must_use]
    pub fn has_value(&self, index: usize) -> bool {
        self.filled || self.is_received(index)
    }

    /// The values of a vertex, or nothing where it has none.
    #[must_use]
    pub fn get(&self, index: usize) -> Option<VertexValues> {
        if index >= self.vertex_count() || !self.has_value(index) {
            return None;
        }
        Some(match &self.values {
            GridValues::Vectors(vectors) => VertexValues::from(&vectors[index]),
            GridValues::Radiance(radiance) => VertexValues::from(&radiance[index]),
        })
    }

    /// What the values of the vertices are.
    #[must_use]
    pub fn quantity(&self) -> Quantity {
        self.values.quantity()
    }

    /// The values of all vertices in order of the linear index; zero where a vertex has none.
    #[must_use]
    pub fn values(&self) -> Values<'_> {
        self.values.borrowed()
    }

    /// The irradiance vectors of all vertices in order of the linear index; zero where a vertex has none.
    ///
    /// # Panics
    ///
    /// If the grid holds radiance harmonics.
    #[must_use]
    pub fn vectors(&self) -> &[HemisphereVectors] {
        match &self.values {
            GridValues::Vectors(vectors) => vectors,
            GridValues::Radiance(_) => panic!("a grid of radiance harmonics has no irradiance vectors"),
        }
    }

    /// The radiance harmonics of all vertices in order of the linear index; zero where a vertex has none.
    ///
    /// # Panics
    ///
    /// If the grid holds irradiance vectors.
    #[must_use]
    pub fn radiance(&self) -> &[RadianceHarmonics] {
        match &self.values {
            GridValues::Radiance(radiance) => radiance,
            GridValues::Vectors(_) => panic!("a grid of irradiance vectors has no radiance harmonics"),
        }
    }

    /// The validity of all vertices in order of the linear index: 0 inside geometry … 255 all free.
    #[must_use]
    pub fn validity(&self) -> &[u8] {
        &self.validity
    }

    /// The blocked edges of all vertices in order of the linear index: bits 0, 1, 2 for the +x, +y, +z neighbour.
    #[must_use]
    pub fn blocked_edges(&self) -> &[u8] {
        &self.blocked_edges
    }

    /// Receives the values of a vertex; a second time replaces the first.
    ///
    /// Values filled in before stay as they are: fill the grid of received vertices again.
    ///
    /// # Panics
    ///
    /// If `index` is not less than the number of vertices, or the values are of the other quantity.
    pub fn set(&mut self, index: usize, values: impl Into<VertexValues>) {
        self.values.put(index, &values.into());
        self.received.insert(index);
    }

    /// Sets the validity of a vertex: 0 inside geometry … 255 all free.
    ///
    /// # Panics
    ///
    /// If `index` is not less than the number of vertices.
    pub fn set_validity(&mut self, index: usize, validity: u8) {
        let before = std::mem::replace(&mut self.validity[index], validity);
        self.invalid_count = self.invalid_count + usize::from(validity == 0) - usize::from(before == 0);
    }

    /// Sets which edges of a vertex geometry cuts: bits 0, 1, 2 for the +x, +y, +z neighbour. Bits of neighbours that
    /// the lattice does not have are dropped, and all others.
    ///
    /// # Panics
    ///
    /// If `index` is not less than the number of vertices.
    pub fn set_blocked_edges(&mut self, index: usize, bits: u8) {
        let bits = bits & existing_edges(&self.lattice, index);
        let before = std::mem::replace(&mut self.blocked_edges[index], bits);
        self.blocked_count = self.blocked_count + bits.count_ones() as usize - before.count_ones() as usize;
    }

    /// The largest absolute number of all values \[W/m² or W/(m² sr)\]: what an upload at half precision scales by.
    #[must_use]
    pub fn largest_component(&self) -> f32 {
        self.values.numbers().iter().fold(0.0, |largest, c| largest.max(c.abs()))
    }

    /// Whether every vertex has a value and is valid, and no edge is blocked: lookups need not look at any of it.
    pub(crate) fn is_unobstructed(&self) -> bool {
        self.invalid_count == 0
            && self.blocked_count == 0
            && (self.filled || self.received.count == self.vertex_count())
    }

    /// Whether a record brings anything: it is the first of its id, or newer than the one accepted before, and is accepted
    /// from now on.
    pub(crate) fn admits(&mut self, file: ContentId, id: RecordId, generation: u32) -> bool {
        matches!(self.accepted.0.admit(file, id, generation), Arrival::New | Arrival::Newer)
    }

    /// Whether records of another file than this have been accepted.
    pub(crate) fn is_of_another_file(&self, file: ContentId) -> bool {
        self.accepted.0.file().is_some_and(|accepted| accepted != file)
    }

    /// The numbers of all vertices, for whoever gives every vertex a value.
    pub(crate) fn fill_numbers(&mut self) -> &mut [f32] {
        self.filled = true;
        self.values.numbers_mut()
    }
}

fn checked_vertices(lattice: &Lattice, limit: u64) -> Result<usize, GridError> {
    lattice.check()?;
    let vertices = lattice.vertex_count();
    let limit = limit.min(u64::from(u32::MAX));
    match usize::try_from(vertices) {
        Ok(count) if vertices <= limit => Ok(count),
        _ => Err(GridError::TooManyVertices { vertices, limit }),
    }
}

/// The bits of those neighbours of a vertex in +x, +y, +z that the lattice has.
fn existing_edges(lattice: &Lattice, index: usize) -> u8 {
    let at = lattice.coords(index as u64);
    (0..3).filter(|&axis| at[axis] + 1 < lattice.dims[axis]).fold(0, |bits, axis| bits | 1 << axis)
}

fn check_length(array: &'static str, found: usize, vertices: usize) -> Result<(), GridError> {
    if found == vertices { Ok(()) } else { Err(GridError::Length { array, found, vertices }) }
}

/// One bit a vertex, and how many are set.
#[derive(Clone, Debug, PartialEq)]
struct BitSet {
    words: Vec<u64>,
    count: usize,
}

impl BitSet {
    fn new(len: usize) -> Self {
        Self { words: vec![0; len.div_ceil(64)], count: 0 }
    }

    fn contains(&self, index: usize) -> bool {
        self.words[index / 64] >> (index % 64) & 1 == 1
    }

    fn insert(&mut self, index: usize) {
        let word = &mut self.words[index / 64];
        let bit = 1 << (index % 64);
        self.count += usize::from(*word & bit == 0);
        *word |= bit;
    }
}

#[cfg(test)]
mod tests;
