//! Cells and what they hold (PMESH-COD-11).

use pmesh_format::Header;

use super::symbols::Symbols;
use super::{Cell, POSITION, Position, bits, fault, minus};
use crate::reference::Fault;
use crate::reference::lattice::Lattice;

/// PMESH-COD-11: cells and what they hold.
pub(super) struct Cells {
    pub(super) most: Cell,
    /// Unit and first cell, with `f32`.
    pub(super) unit: Option<(f64, Cell)>,
    pub(super) bounds: [[f32; 3]; 2],
}

impl Cells {
    pub(super) fn new(header: &Header) -> Self {
        let bounds = header.bounds;
        if let Some(bits) = header.positions.bits() {
            return Self { most: Lattice::new(bounds, bits).most, unit: None, bounds };
        }
        let greatest = bounds.as_flattened().iter().fold(0f32, |all, x| all.max(x.abs()));
        // The step above a number, halved where it is the last of its octave; the same for all that are smaller than 2⁻¹²⁶.
        let exponent =
            if greatest < f32::MIN_POSITIVE { -126 } else { f64::from(greatest).log2().floor() as i32 };
        let mut unit = 2f64.powi((exponent - 23).max(-149));
        loop {
            let [low, high] = bounds.map(|corner| corner.map(|x| (f64::from(x) / unit).floor() as i64));
            let most = minus(high, low);
            if most.iter().all(|&most| most < 1 << 20) {
                return Self { most, unit: Some((unit, low)), bounds };
            }
            unit *= 2.0;
        }
    }

    /// The position in a cell.
    pub(super) fn position(&self, symbols: &mut Symbols<'_>, cell: Cell) -> Result<Position, Fault> {
        let Some((unit, low)) = self.unit else {
            return Ok(Position::Cell(cell));
        };
        let mut position = [0.0; 3];
        for axis in 0..3 {
            // Numbers in ascending order: 0 is the place of +0, −1 that of −0.
            let place = |units: i64| {
                let x = ((units as f64 * unit) as f32).max(f32::MIN);
                let size = i64::from(x.abs().to_bits());
                if units == 0 {
                    -1
                } else if x < 0.0 {
                    -1 - size
                } else {
                    size
                }
            };
            let units = low[axis] + cell[axis];
            let (first, next) = (place(units), place(units + 1));
            let most = (next - 1 - first).max(0);
            let chosen = symbols.about("place in a cell").raw(bits(most));
            let rank = first + chosen.min(most);
            let number =
                if rank < 0 { -f32::from_bits((-1 - rank) as u32) } else { f32::from_bits(rank as u32) };
            if chosen > most || !(self.bounds[0][axis] <= number && number <= self.bounds[1][axis]) {
                return fault(POSITION);
            }
            position[axis] = number;
        }
        Ok(Position::Exact(position))
    }
}
