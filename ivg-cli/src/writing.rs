//! A grid as a file: shared by every command that writes one.

use ivg_format::{BakedLight, EncodeOptions, GridSource};

use crate::failure::Failure;

/// What a file holds besides the grid.
#[derive(Debug, Default)]
pub(crate) struct Extras {
    /// Name of each light whose light is in the grid, and whether its direct light is.
    pub(crate) lights: Vec<(String, bool)>,
    /// Key-value pairs.
    pub(crate) metadata: Vec<(String, String)>,
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
