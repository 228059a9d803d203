//! Between the file format and the grid: decoder events into vertices, and a grid as something to encode.

use ivg_format::{
    Bundle, Event, GridSource, Header, HemisphereVectors, Limits, Quantity, RadianceHarmonics, decode_all,
};

use crate::{GridError, IrradianceGrid, VALIDITY_FREE};

/// Vertices that are decoded at once: enough to be fast, few enough to stay in the nearest cache.
const BLOCK: usize = 64;

impl IrradianceGrid {
    /// Takes over what an event brings: the values of a bundle or of the corners, or a block of validity and blocked
    /// edges. Other events bring nothing; a header is only compared.
    ///
    /// Events may come in any order, as records fetched one by one do. A record that comes again with a higher generation
    /// replaces what it brought before, one with the same or a lower changes nothing (`spec/ivg.md`, "Updates").
    ///
    /// # Errors
    ///
    /// [`GridError::OtherLattice`], [`GridError::OtherQuantity`] and, once a record of one file was accepted,
    /// [`GridError::OtherFile`] if the event belongs to another file. The grid is as before then.
    pub fn accept(&mut self, event: &Event<'_>) -> Result<(), GridError> {
        match event {
            Event::Header(header) => self.check_lattice(header),
            Event::Corners(bundle) | Event::Bundle(bundle) => {
                self.check_lattice(bundle.header())?;
                if self.admits(bundle.header().content_id, bundle.id(), bundle.generation()) {
                    self.receive(bundle);
                }
                Ok(())
            }
            Event::Validity(block) => {
                self.check_lattice(block.header())?;
                if !self.admits(block.header().content_id, block.id(), block.generation()) {
                    return Ok(());
                }
                let first = address(block.first_vertex());
                for (n, &validity) in block.validity().iter().enumerate() {
                    self.set_validity(first + n, validity);
                    self.set_blocked_edges(first + n, block.blocked_edges(n));
                }
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Takes over the values of a bundle of the same lattice and quantity.
    fn receive(&mut self, bundle: &Bundle<'_>) {
        let mut vertices = bundle.vertices().map(address);
        let blocks = (0..bundle.len()).step_by(BLOCK).map(|first| first..bundle.len().min(first + BLOCK));
        match self.quantity() {
            Quantity::Vectors => {
                let mut values = [HemisphereVectors::default(); BLOCK];
                for block in blocks {
                    let values = &mut values[..block.len()];
                    bundle.read_vectors(block.start, values);
                    values
                        .iter()
                        .zip(vertices.by_ref())
                        .for_each(|(values, vertex)| self.set(vertex, values));
                }
            }
            Quantity::Radiance => {
                let mut values = [RadianceHarmonics::default(); BLOCK];
                for block in blocks {
                    let values = &mut values[..block.len()];
                    bundle.read_radiance(block.start, values);
                    values
                        .iter()
                        .zip(vertices.by_ref())
                        .for_each(|(values, vertex)| self.set(vertex, values));
                }
            }
        }
    }

    /// The grid in a whole file, and the file's header.
    ///
    /// Allocates 219 bytes a vertex, 111 for radiance harmonics, and that only once the file is seen to be as long as its
    /// header says: at most six times the length of `bytes`, or 160 times where the order `explicit` leaves out vertices
    /// that light does not reach.
    ///
    /// # Errors
    ///
    /// [`GridError::Format`] with what is wrong with the file (its end missing included), and
    /// [`GridError::TooManyVertices`] beyond [`Limits::vertices`].
    pub fn from_file(bytes: &[u8], limits: &Limits) -> Result<(Self, Header), GridError> {
        let mut whole: Option<(Self, Header)> = None;
        decode_all(bytes, limits, |event| -> Result<(), GridError> {
            match (&mut whole, &event) {
                (None, Event::Header(header)) if header.file_bytes <= bytes.len() as u64 => {
                    let quantity = header.encoding.quantity();
                    let grid = Self::with_limit(header.lattice, quantity, limits.vertices)?;
                    whole = Some((grid, (*header).clone()));
                    Ok(())
                }
                (None, _) => Ok(()),
                (Some((grid, _)), event) => grid.accept(event),
            }
        })?;
        // A file that decodes has a header and is as long as it says.
        whole.ok_or(GridError::OtherLattice)
    }

    /// The grid as something to encode, without lights and metadata, which a file that was read has in its chunks, and
    /// without its units: those go into `EncodeOptions::units`. Without a validity section where every vertex is
    /// free and no edge is blocked.
    ///
    /// Vertices without a value are written as darkness: a file has no missing ones.
    #[must_use]
    pub fn as_source(&self) -> GridSource<'_> {
        let mut source = GridSource::new(*self.lattice(), self.values());
        source.validity =
            self.validity().iter().any(|&validity| validity != VALIDITY_FREE).then(|| self.validity());
        source.blocked_edges = (self.blocked_edge_count() > 0).then(|| self.blocked_edges());
        source
    }

    fn check_lattice(&self, header: &Header) -> Result<(), GridError> {
        if header.lattice != *self.lattice() {
            return Err(GridError::OtherLattice);
        }
        if header.encoding.quantity() != self.quantity() {
            return Err(GridError::OtherQuantity);
        }
        if self.is_of_another_file(header.content_id) {
            return Err(GridError::OtherFile);
        }
        Ok(())
    }
}

/// The place of a vertex in memory. A lattice that fits has only such.
fn address(vertex: u64) -> usize {
    usize::try_from(vertex).unwrap_or(usize::MAX)
}

#[cfg(test)]
mod tests;
