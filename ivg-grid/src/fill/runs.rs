//! The two runs of push-pull: where received vertices reach, and the rest.

use ivg_format::{Lattice, Quantity};

use super::push_pull::PushPull;
use super::row::Row;
use super::{FillOptions, Smoothing};
use crate::IrradianceGrid;
use crate::pyramid::Pyramid;

/// Numbers of a vertex of irradiance vectors: six hemispheres, three channels, three components.
const VECTORS: usize = 54;
/// Numbers of a vertex of radiance harmonics: three channels, nine coefficients.
const RADIANCE: usize = 27;

/// The runs over the values of a grid of either quantity.
#[derive(Clone, Debug)]
pub(crate) enum Runs {
    Vectors(Box<TwoRuns<VECTORS>>),
    Radiance(Box<TwoRuns<RADIANCE>>),
}

impl Runs {
    /// The runs for a grid's validity, blocked edges and received vertices.
    pub(crate) fn new(grid: &IrradianceGrid, options: FillOptions) -> Self {
        match grid.quantity() {
            Quantity::Vectors => Self::Vectors(Box::new(TwoRuns::new(grid, options))),
            Quantity::Radiance => Self::Radiance(Box::new(TwoRuns::new(grid, options))),
        }
    }

    /// The values of a valid vertex have been received.
    pub(crate) fn receive(&mut self, vertex: usize) {
        match self {
            Self::Vectors(runs) => runs.reach.know(vertex),
            Self::Radiance(runs) => runs.reach.know(vertex),
        }
    }

    /// The values of an invalid vertex have been overwritten and have to be filled again.
    pub(crate) fn overwrite(&mut self, vertex: usize) {
        match self {
            Self::Vectors(runs) => runs.overwrite(vertex),
            Self::Radiance(runs) => runs.overwrite(vertex),
        }
    }

    /// Forgets all but what has been received.
    pub(crate) fn forget(&mut self) {
        match self {
            Self::Vectors(runs) => runs.forget(),
            Self::Radiance(runs) => runs.forget(),
        }
    }

    /// Brings the numbers of all vertices up to date.
    pub(crate) fn update(&mut self, numbers: &mut [f32]) {
        match self {
            Self::Vectors(runs) => runs.update(numbers.as_chunks_mut().0),
            Self::Radiance(runs) => runs.update(numbers.as_chunks_mut().0),
        }
    }
}

/// Both runs over rows of `W` numbers.
#[derive(Clone, Debug)]
pub(crate) struct TwoRuns<const W: usize> {
    lattice: Lattice,
    options: FillOptions,
    reach: PushPull<W>,
    /// The run through a pyramid without obstructions, from the first time it is needed.
    rest: Option<PushPull<W>>,
}

impl<const W: usize> TwoRuns<W> {
    fn new(grid: &IrradianceGrid, options: FillOptions) -> Self {
        let mut reach = PushPull::new(Pyramid::of_grid(grid), options);
        (0..grid.vertex_count())
            .filter(|&vertex| grid.is_received(vertex) && grid.is_valid(vertex))
            .for_each(|vertex| reach.know(vertex));
        Self { lattice: *grid.lattice(), options, reach, rest: None }
    }

    fn overwrite(&mut self, vertex: usize) {
        if let Some(rest) = &mut self.rest {
            rest.recompute(vertex);
        }
    }

    fn forget(&mut self) {
        self.reach.forget();
        if let Some(rest) = &mut self.rest {
            rest.forget();
        }
    }

    fn update(&mut self, rows: &mut [Row<W>]) {
        let received =
            self.reach.changed().iter().fold(self.reach.range(), |range, vertex| range.with(&rows[vertex]));
        self.reach.set_range(received);
        self.reach.update(rows);
        if let Some(rest) = &mut self.rest {
            rest.know_all(self.reach.changed());
        } else if !self.reach.valued().is_full() {
            // A guess is not worth a second pass.
            let options = FillOptions { smoothing: Smoothing::Nowhere, ..self.options };
            let mut rest = PushPull::new(Pyramid::unobstructed(&self.lattice), options);
            rest.know_all(self.reach.valued());
            self.rest = Some(rest);
        }
        self.reach.settle();
        if let Some(rest) = &mut self.rest {
            rest.set_range(received);
            rest.narrow();
            rest.update(rows);
            rest.settle();
            if !rest.knows_any() {
                rows.fill([0.0; W]);
            }
        }
    }
}
