//! A grid as a file: shared by every command that writes one.

use ivg_format::{BakedLight, EncodeOptions, GridSource, Order};
use ivg_grid::IrradianceGrid;
use ivg_grid::importance::{self, ImportanceOptions};

use crate::failure::Failure;
use crate::progress;

/// What a file holds besides the grid.
#[derive(Debug, Default)]
pub(crate) struct Extras {
    /// Name of each light whose light is in the grid, and whether its direct light is.
    pub(crate) lights: Vec<(String, bool)>,
    /// Key-value pairs.
    pub(crate) metadata: Vec<(String, String)>,
}

/// The bundles of the order explicit, what matters most first; shows that it is at work. Nothing for other orders.
pub(crate) fn bundles(grid: &IrradianceGrid, options: &EncodeOptions) -> Option<Vec<Vec<u64>>> {
    if options.order != Order::Explicit {
        return None;
    }
    let longest = grid.lattice().dims.into_iter().max().unwrap_or(1);
    let largest = options.vertices_per_slice as usize * usize::from(longest);
    let bar = progress::working("order vertices");
    let bundles = importance::bundles(grid, &ImportanceOptions::new(largest));
    bar.finish_and_clear();
    Some(bundles)
}

/// Encodes a grid.
///
/// # Errors
///
/// What cannot be written, and what to use instead.
pub(crate) fn encode(
    source: GridSource<'_>,
    extras: &Extras,
    options: &EncodeOptions,
) -> Result<Vec<u8>, Failure> {
    let lights: Vec<BakedLight<'_>> =
        extras.lights.iter().map(|(name, direct)| BakedLight { name, direct_included: *direct }).collect();
    let meta: Vec<(&str, &str)> =
        extras.metadata.iter().map(|(key, value)| (key.as_str(), value.as_str())).collect();
    let source = GridSource { lights: &lights, meta: &meta, ..source };
    ivg_format::encode(&source, options).map_err(Failure::new)
}
