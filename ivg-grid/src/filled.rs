//! A grid that stays filled while its vertices arrive.

use std::collections::BTreeMap;

use ivg_format::{Event, Lattice, VertexValues};

use crate::fill::Runs;
use crate::{FillOptions, GridError, IrradianceGrid};

/// An irradiance grid whose vertices arrive in any order and that can be looked at, filled, at any moment.
///
/// Arrivals are only noted. The next [`grid`](Self::grid) computes what they change: the nodes of the pyramid above
/// them and the missing vertices that depend on them; where a node gets the value that it had, its influence ends. The
/// result is bit for bit that of [`fill()`](crate::fill()) for the same received vertices, whatever the order in which
/// they came, whether some were replaced, and whenever the grid was looked at before. A change of validity or blocked
/// edges makes the next look compute everything.
///
/// ```
/// use ivg_format::Lattice;
/// use ivg_grid::{FillOptions, FilledGrid, IrradianceGrid};
///
/// let lattice = Lattice::new([9, 9, 9], [0.0; 3], [1.0; 3])?;
/// let mut filled = FilledGrid::new(IrradianceGrid::new(lattice)?, FillOptions::default());
/// for (vertex, light) in [(0, 1.0), (728, 3.0), (364, 2.0)] {
///     filled.set(vertex, &[[[light; 3]; 3]; 6]);
///     // A frame: every vertex has a value, between those that have arrived.
///     assert!(filled.grid().vectors().iter().all(|vectors| (1.0..=3.0).contains(&vectors[0][0][0])));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Memory: besides the grid about 80 bytes a vertex (60 for radiance harmonics), as much again where geometry keeps
/// some vertices from being reached, at most six times as much for the worst pattern of blocked edges, and a copy of
/// what was received for invalid vertices.
#[derive(Clone, Debug)]
pub struct FilledGrid {
    grid: IrradianceGrid,
    options: FillOptions,
    /// Nothing before the first look and after a change of validity or blocked edges.
    runs: Option<Runs>,
    /// What was received for invalid vertices, whose values in the grid are filled. Empty while there are no runs.
    withheld: BTreeMap<usize, VertexValues>,
    pending: bool,
}

impl FilledGrid {
    /// Takes over a grid: what it has received, its validity and its blocked edges. Nothing is computed yet.
    #[must_use]
    pub fn new(grid: IrradianceGrid, options: FillOptions) -> Self {
        Self { grid, options, runs: None, withheld: BTreeMap::new(), pending: true }
    }

    /// The grid with a value at every vertex: computes what has changed since the last look.
    pub fn grid(&mut self) -> &IrradianceGrid {
        if std::mem::take(&mut self.pending) {
            let runs = match &mut self.runs {
                Some(runs) => runs,
                None => {
                    let hidden = (0..self.grid.vertex_count())
                        .filter(|&index| self.grid.is_received(index) && !self.grid.is_valid(index));
                    self.withheld = hidden.filter_map(|index| Some((index, self.grid.get(index)?))).collect();
                    self.runs.insert(Runs::new(&self.grid, self.options))
                }
            };
            runs.update(self.grid.fill_numbers());
        }
        &self.grid
    }

    /// The filled grid alone.
    #[must_use]
    pub fn into_grid(mut self) -> IrradianceGrid {
        self.grid();
        self.grid
    }

    /// Whether something has arrived since the last look, so that the next one computes.
    #[must_use]
    pub fn is_pending(&self) -> bool {
        self.pending
    }

    /// Where the vertices are.
    #[must_use]
    pub fn lattice(&self) -> &Lattice {
        self.grid.lattice()
    }

    /// Number of vertices received so far.
    #[must_use]
    pub fn received_count(&self) -> usize {
        self.grid.received_count()
    }

    /// What has been received for a vertex, as it was; nothing before it has arrived.
    #[must_use]
    pub fn received(&self, index: usize) -> Option<VertexValues> {
        let received = index < self.grid.vertex_count() && self.grid.is_received(index);
        let values = || self.withheld.get(&index).copied().or_else(|| self.grid.get(index));
        received.then(values).flatten()
    }

    /// Receives the values of a vertex; a second time replaces the first.
    ///
    /// # Panics
    ///
    /// If `index` is not less than the number of vertices, or the values are of the other quantity.
    pub fn set(&mut self, index: usize, values: impl Into<VertexValues>) {
        self.grid.set(index, values);
        self.note(index);
    }

    /// Takes over what an event brings, as [`IrradianceGrid::accept`] does.
    ///
    /// # Errors
    ///
    /// As [`IrradianceGrid::accept`]. Nothing has changed then.
    pub fn accept(&mut self, event: &Event<'_>) -> Result<(), GridError> {
        match event {
            Event::Corners(bundle) | Event::Bundle(bundle) => {
                // The grid may ignore the bundle. What it has of an invalid vertex is then what was received.
                for vertex in bundle.vertices() {
                    self.reveal(vertex);
                }
                let accepted = self.grid.accept(event);
                for vertex in bundle.vertices() {
                    if let Some(index) = self.index(vertex).filter(|&index| self.grid.is_received(index)) {
                        self.note(index);
                    }
                }
                accepted
            }
            Event::Validity(block) => {
                let changes = (0..block.len()).any(|n| {
                    self.index(block.first_vertex().saturating_add(n as u64)).is_some_and(|index| {
                        self.grid.is_valid(index) != (block.validity()[n] > 0)
                            || self.grid.blocked_edges()[index] != block.blocked_edges(n)
                    })
                });
                if changes {
                    self.start_again();
                }
                self.grid.accept(event)
            }
            _ => self.grid.accept(event),
        }
    }

    /// Sets the validity of a vertex: 0 inside geometry … 255 all free.
    ///
    /// # Panics
    ///
    /// If `index` is not less than the number of vertices.
    pub fn set_validity(&mut self, index: usize, validity: u8) {
        if self.grid.is_valid(index) != (validity > 0) {
            self.start_again();
        }
        self.grid.set_validity(index, validity);
    }

    /// Sets which edges of a vertex geometry cuts, as [`IrradianceGrid::set_blocked_edges`] does.
    ///
    /// # Panics
    ///
    /// If `index` is not less than the number of vertices.
    pub fn set_blocked_edges(&mut self, index: usize, bits: u8) {
        if self.grid.blocked_edges()[index] != bits {
            self.start_again();
        }
        self.grid.set_blocked_edges(index, bits);
    }

    /// Makes the next look compute everything again, the pyramid excepted, and not only what has changed. That gives
    /// the same values; it is what benchmarks compare with.
    pub fn forget_filled(&mut self) {
        self.pending = true;
        if let Some(runs) = &mut self.runs {
            runs.forget();
        }
    }

    /// A vertex has been received.
    fn note(&mut self, index: usize) {
        self.pending = true;
        let Some(runs) = &mut self.runs else { return };
        if self.grid.is_valid(index) {
            runs.receive(index);
        } else {
            runs.overwrite(index);
            if let Some(values) = self.grid.get(index) {
                self.withheld.insert(index, values);
            }
        }
    }

    /// Puts back what was received for a vertex.
    fn reveal(&mut self, vertex: u64) {
        let index = self.index(vertex);
        if let Some((index, values)) = index.and_then(|index| self.withheld.remove_entry(&index)) {
            self.grid.set(index, values);
        }
    }

    /// Back to the state before the first look.
    fn start_again(&mut self) {
        self.pending = true;
        self.runs = None;
        for (index, values) in std::mem::take(&mut self.withheld) {
            self.grid.set(index, values);
        }
    }

    /// The place of a vertex, if the grid has it.
    fn index(&self, vertex: u64) -> Option<usize> {
        usize::try_from(vertex).ok().filter(|&index| index < self.grid.vertex_count())
    }
}

#[cfg(test)]
mod tests;
