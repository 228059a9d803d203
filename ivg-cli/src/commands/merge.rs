use std::process::ExitCode;

use ivg_bake::{Accumulator, Estimator};
use ivg_format::{Encoding, Quantity};

use crate::args::MergeArguments;
use crate::baking::{self, Stored};
use crate::failure::Failure;
use crate::{files, table};

pub(crate) fn run(arguments: &MergeArguments) -> Result<ExitCode, Failure> {
    files::require_extension(&arguments.out, &["ivg"])?;
    let parts =
        arguments.files.iter().map(|path| baking::read_sums(path)).collect::<Result<Vec<_>, Failure>>()?;
    let shards = parts.len();
    for (part, path) in parts.iter().zip(&arguments.files).skip(1) {
        let differs = |error| {
            Failure::file(path, format_args!("does not belong to {}: {error}", arguments.files[0].display()))
        };
        parts[0].check_same(part).map_err(differs)?;
    }
    let whole = Accumulator::merge(parts).map_err(Failure::new)?;
    let storage = &arguments.storage;
    let encoding = storage.encoding.unwrap_or(match whole.quantity() {
        Quantity::Vectors => Encoding::PackedOct24,
        Quantity::Radiance => Encoding::Sh2,
    });
    if encoding.quantity() != whole.quantity() {
        return Err(Failure::usage(format_args!(
            "the shards hold {}, which {} does not store",
            whole.quantity().name(),
            encoding.name()
        )));
    }
    let (seed, bounces) = whole.seed_and_bounces();
    let (order, per_slice, estimator) = (storage.order, storage.per_slice, Estimator::TrackLength);
    let result = whole.finish().map_err(Failure::new)?;
    let stored = Stored { encoding, order, per_slice, seed, bounces, estimator };
    let file = baking::encode(&result.grid, &result.stats, &stored)?;
    files::write(&arguments.out, &file)?;
    files::print(&format!(
        "{}: {} photons in {shards} shards, {}\n",
        arguments.out.display(),
        result.stats.photons,
        table::bytes(file.len() as u64)
    ))?;
    Ok(ExitCode::SUCCESS)
}
